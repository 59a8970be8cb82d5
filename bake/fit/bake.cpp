#include "bake/fit/bake.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <optional>

#include "bake/fit/choose.h"
#include "bake/sampling/progress.h"
#include "bake/sampling/surface_points.h"
#include "runtime/asset/error.h"

namespace apertura {
namespace {

constexpr int kLambdaPoints = 400;  // points over the surface, from which the Lagrange multiplier of `auto` is found

}  // namespace

AutoPlan planAuto(const OcclusionSource& source, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options,
                  double tolerance, const Progress& progress) {
    std::vector<CandidateErrors> errors(points.size());
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress,
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) { errors[i] = tryCandidates(tools, samples, frame); });
    return {lambdaFor(errors, tolerance, options.price), leastAlone(errors, tolerance, options.price)};
}

std::vector<BakedPoint> bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options,
                                   const Progress& progress) {
    const Recipe& recipe = recipeNamed(options.recipe);
    if (recipe.model == MODEL_AUTO && !(options.lambda > 0)) throw Error("the recipe auto needs a lambda: planAuto finds it");
    const FitTools tools(options.rays, useOf(recipe));
    const FitOptions fitOptions{options.tolerance, options.lambda, options.price, options.terrain};
    std::vector<BakedPoint> out(points.size());
    samplePoints(
        source, points, tools.lattice, options.seed, options.threads, progress,
        [&](size_t i, const Samples& samples, const glm::mat3& frame) { out[i] = makePoint(recipe, tools, samples, frame, fitOptions); });
    return out;
}

BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress,
                             MeshIssues* issues, AutoPlan* plan) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const Progress placing = part(progress, 0, 0.1), choosing = part(progress, 0.1, 0.2),
                   baking = part(progress, options.recipe == "auto" ? 0.2 : 0.1, 1);
    const VertexPoints vertices = placeVertices(scene, tracer, placing, issues);
    const std::vector<SurfacePoint>& points = vertices.points;
    const RayOcclusion source(tracer, options.maxDistance);
    BakeOptions bakeOptions = options;
    bakeOptions.terrain = scene.isTerrain;
    if (options.recipe == "auto") {
        std::vector<SurfacePoint> spread;
        for (const SurfaceSample& p : sampleSurface(scene, std::min(kLambdaPoints, int(points.size())), options.seed))
            spread.push_back(p.at);
        const AutoPlan found = planAuto(source, spread, FitTools(options.rays, FitTools::Use::Choice), options, options.tolerance,
                                        choosing);
        bakeOptions.lambda = found.lambda;
        if (plan) *plan = found;
    }
    const std::vector<BakedPoint> baked = bakePoints(source, points, bakeOptions, baking);
    const bool stored = recipeNamed(options.recipe).model >= 0;
    BakedVisibility out;
    ModelParams closed{};  // of vertices that no triangle uses
    if (recipeNamed(options.recipe).model == MODEL_AUTO) setChoice(closed, *autoModels()[0], false);
    for (const Instance& instance : scene.instances) {
        const size_t count = scene.surfaces[instance.surface].positions.size();
        out.push_back({std::vector<Visibility>(count), std::vector<ModelParams>(stored ? count : 0, closed)});
    }
    for (size_t k = 0; k < baked.size(); ++k) {
        const auto [instance, vertex] = vertices.places[k];
        out[instance].visibility[vertex] = baked[k].visibility;
        if (stored) out[instance].allParams[vertex] = baked[k].params;
    }
    return out;
}

}  // namespace apertura
