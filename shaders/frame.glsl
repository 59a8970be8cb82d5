// What lights a frame, and what is drawn: the buffers of scene.vert and scene.frag, with the same layout in GLSL (std140,
// std430) and in C++ (runtime/render/renderer.cpp).
#ifndef APERTURA_FRAME_GLSL
#define APERTURA_FRAME_GLSL
#include "cap.glsl"

const int APERTURA_MAX_LIGHTS = 16;

// A directional light with an angular radius, or a glowing sphere.
struct APERTURA_STD140 AperturaLight {
    AperturaCapLight cap;  // the directional light
    vec4 sphere;           // xyz: the centre of the sphere, w: its radius > 0, metres; zeros for a directional light
    vec4 radiance;         // rgb, W/m2/sr
};

APERTURA_FN bool aperturaIsSphere(AperturaLight light) { return light.sphere.w > 0.0f; }

struct AperturaFrame {
    mat4 toClip;
    vec4 sky;     // rgb, W/m2/sr, from all directions that no light fills
    vec4 albedo;  // rgb, 0..1
    // x: number of lights, 0..MAX_LIGHTS; y: where the frame's lit vertices begin, in floats; z: floats of each; w: where the faces begin
    // in the indices, 0: there are none
    ivec4 counts;
    AperturaLight lights[APERTURA_MAX_LIGHTS];
};

struct AperturaSceneVertex {
    vec4 position;  // xyz: world, metres; w: the texture coordinate u
    vec4 normal;    // xyz: unit; w: v
};

// The cap that a light fills as seen from `position`, metres. A lightClass other than APERTURA_LIGHTS_ANY has no spheres.
APERTURA_FN AperturaCapLight aperturaCapSeenFrom(vec3 position, AperturaLight light, int lightClass) {
    if (lightClass != APERTURA_LIGHTS_ANY) return light.cap;
    AperturaCapLight cap = light.cap;
    if (aperturaIsSphere(light)) cap = aperturaCapOfSphere(vec3(light.sphere) - position, light.sphere.w);
    return cap;
}

#endif
