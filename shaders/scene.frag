#version 450
#extension GL_GOOGLE_include_directive : require
#include "models.glsl"
#include "scene.glsl"

// One pipeline per model and class of lights.
layout(constant_id = 0) const int model = MODEL_SOFT;
layout(constant_id = 1) const int lightClass = LIGHTS_ANY;
layout(constant_id = 2) const uint slots = 1;                                          // vec4s of the parameters of a vertex
layout(constant_id = 3) const bool mixes = true;                                       // the parameters may be interpolated
layout(std430, set = 0, binding = 3) readonly buffer AllParams { vec4 allParams[]; };  // `slots` per vertex

layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
layout(location = 2) in vec3 weights;
layout(location = 3) flat in uvec3 corners;

layout(location = 0) out vec4 colour;  // reflected radiance, linear

Receiver receiver;

// Adds the lights to `irradiance` and the sky's E to `sky`, both times `share`. Returns the lights' E for unit radiance.
float lightReceiver(float share, inout vec3 irradiance, inout float sky) {
    float lit = 0.0;
    for (int i = 0; i < frame.counts.x; ++i) {
        float e = share * irradianceThrough(model, receiver, capSeenFrom(worldPosition, frame.lights[i]), lightClass);
        irradiance += e * frame.lights[i].radiance.rgb;
        lit += e;
    }
    sky += share * skyIrradiance(model, receiver);
    return lit;
}

void main() {
    vec3 irradiance = vec3(0.0);
    float lit = 0.0, sky = 0.0;
    receiver.normal = normalize(worldNormal);
    if (mixes) {
        receiver.visibility = vec4(0.0);
        for (int k = 0; k < MAX_SLOTS; ++k) receiver.params[k] = vec4(0.0);
        for (int c = 0; c < 3; ++c) {
            receiver.visibility += weights[c] * vertices[corners[c]].visibility;
            for (uint k = 0; k < slots; ++k) receiver.params[k] += weights[c] * allParams[corners[c] * slots + k];
        }
        receiver = renormalised(model, receiver);
        lit = lightReceiver(1.0, irradiance, sky);
    } else {
        // The lobes of neighbouring vertices need not correspond: the light at the three corners is interpolated instead.
        for (int c = 0; c < 3; ++c) {
            receiver.visibility = vertices[corners[c]].visibility;
            for (uint k = 0; k < slots; ++k) receiver.params[k] = allParams[corners[c] * slots + k];
            lit += lightReceiver(weights[c], irradiance, sky);
        }
    }
    // The sky fills the part of the opening that the lights leave.
    irradiance += max(sky - lit, 0.0) * frame.sky.rgb;
    colour = vec4(frame.albedo.rgb / PI * irradiance, 1.0);
}
