#pragma once
// Where models break: each is swept through singular configurations and compared with its own exact integral and with
// the fastest change that a light can make. Irradiance is E / (L pi sin^2 r) throughout.
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "apertura/bake/fit/fit.h"
#include "apertura/bake/measure/sweeps.h"
#include "apertura/sh/models.h"

namespace apertura {

// Upper bound for the change of E / (L pi sin^2 r) when a light moves, whatever blocks it: its rim, of length 2 pi sin r,
// sweeps 2 moved sin r sr ahead of it, seen at a cosine of at most 1.
//   moved, radius  radians
inline double stepBound(double moved, double radius) { return 2 * moved / (std::numbers::pi * std::sin(radius)); }

// Evaluates aperturaIrradianceThrough for each input on a device; `lightClass` is APERTURA_LIGHTS_... An empty function: there is no
// device.
using FrameEvaluator = std::function<std::vector<float>(int model, int lightClass, const std::vector<AperturaEvaluation>&)>;

// How far E / (L pi sin^2 r) may exceed the unblocked light's before it counts as outside: formulas for lights up to
// 10 degrees are not clamped again where the horizon cuts the light.
inline constexpr float kAboveOne = 0.012f;

// E / (L pi sin^2 r) of a cap light by the model's definition: the integral of its visibility over the light, exact for
// models of caps and by quadrature within 0.002 for others.
//   model     not a baseline
//   receiver  its normal is unit
//   light     unit axis
//   radius    radians
double exactInModel(const Model& model, const AperturaReceiver& receiver, const glm::dvec3& light, double radius);

// E / (L pi sin^2 r) through an opening that is one cap.
double exactThroughCap(const SweepFrame& frame);

// A model's parameters for each frame of a sweep, derived from the opening's four numbers or fitted to it.
struct SweptModel {
    const Model* model;
    std::vector<AperturaReceiver> receivers;  // one per frame
};
SweptModel sweepModel(const Model& model, const FitTools& tools, const Sweep& sweep);

struct StabilityRow {
    std::string model, sweep;
    bool baseline = false;
    int frames = 0;
    int notFinite = 0;      // NaN or Inf
    int outside = 0;        // below 0, or above 1.006 times the unblocked light and kAboveOne
    double error = 0;       // largest difference from exactInModel (a baseline: from exactThroughCap), relative to the
                            // light through the smaller of light and opening
    double worst = 0;       // where in the sweep `error` is: 0 first frame .. 1 last
    double modelError = 0;  // largest difference from exactThroughCap
    double step = 0;        // largest change between frames of a moving light, as a multiple of stepBound
    double exactStep = 0;   // the same for exactInModel and exactThroughCap, whichever is larger
    double onDevice = 0;    // largest difference between the device and this processor; -1 without a device
};

StabilityRow measureSweep(const SweptModel& swept, const Sweep& sweep, const FrameEvaluator& device);

// One point of a map of a model's errors, for a light and an aperture tilted by 35 degrees.
struct FailurePoint {
    std::string model;
    double lightRadius, apertureRadius;  // degrees
    double distance;                     // between the axes, as a multiple of the sum of the radii
    double error;                        // StabilityRow::error, the largest of four directions; 1e9 if one was NaN or Inf
};
// All points: four light radii, 18 aperture radii from 0.5 to 90 degrees, 23 distances from 0 to 1.1.
std::vector<FailurePoint> failureMap(const Model& model, const FitTools& tools);

}  // namespace apertura
