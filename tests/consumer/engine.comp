#version 450
#extension GL_GOOGLE_include_directive : require
// An engine's shader, with names of its own that the formulas of shaders/ have without their prefix.
#include "engine_names.glsl"

#include "apertura/shaders/background.glsl"
#include "apertura/shaders/frame.glsl"
#include "apertura/shaders/lattice.glsl"
#include "apertura/shaders/models.glsl"
#include "apertura/shaders/texels.glsl"
#include "apertura/shaders/tone.glsl"
#include "apertura/shaders/visible.glsl"
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Numbers { vec4 numbers[]; };
vec4 aperturaSoftNode(int i) { return numbers[i]; }
#include "apertura/shaders/soft_table.glsl"
layout(std140, binding = 1) uniform Lights { AperturaLight engineLights[APERTURA_MAX_LIGHTS]; };
AperturaLight aperturaLightAt(int list, int i) { return engineLights[i]; }
#include "apertura/shaders/lights.glsl"

void main() {
    AperturaReceiver receiver;
    receiver.normal = numbers[0].xyz;
    receiver.visibility = numbers[1];
    receiver.params[0] = aperturaLimitSharpness(aperturaSoftFrom(numbers[1].xyz, numbers[1].w, numbers[0].xyz));
    AperturaCapLight light = aperturaCapLight(numbers[2].xyz, numbers[2].w);
    numbers[3].x = aperturaIrradianceThrough(APERTURA_MODEL_SOFT, receiver, light, APERTURA_LIGHTS_SUN);
    numbers[3].y = aperturaSkyIrradiance(APERTURA_MODEL_SOFT, receiver) + float(PI) * 0.0;
}
