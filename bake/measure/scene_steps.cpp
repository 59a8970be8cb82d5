#include "apertura/bake/measure/scene_steps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/fit/fit.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"

namespace apertura {

using std::numbers::pi;
constexpr double kDegree = pi / 180;

namespace {

// Computes every model at every receiver of a scene and calls use(point, frame, model, receiver) for each, from any thread.
template <typename Use>
void forReceivers(const Scene& scene, const std::vector<const Model*>& asked, int receivers, int rays, uint32_t seed,
                  const Progress& progress, Use&& use) {
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, receivers, seed)) points.push_back(p.at);
    const FitTools tools(rays);
    FitOptions fitOptions;
    fitOptions.lambda = 1 / (fitOptions.tolerance * fitOptions.tolerance);
    samplePoints(RayOcclusion(tracer), points, tools.lattice, seed, 0, progress,
                 [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                     for (size_t m = 0; m < asked.size(); ++m) {
                         const Model& model = *asked[m];
                         const Recipe& recipe = recipeFor(model);
                         const BakedPoint point = makePoint(recipe, tools, samples, frame, fitOptions);
                         use(i, frame, m,
                             toReceiver(point.visibility,
                                        toParams(model, point.visibility, recipe.model >= 0 ? &point.params : nullptr, points[i].normal),
                                        points[i].normal));
                     }
                 });
}

// Calls use(light, first) along two arcs across the sky above `frame`. `degrees`: radius of the light; `step`: radians.
template <typename Use>
void forArcs(const glm::mat3& frame, uint32_t seed, size_t index, double degrees, double step, Use&& use) {
    const double radius = degrees * kDegree;
    for (int arc = 0; arc < 2; ++arc) {
        const double turn = pi * (hashUnit(seed, index, 7) + 0.5 * arc);
        bool first = true;
        for (double a = -pi / 2 - 1.2 * radius; a < pi / 2 + 1.2 * radius; a += step, first = false)
            use(aperturaCapLight(frame * vec3(tilted(a, turn)), float(std::sin(radius))), first);
    }
}

}  // namespace

std::vector<SceneSteps> measureSceneSteps(const Scene& scene, const std::vector<const Model*>& asked, int receivers, int rays,
                                          uint32_t seed, const std::vector<double>& radii, const Progress& progress) {
    std::vector<std::vector<double>> largest(size_t(receivers), std::vector<double>(asked.size() * radii.size()));
    forReceivers(
        scene, asked, receivers, rays, seed, progress, [&](size_t i, const glm::mat3& frame, size_t m, const AperturaReceiver& receiver) {
            for (size_t r = 0; r < radii.size(); ++r) {
                const double step = std::min(radii[r] * kDegree / 6, kDegree);
                double before = 0;
                forArcs(frame, seed, i, radii[r], step, [&](const AperturaCapLight& light, bool first) {
                    const double value = double(aperturaIrradianceThrough(asked[m]->id, receiver, light, lightClassOf(light.sinRadius)))
                                       / light.area;
                    double& most = largest[i][m * radii.size() + r];
                    if (!first)
                        most = std::isfinite(value) ? std::max(most, std::abs(value - before) / stepBound(step, radii[r] * kDegree)) : 1e30;
                    before = value;
                });
            }
        });
    std::vector<SceneSteps> out;
    for (size_t m = 0; m < asked.size(); ++m)
        for (size_t r = 0; r < radii.size(); ++r) {
            SceneSteps row{scene.name, std::string(asked[m]->name), asked[m]->baseline, radii[r], 0};
            for (const auto& each : largest) row.step = std::max(row.step, each[m * radii.size() + r]);
            out.push_back(row);
        }
    return out;
}

std::vector<HalfError> measureHalf(const std::vector<Scene>& scenes, const std::vector<const Model*>& asked, int receivers, int rays,
                                   uint32_t seed, const std::vector<double>& radii, const FrameEvaluator& half) {
    const size_t places = size_t(receivers), kinds = asked.size() * radii.size();
    std::vector<std::vector<AperturaEvaluation>> lights(scenes.size() * places * kinds);
    for (size_t s = 0; s < scenes.size(); ++s)
        forReceivers(scenes[s], asked, receivers, rays, seed, {},
                     [&](size_t i, const glm::mat3& frame, size_t m, const AperturaReceiver& receiver) {
                         for (size_t r = 0; r < radii.size(); ++r)
                             forArcs(frame, seed, i, radii[r], 2 * kDegree, [&](const AperturaCapLight& light, bool) {
                                 AperturaEvaluation e{vec4(receiver.normal, 0), vec4(light.axis, light.sinRadius), receiver.visibility, {}};
                                 std::copy_n(receiver.params, APERTURA_MAX_SLOTS, e.params);
                                 lights[(s * places + i) * kinds + m * radii.size() + r].push_back(e);
                             });
                     });
    std::vector<HalfError> out;
    for (size_t kind = 0; kind < kinds; ++kind) {
        const Model& model = *asked[kind / radii.size()];
        HalfError row{std::string(model.name), radii[kind % radii.size()]};
        std::vector<AperturaEvaluation> all;
        for (size_t k = kind; k < lights.size(); k += kinds) all.insert(all.end(), lights[k].begin(), lights[k].end());
        const int lightClass = lightClassOf(float(std::sin(row.radius * kDegree)));
        const std::vector<float> found = half(model.id, lightClass, all);
        double sum = 0;
        for (size_t k = 0; k < all.size(); ++k) {
            const AperturaCapLight light = aperturaCapLight(vec3(all[k].light), all[k].light.w);
            AperturaReceiver receiver{vec3(all[k].normal), all[k].visibility, {}};
            std::copy_n(all[k].params, APERTURA_MAX_SLOTS, receiver.params);
            const double e = (double(found[k]) - aperturaIrradianceThrough(model.id, receiver, light, lightClass)) / light.area;
            ++row.lights;
            row.notFinite += !std::isfinite(e);
            if (!std::isfinite(e)) continue;
            sum += e * e;
            row.max = std::max(row.max, std::abs(e));
        }
        row.rms = std::sqrt(sum / std::max(row.lights - row.notFinite, 1));
        out.push_back(row);
    }
    return out;
}

}  // namespace apertura
