#pragma once
// Where methods break: models swept through singular configurations, against what they would be if integrated
// exactly, and against how fast light can change.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "bake/fit/fit.h"
#include "bake/measure/sweeps.h"
#include "sh/models.h"

namespace apertura {

// The largest change of E / (L pi sin^2 r) when a light of this radius moves by `moved` radians, whatever blocks it:
// its rim, of length 2 pi sin r, sweeps 2 moved sin r ahead of it, lit from overhead at most.
inline double stepBound(double moved, double radius) { return 2 * moved / (std::numbers::pi * std::sin(radius)); }

// The light of each frame; empty where it could not be had.
using FrameEvaluator = std::function<std::vector<float>(int model, int lightClass, const std::vector<Evaluation>&)>;

// Of the light overhead, what is let pass above the unblocked light: one of up to 10 degrees that the horizon cuts is not
// clamped again.
inline constexpr float kAboveOne = 0.012f;

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

}  // namespace apertura
