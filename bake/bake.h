#pragma once
// Visibility at points and at all vertices of a scene.
#include <cstdint>
#include <span>
#include <vector>

#include "bake/tracer.h"
#include "bake/fit.h"
#include "bake/vertices.h"
#include "runtime/asset.h"

namespace apertura {

struct BakeOptions {
    std::string_view recipe = "sh";  // of recipes()
    double tolerance = 0.05;         // of the recipe "auto": RMSE of E / (L pi sin^2 r)
    double price = 0;                // of "auto": see FitOptions; bakeVertices finds it itself
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

// What the rays from each point find: a lattice spun by an angle of its own, hashed from the seed and the index.
// Calls `use(i, samples, frame)` for each from any thread; `frame` takes the lattice to the world. Throws Cancelled.
void samplePoints(const Tracer& tracer, std::span<const SurfacePoint> points, const SampleLattice& lattice,
                  const BakeOptions& options, const Progress& progress,
                  const std::function<void(size_t, const Samples&, const glm::mat3&)>& use);

// The price at which `auto` keeps its tolerance over these points.
double priceAt(const Tracer& tracer, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options, double tolerance, const Progress& progress);

// Points as the recipe of the options has them. The result does not depend on the number of threads.
// Throws Cancelled.
std::vector<BakedPoint> bakePoints(const Tracer& tracer, std::span<const SurfacePoint> points,
                                   const BakeOptions& options, const Progress& progress = {});

// At the vertices that triangles use (bake/vertices.h says where); the others are closed. `doubts`, where it is
// given, becomes what was ambiguous.
BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options,
                             const Progress& progress = {}, Doubts* doubts = nullptr);

// A number in 0..1 from a seed and two indices; the same everywhere.
double hashUnit(uint32_t seed, uint64_t a, uint64_t b);

// Columns x, y, z: a right-handed frame whose z is `normal`, spun about it by `angle` radians.
glm::mat3 frameAbout(const glm::vec3& normal, double angle);

}  // namespace apertura
