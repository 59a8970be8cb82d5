// BASELINE: percentage-closer soft shadows (Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH sketch 2005) of one directional light,
// from a shadow map. GLSL and C++ include this text; C++ reads a map that rays fill in, texel by texel (sh/shading.h).
#ifndef APERTURA_SOFT_SHADOW_GLSL
#define APERTURA_SOFT_SHADOW_GLSL
#include "cap.glsl"
#include "shadow.glsl"

#ifndef APERTURA_CPP
#define APERTURA_SHADOW_MAP texture2D
float aperturaShadowDepth(texture2D map, ivec2 texel) { return texelFetch(map, texel, 0).r; }
#endif

const int APERTURA_SHADOW_TAPS = 32;

APERTURA_FN float aperturaShadowDepthAt(APERTURA_SHADOW_MAP map, AperturaShadowView shadow, vec2 uv) {
    int last = int(shadow.shape.y) - 1;
    return aperturaShadowDepth(map,
                               clamp(ivec2(int(floor(uv.x * shadow.shape.y)), int(floor(uv.y * shadow.shape.y))), ivec2(0), ivec2(last)));
}

// Point i of a Fibonacci lattice on the unit disc, rotated by `turn` radians.
APERTURA_FN vec2 aperturaShadowTap(int i, float turn) {
    float angle = 2.399963f * float(i) + turn;
    return sqrt((float(i) + 0.5f) / float(APERTURA_SHADOW_TAPS)) * vec2(cos(angle), sin(angle));
}

// The fraction of the light that the map lets through to a point of the surface, 0..1.
//   position  world, metres; normal: unit
//   turn      radians that the taps are rotated by, different from pixel to pixel
APERTURA_FN float aperturaOpenInShadowMap(APERTURA_SHADOW_MAP map, AperturaShadowView shadow, vec3 position, vec3 normal, float turn) {
    vec3 seen = vec3(dot(normal, vec3(shadow.right)), dot(normal, vec3(shadow.up)), dot(normal, vec3(shadow.towards)));
    vec4 clip = shadow.toLight * vec4(position + 2.0f * shadow.shape.z * normal, 1.0f);
    vec2 uv = 0.5f * vec2(clip) + vec2(0.5f);
    float here = clip.z;
    // The slope of the surface itself across the disc: the map's depth per texture coordinate.
    vec2 rise = -vec2(seen) / max(seen.z, 0.15f) * shadow.towards.w / vec2(shadow.right.w, -shadow.up.w);
    // The light's radius in texture coordinates, per unit of depth.
    vec2 reach = shadow.shape.x / shadow.towards.w * vec2(shadow.right.w, shadow.up.w);
    float sum = 0.0f;
    float count = 0.0f;
    for (int i = 0; i < APERTURA_SHADOW_TAPS; ++i) {
        vec2 offset = reach * max(1.0f - here, 0.0f) * aperturaShadowTap(i, turn);
        float depth = aperturaShadowDepthAt(map, shadow, uv + offset);
        if (depth > here + dot(rise, offset) + 1e-4f) {
            sum += depth;
            count += 1.0f;
        }
    }
    if (count <= 0.0f) return 1.0f;
    vec2 penumbra = max(reach * (sum / count - here), vec2(0.7f / shadow.shape.y));
    float open = 0.0f;
    for (int i = 0; i < APERTURA_SHADOW_TAPS; ++i) {
        vec2 offset = penumbra * aperturaShadowTap(i, turn);
        open += aperturaShadowDepthAt(map, shadow, uv + offset) > here + dot(rise, offset) + 1e-4f ? 0.0f : 1.0f;
    }
    return open / float(APERTURA_SHADOW_TAPS);
}

#endif
