#pragma once
// Lights that cross the sky of a scene's receivers: how far a model's light jumps from step to step, and the error of
// 16-bit floats.
//   receivers  points per scene
//   rays       per receiver, to compute the models from
//   radii      of the lights, degrees
#include "apertura/bake/measure/stability.h"
#include "apertura/bake/sampling/progress.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// The largest change between neighbouring positions of a light, as a multiple of stepBound: above 1 the model flashes.
struct SceneSteps {
    std::string scene, model;
    bool baseline;
    double radius;  // degrees
    double step;    // 1e30 if a value was NaN or Inf
};
std::vector<SceneSteps> measureSceneSteps(const Scene& scene, const std::vector<const Model*>& models, int receivers, int rays,
                                          uint32_t seed, const std::vector<double>& radii, const Progress& progress);

// Difference between `half`, which evaluates in 16-bit floats, and this processor in 32, over all lights of all scenes.
struct HalfError {
    std::string model;
    double radius;  // degrees
    int lights = 0;
    int notFinite = 0;        // NaN or Inf
    double rms = 0, max = 0;  // of E / (L pi sin^2 r), over the finite ones
};
std::vector<HalfError> measureHalf(const std::vector<Scene>& scenes, const std::vector<const Model*>& models, int receivers, int rays,
                                   uint32_t seed, const std::vector<double>& radii, const FrameEvaluator& half);

}  // namespace apertura
