// Visibility in an image over a set of texture coordinates. Row 0 is on top, where v is 0; the middle of texel (i, j) lies at
// ((i + 1/2) / width, (j + 1/2) / height), as in glTF.
#ifndef APERTURA_TEXELS_GLSL
#define APERTURA_TEXELS_GLSL
#include "cap.glsl"

// The four texels about a point, and their weights, which sum to 1: those of bilinear filtering. Beyond the outermost texels' middles,
// theirs.
struct TexelCell {
    ivec4 texels;
    vec4 weights;
};

// `place`: in texels from the middle of texel (0, 0).
APERTURA_FN TexelCell texelCellAt(vec2 place, int width, int height) {
    float x = clamp(place.x, 0.0f, float(width - 1));
    float y = clamp(place.y, 0.0f, float(height - 1));
    int i = int(min(x, float(max(width - 2, 0))));
    int j = int(min(y, float(max(height - 2, 0))));
    int right = min(i + 1, width - 1) - i;
    int down = (min(j + 1, height - 1) - j) * width;
    int first = j * width + i;
    x -= float(i);
    y -= float(j);
    return TexelCell(ivec4(first, first + right, first + down, first + down + right),
                     vec4((1.0f - x) * (1.0f - y), x * (1.0f - y), (1.0f - x) * y, x * y));
}

// Texture coordinates in texels from the middle of texel (0, 0).
APERTURA_FN vec2 placeInImage(vec2 coordinates, float width, float height) { return coordinates * vec2(width, height) - vec2(0.5f); }

#endif
