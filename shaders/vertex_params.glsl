// What samples, vertices and those on faces, store for one model. Include it before any other constant or buffer of a shader.
#ifndef APERTURA_VERTEX_PARAMS_GLSL
#define APERTURA_VERTEX_PARAMS_GLSL
#include "models.glsl"
#include "scene.glsl"
#include "stored_bounce.glsl"

layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(constant_id = 1) const int lightClass = APERTURA_LIGHTS_ANY;
layout(constant_id = 2) const uint slots = 1;                                          // vec4s of the parameters of a vertex
layout(std430, set = 0, binding = 3) readonly buffer AllParams { vec4 allParams[]; };  // `slots` per sample
layout(std430, set = 0, binding = 5) readonly buffer Seen { vec4 seen[]; };            // D, A, sr, of each sample: first the vertices

// What is seen at a sample. `normal`: of the receiver, unit.
AperturaReceiver receiverOf(uint place, vec3 normal) {
    AperturaReceiver receiver;
    receiver.normal = normal;
    receiver.visibility = seen[place];
    for (uint k = 0; k < slots; ++k) receiver.params[k] = allParams[place * slots + k];
    return receiver;
}

#endif
