#version 450
#extension GL_GOOGLE_include_directive : require
#include "evaluate.glsl"
#include "visible.glsl"

layout(constant_id = 0) const int model = MODEL_SOFT;
layout(constant_id = 1) const int lightClass = LIGHTS_ANY;
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Inputs { Evaluation inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Outputs { vec2 results[]; };  // light, sky

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    Receiver receiver;
    receiver.normal = inputs[i].normal.xyz;
    receiver.visibility = inputs[i].visibility;
    receiver.params = inputs[i].params;
    CapLight light = capLight(inputs[i].light.xyz, inputs[i].light.w);
    results[i] = vec2(irradianceThrough(model, receiver, light, lightClass), skyIrradiance(model, receiver));
}
