#pragma once
// Evaluates models on inputs that no asset should hold.
#include "apertura/bake/measure/stability.h"

namespace apertura {

// One evaluation of a model. Many are edge cases on purpose: axes with zero or wrong length, opposite or equal axes, areas
// of zero, of a hemisphere and beyond, numbers at the ends of a byte's range, mixed parameters of two points, lights of
// any size.
struct FuzzInput {
    AperturaReceiver receiver;
    vec4 light;  // axis and sine of the radius, as Evaluation::light
    bool sound;  // normal and light are unit: the result must lie between 0 and the unblocked light's
};
// Number `index` of the stream that `seed` starts.
FuzzInput fuzzInput(const Model& model, uint32_t seed, uint64_t index);

//   notFinite  results that are NaN or Inf
//   outside    results of sound inputs below 0, or above 1.006 times the unblocked light's and kAboveOne
struct FuzzCount {
    uint64_t inputs = 0, notFinite = 0, outside = 0;
};
// Evaluates `inputs` inputs with `device`, or, without one, on all cores of this processor.
FuzzCount countFuzz(const Model& model, uint32_t seed, uint64_t inputs, const FrameEvaluator& device = nullptr);

}  // namespace apertura
