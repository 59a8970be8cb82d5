#pragma once
// The baseline that a user would otherwise pick: a shadow map with percentage-closer soft shadows.
#include <memory>

#include "runtime/asset/scene.h"
#include "runtime/render/vulkan.h"
#include "sh/shading.h"

namespace apertura {

class ShadowMap {
public:
    // Of the renderer's buffers, which must outlive it; `bounds` is the scene's, metres.
    ShadowMap(const Gpu& gpu, const GpuBuffer& frame, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds);
    ~ShadowMap();

    // From this light (of a direction) the next map is drawn.
    void aim(const Light& light);
    void draw(VkCommandBuffer commands, uint32_t vertices) const;
    // What shades the scene with it.
    VkPipeline pipeline() const { return shading_; }
    const GpuBindings& bindings() const { return *bindings_; }

private:
    const Gpu& gpu_;
    Box bounds_;
    GpuImage map_;
    std::unique_ptr<GpuBuffer> view_;
    std::unique_ptr<GpuBindings> bindings_, mapBindings_;
    VkPipeline mapping_ = VK_NULL_HANDLE, shading_ = VK_NULL_HANDLE;
};

}  // namespace apertura
