#pragma once
// What a model costs in a shader: cost.comp, specialised to it, as a driver compiles it or a device runs it.
#include <optional>
#include <span>
#include <vector>

#include "runtime/render/vulkan.h"

namespace apertura {

struct CostCase {
    int model;         // MODEL_...
    int lightClass;    // LIGHTS_...
    bool sky = false;  // with the irradiance from the sky
};

// As Mesa's compiler for Radeons states it, for one wave. Cycles are its "Inverse Throughput".
struct CompiledCost {
    int cycles = 0, instructions = 0, latency = 0, registers = 0;
};

// Needs a Gpu made with `statistics`. Nothing is run. Throws Error where the driver states none of it.
std::vector<CompiledCost> compiledCosts(const Gpu& gpu, std::span<const CostCase> cases);

// Seconds that the device takes for `points` receivers, by its own clock: of each case the least of `rounds`,
// which take the cases in turn. Throws Error where the device has no clock.
std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds);

}  // namespace apertura
