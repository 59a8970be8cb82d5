#pragma once
// Where methods break: models swept through singular configurations, against what they would be if integrated
// exactly, and against how fast light can change.
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bake/bake.h"
#include "sh/models.h"

namespace apertura {

// One cap light over one cap-shaped opening; the receiver's normal is +Z.
struct SweepFrame {
    glm::dvec3 aperture;    // unit
    double apertureRadius;  // radians, 0 .. pi
    glm::dvec3 light;       // unit
    double lightRadius;     // radians, 0 .. pi / 2
    double moved = 0;       // radians that the light moved since the frame before
    double axisLength = 1;  // of the aperture's axis as it is stored
    double areaScale = 1;   // of its area
};

struct Sweep {
    std::string_view name;
    std::string_view what;
    std::vector<SweepFrame> frames;
};

// All singular configurations, by name.
std::vector<Sweep> singularSweeps();

// E / (L pi sin^2 r) of a cap light as the model means it: the integral of its visibility, exact for caps and by
// quadrature within 0.002 for others. `model` is not a baseline; the receiver's normal is unit.
double exactInModel(const Model& model, const Receiver& receiver, const glm::dvec3& light, double radius);

// E / (L pi sin^2 r) through an opening that is one cap.
double exactThroughCap(const SweepFrame& frame);

// What a model makes of one frame, as it is made from the opening: from the four numbers, or fitted.
struct SweptModel {
    const Model* model;
    std::vector<Receiver> receivers;  // a frame
};
SweptModel sweepModel(const Model& model, const FitTools& tools, const Sweep& sweep);

struct StabilityRow {
    std::string model, sweep;
    bool baseline = false;
    int frames = 0;
    int notFinite = 0;      // NaN or Inf
    int outside = 0;        // below 0, or above what the light gives unblocked
    double error = 0;       // largest, against exactInModel (of a baseline against the opening itself), of E
    double worst = 0;       //     through the smaller of light and opening; 0..1: where in the sweep
    double modelError = 0;  // largest, against the opening itself
    double step = 0;        // largest between neighbouring frames of a moving light, as a share of the bound
    double exactStep = 0;   // the same of exactInModel or of the opening, whichever is larger
    double onDevice = 0;    // largest difference between the device and this processor; not there: -1
};

// The largest change of E / (L pi sin^2 r) when a light of this radius moves by `moved` radians, whatever blocks it:
// its rim, of length 2 pi sin r, sweeps 2 moved sin r ahead of it, lit from overhead at most.
inline double stepBound(double moved, double radius) { return 2 * moved / (3.14159265358979 * std::sin(radius)); }

// The light of each frame; empty where it could not be had.
using FrameEvaluator = std::function<std::vector<float>(int model, int size, const std::vector<Evaluation>&)>;

StabilityRow measureSweep(const SweptModel& swept, const Sweep& sweep, const FrameEvaluator& device);

// Where a model fails: the largest error of E through the smaller of light and opening over four directions in which
// a light lies from a tilted aperture. Distance: between the axes, in sums of the radii.
struct FailurePoint {
    std::string model;
    double lightRadius, apertureRadius;  // degrees
    double distance;
    double error;
};
std::vector<FailurePoint> failureMap(const Model& model, const FitTools& tools);

// Inputs of a model, many of them on purpose at the edge: axes of no length or of a wrong one, opposite or equal to
// each other, areas of nothing, of a hemisphere and beyond, numbers at the ends of what bytes hold, forms mixed of
// two; lights of any size. Evaluation `index` of a stream that `seed` begins.
struct HostileInput {
    Receiver receiver;
    vec4 light;  // axis, sine of the radius
    bool sound;  // normal and light are unit: the result has to be between nothing and the unblocked light's
};
HostileInput hostileInput(const Model& model, uint32_t seed, uint64_t index);

struct HostileCount {
    uint64_t inputs = 0, notFinite = 0, outside = 0;
};
// On this processor, all its cores; and on the device, where there is one.
HostileCount countHostile(const Model& model, uint32_t seed, uint64_t inputs, const FrameEvaluator& device = nullptr);

// The largest step, as a share of the bound, of a light that crosses the sky of a scene's receivers.
struct SceneSteps {
    std::string scene, model;
    bool baseline;
    double radius;  // degrees
    double step;
};
std::vector<SceneSteps> measureSceneSteps(const Scene& scene, const std::vector<const Model*>& models, int receivers, int rays, uint32_t seed,
                                          const std::vector<double>& radii, const Progress& progress);

// What 16-bit floats cost a model: lights that cross the sky of the scenes' receivers, `half` against this processor.
struct HalfError {
    std::string model;
    double radius;        // degrees
    int lights = 0;
    int notFinite = 0;    // NaN or Inf
    double rms = 0, max = 0;  // of E / (L pi sin^2 r), where it is a number
};
std::vector<HalfError> measureHalf(const std::vector<Scene>& scenes, const std::vector<const Model*>& models, int receivers, int rays, uint32_t seed,
                                   const std::vector<double>& radii, const FrameEvaluator& half);

}  // namespace apertura
