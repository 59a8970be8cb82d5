// Samples on a triangle: a lattice of the points whose barycentric coordinates about corners 1 and 2 are i / steps and j / steps, with
// i + j <= steps. They are stored row after row, each row from i = 0 on: row 0 leads from corner 0 to corner 1, and the last row is
// corner 2. (The samples of a face are its "mesh colors": Yuksel, Keyser & House, "Mesh Colors", 2010; theirs share edges.)
#ifndef APERTURA_LATTICE_GLSL
#define APERTURA_LATTICE_GLSL
#include "cap.glsl"

// A face of level 0 has its vertices alone; of level 1, samples of its own at its three corners; and each level more doubles the steps.
const int MAX_LATTICE_LEVEL = 9;  // 33153 samples
APERTURA_FN int latticeSteps(int level) { return 1 << (level - 1); }

APERTURA_FN int latticeSize(int steps) { return (steps + 1) * (steps + 2) / 2; }

// Where row j begins.
APERTURA_FN int latticeRow(int j, int steps) { return j * (2 * steps + 3 - j) / 2; }

// The three samples about a point of the triangle, and their weights, which sum to 1.
struct LatticeCell {
    ivec3 samples;
    vec3 weights;
};

// `barycentrics`: weights of the triangle's corners; they may lie a little outside, as a fragment's do. Floats hold all places exactly, and
// GPUs multiply them several times faster than integers.
APERTURA_FN LatticeCell latticeCell(vec3 barycentrics, int steps) {
    float n = float(steps);
    float x = max(barycentrics.y * n, 0.0f);
    float y = max(barycentrics.z * n, 0.0f);
    float i = min(floor(x), n - 1.0f);
    float j = min(floor(y), n - 1.0f - i);
    x -= i;
    y -= j;
    int row = int(j * (n + 1.5f - 0.5f * j) + i);
    int above = row + int(n + 1.0f - j);
    // The half of the cell's square that faces away from corner 0. There is none at the far edge.
    bool isFar = x + y > 1.0f && i + j < n - 1.0f;
    return LatticeCell(ivec3(isFar ? above + 1 : row, row + 1, above), vec3(abs(1.0f - x - y), isFar ? 1.0f - y : x, isFar ? 1.0f - x : y));
}

#endif
