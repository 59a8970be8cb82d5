#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "scene.glsl"
#include "shadow.glsl"

layout(set = 0, binding = 3) uniform ShadowBlock { ShadowView shadow; };
layout(set = 0, binding = 4) uniform texture2D shadowMap;

layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
layout(location = 2) in vec3 weights;
layout(location = 3) flat in uvec3 corners;

layout(location = 0) out vec4 colour;

const int TAPS = 32;

float depthAt(vec2 uv) {
    ivec2 texel = clamp(ivec2(uv * shadow.shape.y), ivec2(0), ivec2(int(shadow.shape.y) - 1));
    return texelFetch(shadowMap, texel, 0).r;
}

// Point i of a Fibonacci lattice on the unit disc, rotated by `turn` radians, which differ from pixel to pixel.
vec2 tap(int i, float turn) {
    float angle = 2.399963 * float(i) + turn;
    return sqrt((float(i) + 0.5) / float(TAPS)) * vec2(cos(angle), sin(angle));
}

void main() {
    vec3 normal = normalize(worldNormal);
    CapLight light = frame.lights[0].cap;
    vec3 seen = vec3(dot(normal, shadow.right.xyz), dot(normal, shadow.up.xyz), dot(normal, shadow.towards.xyz));
    vec4 clip = shadow.toLight * vec4(worldPosition + 2.0 * shadow.shape.z * normal, 1.0);
    vec2 uv = 0.5 * clip.xy + 0.5;
    float here = clip.z;
    // The slope of the surface itself across the disc: the map's depth per texture coordinate.
    vec2 rise = -seen.xy / max(seen.z, 0.15) * shadow.towards.w / vec2(shadow.right.w, -shadow.up.w);
    // The light's radius in texture coordinates, per unit of depth.
    vec2 reach = shadow.shape.x / shadow.towards.w * vec2(shadow.right.w, shadow.up.w);
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));

    float sum = 0.0, count = 0.0;
    for (int i = 0; i < TAPS; ++i) {
        vec2 offset = reach * max(1.0 - here, 0.0) * tap(i, turn);
        float depth = depthAt(uv + offset);
        if (depth > here + dot(rise, offset) + 1e-4) {
            sum += depth;
            count += 1.0;
        }
    }
    float open = 1.0;
    if (count > 0.0) {
        vec2 penumbra = max(reach * (sum / count - here), vec2(0.7 / shadow.shape.y));
        open = 0.0;
        for (int i = 0; i < TAPS; ++i) {
            vec2 offset = penumbra * tap(i, turn);
            open += depthAt(uv + offset) > here + dot(rise, offset) + 1e-4 ? 0.0 : 1.0;
        }
        open /= float(TAPS);
    }
    float lit = open * irradianceAboveHorizon(normal, light);
    vec3 irradiance = lit * frame.lights[0].radiance.rgb + max(PI - lit, 0.0) * frame.sky.rgb;
    colour = vec4(frame.albedo.rgb / PI * irradiance, 1.0);
}
