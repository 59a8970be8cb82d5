#pragma once
// Where the rays of each vertex start. A vertex is a poor place to look from: other triangles meet there, and it may lie
// on or inside other geometry. So its rays start a rounding step inside its own triangles, or farther inside them where
// that point is buried.
#include <string>
#include <vector>

#include "apertura/bake/sampling/solids.h"

namespace apertura {

// What is doubtful in a scene's meshes, counted, and what is done about it.
struct MeshIssues {
    size_t degenerate = 0;     // triangles of no area: they block nothing
    size_t withoutFaces = 0;   // vertices of such triangles alone: they look along the normal that the file has, or +Y
    size_t inverted = 0;       // triangles wound opposite to their vertices' normals: the normals are believed
    size_t normalsBehind = 0;  // vertices whose normal points behind all of their faces: they look out on the faces' side
    size_t moved = 0;          // vertices inside something else: they look from the nearest point of their triangles that is outside
    size_t large = 0;          // triangles longer than a twentieth of the scene: visibility is known only at their corners
    size_t insideSolids = 0;   // vertices that see backs of faces, and no better from elsewhere on their triangles: they stay as they are
};

// One line for each count that is not zero.
std::vector<std::string> describe(const MeshIssues& issues);

struct VertexPoints {
    std::vector<SurfacePoint> points;               // one for each vertex that triangles use
    std::vector<std::pair<size_t, size_t>> places;  // instance and vertex of each point
};

// The starting points of all vertices that triangles use. `issues`, where given, receives the counts. The result does not
// depend on the number of threads. Throws Cancelled.
VertexPoints placeVertices(const Scene& scene, const Tracer& tracer, const Progress& progress = {}, MeshIssues* issues = nullptr);

}  // namespace apertura
