#include "apertura/bake/measure/measure.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/fit/choose.h"
#include "apertura/bake/measure/appearance.h"
#include "apertura/bake/measure/rows.h"
#include "apertura/bake/sampling/progress.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/sh/packing.h"

namespace apertura {
namespace {

using std::numbers::pi;
constexpr double kPathRadius = 5;  // degrees, light radius of PathRow::irradianceRms

bool asked(const MeasureOptions& options, const Model& model) {
    return (options.models.empty() && !options.only)
        || std::find(options.models.begin(), options.models.end(), &model) != options.models.end();
}

// The models that a recipe's points are measured with: the recipe's own, or all that are derived from the four numbers.
std::vector<const Model*> modelsOf(const Recipe& recipe, const MeasureOptions& options) {
    std::vector<const Model*> out;
    if (recipe.source == "transfer") return out;  // comparePaths measures it
    for (const Model& model : models()) {
        const bool own = recipe.model >= 0 ? model.id == recipe.model
                       : recipe.only >= 0  ? model.id == recipe.only
                                           : model.fromVisibility != nullptr;
        if (own && asked(options, model)) out.push_back(&model);
    }
    return out;
}

// Bytes a point: the four numbers and what is stored beside them, or what a rival takes alone.
double bytesOf(const Model& model, const Recipe& recipe) {
    return model.ownBytes > 0 ? model.ownBytes : 4 + (recipe.model >= 0 ? storedNumbers(model) : 0);
}

// Mean count of numbers that the models chosen by `auto` read.
double chosenNumbers(const Asset& asset) {
    double sum = 0, count = 0;
    for (const SeenByInstance& seen : asset.seen)
        for (const ModelParams& params : seen.allParams) sum += chosenModel(models()[APERTURA_MODEL_AUTO], params).numbers, ++count;
    return sum / std::max(count, 1.0);
}

const Model& apertureModel() { return models()[APERTURA_MODEL_APERTURE]; }

std::vector<AperturaReceiver> receiversFrom(const LitReceivers& lit, const std::vector<Visibility>& visibility) {
    std::vector<AperturaReceiver> out;
    for (size_t i = 0; i < visibility.size(); ++i) out.push_back(toReceiver(apertureModel(), visibility[i], lit.points[i].at.normal));
    return out;
}

AperturaAperture apertureOf(const AperturaReceiver& receiver) {
    return aperturaMakeAperture(vec3(receiver.params[0]), receiver.params[0].w);
}

PathRow comparePath(const LitReceivers& lit, const std::string& stage, const std::string& source,
                    const std::vector<AperturaReceiver>& reference, const std::vector<AperturaReceiver>& changed) {
    PathRow row{stage, source};
    double lights = 0, axes = 0;
    for (size_t i = 0; i < reference.size(); ++i) {
        const AperturaAperture a = apertureOf(reference[i]), b = apertureOf(changed[i]);
        const double radius = (double(aperturaCapRadius(b.height)) - aperturaCapRadius(a.height)) * 180 / pi;
        row.radiusRms += radius * radius;
        row.radiusMax = std::max(row.radiusMax, std::abs(radius));
        if (a.height > 1e-4f) {  // a closed point has no direction
            const double angle = 2 * std::asin(std::min(0.5 * glm::length(glm::dvec3(a.axis) - glm::dvec3(b.axis)), 1.0)) * 180 / pi;
            row.directionRms += angle * angle;
            row.directionMax = std::max(row.directionMax, angle);
            ++axes;
        }
        for (const glm::vec3& l : lit.lights[i]) {
            const AperturaCapLight light = aperturaCapLight(l, float(std::sin(kPathRadius * pi / 180)));
            const double e = modelValue(APERTURA_MODEL_APERTURE, changed[i], light)
                           - modelValue(APERTURA_MODEL_APERTURE, reference[i], light);
            row.irradianceRms += e * e;
            ++lights;
        }
    }
    row.directionRms = std::sqrt(row.directionRms / std::max(axes, 1.0));
    row.radiusRms = std::sqrt(row.radiusRms / double(reference.size()));
    row.irradianceRms = std::sqrt(row.irradianceRms / std::max(lights, 1.0));
    return row;
}

float throughByte(float value, float top) { return std::round(std::clamp(value / top, -1.0f, 1.0f) * 127) / 127 * top; }

// Rounds each of the four coefficients to a byte over its possible range.
Visibility shThroughBytes(const Visibility& v) {
    const Sh4 largest = toSh4({glm::vec3(float(pi)), float(2 * pi)});
    Sh4 sh = toSh4(v);
    for (int i = 0; i < 4; ++i) sh.c[i] = throughByte(sh.c[i], largest.c[i]);
    return toVisibility(sh);
}

// Rounds an aperture's axis and radius to bytes.
AperturaReceiver apertureThroughBytes(AperturaReceiver receiver) {
    AperturaAperture a = apertureOf(receiver);
    for (int i = 0; i < 3; ++i) a.axis[i] = throughByte(a.axis[i], 1);
    a.axis = glm::normalize(a.axis);
    const float radius = (throughByte(aperturaCapRadius(a.height) * 4 / float(pi) - 1, 1) + 1) * float(pi) / 4;
    receiver.params[0] = vec4(a.axis, 1 - std::cos(radius));
    return aperturaRenormalised(APERTURA_MODEL_APERTURE, receiver);
}

std::vector<PathRow> comparePaths(const Scene& scene, const Tracer& tracer, const LitReceivers& lit, const std::vector<Visibility>& sh,
                                  const std::vector<Visibility>& rays, const std::vector<Visibility>& transfer, const BakeOptions& bake,
                                  const Progress& progress) {
    const std::vector<AperturaReceiver> reference = receiversFrom(lit, sh);
    std::vector<PathRow> out;
    out.push_back(comparePath(lit, "at the receiver, unquantised: the same by construction", "rays", reference, receiversFrom(lit, rays)));
    out.push_back(
        comparePath(lit, "cosine-weighted transfer, converted, instead of visibility", "sh", reference, receiversFrom(lit, transfer)));
    auto through = [&](auto&& change) {
        std::vector<Visibility> changed;
        changed.reserve(sh.size());
        for (const Visibility& v : sh) changed.push_back(change(v));
        return receiversFrom(lit, changed);
    };
    out.push_back(comparePath(lit, "the asset's 4 bytes", "sh", reference, through([](const Visibility& v) { return unpack(pack8(v)); })));
    out.push_back(comparePath(lit, "the asset's 8 bytes", "sh", reference, through([](const Visibility& v) { return unpack(pack16(v)); })));
    out.push_back(comparePath(lit, "4 bytes of raw coefficients", "sh", reference, through(shThroughBytes)));
    std::vector<AperturaReceiver> packed;
    packed.reserve(reference.size());
    for (const AperturaReceiver& r : reference) packed.push_back(apertureThroughBytes(r));
    out.push_back(comparePath(lit, "4 bytes of axis and radius", "rays", reference, packed));

    // Visibility at the corners of each receiver's triangle, with the receiver's own normal; to be interpolated.
    std::vector<SurfacePoint> corners;
    for (const SurfaceSample& p : lit.points)
        for (const glm::dvec3& corner : cornersOf(scene, p.instance, p.triangle))
            corners.push_back({glm::mix(corner, p.at.position, 0.01), p.at.normal, p.at.longest});
    const std::vector<BakedPoint> at = bakePoints(RayOcclusion(tracer), corners, bake, progress);
    auto mixed = [&](bool even, bool coefficients) {
        std::vector<AperturaReceiver> receivers;
        for (size_t i = 0; i < lit.points.size(); ++i) {
            const glm::vec3 w = even ? glm::vec3(1 / 3.0f) : lit.points[i].weights, n = lit.points[i].at.normal;
            Visibility sum;
            vec4 mix(0);
            for (int c = 0; c < 3; ++c) {
                const Visibility& v = at[3 * i + c].visibility;
                sum.area += w[c] * v.area;
                sum.direction += w[c] * v.direction;
                mix += w[c] * toParams(apertureModel(), v, nullptr, n)[0];
            }
            receivers.push_back(coefficients ? toReceiver(apertureModel(), sum, n)
                                             : aperturaRenormalised(APERTURA_MODEL_APERTURE, toReceiver(sum, {mix}, n)));
        }
        return receivers;
    };
    out.push_back(comparePath(lit, "interpolated over its triangle, then converted", "sh", reference, mixed(false, true)));
    out.push_back(comparePath(lit, "apertures interpolated over its triangle", "rays", reference, mixed(false, false)));
    out.push_back(comparePath(lit, "filtered over its triangle, then converted", "sh", reference, mixed(true, true)));
    out.push_back(comparePath(lit, "apertures filtered over its triangle", "rays", reference, mixed(true, false)));
    return out;
}

std::optional<tbb::global_control> limitThreads(int threads) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
    return limit;
}

}  // namespace

