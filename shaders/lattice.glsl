// Samples on a triangle: a lattice of the points whose barycentric coordinates about corners 1 and 2 are i / steps and j / steps, with
// i + j <= steps. They are stored row after row, each row from i = 0 on: row 0 leads from corner 0 to corner 1, and the last row is
// corner 2. (The samples of a face are its "mesh colors": Yuksel, Keyser & House, "Mesh Colors", 2010; theirs share edges.)
#ifndef APERTURA_LATTICE_GLSL
#define APERTURA_LATTICE_GLSL
#include "cap.glsl"

// A face of level 0 has its vertices alone; of level 1, samples of its own at its three corners; and each level more doubles the steps.
const int APERTURA_MAX_LATTICE_LEVEL = 9;  // 33153 samples
APERTURA_FN int aperturaLatticeSteps(int level) { return 1 << (level - 1); }

APERTURA_FN int aperturaLatticeSize(int steps) { return (steps + 1) * (steps + 2) / 2; }

// Where row j begins.
APERTURA_FN int aperturaLatticeRow(int j, int steps) { return j * (2 * steps + 3 - j) / 2; }

// Three samples about a point of the triangle, and their weights, which sum to 1.
struct AperturaLatticeCell {
    ivec3 samples;
    vec3 weights;
};

// What a corner's own weight is short of 1 in aperturaPlaceInLattice: points of the triangle then lie in its cells, however a GPU rounds.
const float APERTURA_LATTICE_MARGIN = 3.0e-5f;

// Where in a lattice a point is, in steps: its barycentric coordinates about corners 1 and 2, drawn in from the edges a little. `weights`:
// those of corners 1 and 2. Affine, so that it may be taken at the corners and interpolated.
APERTURA_FN vec2 aperturaPlaceInLattice(vec2 weights, float steps) {
    return steps * (weights * (1.0f - 3.0f * APERTURA_LATTICE_MARGIN) + vec2(APERTURA_LATTICE_MARGIN));
}

// The cell about a place. Its samples are given as their distances from those of the first cell, which are 0, 1 and steps + 1: a triangle
// that has its three vertices alone, wherever these are stored, is thus a lattice of one step. Floats hold all numbers here exactly, and
// GPUs multiply them several times faster than integers. `pitch`: steps + 1.5.
APERTURA_FN AperturaLatticeCell aperturaLatticeCellFromFirst(vec2 place, float pitch) {
    float i = floor(place.x);
    float j = floor(place.y);
    float row = i + j * (pitch - 0.5f * j);
    float x = place.x - i;
    float y = place.y - j;
    float left = 1.0f - x;
    float rest = left - y;
    bool isFar = rest < 0.0f;  // in the half of the cell's square that faces away from corner 0
    return AperturaLatticeCell(ivec3(int(isFar ? row - j + (pitch + 0.5f) : row), int(row), int(row - j)),
                               vec3(abs(rest), isFar ? 1.0f - y : x, isFar ? left : y));
}

// The cell about a point of the given weights of the triangle's corners, 0..1, its samples counted from the lattice's own first.
APERTURA_FN AperturaLatticeCell aperturaLatticeCell(vec3 barycentrics, int steps) {
    AperturaLatticeCell cell = aperturaLatticeCellFromFirst(aperturaPlaceInLattice(vec2(barycentrics.y, barycentrics.z), float(steps)),
                                                            float(steps) + 1.5f);
    cell.samples += ivec3(0, 1, steps + 1);
    return cell;
}

#endif
