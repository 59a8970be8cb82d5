#pragma once
// Passes over triangles that the vertex shader pulls from buffers.
#include <glm/glm.hpp>
#include <span>

#include "runtime/render/resources.h"

namespace apertura {

constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

// What a pass draws with: SPIR-V words, and the fragment shader's constants. Without a fragment shader it
// draws depth alone.
struct DrawShaders {
    std::span<const uint32_t> vertex, fragment;
    std::span<const int32_t> constants;
};

// A pipeline without vertex input, for a colour image of this format: the greater depth wins.
vk::raii::Pipeline makePipeline(const Gpu& gpu, const DrawShaders& shaders, const GpuBindings& bindings, vk::Format colour);

struct DrawPass {
    vk::Pipeline pipeline;
    const GpuBindings& bindings;
    std::span<const uint32_t> offsets;  // of the bindings that are dynamic, bytes
};

// Clears the images (depth to 0) and draws `vertices` vertices. Where the target has no colour, its depth is kept.
void drawTriangles(vk::CommandBuffer commands, const RenderTarget& target, const glm::vec3& clear, const DrawPass& pass, uint32_t vertices);

// A target without a window, and its pixels.
class Offscreen {
public:
    Offscreen(const Gpu& gpu, vk::Extent2D size, vk::Format colour);

    RenderTarget target() const;
    void begin(vk::CommandBuffer commands) const;  // before it is drawn to
    void end(vk::CommandBuffer commands) const;    // after
    // Row by row from the top, once the commands have run.
    const void* pixels() const { return result_.data(); }

private:
    vk::Extent2D size_;
    vk::Format format_;
    GpuImage colour_, depth_;
    GpuBuffer result_;
};

}  // namespace apertura
