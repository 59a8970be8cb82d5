#pragma once
// The materials of a scene on the device: a descriptor set of each, set 1 of the pipelines that draw the scene (shaders/paint.glsl).
#include <optional>
#include <vector>

#include "apertura/runtime/asset/scene.h"
#include "apertura/runtime/render/resources.h"

namespace apertura {

class Materials {
public:
    // Uploads what is loaded of the scene's textures; others are white, and so is the material of surfaces that have none. Images that are
    // too large for the device are used from a mip on that is not.
    Materials(const Gpu& gpu, const Scene& scene);

    // The layout alone, which is enough to compile pipelines.
    static vk::raii::DescriptorSetLayout makeLayout(const Gpu& gpu);
    vk::DescriptorSetLayout layout() const { return *layout_; }
    // `material`: of the scene's, or -1.
    void bind(vk::CommandBuffer commands, vk::PipelineLayout layout, int material) const;
    size_t bytes() const { return bytes_; }  // that they take on the device

private:
    vk::Sampler samplerFor(const Gpu& gpu, const Texture& texture);

    vk::raii::DescriptorSetLayout layout_;
    std::vector<std::pair<int, vk::raii::Sampler>> samplers_;  // by wrapping and filter
    std::vector<GpuImage> images_;                             // the first is white
    std::optional<GpuBuffer> constants_;
    vk::raii::DescriptorPool pool_ = nullptr;
    std::vector<vk::raii::DescriptorSet> sets_;  // of materials -1, 0, 1, ...
    size_t bytes_ = 0;
};

}  // namespace apertura
