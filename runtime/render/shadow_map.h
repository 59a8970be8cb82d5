#pragma once
// The baseline that a user would otherwise pick: a shadow map with percentage-closer soft shadows.
#include <map>

#include "runtime/asset/view.h"
#include "runtime/render/resources.h"

namespace apertura {

class ShadowMap {
public:
    // Over the renderer's buffers, which must outlive it; `bounds` is the scene's, metres.
    ShadowMap(const Gpu& gpu, const PerFrame<Frame>& lit, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds,
              int frames);

    // Makes the pipeline for targets of this format.
    void prepare(const Gpu& gpu, VkFormat format);
    // Draws the map of the view's one light, from a direction, and what it shades. Throws Error if not prepared.
    void record(vk::CommandBuffer commands, const RenderTarget& target, const View& view, int frame, uint32_t vertices) const;

private:
    Box bounds_;
    GpuImage map_;
    PerFrame<ShadowView> seen_;
    GpuBindings bindings_, mapBindings_;
    vk::raii::Pipeline mapping_;
    std::map<VkFormat, vk::raii::Pipeline> shading_;
};

}  // namespace apertura
