#pragma once
// Visibility at points and at all vertices of a scene.
#include <cstdint>
#include <span>
#include <vector>

#include "bake/tracer.h"
#include "runtime/asset.h"

namespace apertura {

// A point of a surface and the hemisphere it looks into.
struct SurfacePoint {
    glm::vec3 position;  // world, metres
    glm::vec3 normal;    // unit
};

enum class BakeModel {
    Sh,    // visibility projected to four SH coefficients, and converted
    Rays,  // visible area and mean direction straight from the rays
};

struct BakeOptions {
    BakeModel model = BakeModel::Sh;
    int rays = 256;          // a point, 1 .. 1 << 20
    uint32_t seed = 1;
    double maxDistance = 0;  // metres beyond which nothing blocks; 0: no limit
    int threads = 0;         // 0: all cores
};

// `n` directions of the hemisphere about +Z, each standing for 2 pi / n sr: capLattice, ordered so that
// neighbours in the list are neighbours on the sphere.
std::vector<glm::vec3> hemisphereLattice(int n);

// `n` directions of the cap about +Z of height h = 1 - cos(radius), each standing for 2 pi h / n sr, from
// its centre outwards.
std::vector<glm::vec3> capLattice(int n, double h);

// Visibility at points: a lattice spun by an angle of its own, hashed from the seed and the index, at each.
// The result does not depend on the number of threads. Throws Cancelled.
std::vector<Visibility> bakePoints(const Tracer& tracer, std::span<const SurfacePoint> points,
                                   const BakeOptions& options, const Progress& progress = {});

// Visibility at the vertices that triangles use; the others are closed.
BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options,
                             const Progress& progress = {});

// A number in 0..1 from a seed and two indices; the same everywhere.
double hashUnit(uint32_t seed, uint64_t a, uint64_t b);

// Columns x, y, z: a right-handed frame whose z is `normal`, spun about it by `angle` radians.
glm::mat3 frameAbout(const glm::vec3& normal, double angle);

}  // namespace apertura