namespace {

// A model at the receivers themselves, from what a recipe made there. `unreached` is set for `auto` alone.
ModelReceivers receiversOf(const Recipe& recipe, const Model& model, std::span<const BakedPoint> baked,
                           std::span<const SurfacePoint> points, double& unreached) {
    ModelReceivers made{&model, std::string(recipe.source), double(model.numbers), bytesOf(model, recipe), {}};
    double chosen = 0, bytes = 0, missed = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const BakedPoint& p = baked[i];
        const ModelParams* stored = recipe.model >= 0 ? &p.params : nullptr;
        made.receivers.push_back(
            {{1.0f, toReceiver(p.visibility, toParams(model, p.visibility, stored, points[i].normal), points[i].normal)}});
        if (model.id != APERTURA_MODEL_AUTO) continue;
        const Model& own = chosenModel(model, p.params);
        chosen += own.numbers;
        bytes += storedNumbers(own);
        missed += aperturaChoiceIn(p.params[APERTURA_CHOICE_SLOT]).outOfReach;
    }
    if (model.id == APERTURA_MODEL_AUTO) {
        made.numbers = chosen / double(points.size());
        made.bytes = 5 + bytes / double(points.size());  // four, one for the choice, and the chosen model's own
        unreached = missed / double(points.size());
    } else if (recipe.model >= 0 && model.fromVisibility) {
        made.numbers = storedNumbers(model);
    }
    return made;
}

