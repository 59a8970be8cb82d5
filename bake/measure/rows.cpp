#include "apertura/bake/measure/rows.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/materials.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {
namespace {

using std::numbers::pi;
constexpr int kBounceRays = 1024;    // paths of a receiver
constexpr int kBackRays = 64;        // by which a receiver is found to be buried
constexpr double kLeakCosine = 0.1;  // leaks count for lights whose cosine to the normal is above this

// E / (L pi sin^2 r) that a model or a baseline has for light k of receiver i.
using ValueOf = std::function<double(size_t i, size_t k, const AperturaCapLight& light)>;

// Fills in the errors of a row for its light radius, the r-th of the options.
void measureRow(const LitReceivers& lit, size_t r, const ValueOf& valueOf, MeasureRow& row) {
    const size_t n = lit.points.size();
    std::vector<std::vector<double>> errors(n);
    tbb::parallel_for(size_t(0), n, [&](size_t i) {
        for (size_t k = 0; k < lit.lights[i].size(); ++k) {
            const AperturaCapLight light = aperturaCapLight(lit.lights[i][k], float(std::sin(row.lightRadius * pi / 180)));
            errors[i].push_back(valueOf(i, k, light) - lit.truth[i][r][k].mean());
        }
    });
    size_t count = 0;
    std::vector<double> leaks;
    for (size_t i = 0; i < n; ++i) {
        double here = 0;
        for (size_t k = 0; k < lit.lights[i].size(); ++k) {
            const TruthSample& sample = lit.truth[i][r][k];
            const double e = errors[i][k];
            const bool blocked = sample.first <= 0 && sample.second <= 0
                              && glm::dot(lit.lights[i][k], lit.points[i].at.normal) > kLeakCosine;
            if (blocked) leaks.push_back(e);
            here += e * e;
            row.bias += e;
            row.max = std::max(row.max, std::abs(e));
            row.rmsTruth += double(sample.mean()) * sample.mean();
            row.noise += double(sample.noise()) * sample.noise();
            ++count;
        }
        row.rmse += here;
        row.receiverRmse.push_back(float(std::sqrt(here / double(lit.lights[i].size()))));
    }
    row.rmse = std::sqrt(row.rmse / double(count));
    row.rmsTruth = std::sqrt(row.rmsTruth / double(count));
    row.noise = std::sqrt(row.noise / double(count));
    row.bias /= double(count);
    if (leaks.empty()) return;
    std::sort(leaks.begin(), leaks.end());
    row.leakMax = std::max(leaks.back(), 0.0);
    row.leak99 = std::max(leaks[size_t(0.99 * double(leaks.size() - 1))], 0.0);
}

// The row of a model or a baseline before it is measured. `sky`: its E of a uniform sky at receiver i.
MeasureRow newRow(const LitReceivers& lit, std::string model, std::string source, double radius, const std::vector<Visibility>& truth,
                  const std::function<double(size_t i)>& sky) {
    MeasureRow row;
    row.model = std::move(model);
    row.source = std::move(source);
    row.lightRadius = radius;
    double ambient = 0, unbounced = 0, bounced = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double own = sky(i), off = own - std::max(glm::dot(lit.points[i].at.normal, truth[i].direction), 0.0f);
        ambient += off * off / (pi * pi);
        if (lit.bounces.empty()) continue;
        const glm::dvec3 without = own / pi - glm::dvec3(lit.bounces[i].sky),
                         with = without + glm::dvec3(lit.bounceAt(i, float(own)).share);
        unbounced += glm::dot(without, without) / 3;
        bounced += glm::dot(with, with) / 3;
    }
    row.ambient = std::sqrt(ambient / double(truth.size()));
    row.unbounced = std::sqrt(unbounced / double(truth.size()));
    row.bounced = std::sqrt(bounced / double(truth.size()));
    return row;
}

// The shadow map of the renderer, each of its texels filled by a ray from where the light comes in.
class TracedShadowMap : public ShadowDepths {
public:
    TracedShadowMap(const Tracer& tracer, const AperturaShadowView& view)
        : tracer_(tracer), view_(view), toWorld_(glm::inverse(glm::dmat4(view.toLight))) {}
    float at(ivec2 texel) const override {
        const glm::dvec2 clip = 2.0 * (glm::dvec2(texel) + 0.5) / double(view_.shape.y) - 1.0;
        const glm::dvec3 from = toWorld_ * glm::dvec4(clip, 1, 1);
        const std::optional<Hit> hit = tracer_.nearest(from, -vec3(view_.towards));
        return hit ? float(1 - double(hit->distance) * view_.towards.w) : 0;
    }

private:
    const Tracer& tracer_;
    const AperturaShadowView& view_;
    glm::dmat4 toWorld_;
};

}  // namespace

