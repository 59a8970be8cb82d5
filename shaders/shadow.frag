#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define APERTURA_PAINT_CONSTANT 0
#define APERTURA_PAINT_BINDING 4
#include "paint.glsl"
#include "soft_shadow.glsl"

layout(set = 0, binding = 3) uniform ShadowBlock { AperturaShadowView shadow; };
layout(set = 0, binding = 5) uniform texture2D shadowMap;

layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;

layout(location = 0) out vec4 colour;

void main() {
    vec4 base = baseColour();
    vec3 normal = normalize(worldNormal);
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    float open = aperturaOpenInShadowMap(shadowMap, shadow, worldPosition, normal, turn);
    float lit = open * aperturaIrradianceAboveHorizon(normal, frame.lights[0].cap);
    vec3 sky = APERTURA_PI * aperturaSkyMean(frame.sky, 2.0 / 3.0 * normal);
    vec3 irradiance = lit * frame.lights[0].radiance.rgb + max(sky - lit * frame.lights[0].behind.rgb, vec3(0.0));
    colour = painting(base, irradiance);
}
