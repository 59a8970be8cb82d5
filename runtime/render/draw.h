#pragma once
// Passes over triangles that the vertex shader pulls from buffers.
#include <glm/glm.hpp>
#include <span>

#include "runtime/render/resources.h"

namespace apertura {

constexpr vk::Format kColourFormat = vk::Format::eR32G32B32A32Sfloat, kDepthFormat = vk::Format::eD32Sfloat;

// What a pass draws with: SPIR-V words, and the fragment shader's constants. Without a fragment shader it
// draws depth alone.
struct DrawShaders {
    std::span<const uint32_t> vertex, fragment;
    std::span<const int32_t> constants;
};

// A pipeline without vertex input: the greater depth wins.
vk::raii::Pipeline makePipeline(const Gpu& gpu, const DrawShaders& shaders, const GpuBindings& bindings);

// Clears the images (depth to 0) and draws `vertices` vertices. `colour` may be null.
void drawTriangles(vk::CommandBuffer commands, const GpuImage* colour, const GpuImage& depth, vk::Extent2D size, const glm::vec3& clear,
                   vk::Pipeline pipeline, const GpuBindings& bindings, uint32_t vertices);

}  // namespace apertura
