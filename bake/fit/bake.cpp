#include "bake/fit/bake.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <optional>

#include "bake/fit/choose.h"
#include "bake/sampling/surface_points.h"
#include "bake/sampling/progress.h"
#include "runtime/asset/error.h"

namespace apertura {
namespace {

constexpr int kPricePoints = 400;  // over the surface, on which the price of `auto` is found

const Recipe& recipeNamed(std::string_view name) {
    const Recipe* recipe = findRecipe(name);
    if (!recipe) throw Error("there is no recipe '" + std::string(name) + "'");
    return *recipe;
}

}  // namespace

double priceAt(const OcclusionSource& source, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options, double tolerance,
               const Progress& progress) {
    std::vector<CandidateErrors> errors(points.size());
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        errors[i] = tryCandidates(tools, samples, frame);
    });
    return priceFor(errors, tolerance);
}

std::vector<BakedPoint> bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points,
                                   const BakeOptions& options, const Progress& progress) {
    const Recipe& recipe = recipeNamed(options.recipe);
    if (recipe.model == MODEL_AUTO && !(options.price > 0)) throw Error("the recipe auto needs a price: priceAt finds it");
    const FitTools tools(options.rays, useOf(recipe));
    const FitOptions how{options.tolerance, options.price};
    std::vector<BakedPoint> out(points.size());
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        out[i] = makePoint(recipe, tools, samples, frame, how);
    });
    return out;
}

BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options,
                             const Progress& progress, Doubts* doubts) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const Progress placing = part(progress, 0, 0.1), pricing = part(progress, 0.1, 0.2), baking = part(progress, options.recipe == "auto" ? 0.2 : 0.1, 1);
    const VertexPoints vertices = placeVertices(scene, tracer, placing, doubts);
    const std::vector<SurfacePoint>& points = vertices.points;
    const RayOcclusion source(tracer, options.maxDistance);
    BakeOptions how = options;
    if (options.recipe == "auto") {
        std::vector<SurfacePoint> spread;
        for (const SurfaceSample& p : sampleSurface(scene, std::min(kPricePoints, int(points.size())), options.seed)) spread.push_back(p.at);
        how.price = priceAt(source, spread, FitTools(options.rays, FitTools::Use::Choice), options, options.tolerance, pricing);
    }
    const std::vector<BakedPoint> baked = bakePoints(source, points, how, baking);
    const bool stored = recipeNamed(options.recipe).model >= 0;
    BakedVisibility out;
    for (const Instance& instance : scene.instances) {
        const size_t count = scene.surfaces[instance.surface].positions.size();
        out.push_back({std::vector<Visibility>(count), std::vector<Form>(stored ? count : 0)});
    }
    for (size_t k = 0; k < baked.size(); ++k) {
        const auto [instance, vertex] = vertices.places[k];
        out[instance].visibility[vertex] = baked[k].visibility;
        if (stored) out[instance].forms[vertex] = baked[k].form;
    }
    return out;
}

}  // namespace apertura
