#include "apertura/bake/fit/bake.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "apertura/bake/fit/agree.h"
#include "apertura/bake/fit/choose.h"
#include "apertura/bake/fit/faces.h"
#include "apertura/bake/fit/rounding.h"
#include "apertura/bake/fit/texels.h"
#include "apertura/bake/sampling/progress.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/tangents.h"

namespace apertura {
namespace {

constexpr int kLambdaPoints = 400;         // points over the surface, from which the Lagrange multiplier of `auto` is found
constexpr size_t kMostNeighbours = 16;     // of a vertex, that its lobes agree with
constexpr int kOwnPoints = 600;            // and those from which what a model itself errs is found,
constexpr int kOwnRays = 1024;             // by at least so many rays
constexpr double kStorageShare = 0.5;      // of the model's own error: what storing adds to it is then an eighth
constexpr double kLeastTolerance = 0.001;  // RMSE: what no one sees, where a model's own error is next to nothing
constexpr double kSkyTolerance = 0.012;    // RMSE of the sky's E, over pi, that storing may add

// The RMSE of E / (L pi sin^2 r) that a recipe's model has at points of the surface that lie outside solids, under lights of 5 degrees.
double ownErrorOf(const Scene& scene, const OcclusionSource& source, const Solids& solids, const BakeOptions& options,
                  const FitOptions& fitOptions, const Progress& progress) {
    const Recipe& recipe = recipeNamed(options.recipe);
    const Model& model = models()[size_t(recipe.model >= 0 ? recipe.model : recipe.only >= 0 ? recipe.only : APERTURA_MODEL_SOFT)];
    const FitTools tools(std::max(options.rays, kOwnRays), FitTools::Use::Choice);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleSurface(scene, kOwnPoints, options.seed))
        if (solids.backsSeen(p.at, 0) <= Solids::kProbes / 4) points.push_back(p.at);
    std::vector<double> errors(points.size());
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress,
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                     const BakedPoint local = recipe.make(tools, samples, frame, fitOptions);
                     errors[i] = probeError(tools, tools.probes[0], samples, visibleTo(tools.lattice.directions(), model, local));
                 });
    double sum = 0;
    for (const double error : errors) sum += error * error;
    return std::sqrt(sum / double(std::max<size_t>(errors.size(), 1)));
}

FitOptions fitOptionsOf(const BakeOptions& options) { return {options.tolerance, options.lambda, options.price, options.terrain}; }

// Of each vertex, some of those that an edge joins it to, each place once however its vertices are split; and its own first twin.
Neighbours neighboursOf(const Scene& scene, const VertexPoints& vertices) {
    std::vector<std::vector<uint32_t>> pointOf;
    for (const Instance& instance : scene.instances) pointOf.emplace_back(scene.surfaces[instance.surface].positions.size(), 0);
    for (size_t k = 0; k < vertices.places.size(); ++k) pointOf[vertices.places[k].first][vertices.places[k].second] = uint32_t(k);
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    std::optional<StoredPoints> stored;
    for (size_t k = 0, last = scene.instances.size(); k < vertices.places.size(); ++k) {
        const auto [instance, vertex] = vertices.places[k];
        if (instance != last) stored.emplace(scene, instance);
        last = instance;
        edges.emplace_back(k, pointOf[instance][stored->firstTwin(vertex)]);
        const std::span<const uint32_t> near = stored->neighbours(vertex);
        const size_t few = std::min(near.size(), kMostNeighbours);
        for (size_t n = 0; n < few; ++n) edges.emplace_back(k, pointOf[instance][near[(n * near.size() + k) / few % near.size()]]);
    }
    return Neighbours(vertices.places.size(), std::move(edges), Neighbours::Edges::OneWay);
}

}  // namespace

int defaultRays(const Recipe& recipe) {
    return recipe.model >= 0 && recipe.model != APERTURA_MODEL_AUTO && canAgree(models()[size_t(recipe.model)]) ? 1024 : 256;
}

