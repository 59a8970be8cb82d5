// What a frame is lit by, and what is drawn: the buffers of scene.vert and scene.frag, laid out alike in
// GLSL (std140, std430) and in C++ (runtime/renderer.cpp).
#ifndef APERTURA_FRAME_GLSL
#define APERTURA_FRAME_GLSL
#include "cap.glsl"

const int MAX_LIGHTS = 16;

// A direction with an angular radius, or a sphere at a place.
struct Light {
    vec4 place;     // xyz: unit direction towards it where w = 0, its centre in metres where w = 1
    vec4 shape;     // of a direction: sinRadius, height, area, axialWeight; w: a sphere's radius, metres
    vec4 shape2;    // of a direction: rim, rimSlope, angle, inverseAngle
    vec4 shape3;    // of a direction: inverseSin, inverseHeight, shrink, spread
    vec4 radiance;  // rgb, W/m2/sr
};

struct Frame {
    mat4 toClip;
    vec4 sky;       // rgb, W/m2/sr, from everywhere that no light fills
    vec4 albedo;    // rgb, 0..1
    ivec4 counts;   // x: lights
    Light lights[MAX_LIGHTS];
};

struct SceneVertex {
    vec4 position;    // xyz: world, metres
    vec4 normal;      // xyz: unit
    vec4 visibility;  // D, A, sr
};

// The cap of a light from a direction: everything that depends on its size was computed with it.
APERTURA_FN CapLight lightFromAfar(Light light) {
    return CapLight(vec3(light.place), light.shape.x, light.shape.y, light.shape.z, light.shape2.x, light.shape2.y,
                    light.shape2.z, light.shape2.w, light.shape3.x, light.shape3.y, light.shape3.z, light.shape3.w, light.shape.w);
}

// The cap that a light fills as seen from `position`, metres.
APERTURA_FN CapLight lightSeenFrom(vec3 position, Light light) {
    if (light.place.w > 0.0f) return sphereLight(vec3(light.place) - position, light.shape.w);
    return lightFromAfar(light);
}

// A light from a direction.
APERTURA_FN Light lightFrom(CapLight cap, vec3 radiance) {
    return Light(vec4(cap.axis, 0.0f), vec4(cap.sinRadius, cap.height, cap.area, cap.axialWeight),
                 vec4(cap.rim, cap.rimSlope, cap.angle, cap.inverseAngle),
                 vec4(cap.inverseSin, cap.inverseHeight, cap.shrink, cap.spread), vec4(radiance, 0.0f));
}

#endif
