// Visibility in an image over a set of texture coordinates. Row 0 is on top, where v is 0; the middle of texel (i, j) lies at
// ((i + 1/2) / width, (j + 1/2) / height), as in glTF.
#ifndef APERTURA_TEXELS_GLSL
#define APERTURA_TEXELS_GLSL
#include "cap.glsl"

// The four texels about a point, and their weights, which sum to 1: those of bilinear filtering. Beyond the outermost texels' middles,
// theirs.
struct AperturaTexelCell {
    ivec4 texels;
    vec4 weights;
};

// `place`: in texels from the middle of texel (0, 0).
APERTURA_FN AperturaTexelCell aperturaTexelCellAt(vec2 place, int width, int height) {
    float x = clamp(place.x, 0.0f, float(width - 1));
    float y = clamp(place.y, 0.0f, float(height - 1));
    int i = int(min(x, float(max(width - 2, 0))));
    int j = int(min(y, float(max(height - 2, 0))));
    int right = min(i + 1, width - 1) - i;
    int down = (min(j + 1, height - 1) - j) * width;
    int first = j * width + i;
    x -= float(i);
    y -= float(j);
    return AperturaTexelCell(ivec4(first, first + right, first + down, first + down + right),
                             vec4((1.0f - x) * (1.0f - y), x * (1.0f - y), (1.0f - x) * y, x * y));
}

// Mips: each has half the texels of the one before across and down, rounded down, and at least one; the last has one.
APERTURA_FN int aperturaMipSize(int size, int level) { return max(size >> level, 1); }
APERTURA_FN int aperturaMipCount(int width, int height) { return findMSB(max(width, height)) + 1; }
// Where a mip's texels begin, if they lie one mip after another.
APERTURA_FN int aperturaFirstOfMip(int width, int height, int level) {
    int first = 0;
    for (int l = 0; l < level; ++l) first += aperturaMipSize(width, l) * aperturaMipSize(height, l);
    return first;
}

// What of an image a pixel covers: `taps` places, a `step` apart in texels of the image itself, the middle one being the pixel's, each as
// wide as a texel of mip `level`.
struct AperturaTexelFootprint {
    vec2 step;
    int taps;
    float level;
};

const int APERTURA_MOST_TAPS = 8;

// `across`, `down`: how far the place moves, in texels, from this pixel to the next ones. A pixel that is seen at a slant takes several
// places along the longer of the two, as EXT_texture_filter_anisotropic describes it.
APERTURA_FN AperturaTexelFootprint aperturaTexelFootprint(vec2 across, vec2 down, int mips) {
    float a = length(across);
    float b = length(down);
    float longest = max(a, b);
    float ratio = min(longest / max(min(a, b), 1e-6f), longest);
    float taps = clamp(ceil(ratio), 1.0f, float(APERTURA_MOST_TAPS));
    float level = clamp(log2(max(longest / taps, 1.0f)), 0.0f, float(mips - 1));
    return AperturaTexelFootprint((a >= b ? across : down) / taps, int(taps), level);
}

// Of a place in the image, the same place in one of its mips.
APERTURA_FN vec2 aperturaPlaceInMip(vec2 place, int width, int height, int level) {
    vec2 scale = vec2(float(aperturaMipSize(width, level)) / float(width), float(aperturaMipSize(height, level)) / float(height));
    return (place + vec2(0.5f)) * scale - vec2(0.5f);
}

// The cosine between a face and a vertex's normal below which that is not the face's.
const float APERTURA_LEANING = 0.8f;
// 1 if a face's unit normal is on the side of its vertices' normals, else -1. Normals that lie in the face do not tell its side: its
// winding decides.
APERTURA_FN float aperturaSideOfFace(vec3 unit, vec3 normals) { return dot(unit, normals) < -1e-6f * length(normals) ? -1.0f : 1.0f; }
// A face's unit normal on the side of its vertices' normals, where one of these leans from it; else 0. `face`: of any length.
APERTURA_FN vec3 aperturaLeaningFace(vec3 face, vec3 a, vec3 b, vec3 c) {
    float size = length(face);
    if (!(size > 0.0f)) return vec3(0.0f);
    vec3 unit = face / size;
    unit *= aperturaSideOfFace(unit, a + b + c);
    return min(min(dot(unit, a), dot(unit, b)), dot(unit, c)) > APERTURA_LEANING ? vec3(0.0f) : unit;
}

// Texture coordinates in texels from the middle of texel (0, 0).
APERTURA_FN vec2 aperturaPlaceInImage(vec2 coordinates, float width, float height) {
    return coordinates * vec2(width, height) - vec2(0.5f);
}

#endif