AutoPlan planAuto(const OcclusionSource& source, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options,
                  double tolerance, const Progress& progress) {
    std::vector<CandidateErrors> errors(points.size());
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress,
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) { errors[i] = tryCandidates(tools, samples, frame); });
    return {lambdaFor(errors, tolerance, options.price), leastAlone(errors, tolerance, options.price)};
}

void bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options, const Progress& progress,
                const std::function<void(size_t, const BakedPoint&, const Samples&, const glm::mat3&)>& keep) {
    const Recipe& recipe = recipeNamed(options.recipe);
    if (recipe.model == APERTURA_MODEL_AUTO && !(options.lambda > 0)) throw Error("the recipe auto needs a lambda: planAuto finds it");
    const FitTools tools(options.rays, useOf(recipe));
    const FitOptions fitOptions = fitOptionsOf(options);
    samplePoints(source, points, tools.lattice, options.seed, options.threads, progress,
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                     keep(i, makePoint(recipe, tools, samples, frame, fitOptions), samples, frame);
                 });
}

std::vector<BakedPoint> bakePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const BakeOptions& options,
                                   const Progress& progress) {
    std::vector<BakedPoint> out(points.size());
    bakePoints(source, points, options, progress,
               [&](size_t i, const BakedPoint& point, const Samples&, const glm::mat3&) { out[i] = point; });
    return out;
}

BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress,
                             MeshIssues* issues, AutoPlan* plan) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const VertexPoints vertices = placeVertices(scene, tracer, part(progress, 0, 0.1), issues);
    return bakeAt(scene, RayOcclusion(tracer, options.maxDistance), vertices, options, part(progress, 0.1, 1), plan);
}

BakedVisibility bakeAt(const Scene& scene, const OcclusionSource& source, const VertexPoints& vertices, const BakeOptions& options,
                       const Progress& progress, AutoPlan* plan) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const Progress choosing = part(progress, 0, 0.1), baking = part(progress, options.recipe == "auto" ? 0.1 : 0, 1);
    const std::vector<SurfacePoint>& points = vertices.points;
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
    const bool stored = recipeNamed(options.recipe).model >= 0;
    BakedVisibility out;
    ModelParams closed{};  // of vertices that no triangle uses
    if (recipeNamed(options.recipe).model == APERTURA_MODEL_AUTO) setChoice(closed, *autoModels()[0], false);
    for (const Instance& instance : scene.instances) {
        const size_t count = scene.surfaces[instance.surface].positions.size();
        out.push_back({std::vector<Visibility>(count), std::vector<ModelParams>(stored ? count : 0, closed)});
    }
    const Model* model = stored ? &models()[size_t(recipeNamed(options.recipe).model)] : nullptr;
    const bool agreeing = model && canAgree(*model);
    std::vector<FittedPoint> fitted(agreeing ? points.size() : 0);
    bakePoints(source, points, bakeOptions, agreeing ? part(baking, 0, 0.7) : baking,
               [&](size_t k, const BakedPoint& baked, const Samples& samples, const glm::mat3& frame) {
                   const auto [instance, vertex] = vertices.places[k];
                   out[instance].visibility[vertex] = baked.visibility;
                   if (stored) out[instance].allParams[vertex] = baked.params;
                   if (agreeing) fitted[k] = {baked, frame, samples.bits};
               });
    if (!agreeing) return out;
    agree(*model, FitTools(options.rays, useOf(recipeNamed(options.recipe))), fitOptionsOf(bakeOptions), fitted,
          neighboursOf(scene, vertices), options.seed, part(baking, 0.7, 1));
    tbb::parallel_for(size_t(0), fitted.size(), [&](size_t k) {
        const auto [instance, vertex] = vertices.places[k];
        const glm::mat3 toLocal = glm::transpose(rotationPart(scene.instances[instance].toWorld));
        out[instance].visibility[vertex] = fitted[k].baked.visibility;
        out[instance].allParams[vertex] = roundedParams(*model, fitted[k].baked.params, points[k].normal, toLocal, options.bits);
    });
    return out;
}

