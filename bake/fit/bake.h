#pragma once
// Visibility at points and at all vertices of a scene.
#include <cstdint>
#include <span>
#include <vector>

#include "bake/fit/fit.h"
#include "bake/sampling/occlusion.h"
#include "runtime/asset/asset.h"

namespace apertura {

struct BakeOptions {
    std::string_view recipe = "sh";  // of recipes()
    double tolerance = 0.05;         // of the recipe "auto": RMSE of E / (L pi sin^2 r)
    double lambda = 0;               // of "auto": see FitOptions; bakeVertices finds it itself
    int rays = 256;                  // a point, 1 .. 1 << 20
    uint32_t seed = 1;
    double maxDistance = 0;  // of bakeVertices: metres beyond which nothing blocks; 0: no limit
    int threads = 0;         // 0: all cores
};

// The Lagrange multiplier at which `auto` keeps its tolerance over these points.
double lambdaAt(const OcclusionSource& source, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options,
                double tolerance, const Progress& progress);

// Points as the recipe of the options has them. The result does not depend on the number of threads.
// Throws Cancelled, and Error where there is no such recipe, or it is "auto" and has no lambda.
std::vector<BakedPoint> bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options,
                                   const Progress& progress = {});

// At the vertices that triangles use (bake/sampling/vertices.h says where); the others are closed. `issues`, where it is
// given, becomes what was ambiguous.
BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress = {},
                             MeshIssues* issues = nullptr);

}  // namespace apertura
