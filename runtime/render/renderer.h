#pragma once
// Draws a baked scene off-screen with Vulkan.
#include <memory>
#include <span>

#include "runtime/asset/asset.h"
#include "runtime/asset/picture.h"
#include "runtime/asset/view.h"
#include "runtime/render/vulkan.h"
#include "sh/models.h"

namespace apertura {

class Renderer {
public:
    // Uploads the geometry, once. `gpu` and `asset` must outlive it.
    Renderer(const Gpu& gpu, const Asset& asset);
    ~Renderer();

    // The scene through one model: made from the four numbers, or the one that the asset stores. A model's
    // parameters are uploaded and its pipeline made, from the one shader, when it is first asked for. Throws Error
    // where the asset does not hold the model, or the picture or the parameters are too large for the device.
    Picture draw(const View& view, const Model& model);

    // The baseline: N.L, a shadow map of 2048 texels a side and percentage-closer soft shadows; no occlusion
    // of the sky. Throws Error unless there is one light, from a direction.
    Picture drawShadowMapped(const View& view);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

// irradianceThrough and skyIrradiance (x, y) of a model on the device, for each of `inputs`; `lightClass` LIGHTS_... With `half` in
// 16-bit floats, for a device that offers them.
std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const Evaluation> inputs, bool half = false);

}  // namespace apertura
