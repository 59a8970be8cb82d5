#pragma once
// The usual alternative, as a baseline: a shadow map with percentage-closer soft shadows.
#include <map>
#include <optional>

#include "apertura/runtime/asset/view.h"
#include "apertura/runtime/render/draw.h"

namespace apertura {

class ShadowMap {
public:
    // The renderer's geometry: one of the parts that it is bound in.
    struct Part {
        const GpuBuffer& vertices;
        const GpuBuffer& indices;
        uint32_t indexCount;
    };

    // The renderer's buffers must outlive the shadow map.
    //   lit     of each frame one for each part in turn
    //   bounds  of the scene, world, metres
    //   frames  slots for record()
    ShadowMap(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, std::span<const Part> parts, const Box& bounds, int frames);

    // Creates the pipeline for targets of this format.
    void prepare(const Gpu& gpu, VkFormat format);
    // Draws the map of the view's one directional light.
    //   frame  0 .. frames - 1
    void recordMap(vk::CommandBuffer commands, const View& view, int frame) const;
    // Draws the scene with it. Throws Error unless the format, of the pass's target, is prepared.
    void draw(const DrawPass& pass, VkFormat format, int frame) const;

private:
    struct BoundPart {
        GpuBindings shading, mapping;
        uint32_t indexCount;
    };
    void drawParts(const DrawPass& pass, GpuBindings BoundPart::*bindings, int frame) const;

    Box bounds_;
    GpuImage map_;
    PerFrame<AperturaShadowView> seen_;
    std::vector<BoundPart> parts_;
    std::optional<vk::raii::Pipeline> mapping_;
    std::map<VkFormat, vk::raii::Pipeline> shading_;
};

}  // namespace apertura
