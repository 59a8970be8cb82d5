#pragma once
// What a model makes of receivers of the built-in scenes, and how far lights that cross their sky step: as
// Stability.NoScenesLightStepsFurtherThanItsRimSweeps has it.
#include "apertura/bake/fit/fit.h"
#include "apertura/bake/measure/sweeps.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/scene/builtin.h"
#include "light_integral.h"

namespace apertura::test {

struct SceneReceiver {
    AperturaReceiver receiver;
    glm::mat3 frame;
    size_t index;  // in its scene
};

// `each`: receivers of a scene.
inline std::vector<SceneReceiver> sceneReceivers(const Model& model, int each = 6) {
    std::vector<SceneReceiver> out;
    const FitTools tools(256, FitTools::Use::Fits);
    for (const std::string& name : builtinNames()) {
        const Scene scene = makeBuiltin(name);
        const Tracer tracer(scene);
        std::vector<SurfacePoint> points;
        for (const SurfaceSample& p : sampleReceivers(scene, each, 1)) points.push_back(p.at);
        std::vector<SceneReceiver> here(points.size());
        samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
            const Recipe& recipe = recipeFor(model);
            const BakedPoint point = makePoint(recipe, tools, samples, frame, {});
            const ModelParams params = toParams(model, point.visibility, recipe.model >= 0 ? &point.params : nullptr, points[i].normal);
            here[i] = {toReceiver(point.visibility, params, points[i].normal), frame, i};
        });
        out.insert(out.end(), here.begin(), here.end());
    }
    return out;
}

// The largest step on any of the receivers, as a share of stepBound.
//   degrees  radii of the lights
inline double steepestInScenes(const std::vector<SceneReceiver>& receivers, int model, int lightClass, const std::vector<double>& degrees) {
    double out = 0;
    for (const double d : degrees) {
        const double radius = d * pi / 180, step = std::min(radius / 6, pi / 180), bound = 2 * step / (pi * std::sin(radius));
        for (const SceneReceiver& r : receivers)
            for (int arc = 0; arc < 2; ++arc) {
                const double turn = pi * (hashUnit(1, r.index, 7) + 0.5 * arc);
                double before = -1;
                for (double a = -pi / 2 - 1.2 * radius; a < pi / 2 + 1.2 * radius; a += step) {
                    const AperturaCapLight light = apertura::aperturaCapLight(r.frame * vec3(tilted(a, turn)), float(std::sin(radius)));
                    const double now = double(aperturaIrradianceThrough(model, r.receiver, light, lightClass)) / light.area;
                    if (before >= 0) out = std::max(out, std::abs(now - before) / bound);
                    before = now;
                }
            }
    }
    return out;
}

}  // namespace apertura::test