LitReceivers traceLitReceivers(const Scene& scene, const MeasuredRegion& region, const Tracer& tracer, const MeasureOptions& options,
                               const Progress& progress) {
    LitReceivers lit;
    const std::vector<SurfaceSample> spread = sampleSurface(scene, options.receivers, options.seed, region.region);
    const Solids solids(scene, tracer);
    std::vector<uint8_t> buried(spread.size());
    tbb::parallel_for(size_t(0), spread.size(), [&](size_t i) {
        buried[i] = solids.backsSeen(spread[i].at, 2 * pi * hashUnit(options.seed, i, 99), kBackRays) > kBackRays / 4;
    });
    for (size_t i = 0; i < spread.size(); ++i)
        if (!buried[i]) lit.points.push_back(spread[i]);
    lit.buried = int(spread.size() - lit.points.size());
    if (lit.points.empty()) throw Error(scene.name + ": its whole surface lies inside solids, or its faces are inside out");
    const size_t n = lit.points.size();
    lit.lights.resize(n);
    lit.truth.resize(n);
    ProgressCounter counter(progress, n);
    tbb::parallel_for(size_t(0), n, [&](size_t i) {
        if (counter.stopped()) return;
        const SurfacePoint& point = lit.points[i].at;
        lit.lights[i] = lightDirections(region, point, options.seed, i);
        for (size_t r = 0; r < options.lightRadii.size(); ++r) {
            std::vector<TruthSample> row;
            for (size_t k = 0; k < lit.lights[i].size(); ++k)
                row.push_back(traceLight(tracer, point, lit.lights[i][k], options.lightRadii[r] * pi / 180, options.lightSamples,
                                         2 * pi * hashUnit(options.seed, i, 100 + k)));
            lit.truth[i].push_back(std::move(row));
        }
        counter.add(1);
    });
    counter.throwIfStopped();
    return lit;
}

std::vector<BounceRow> traceLitBounces(LitReceivers& lit, const Tracer& tracer, const Asset* asset, const MeasureOptions& options,
                                       const Progress& progress) {
    if (options.bounces == 0) return {};
    const std::vector<SurfacePoint> points = lit.surfacePoints();
    lit.bounces = traceBounces(tracer, points, options.albedo, options.bounces, kBounceRays, options.seed, progress);
    const glm::vec3 albedo = options.albedo.isPlain ? options.albedo.plain : meanAlbedo(tracer.scene(), options.albedo.plain);
    lit.absorbed = glm::max(1.0f - albedo, APERTURA_LEAST_ABSORBED);
    std::vector<AperturaBounce> none(points.size(), {glm::vec3(0), glm::vec3(0)}), given;
    for (size_t i = 0; i < points.size(); ++i) given.push_back(lit.bounceAt(i, float(pi) * lit.bounces[i].open));
    std::vector<BounceRow> out{bounceRow("none", lit.bounces, none), bounceRow("given", lit.bounces, given)};
    if (!asset || !hasBounces(*asset) || (options.albedo.isPlain && bakedAlbedo(asset->info) != options.albedo.plain)) return out;
    for (const SurfaceSample& p : lit.points) lit.baked.push_back(bounceAt(*asset, p.instance, p.triangle, p.weights));
    out.push_back(bounceRow("baked", lit.bounces, lit.baked));
    return out;
}

void addRows(const LitReceivers& lit, const ModelReceivers& made, const std::vector<Visibility>& truth, const MeasureOptions& options,
             std::vector<MeasureRow>& rows) {
    const auto sum = [&](size_t i, auto&& valueOf) {
        double out = 0;
        for (const auto& [weight, receiver] : made.receivers[i]) out += weight * valueOf(receiver);
        return out;
    };
    for (size_t r = 0; r < options.lightRadii.size(); ++r) {
        MeasureRow row = newRow(lit, std::string(made.model->name), made.source, options.lightRadii[r], truth, [&](size_t i) {
            return sum(i, [&](const AperturaReceiver& receiver) { return aperturaSkyIrradiance(made.model->id, receiver); });
        });
        row.numbers = made.numbers;
        row.bytes = made.bytes;
        measureRow(
            lit, r,
            [&](size_t i, size_t, const AperturaCapLight& light) {
                return sum(i, [&](const AperturaReceiver& receiver) { return modelValue(made.model->id, receiver, light); });
            },
            row);
        rows.push_back(row);
    }
}

void addShadowRows(const LitReceivers& lit, const Tracer& tracer, const Box& bounds, const std::vector<Visibility>& truth,
                   const MeasureOptions& options, std::vector<MeasureRow>& rows) {
    for (size_t r = 0; r < options.lightRadii.size(); ++r) {
        MeasureRow row = newRow(lit, "shadow-map", "map", options.lightRadii[r], truth, [](size_t) { return pi; });
        double texels = 0, lights = 0;
        for (const auto& directions : lit.lights)
            for (const glm::vec3& direction : directions) {
                texels += 1 / double(shadowViewOf(directionalLight(direction, 0.01, vec3(1)), bounds).shape.z);
                ++lights;
            }
        row.texelsPerMetre = texels / lights;
        measureRow(
            lit, r,
            [&](size_t i, size_t k, const AperturaCapLight& light) {
                const SurfacePoint& at = lit.points[i].at;
                const AperturaShadowView view = shadowViewOf({light, vec4(0), vec4(1)}, bounds);
                const double open = aperturaIrradianceAboveHorizon(at.normal, light) / light.area;
                if (open <= 0) return 0.0;
                const auto turn = float(2 * pi * hashUnit(options.seed, i, 1000 + k));
                return open * aperturaOpenInShadowMap(TracedShadowMap(tracer, view), view, vec3(at.position), at.normal, turn);
            },
            row);
        rows.push_back(row);
    }
}

}  // namespace apertura
