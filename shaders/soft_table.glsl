// The soft aperture of four numbers, looked up: at load for what is drawn as it is stored, in the shader for what is filtered first.
// Whoever includes this text has `vec4 aperturaSoftNode(int i)`, node i of the table (sh/soft.h).
#ifndef APERTURA_SOFT_TABLE_GLSL
#define APERTURA_SOFT_TABLE_GLSL
#include "soft.glsl"
#include "soft_grid.glsl"

const float APERTURA_LOBE_SHARPEST = 240.0f;  // the limit of |slope|

// Limits a lobe's sharpness so that its edge is no narrower than the sun: a point-like light would step over a harder one. The lobe keeps
// the area of the sphere that it lets through, or the area that it blocks where that is less. With a slope of length S this area is
// 2 pi / S times the integral of aperturaSoftStep up to its value f at the axis, (f + sqrt(1 + f^2)) / 2. (Where the horizon cuts the lobe,
// the part above it changes.)
APERTURA_FN vec4 aperturaLimitSharpness(vec4 lobe) {
    float sharp = length(vec3(lobe));
    float side = lobe.w > 0.0f ? -1.0f : 1.0f;
    if (!(sharp > APERTURA_LOBE_SHARPEST) && !(sharp + abs(lobe.w) > APERTURA_LOBE_FARTHEST)) return lobe;
    if (sharp < 1e-6f) return vec4(0.0f, 0.0f, 0.0f, -side * APERTURA_LOBE_FARTHEST);
    float peak = sharp + side * lobe.w;
    float root = sqrt(1.0f + peak * peak);
    float height = clamp((peak > 0.0f ? peak + root : 1.0f / (root - peak)) / (2.0f * sharp), 1e-12f, 1.0f);  // area / 2 pi
    // A slope S gives that area if f = S height - 1 / (4 S height), with the offset f - S. The sharpest S within the limit solves
    // S + (S - f) = APERTURA_LOBE_FARTHEST. If no S gives so small an area, the faintest lobe is taken.
    float left = APERTURA_LOBE_FARTHEST * APERTURA_LOBE_FARTHEST - (2.0f - height) / height;
    float S = min(min((APERTURA_LOBE_FARTHEST + sqrt(max(left, 0.0f))) / (2.0f * (2.0f - height)), sharp), APERTURA_LOBE_SHARPEST);
    float f = max(S * height - 1.0f / (4.0f * S * height), 2.0f * S - APERTURA_LOBE_FARTHEST);
    return vec4(vec3(lobe) * (S / sharp), side * (f - S));
}

// The node below coordinate c (0..1) on an axis of `nodes` nodes, and the fraction of the way to the next one.
struct AperturaSoftCell {
    int index;
    float t;
};
APERTURA_FN AperturaSoftCell aperturaSoftCell(float c, int nodes) {
    float scaled = clamp(c, 0.0f, 1.0f) * float(nodes - 1);
    int index = min(int(scaled), nodes - 2);
    return AperturaSoftCell(index, scaled - float(index));
}

// Slope and offset of the soft aperture whose integrals over the hemisphere about `normal` (unit) are A and D, sr. They must be possible,
// as those of any mix of visibilities are: |D| <= A (1 - A / 4 pi). Not limited yet.
APERTURA_FN vec4 aperturaSoftFrom(vec3 D, float A, vec3 normal) {
    float open = A / (2.0f * float(APERTURA_PI));
    float x = clamp(open, APERTURA_SOFT_LEAST_AREA, 1.0f - APERTURA_SOFT_LEAST_AREA);
    // Where the area is clamped, the direction is scaled with it. If nothing or everything is open, visibility is an even haze.
    bool even = open <= 0.0f || open > x;
    vec3 direction = even ? float(APERTURA_PI) * x * normal : D * (x / open);
    float n = dot(direction, normal);
    vec3 across = direction - n * normal;
    float t = even ? 0.0f : length(across);
    float above = n - float(APERTURA_PI) * x;
    float distance = sqrt(above * above + t * t);

    float rootOpen = sqrt(x);
    float rootBlocked = sqrt(1.0f - x);
    AperturaSoftCell area = aperturaSoftCell(rootOpen / (rootOpen + rootBlocked), APERTURA_SOFT_AREAS);
    AperturaSoftCell turn = aperturaSoftCell(0.5f - 0.5f * above / max(abs(above) + t, 1e-20f), APERTURA_SOFT_PSIS);
    vec4 w = vec4((1.0f - area.t) * (1.0f - turn.t), (1.0f - area.t) * turn.t, area.t * (1.0f - turn.t), area.t * turn.t);
    int first = (area.index * APERTURA_SOFT_PSIS + turn.index) * APERTURA_SOFT_REACHES;
    ivec4 columns = ivec4(first, first + APERTURA_SOFT_REACHES, first + APERTURA_SOFT_PSIS * APERTURA_SOFT_REACHES,
                          first + (APERTURA_SOFT_PSIS + 1) * APERTURA_SOFT_REACHES);
    float boundary = 0.0f;
    for (int c = 0; c < 4; ++c) boundary += w[c] * aperturaSoftNode(columns[c]).w;

    float rho = distance / (float(APERTURA_PI) * x * (1.0f - x) * boundary);
    float reach = min(1.0f - sqrt(1.0f - min(rho, 1.0f)), APERTURA_SOFT_REACH);
    rho = 1.0f - (1.0f - reach) * (1.0f - reach);
    AperturaSoftCell depth = aperturaSoftCell(reach / APERTURA_SOFT_REACH, APERTURA_SOFT_REACHES);
    vec4 node = vec4(0.0f);
    for (int c = 0; c < 4; ++c) {
        vec4 a = aperturaSoftNode(columns[c] + depth.index);
        vec4 b = aperturaSoftNode(columns[c] + depth.index + 1);
        node += w[c] * (a + depth.t * (b - a));
    }
    float variance = x * (1.0f - x);
    float slope = node.x * rho / sqrt((1.0f - rho) * variance);
    // softStepInverse(x)^2 + 1, in closed form
    float haze = 1.0f / (4.0f * variance);
    // The direction (above, t), rotated by the lean.
    float lean = node.y;
    float scale = slope / (max(distance, 1e-20f) * (1.0f + lean * lean));
    float c = 1.0f - lean * lean;
    float s = 2.0f * lean;
    float alongNormal = scale * (c * above - s * t);
    float sideways = t > 0.0f ? scale * (c * t + s * above) / t : 0.0f;
    return vec4(alongNormal * normal + sideways * across, node.z * sqrt(haze + slope * slope));
}

#endif
