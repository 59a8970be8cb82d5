#pragma once
// The cost of a model in a shader: cost.comp, specialised to the model, as a driver compiles it or a device runs it.
#include <optional>
#include <span>
#include <vector>

#include "runtime/render/vulkan.h"

namespace apertura {

struct CostCase {
    int model;         // MODEL_...
    int lightClass;    // LIGHTS_...
    bool sky = false;  // adds the irradiance from the sky
};

// Statistics of Mesa's compiler for Radeons, for one wave: "Inverse Throughput", "Instructions", "Latency" and "VGPRs".
// A figure that the driver does not state is 0.
struct CompiledCost {
    int cycles = 0, instructions = 0, latency = 0, registers = 0;
};

// Compiles each case and runs nothing. The Gpu needs GpuOptions::statistics. Throws Error if the driver states no inverse
// throughput.
std::vector<CompiledCost> compiledCosts(const Gpu& gpu, std::span<const CostCase> cases);

// Seconds that the device takes for each case, by its own clock: the minimum over the rounds.
//   points  receivers per run, a multiple of 64
//   rounds  each runs all cases in turn
// Throws Error if the device has no clock.
std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds);

}  // namespace apertura
