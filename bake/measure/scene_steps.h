#pragma once
// Lights that cross the sky of a scene's receivers: how far a model steps, and what 16-bit floats cost it.
#include "bake/measure/stability.h"
#include "bake/sampling/progress.h"
#include "runtime/asset/scene.h"

namespace apertura {

// The largest step, as a share of the bound, of a light that crosses the sky of a scene's receivers.
struct SceneSteps {
    std::string scene, model;
    bool baseline;
    double radius;  // degrees
    double step;
};
std::vector<SceneSteps> measureSceneSteps(const Scene& scene, const std::vector<const Model*>& models, int receivers, int rays,
                                          uint32_t seed, const std::vector<double>& radii, const Progress& progress);

// What 16-bit floats cost a model: lights that cross the sky of the scenes' receivers, `half` against this processor.
struct HalfError {
    std::string model;
    double radius;  // degrees
    int lights = 0;
    int notFinite = 0;        // NaN or Inf
    double rms = 0, max = 0;  // of E / (L pi sin^2 r), where it is a number
};
std::vector<HalfError> measureHalf(const std::vector<Scene>& scenes, const std::vector<const Model*>& models, int receivers, int rays,
                                   uint32_t seed, const std::vector<double>& radii, const FrameEvaluator& half);

}  // namespace apertura
