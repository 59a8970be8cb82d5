#pragma once
// Draws a baked scene off-screen with Vulkan.
#include <map>
#include <memory>

#include "runtime/asset/asset.h"
#include "runtime/asset/picture.h"
#include "runtime/render/shadow_map.h"
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
    struct AllParams {
        std::unique_ptr<GpuBuffer> buffer;
        std::unique_ptr<GpuBindings> bindings;
    };
    const AllParams& allParams(const Model& model);
    VkPipeline pipeline(const Model& model, int lightClass, const GpuBindings& bindings);
    Picture picture(const View& view, VkPipeline drawing, const GpuBindings& bindings, const std::function<void(VkCommandBuffer)>& before);

    const Gpu& gpu_;
    const Asset& asset_;
    float nearest_;
    uint32_t indexCount_ = 0;
    std::unique_ptr<GpuBuffer> vertices_, indices_, frame_;
    std::unique_ptr<GpuShader> vertexShader_, fragmentShader_;
    std::unique_ptr<ShadowMap> shadow_;
    std::map<int, AllParams> allParams_;                           // by model
    std::map<std::pair<int, int>, VkPipeline> pipelines_;  // by model and class of lights
};

// irradianceThrough and skyIrradiance (x, y) of a model on the device, for each of `inputs`; `size` LIGHTS_... With `half` in
// 16-bit floats, for a device that offers them.
std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const Evaluation> inputs, bool half = false);

}  // namespace apertura
