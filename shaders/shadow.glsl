// How a shadow map sees the scene: see soft_shadow.glsl. The same layout (std140) in GLSL and in C++.
#ifndef APERTURA_SHADOW_GLSL
#define APERTURA_SHADOW_GLSL

struct AperturaShadowView {
    mat4 toLight;  // clip space of the map: depth 1 nearest the light, 0 farthest
    vec4 right;    // xyz: the map's axes in the world, unit; w of each: 1 / the map's extent along it, 1/m
    vec4 up;
    vec4 towards;  // xyz: towards the light; w: 1 / the depth's range, 1/m
    vec4 shape;    // x: tangent of the light's radius; y: texels a side; z: a texel, metres
};

#endif
