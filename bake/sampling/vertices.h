#pragma once
// Where the rays of each vertex start. A vertex is a poor place to look from: others meet there, and it may lie on or
// inside other geometry; so its rays start a rounding step within its own triangles, or farther where that is buried.
#include <string>
#include <vector>

#include "bake/sampling/solids.h"

namespace apertura {

// What a scene leaves open, counted; and what was made of it.
struct MeshIssues {
    size_t degenerate = 0;     // triangles of no area: they block nothing
    size_t withoutFaces = 0;   // vertices of those alone: they look along the normal that the file has, or +Y
    size_t inverted = 0;       // triangles wound against their vertices' normals: the normals are believed
    size_t normalsBehind = 0;  // vertices whose normal points behind all of their faces: they look out on the faces' side
    size_t moved = 0;          // vertices inside something else: they look from the nearest point of their triangles outside
    size_t large = 0;          // triangles longer than a twentieth of the scene: visibility is known at their corners alone
    size_t insideSolids = 0;   // vertices that see backs of faces, and no better from their triangles: they stay as they are
};

// One line for each that is not nothing.
std::vector<std::string> describe(const MeshIssues& issues);

struct VertexPoints {
    std::vector<SurfacePoint> points;               // of the vertices that triangles use
    std::vector<std::pair<size_t, size_t>> places;  // instance and vertex of each
};

// The result does not depend on the number of threads. Throws Cancelled.
VertexPoints placeVertices(const Scene& scene, const Tracer& tracer, const Progress& progress = {}, MeshIssues* issues = nullptr);

}  // namespace apertura
