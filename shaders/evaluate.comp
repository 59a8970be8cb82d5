#version 450
#extension GL_GOOGLE_include_directive : require
#include "models.glsl"
#include "evaluate.glsl"

layout(constant_id = 0) const int model = MODEL_SOFT;
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Inputs { Evaluation inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Outputs { vec2 results[]; };  // light, sky

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    Evaluation e = inputs[i];
    Receiver receiver = interpolatedReceiver(e.normal.xyz, e.visibility, e.aperture, e.soft);
    CapLight light = CapLight(e.light.xyz, e.normal.w, e.light.w);
    results[i] = vec2(lightThrough(model, receiver, light), skyThrough(model, receiver));
}
