#pragma once
// The usual alternative, as a baseline: a shadow map with percentage-closer soft shadows.
#include <map>

#include "runtime/asset/view.h"
#include "runtime/render/resources.h"

namespace apertura {

class ShadowMap {
public:
    // The first four are the renderer's and must outlive the shadow map.
    //   bounds  of the scene, world, metres
    //   frames  slots for record()
    ShadowMap(const Gpu& gpu, const PerFrame<Frame>& lit, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds,
              int frames);

    // Creates the pipeline for targets of this format.
    void prepare(const Gpu& gpu, VkFormat format);
    // Draws the map of the view's one directional light, then the scene with it. Throws Error if the target's format is not
    // prepared.
    //   frame     0 .. frames - 1
    //   vertices  to draw, three per triangle
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
