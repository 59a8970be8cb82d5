#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "compose.glsl"
#include "tone.glsl"

// Two pictures of linear radiance side by side, each pixel the mean of its samples, as a display shows them.
layout(set = 0, binding = 0) uniform ComposeBlock { AperturaCompose compose; };
layout(set = 0, binding = 1) uniform texture2D first;
layout(set = 0, binding = 2) uniform texture2D second;

layout(location = 0) out vec4 colour;

vec3 pixelOf(texture2D picture, int samples) {
    vec3 sum = vec3(0.0);
    for (int y = 0; y < samples; ++y)
        for (int x = 0; x < samples; ++x) sum += texelFetch(picture, ivec2(gl_FragCoord.xy) * samples + ivec2(x, y), 0).rgb;
    return compose.show.y / float(samples * samples) * sum;
}

void main() {
    bool isSecond = gl_FragCoord.x >= compose.show.x;
    vec3 shown = isSecond ? pixelOf(second, compose.samples.y) : pixelOf(first, compose.samples.x);
    if (isSecond && compose.show.w > 0.0) {
        // Red where the first is too bright, blue where it is too dark, white where it errs by more than a display can show.
        float off = dot(pixelOf(first, compose.samples.x) - shown, vec3(0.2126, 0.7152, 0.0722));
        shown = max(vec3(off, abs(off) - 0.5, -off), vec3(0.0));
    } else if (compose.show.z > 0.0) {
        shown = aperturaNeutralTone(shown);
    }
    colour = vec4(shown, 1.0);
}