BakedVisibility bakeScene(const Scene& scene, const Tracer& tracer, const BakeOptions& options, const Progress& progress,
                          MeshIssues* issues, AutoPlan* plan, FaceReport* report, TexelReport* texels) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const Recipe& recipe = recipeNamed(options.recipe);
    if (options.at == At::Texels) {
        if (recipe.name != "sh")
            throw Error("images hold the four numbers alone, which filter; bake sh, or " + std::string(recipe.name) + " at faces");
        requireCharts(scene, options.texels);
        for (size_t i = 0; options.as == As::BentNormals && i < scene.instances.size(); ++i) tangentsOf(scene, i);
    }
    AutoPlan found{};
    const bool isFitted = recipe.name == "sh";  // by least squares
    const double share = options.at == At::Faces ? 0.4 : options.at == At::Texels ? 0.2 : 0.8;
    const Progress first = options.at == At::Faces || isFitted ? part(progress, 0, share) : progress;
    BakedVisibility out = bakeVertices(scene, tracer, options, first, issues, &found);
    if (plan) *plan = found;
    if (options.at == At::Vertices && !isFitted) return out;
    const RayOcclusion source(tracer, options.maxDistance);
    const Solids solids(scene, tracer);
    const Prober prober(scene, source, solids, options.rays, options.seed);
    const FitOptions fitOptions{options.tolerance, found.lambda, options.price, scene.isTerrain};
    const Progress probing = options.at == At::Faces ? part(progress, 0.4, 0.5) : part(progress, share, options.at == At::Texels ? 0.4 : 1);
    Faces faces(scene, prober, out, options.at == At::Texels ? At::Vertices : options.at, options.seed, probing);
    if (issues && options.at != At::Vertices) issues->large = 0;  // samples on them, or texels, hold what their vertices cannot
    if (faces.empty()) return out;
    if (options.at != At::Faces) {
        out = faces.fit();
        if (options.at == At::Texels) {
            const TexelReport done = bakeTexels(scene, prober, options.texels, options.as, out, part(progress, 0.4, 1));
            if (texels) *texels = done;
        }
        if (report) report->rays = prober.rays();
        return out;
    }
    FaceOptions wanted;
    wanted.tolerance = wanted.skyTolerance = options.storageTolerance;
    if (!(options.storageTolerance > 0)) {
        wanted.skyTolerance = kSkyTolerance;
        wanted.tolerance = std::max(kStorageShare * ownErrorOf(scene, source, solids, options, fitOptions, part(progress, 0.5, 0.55)),
                                    kLeastTolerance);
    }
    wanted.maxBytes = options.maxBytes;
    wanted.isFitted = isFitted;
    wanted.isMixed = recipe.model < 0 || models()[size_t(recipe.model)].mixes;
    size_t vertices = 0;
    for (const SeenByInstance& seen : out) vertices += seen.visibility.size();
    const double extra = recipe.model == APERTURA_MODEL_AUTO ? 4 : recipe.model >= 0 ? storedNumbers(models()[size_t(recipe.model)]) : 0;
    wanted.bytesASample = (4 + extra) * options.bits / 8;
    wanted.bytesElsewhere = double(vertices) * wanted.bytesASample + double(triangleCount(scene));
    faces.refine(wanted, part(progress, 0.55, 0.8));
    BakedVisibility fitted = faces.fit();
    if (isFitted) {
        out = std::move(fitted);
    } else {
        BakeOptions sampling = options;
        sampling.lambda = found.lambda;
        for (size_t i = 0; i < out.size(); ++i) out[i].faces = std::move(fitted[i].faces);
        faces.bakeSamples(out, source, sampling, part(progress, 0.8, 1));
    }
    throwIfStopped(progress, 1);
    faces.judge(out);
    throwIfStopped(progress, 1);
    if (report) *report = faces.report();
    return out;
}

}  // namespace apertura
