#pragma once
// Draws a baked scene off-screen with Vulkan.
#include <map>
#include <memory>

#include "runtime/asset.h"
#include "runtime/picture.h"
#include "runtime/view.h"
#include "runtime/vulkan.h"
#include "sh/models.h"

namespace apertura {

class Renderer {
public:
    // Converts the asset's visibility to apertures and uploads everything, once. `gpu` must outlive it.
    Renderer(const Gpu& gpu, const Asset& asset);
    ~Renderer();

    // The scene through one model. Nothing is loaded again between models: a pipeline each, made when first
    // asked for, from one shader. Throws Error where the picture is too large for the device.
    Picture draw(const View& view, const ModelInfo& model);

private:
    VkPipeline pipeline(int model);

    const Gpu& gpu_;
    float nearest_;
    uint32_t indexCount_ = 0;
    std::unique_ptr<GpuBuffer> vertices_, indices_, frame_;
    std::unique_ptr<GpuBindings> bindings_;
    std::unique_ptr<GpuShader> vertexShader_, fragmentShader_;
    std::map<int, VkPipeline> pipelines_;
};

// lightThrough and skyThrough (x, y) of a model on the device, for each of `inputs`.
std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, std::span<const Evaluation> inputs);

}  // namespace apertura
