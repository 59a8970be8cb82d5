#version 450
#extension GL_GOOGLE_include_directive : require
#include "models.glsl"
#include "scene.glsl"
AperturaLight aperturaLightAt(int frameOfAll, int i) { return frame.lights[i]; }
#include "lights.glsl"
#define APERTURA_PAINT_CONSTANT 3
#include "paint.glsl"

layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(constant_id = 1) const int more = APERTURA_MAX_LIGHTS / 4;
layout(constant_id = 2) const int lightClass = APERTURA_LIGHTS_ANY;

layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
layout(location = 2) in vec4 seen;
layout(location = 3) in vec3 radiance;
layout(location = 4) in vec4 visible[APERTURA_MAX_LIGHTS / 4];
layout(location = 10) in vec4 around;
layout(constant_id = 5) const bool bounces = false;

layout(location = 0) out vec4 colour;

AperturaIrradiance irradiance = AperturaIrradiance(vec3(0.0), vec3(0.0), 0.0);

// Without blockers a light's E is that of the pixel: its own normal, and what it sees of a lamp.
void addLight(vec3 normal, AperturaLight light, float fraction) {
    AperturaCapLight cap = aperturaCapSeenFrom(worldPosition, light, lightClass);
    irradiance = aperturaWithLight(irradiance, light, cap, fraction * aperturaUnoccludedIrradiance(normal, cap, lightClass), frame.sky);
}

void main() {
    vec4 base = baseColour();
    AperturaReceiver receiver;
    receiver.normal = normalize(worldNormal);
    receiver.visibility = vec4(seen.xyz, 0.0);
    if (frame.counts.x > 0) addLight(receiver.normal, frame.lights[0], seen.w);
    for (int i = 0; i < more; ++i)
        for (int k = 0; k < 4; ++k)
            if (4 * i + k + 1 < frame.counts.x) addLight(receiver.normal, frame.lights[4 * i + k + 1], visible[i][k]);
    irradiance.sky = aperturaSkyNeedsMore(model) ? seen.x : aperturaSkyIrradiance(model, receiver);
    vec3 sum = aperturaSumOf(irradiance, irradiance.sky * radiance, frame.brightest.rgb);
    if (bounces) {
        vec3 albedo = frame.around.w > 0.0 ? base.rgb : frame.around.rgb;
        sum += aperturaBounced(aperturaBounceAround(irradiance.sky, around, albedo), frame.sky, 0, frame.counts.x);
    }
    colour = painting(base, sum);
}