Price priceNamed(const std::string& name) { return name == "bytes" ? Price::Bytes : name == "cycles" ? Price::Cycles : Price::Numbers; }

}  // namespace

Measurement measureScene(const Scene& scene, const MeasureOptions& options, const Progress& progress) {
    const auto limit = limitThreads(options.threads);
    const Tracer tracer(scene, part(progress, 0, 0));
    LitReceivers lit = traceLitReceivers(scene, measuredRegion(scene.name, scene), tracer, options, part(progress, 0, 0.5));
    Measurement out;
    out.bounces = traceLitBounces(lit, tracer, nullptr, options, part(progress, 0.5, 0.6));
    const std::vector<SurfacePoint> points = lit.surfacePoints();
    const RayOcclusion occlusion(tracer);
    BakeOptions bake;
    bake.rays = options.rays;
    bake.seed = options.seed;

    std::vector<std::pair<const Recipe*, std::vector<const Model*>>> wanted;
    for (const Recipe& recipe : recipes())
        if (auto models = modelsOf(recipe, options); !models.empty()) wanted.emplace_back(&recipe, models);
    const FitTools tools(options.rays);
    FitOptions fitOptions{.tolerance = options.tolerance, .terrain = scene.isTerrain};
    if (asked(options, models()[APERTURA_MODEL_AUTO]))
        fitOptions.lambda = planAuto(occlusion, points, tools, bake, options.tolerance, part(progress, 0.6, 0.7)).lambda;
    std::vector<std::vector<BakedPoint>> baked(wanted.size(), std::vector<BakedPoint>(points.size()));
    std::vector<Visibility> sh(points.size()), rays(points.size()), transfer(points.size());
    samplePoints(occlusion, points, tools.lattice, options.seed, 0, part(progress, 0.7, 0.95),
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                     for (size_t k = 0; k < wanted.size(); ++k)
                         baked[k][i] = makePoint(*wanted[k].first, tools, samples, frame, fitOptions);
                     sh[i] = makePoint(recipeNamed("sh"), tools, samples, frame, fitOptions).visibility;
                     rays[i] = makePoint(recipeNamed("rays"), tools, samples, frame, fitOptions).visibility;
                     transfer[i] = makePoint(recipeNamed("transfer"), tools, samples, frame, fitOptions).visibility;
                 });

    out.scene = scene.name;
    out.receivers = int(points.size());
    out.buried = lit.buried;
    for (const SurfacePoint& p : points) out.positions.push_back(p.position);
    for (size_t k = 0; k < wanted.size(); ++k) {
        const Recipe& recipe = *wanted[k].first;
        for (const Model* model : wanted[k].second) {
            const ModelReceivers made = receiversOf(recipe, *model, baked[k], points, out.unreached);
            addRows(lit, made, sh, options, out.rows);
        }
    }
    if (options.shadowMap) addShadowRows(lit, tracer, worldBounds(scene), sh, options, out.rows);
    bake.recipe = "sh";
    out.paths = comparePaths(scene, tracer, lit, sh, rays, transfer, bake, part(progress, 0.95, 1));
    return out;
}

