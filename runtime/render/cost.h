#pragma once
// The cost of a model in a shader: cost.comp, specialised to the model, as a driver compiles it or a device runs it.
#include <optional>
#include <span>
#include <vector>

#include "apertura/runtime/render/renderer.h"

namespace apertura {

struct CostCase {
    int model;         // APERTURA_MODEL_...
    int lightClass;    // APERTURA_LIGHTS_...
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

// What a fragment costs under one light and the sky, with all that it fetches: of Renderer::record or, without a model, of
// recordShadowMapped. Compiles each case and runs nothing, as compiledCosts does.
struct PixelCase {
    const Model* model;
    int lightClass;  // APERTURA_LIGHTS_...
    LightAt at = LightAt::Pixels;
    bool onFaces = false;  // with samples on faces
    bool painted = false;  // with textures, of a material that is opaque
    int bounces = APERTURA_BOUNCES_NONE;
};
std::vector<CompiledCost> compiledPixelCosts(const Gpu& gpu, std::span<const PixelCase> cases);

// Seconds that the device takes for each case, by its own clock: the minimum over the rounds.
//   points  receivers per run, a multiple of 64
//   rounds  each runs all cases in turn
// Throws Error if the device has no clock.
std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds);

// A whole frame: what `record` does, or `recordShadowMapped` where there is no model, its depth pass included.
struct FrameCase {
    Renderer* renderer;  // holds the model
    const Model* model;
    LightAt at = LightAt::Pixels;
};

// Seconds that the device takes for each frame, by its own clock: the minimum over the rounds, each of which draws all in turn. Prepares
// what is missing. Throws Error as Renderer does, or if the device has no clock.
std::vector<double> measuredFrames(const Gpu& gpu, const View& view, std::span<const FrameCase> cases, int rounds);

}  // namespace apertura
