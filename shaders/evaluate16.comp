#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
// evaluate.comp in 16-bit floats: receivers and lights arrive in 32 bits, as the CPU made them; all that depends on both
// is computed in 16.
#define APERTURA_HALF
#include "models.glsl"
#include "visible.glsl"

// The same text again in 32 bits, for what depends on a light alone.
#undef APERTURA_HALF
#undef APERTURA_CAP_GLSL
#define AperturaCapLight WideLight
#define APERTURA_PI WIDE_PI
#define APERTURA_LIGHTS_ANY WIDE_ANY
#define APERTURA_LIGHTS_MEDIUM WIDE_MEDIUM
#define APERTURA_LIGHTS_SMALL WIDE_SMALL
#define APERTURA_LIGHTS_SUN WIDE_SUN
#include "cap.glsl"
#undef AperturaCapLight
#undef APERTURA_PI
#undef APERTURA_LIGHTS_ANY
#undef APERTURA_LIGHTS_MEDIUM
#undef APERTURA_LIGHTS_SMALL
#undef APERTURA_LIGHTS_SUN
#include "evaluate.glsl"

layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(constant_id = 1) const int lightClass = APERTURA_LIGHTS_ANY;
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Inputs { AperturaEvaluation inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Outputs { vec2 results[]; };  // light, sky

float16_t narrow(float x) { return float16_t(clamp(x, -65504.0, 65504.0)); }
f16vec4 narrow(vec4 v) { return f16vec4(clamp(v, vec4(-65504.0), vec4(65504.0))); }

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    AperturaReceiver receiver;
    receiver.normal = f16vec3(narrow(inputs[i].normal));
    receiver.visibility = narrow(inputs[i].visibility);
    for (int k = 0; k < APERTURA_MAX_SLOTS; ++k) receiver.params[k] = narrow(inputs[i].params[k]);
    WideLight wide = aperturaCapLight(inputs[i].light.xyz, inputs[i].light.w);
    AperturaCapLight light = AperturaCapLight(f16vec3(narrow(vec4(wide.axis, 0.0))), narrow(wide.sinRadius), narrow(wide.height),
                                              narrow(wide.area), narrow(wide.rim), narrow(wide.rimSlope), narrow(wide.angle),
                                              narrow(wide.inverseAngle), narrow(wide.inverseSin), narrow(wide.inverseHeight),
                                              narrow(wide.shrink), narrow(wide.spread), narrow(wide.axialWeight));
    results[i] = vec2(aperturaIrradianceThrough(model, receiver, light, lightClass), aperturaSkyIrradiance(model, receiver));
}
