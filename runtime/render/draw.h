#pragma once
// Passes over triangles that the vertex shader pulls from buffers.
#include <glm/glm.hpp>
#include <span>

#include "runtime/render/vulkan.h"

namespace apertura {

constexpr VkFormat kColourFormat = VK_FORMAT_R32G32B32A32_SFLOAT, kDepthFormat = VK_FORMAT_D32_SFLOAT;

// A pipeline without vertex input: the greater depth wins. Without a colour image where `colour` is false.
VkPipeline makePipeline(const Gpu& gpu, std::span<const VkPipelineShaderStageCreateInfo> stages, VkPipelineLayout layout, bool colour);

// Clears the images (depth to 0) and draws `vertices` vertices. `colour` may be null.
void drawTriangles(VkCommandBuffer commands, const GpuImage* colour, const GpuImage& depth, VkExtent2D size, const glm::vec3& clear,
                   VkPipeline pipeline, const GpuBindings& bindings, uint32_t vertices);

}  // namespace apertura
