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

// The same with as few vertices as keep every texel within `error` metres (>= 0) of the surface, above or below: triangles of halved
// squares (Evans, Kirkpatrick & Townsend, "Right-Triangulated Irregular Networks", 2001), of which each is judged by all texels
// that it covers. It has no gaps, and seen from above no triangle lies over another. What meets texels without data, or the edge of a map
// whose sides are not 128 k + 1 texels, stays as fine as the field. Normals are those of the full field. Throws Cancelled.
Surface decimatedMesh(const HeightField& field, double error, const Progress& progress = {});

// How far the texels lie above or below a mesh that decimatedMesh made: RMS and most, metres.
struct MeshError {
    double rms = 0, most = 0;
};
MeshError errorOf(const HeightField& field, const Surface& mesh);

}  // namespace apertura