Measurement measureAsset(const Asset& asset, const MeasureOptions& options, const Progress& progress) {
    const auto limit = limitThreads(options.threads);
    const Tracer tracer(asset.scene, part(progress, 0, 0));
    LitReceivers lit = traceLitReceivers(asset.scene, measuredRegion(asset.info.scene, asset.scene), tracer, options,
                                         part(progress, 0, 0.7));
    Measurement out;
    out.bounces = traceLitBounces(lit, tracer, &asset, options, part(progress, 0.7, 0.8));
    const std::vector<SurfacePoint> points = lit.surfacePoints();
    const RayOcclusion occlusion(tracer, asset.info.maxDistance);
    // What each model is measured with: the recipe that the asset was baked by. A stored model leaves the four numbers as they were baked;
    // only `auto` may replace them with fitted ones.
    const Model* storedOne = storedModel(asset.info);
    const Recipe* baked = findRecipe(asset.info.model);
    std::vector<std::pair<const Recipe*, const Model*>> wanted;
    for (const Model& model : models()) {
        const bool stored = storedOne == &model;
        if ((!stored && !model.fromVisibility) || !asked(options, model)) continue;
        const bool four = baked && (stored || baked->model < 0 || baked->model == APERTURA_MODEL_AUTO);
        wanted.emplace_back(four ? baked : &recipeNamed("sh"), &model);
    }
    std::vector<const Recipe*> recipes{&recipeNamed("sh")};
    for (const auto& [recipe, model] : wanted)
        if (std::find(recipes.begin(), recipes.end(), recipe) == recipes.end()) recipes.push_back(recipe);
    const FitTools tools(options.rays);
    FitOptions fitOptions{.tolerance = asset.info.tolerance, .price = priceNamed(asset.info.price), .terrain = asset.scene.isTerrain};
    BakeOptions bake;
    bake.rays = options.rays;
    bake.seed = options.seed;
    bake.price = fitOptions.price;
    if (baked && baked->model == APERTURA_MODEL_AUTO)
        fitOptions.lambda = planAuto(occlusion, points, tools, bake, asset.info.tolerance, part(progress, 0.8, 0.85)).lambda;
    std::vector<std::vector<BakedPoint>> own(recipes.size(), std::vector<BakedPoint>(points.size()));
    samplePoints(occlusion, points, tools.lattice, options.seed, 0, part(progress, 0.85, 0.9),
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                     for (size_t k = 0; k < recipes.size(); ++k) own[k][i] = makePoint(*recipes[k], tools, samples, frame, fitOptions);
                 });
    std::vector<Visibility> truth;
    for (const BakedPoint& p : own[0]) truth.push_back(p.visibility);

    std::vector<double> small;
    for (const double radius : options.lightRadii)
        if (radius <= Appearance::kLargest) small.push_back(radius);
    const Appearance appearance(asset, tracer, lit.points, small, options.seed, part(progress, 0.9, 1));

    out.scene = asset.scene.name;
    out.receivers = int(points.size());
    out.buried = lit.buried;
    for (const SurfacePoint& p : points) out.positions.push_back(p.position);
    for (const auto& [recipe, model] : wanted) {
        const bool stored = storedOne == model;
        ModelReceivers made{model, std::string(recipe->source), double(model->numbers), bytesAPoint(asset), {}};
        if (stored && model->id == APERTURA_MODEL_AUTO) made.numbers = chosenNumbers(asset);
        if (stored && model->fromVisibility) made.numbers = storedNumbers(*model);
        for (const SurfaceSample& p : lit.points)
            made.receivers.push_back(receiverAt(asset, *model, p.instance, p.triangle, p.weights, p.at.normal));
        const size_t first = out.rows.size();
        addRows(lit, made, truth, options, out.rows);
        double unreached = 0;
        const auto k = size_t(std::find(recipes.begin(), recipes.end(), recipe) - recipes.begin());
        std::vector<MeasureRow> there;
        addRows(lit, receiversOf(*recipe, *model, own[k], points, unreached), truth, options, there);
        for (size_t r = 0; r < there.size(); ++r)
            out.rows[first + r].own = there[r].rmse, out.rows[first + r].ambientOwn = there[r].ambient;
        for (size_t r = first; r < out.rows.size(); ++r) {
            MeasureRow& row = out.rows[r];
            if (row.lightRadius > Appearance::kLargest) continue;
            row.mottle = appearance.mottle(*model, row.lightRadius);
            row.edge = appearance.edge(*model, row.lightRadius);
        }
    }
    if (options.shadowMap) addShadowRows(lit, tracer, worldBounds(asset.scene), truth, options, out.rows);
    return out;
}

}  // namespace apertura
