#version 450
#extension GL_GOOGLE_include_directive : require
#include "background.glsl"
#include "scene.glsl"

// What is seen beside the scene: the sky, lights at infinity, and with APERTURA_LAMPS those that stand in the scene, behind or before its
// surfaces.
layout(set = 0, binding = 1) uniform sampler2D skyPicture;

layout(location = 0) in vec2 screen;
layout(location = 0) out vec4 colour;

void main() {
    vec3 ray = normalize(frame.rays[0].xyz + screen.x * frame.rays[1].xyz + screen.y * frame.rays[2].xyz);
    vec3 seen = frame.background.rgb;
    if (frame.background.w > 0.0) seen = textureLod(skyPicture, aperturaPlaceInSky(ray), 0.0).rgb;
    float nearest = 0.0;
    for (int i = frame.counts.x - 1; i >= 0; --i) {
        if (!aperturaIsSphere(frame.lights[i]) && aperturaIsWithin(frame.lights[i].cap, ray)) seen = frame.lights[i].radiance.rgb;
    }
#if APERTURA_LAMPS
    gl_FragDepth = 0.0;
    for (int i = 0; i < frame.counts.x; ++i) {
        float along = aperturaDistanceToLamp(frame.lights[i].sphere, frame.eye.xyz, ray);
        if (aperturaIsSphere(frame.lights[i]) && along > 0.0 && (nearest == 0.0 || along < nearest)) {
            nearest = along;
            seen = frame.lights[i].radiance.rgb;
            vec4 at = frame.toClip * vec4(frame.eye.xyz + along * ray, 1.0);
            gl_FragDepth = clamp(at.z / at.w, 0.0, 1.0);
        }
    }
#endif
    colour = vec4(seen, 1.0);
}
