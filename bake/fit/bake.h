#pragma once
// Bakes visibility at points and at all vertices of a scene.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "apertura/bake/fit/fit.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/runtime/asset/asset.h"

namespace apertura {

// Where visibility is stored: at vertices alone; on faces too, as finely as each one needs; or in images over texture coordinates too.
enum class At { Vertices, Faces, Texels };

// What images hold: the four numbers, or what engines read today (BentNormals).
enum class As { Visibility, BentNormals };

struct BakeOptions {
    std::string_view recipe = "sh";  // a name of recipes()
    double tolerance = 0.05;         // "auto" only: the RMSE of E / (L pi sin^2 r) to keep
    double lambda = 0;               // "auto" only: see FitOptions; bakeVertices finds it itself
    Price price = Price::Numbers;    // "auto" only
    int rays = 256;                  // a point, 1 .. 1 << 20; see defaultRays
    uint32_t seed = 1;               // of the spin of each point's directions
    double maxDistance = 0;          // bakeVertices only: metres beyond which nothing blocks; 0: no limit
    bool terrain = false;            // bakePoints only: see FitOptions; bakeVertices takes it from the scene
    int threads = 0;                 // 0: all cores
    double error = 0.005;            // bakeTerrain only: RMS of area / 2 pi that it may err
    // bakeScene only:
    At at = At::Faces;
    double storageTolerance = 0;  // RMSE of E / (L pi sin^2 r), a light of 5 degrees, and of the sky's E over pi, that storing may add; 0:
                                  // half of what the model errs, and .012
    double maxBytes = 0;          // of all visibility; 0: no limit
    int bits = 8;            // that a number will be stored in: of 8, lobes and caps are made what bytes can hold (bake/fit/rounding.h)
    int texels = 256;        // At::Texels: of each image, across and down
    As as = As::Visibility;  // At::Texels
};

// 256 rays a point do; 1024 for a model whose lobes or caps are fitted: by fewer its edges lie beside the true ones, on a building that is
// open here and there at twice the error. `auto`, which fits many models to each point, goes by 256.
int defaultRays(const Recipe& recipe);

struct FaceReport;   // bake/fit/faces.h
struct TexelReport;  // bake/fit/texels.h

// What `auto` needs to know of a scene before it chooses.
struct AutoPlan {
    double lambda;       // the Lagrange multiplier (FitOptions::lambda) at which it keeps an RMSE of the tolerance
    const Model* alone;  // the least model that would keep it as the only one; nullptr: there is none
};

// Plans from these points. Of `options` it reads price, seed and threads; `tools` must be made for Use::Choice. Throws Cancelled.
AutoPlan planAuto(const OcclusionSource& source, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options,
                  double tolerance, const Progress& progress);

// Bakes each point by the options' recipe; directions in the result are in the world. The result does not depend on the
// number of threads. Throws Cancelled, and Error where there is no such recipe, or it is "auto" without a lambda.
//   keep  called once for each point, with its index, from any thread
void bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options, const Progress& progress,
                const std::function<void(size_t, const BakedPoint&, const Samples&, const glm::mat3& frame)>& keep);
std::vector<BakedPoint> bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options,
                                   const Progress& progress = {});

// Bakes all vertices that triangles use (bake/sampling/vertices.h says where their rays start); the others are closed.
// `issues`, where given, receives what is doubtful in the scene's meshes, and `plan` what "auto" went by.
BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress = {},
                             MeshIssues* issues = nullptr, AutoPlan* plan = nullptr);

// The same at these points of vertices, by any source.
BakedVisibility bakeAt(const Scene& scene, const OcclusionSource& source, const VertexPoints& vertices, const BakeOptions& options,
                       const Progress& progress = {}, AutoPlan* plan = nullptr);

// Bakes vertices and, where options.at asks for them, samples on faces. The four numbers of the recipe "sh" are fitted to points all over
// the faces, and images hold these alone: Kavan, Bargteil & Sloan, "Least Squares Vertex Baking", 2011. The result does not depend on the
// number of threads. Throws Cancelled, and Error where images are wanted that the scene's texture coordinates or the recipe do not allow.
BakedVisibility bakeScene(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress = {},
                          MeshIssues* issues = nullptr, AutoPlan* plan = nullptr, FaceReport* report = nullptr,
                          TexelReport* texels = nullptr);

}  // namespace apertura
