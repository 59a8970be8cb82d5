#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "models.glsl"

// What a model costs: one receiver per invocation, from a buffer that holds nothing more than the model reads, and one
// light in a uniform buffer. This is compiled and timed for every model alike, and the cost includes all of it.
layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(constant_id = 1) const int lightClass = APERTURA_LIGHTS_ANY;
layout(constant_id = 2) const uint slots = 1;
layout(constant_id = 3) const bool sky = false;  // with the irradiance from the sky
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Points { vec4 points[]; };  // normal, visibility, parameters
layout(std430, set = 0, binding = 1) writeonly buffer Results { float results[]; };
layout(set = 0, binding = 2) uniform LightBlock { AperturaLight light; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    uint first = i * (2 + slots);
    AperturaReceiver receiver;
    receiver.normal = points[first].xyz;
    receiver.visibility = points[first + 1];
    for (uint k = 0; k < slots; ++k) receiver.params[k] = points[first + 2 + k];
    float e = aperturaIrradianceThrough(model, receiver, light.cap, lightClass);
    if (sky) e += max(aperturaSkyIrradiance(model, receiver) - e, 0.0);
    results[i] = e;
}
