#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "models.glsl"

layout(constant_id = 0) const int model = MODEL_SOFT;  // one pipeline a model
layout(set = 0, binding = 0) uniform FrameBlock { Frame frame; };

layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
layout(location = 2) in vec4 visibility;
layout(location = 3) in vec4 aperture;
layout(location = 4) in vec4 soft;

layout(location = 0) out vec4 colour;  // reflected radiance, linear

void main() {
    Receiver receiver = interpolatedReceiver(normalize(worldNormal), visibility, aperture, soft);
    vec3 irradiance = vec3(0.0);
    float lit = 0.0;
    for (int i = 0; i < frame.counts.x; ++i) {
        float e = lightThrough(model, receiver, lightSeenFrom(worldPosition, frame.lights[i]));
        irradiance += e * frame.lights[i].radiance.rgb;
        lit += e;
    }
    // The sky fills what the lights leave of the opening.
    irradiance += max(skyThrough(model, receiver) - lit, 0.0) * frame.sky.rgb;
    colour = vec4(frame.albedo.rgb / PI * irradiance, 1.0);
}
