#pragma once
// Models fed with what no asset should hold.
#include "bake/measure/stability.h"

namespace apertura {

// Inputs of a model, many of them on purpose at the edge: axes of no length or of a wrong one, opposite or equal to
// each other, areas of nothing, of a hemisphere and beyond, numbers at the ends of what bytes hold, parameters mixed of
// two; lights of any size. Evaluation `index` of a stream that `seed` begins.
struct FuzzInput {
    Receiver receiver;
    vec4 light;  // axis, sine of the radius
    bool sound;  // normal and light are unit: the result has to be between nothing and the unblocked light's
};
FuzzInput fuzzInput(const Model& model, uint32_t seed, uint64_t index);

struct FuzzCount {
    uint64_t inputs = 0, notFinite = 0, outside = 0;
};
// On this processor, all its cores; and on the device, where there is one.
FuzzCount countFuzz(const Model& model, uint32_t seed, uint64_t inputs, const FrameEvaluator& device = nullptr);

}  // namespace apertura
