#version 450
#extension GL_GOOGLE_include_directive : require
#include "evaluate.glsl"
#include "visible.glsl"

layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(constant_id = 1) const int lightClass = APERTURA_LIGHTS_ANY;
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Inputs { AperturaEvaluation inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Outputs { vec2 results[]; };  // light, sky

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    AperturaReceiver receiver;
    receiver.normal = inputs[i].normal.xyz;
    receiver.visibility = inputs[i].visibility;
    receiver.params = inputs[i].params;
    AperturaCapLight light = aperturaCapLight(inputs[i].light.xyz, inputs[i].light.w);
    results[i] = vec2(aperturaIrradianceThrough(model, receiver, light, lightClass), aperturaSkyIrradiance(model, receiver));
}
