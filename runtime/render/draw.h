#pragma once
// Draws triangles whose vertices the vertex shader pulls from buffers.
#include <glm/glm.hpp>
#include <span>

#include "apertura/runtime/render/resources.h"

namespace apertura {

constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

// Shaders of a pass, as SPIR-V words. Without a fragment shader, or a format, the pass draws depth alone.
struct DrawShaders {
    std::span<const uint32_t> vertex, fragment;
    std::span<const int32_t> constants;  // specialisation constants 0, 1, ... of both
    enum class Covers { Farther, Equal };
    Covers covers = Covers::Farther;  // what is drawn over: what lies farther, or at the same depth too
    bool blends = false;              // with what is there, by alpha; it then leaves the depth as it is
};

// A pipeline without vertex input, for a colour image of this format. The greater depth wins.
vk::raii::Pipeline makePipeline(const Gpu& gpu, const DrawShaders& shaders, const GpuBindings& bindings, vk::Format colour,
                                vk::PipelineCreateFlags flags = {});

// A pass over a target, from its construction to its destruction. It clears the images, the colour to black and the depth to 0; the depth
// is kept only if the target has no colour.
class DrawPass {
public:
    DrawPass(vk::CommandBuffer commands, const RenderTarget& target);
    ~DrawPass() { commands_.endRendering(); }
    DrawPass(const DrawPass&) = delete;

    // With what the next are drawn.
    void use(vk::Pipeline pipeline) const { commands_.bindPipeline(vk::PipelineBindPoint::eGraphics, pipeline); }
    // Draws so many vertices or, by 32-bit indices, as many of these.
    //   bindings  with the layout of the pipeline's
    //   offsets   bytes, one per dynamic binding
    void draw(const GpuBindings& bindings, std::span<const uint32_t> offsets, uint32_t vertices, const GpuBuffer* indices = nullptr) const;
    // The two halves of that: what is bound stays so for several draws.
    void bind(const GpuBindings& bindings, std::span<const uint32_t> offsets, const GpuBuffer* indices) const;
    void drawRange(uint32_t first, uint32_t vertices, bool indexed) const;
    vk::CommandBuffer commands() const { return commands_; }

private:
    vk::CommandBuffer commands_;
};

// A target without a window whose pixels can be read. `colour`: a format of at most 16 bytes per pixel.
class Offscreen {
public:
    Offscreen(const Gpu& gpu, vk::Extent2D size, vk::Format colour);

    RenderTarget target() const;
    void begin(vk::CommandBuffer commands) const;  // record it before the first pass
    void end(vk::CommandBuffer commands) const;    // record it after the last one
    // Row by row from the top, in the colour's format; valid once the commands have run.
    const void* pixels() const { return result_.data(); }

private:
    vk::Extent2D size_;
    vk::Format format_;
    const Gpu& gpu_;
    GpuImage colour_, depth_;
    GpuBuffer result_;
};

}  // namespace apertura
