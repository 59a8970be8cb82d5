#pragma once
// The baseline that a user would otherwise pick: a shadow map with percentage-closer soft shadows.
#include "runtime/asset/scene.h"
#include "runtime/render/resources.h"
#include "sh/shading.h"

namespace apertura {

class ShadowMap {
public:
    // Of the renderer's buffers, which must outlive it; `bounds` is the scene's, metres.
    ShadowMap(const Gpu& gpu, const GpuBuffer& frame, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds);

    // From this light (of a direction) the next map is drawn.
    void aim(const Light& light);
    void draw(vk::CommandBuffer commands, uint32_t vertices) const;
    // What shades the scene with it.
    vk::Pipeline pipeline() const { return *shading_; }
    const GpuBindings& bindings() const { return bindings_; }

private:
    Box bounds_;
    GpuImage map_;
    GpuBuffer view_;
    GpuBindings bindings_, mapBindings_;
    vk::raii::Pipeline mapping_, shading_;
};

}  // namespace apertura
