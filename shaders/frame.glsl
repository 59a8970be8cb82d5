// What a frame is lit by, and what is drawn: the buffers of scene.vert and scene.frag, laid out alike in
// GLSL (std140, std430) and in C++ (runtime/render/renderer.cpp).
#ifndef APERTURA_FRAME_GLSL
#define APERTURA_FRAME_GLSL
#include "cap.glsl"

const int MAX_LIGHTS = 16;

// A directional light with an angular radius, or a glowing sphere at a place.
struct APERTURA_STD140 Light {
    CapLight cap;   // of a directional light
    vec4 sphere;    // of a sphere: xyz its centre, w its radius > 0, metres; of a directional light: zeros
    vec4 radiance;  // rgb, W/m2/sr
};

APERTURA_FN bool isSphere(Light light) { return light.sphere.w > 0.0f; }

struct Frame {
    mat4 toClip;
    vec4 sky;      // rgb, W/m2/sr, from everywhere that no light fills
    vec4 albedo;   // rgb, 0..1
    ivec4 counts;  // x: lights
    Light lights[MAX_LIGHTS];
};

struct SceneVertex {
    vec4 position;    // xyz: world, metres
    vec4 normal;      // xyz: unit
    vec4 visibility;  // D, A, sr
};

// The cap that a light fills as seen from `position`, metres.
APERTURA_FN CapLight capSeenFrom(vec3 position, Light light) {
    if (isSphere(light)) return capOfSphere(vec3(light.sphere) - position, light.sphere.w);
    return light.cap;
}

#endif
