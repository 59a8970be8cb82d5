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
layout(location = 11) in vec3 bounceShare;
layout(location = 12) in vec3 bounceTowards;
layout(constant_id = 5) const int bounces = APERTURA_BOUNCES_NONE;

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
    vec3 fromSky = irradiance.sky * radiance;
    AperturaBounce bounce = AperturaBounce(bounceShare, bounceTowards);
    if (bounces != APERTURA_BOUNCES_NONE) {
        if (bounces != APERTURA_BOUNCES_BAKED) bounce = aperturaBounceAround(irradiance.sky, around, absorbedAround(bounces, base));
        fromSky = aperturaSkyBounced(irradiance.sky, radiance, bounce);
    }
    vec3 sum = aperturaSumOf(irradiance, fromSky, frame.brightest.rgb);
    if (bounces != APERTURA_BOUNCES_NONE) sum += aperturaBouncedLights(bounce, 0, frame.counts.x, lightClass);
    colour = painting(base, sum);
}
