#pragma once
// The usual alternative, as a baseline: a shadow map with percentage-closer soft shadows.
#include <map>
#include <mutex>
#include <optional>

#include "apertura/runtime/asset/view.h"
#include "apertura/runtime/render/batches.h"

namespace apertura {

class ShadowMap {
public:
    // The renderer's geometry: one of the parts that it is bound in.
    struct Part {
        const GpuBuffer& vertices;
        const GpuBuffer& indices;
        const GpuBuffer& paint;
        const std::vector<Batch>& batches;
    };

    // The renderer's buffers and materials must outlive the shadow map.
    //   lit     of each frame one for each part in turn
    //   bounds  of the scene, world, metres
    //   frames  slots for recordMap()
    ShadowMap(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, std::span<const Part> parts, const Materials& materials, bool painted,
              const Box& bounds, int frames);

    // Creates the pipelines for targets of this format.
    void prepare(const Gpu& gpu, VkFormat format);
    // Draws the map of the view's one directional light. Holes of masks, and what blends, cast no shadow.
    //   frame  0 .. frames - 1
    void recordMap(vk::CommandBuffer commands, const View& view, int frame) const;
    // What draws the scene with it. Throws Error unless the format, of the target, is prepared.
    std::vector<BoundPart> shading(int frame) const;
    vk::Pipeline pipeline(VkFormat format, Material::Alpha alpha) const;

private:
    struct PartBindings {
        GpuBindings shading, mapping;
        const std::vector<Batch>* batches;
    };
    std::vector<BoundPart> bound(GpuBindings PartBindings::*bindings, int frame) const;

    Box bounds_;
    const Materials& materials_;
    bool painted_;
    GpuImage map_;
    PerFrame<AperturaShadowView> seen_;
    std::vector<PartBindings> parts_;
    std::optional<vk::raii::Pipeline> mapping_, mappingMasks_;
    std::map<std::pair<VkFormat, Material::Alpha>, vk::raii::Pipeline> shading_;
    mutable std::mutex lock_;  // of it
};

}  // namespace apertura
