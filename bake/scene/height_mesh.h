#pragma once
// A height field as a mesh.
#include "apertura/bake/sampling/height_field.h"
#include "apertura/bake/sampling/progress.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// The world of a height field: +x east, +y up, +z south, the middle of the map over the origin.
glm::dvec3 placeOf(const HeightField& field, int x, int y, float height);

// A vertex for each texel with data, row after row, and the triangles that HeightField states. Normals are those of the field's slopes, and
// coordinates lie over the field's texels.
Surface fullMesh(const HeightField& field);

// Texels along the sides of a tile, less the one that it shares with the next: their images are small enough for all devices.
constexpr int kTileTexels = 1536;

// The same in tiles of kTileTexels, row after row, and with as few vertices as keep every texel within `error` metres (>= 0) of the
// surface, above or below: triangles of halved squares (Evans, Kirkpatrick & Townsend, "Right-Triangulated Irregular Networks", 2001), of
// which each is judged by all texels that it covers. It has no gaps, and seen from above no triangle lies over another. What meets texels
// without data, or the edge of a map whose sides are not 128 k + 1 texels, stays as fine as the field. Tiles without a triangle are left
// out. Normals are those of the full field, and each tile's coordinates lie over its own texels. Throws Cancelled.
std::vector<Surface> decimatedMesh(const HeightField& field, double error, const Progress& progress = {});

}  // namespace apertura
