// What a frame is lit by: the uniform buffer of scene.vert and scene.frag, laid out alike (std140) in
// GLSL and in C++ (runtime/renderer.h).
#ifndef APERTURA_FRAME_GLSL
#define APERTURA_FRAME_GLSL
#include "cap.glsl"

const int MAX_LIGHTS = 16;

// A direction with an angular radius, or a sphere at a place.
struct Light {
    vec4 place;     // xyz: unit direction towards it where w = 0, its centre in metres where w = 1
    vec4 shape;     // x, y: sine of the radius and 1 - cosine of a direction; z: a sphere's radius, metres
    vec4 radiance;  // rgb, W/m2/sr
};

struct Frame {
    mat4 toClip;
    vec4 sky;       // rgb, W/m2/sr, from everywhere that no light fills
    vec4 albedo;    // rgb, 0..1
    ivec4 counts;   // x: lights
    Light lights[MAX_LIGHTS];
};

// The cap that a light fills as seen from `position`, metres.
APERTURA_FN CapLight lightSeenFrom(vec3 position, Light light) {
    if (light.place.w > 0.0f) return sphereLight(vec3(light.place) - position, light.shape.z);
    return CapLight(vec3(light.place), light.shape.x, light.shape.y);
}

#endif
