#include "apertura/runtime/render/draw.h"

namespace apertura {

vk::raii::Pipeline makePipeline(const Gpu& gpu, const DrawShaders& shaders, const GpuBindings& bindings, vk::Format colour,
                                vk::PipelineCreateFlags flags) {
    const bool shades = !shaders.fragment.empty(), colours = shades && colour != vk::Format::eUndefined;
    const vk::raii::ShaderModule vertex = makeShader(gpu, shaders.vertex);
    const vk::raii::ShaderModule fragment = shades ? makeShader(gpu, shaders.fragment) : nullptr;
    const Constants constants(shaders.constants);
    const vk::PipelineShaderStageCreateInfo stages[] = {
        {.stage = vk::ShaderStageFlagBits::eVertex, .module = *vertex, .pName = "main", .pSpecializationInfo = &constants.info},
        {.stage = vk::ShaderStageFlagBits::eFragment, .module = *fragment, .pName = "main", .pSpecializationInfo = &constants.info}};
    const vk::PipelineVertexInputStateCreateInfo input{};
    const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
    const vk::PipelineViewportStateCreateInfo viewport{.viewportCount = 1, .scissorCount = 1};
    const vk::PipelineRasterizationStateCreateInfo raster{.lineWidth = 1};
    const vk::PipelineMultisampleStateCreateInfo samples{.rasterizationSamples = vk::SampleCountFlagBits::e1};
    const vk::PipelineDepthStencilStateCreateInfo depth{
        .depthTestEnable = true,
        .depthWriteEnable = !shaders.blends,
        .depthCompareOp = shaders.covers == DrawShaders::Covers::Equal ? vk::CompareOp::eGreaterOrEqual : vk::CompareOp::eGreater};
    using Channel = vk::ColorComponentFlagBits;
    const vk::PipelineColorBlendAttachmentState attachment{.blendEnable = shaders.blends,
                                                           .srcColorBlendFactor = vk::BlendFactor::eSrcAlpha,
                                                           .dstColorBlendFactor = vk::BlendFactor::eOneMinusSrcAlpha,
                                                           .srcAlphaBlendFactor = vk::BlendFactor::eZero,
                                                           .dstAlphaBlendFactor = vk::BlendFactor::eOne,
                                                           .colorWriteMask = Channel::eR | Channel::eG | Channel::eB | Channel::eA};
    const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = colours ? 1u : 0u, .pAttachments = &attachment};
    const vk::DynamicState changing[] = {vk::DynamicState::eViewport, vk::DynamicState::eScissor};
    const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = uint32_t(std::size(changing)), .pDynamicStates = changing};
    const vk::PipelineRenderingCreateInfo rendering{
        .colorAttachmentCount = blend.attachmentCount, .pColorAttachmentFormats = &colour, .depthAttachmentFormat = kDepthFormat};
    ++gpu.handles().counters.pipelines;
    return make<vk::raii::Pipeline>(gpu, nullptr,
                                    vk::GraphicsPipelineCreateInfo{.pNext = &rendering,
                                                                   .flags = flags,
                                                                   .stageCount = shades ? 2u : 1u,
                                                                   .pStages = stages,
                                                                   .pVertexInputState = &input,
                                                                   .pInputAssemblyState = &assembly,
                                                                   .pViewportState = &viewport,
                                                                   .pRasterizationState = &raster,
                                                                   .pMultisampleState = &samples,
                                                                   .pDepthStencilState = &depth,
                                                                   .pColorBlendState = &blend,
                                                                   .pDynamicState = &dynamic,
                                                                   .layout = bindings.layout()});
}

DrawPass::DrawPass(vk::CommandBuffer commands, const RenderTarget& target) : commands_(commands) {
    const bool hasColour = target.colour;
    const vk::RenderingAttachmentInfo colour{.imageView = target.colour,
                                             .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                             .loadOp = vk::AttachmentLoadOp::eClear,
                                             .storeOp = vk::AttachmentStoreOp::eStore,
                                             .clearValue = vk::ClearColorValue(std::array{0.0f, 0.0f, 0.0f, 1.0f})};
    const vk::RenderingAttachmentInfo depth{.imageView = target.depth,
                                            .imageLayout = vk::ImageLayout::eDepthAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = hasColour ? vk::AttachmentStoreOp::eDontCare : vk::AttachmentStoreOp::eStore,
                                            .clearValue = vk::ClearDepthStencilValue{0, 0}};
    const vk::Rect2D all{{0, 0}, {target.size.width, target.size.height}};
    commands.beginRendering({.renderArea = all,
                             .layerCount = 1,
                             .colorAttachmentCount = hasColour ? 1u : 0u,
                             .pColorAttachments = &colour,
                             .pDepthAttachment = &depth});
    commands.setViewport(0, vk::Viewport{0, 0, float(target.size.width), float(target.size.height), 0, 1});
    commands.setScissor(0, all);
}

void DrawPass::draw(const GpuBindings& bindings, std::span<const uint32_t> offsets, uint32_t vertices, const GpuBuffer* indices) const {
    bind(bindings, offsets, indices);
    drawRange(0, vertices, indices);
}

void DrawPass::bind(const GpuBindings& bindings, std::span<const uint32_t> offsets, const GpuBuffer* indices) const {
    bindings.bind(commands_, vk::PipelineBindPoint::eGraphics, offsets);
    if (indices) commands_.bindIndexBuffer(indices->handle(), 0, vk::IndexType::eUint32);
}

void DrawPass::drawRange(uint32_t first, uint32_t vertices, bool indexed) const {
    if (indexed)
        commands_.drawIndexed(vertices, 1, first, 0, 0);
    else
        commands_.draw(vertices, 1, first, 0);
}

Offscreen::Offscreen(const Gpu& gpu, vk::Extent2D size, vk::Format colour)
    : size_(size),
      format_(colour),
      gpu_(gpu),
      colour_(gpu, size, colour, vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc,
              vk::ImageAspectFlagBits::eColor),
      depth_(gpu, size, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment, vk::ImageAspectFlagBits::eDepth),
      result_(gpu, VkDeviceSize(size.width) * size.height * sizeof(glm::vec4), vk::BufferUsageFlagBits::eTransferDst,
              GpuBuffer::Place::Host) {}

RenderTarget Offscreen::target() const { return {colour_.view(), VkFormat(format_), depth_.view(), size_}; }

void Offscreen::begin(vk::CommandBuffer commands) const {
    colour_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eColorAttachmentOptimal);
    depth_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
}

void Offscreen::end(vk::CommandBuffer commands) const {
    ++gpu_.handles().counters.copiesToHost;
    colour_.transition(commands, vk::ImageLayout::eColorAttachmentOptimal, vk::ImageLayout::eTransferSrcOptimal);
    commands.copyImageToBuffer(
        colour_.handle(), vk::ImageLayout::eTransferSrcOptimal, result_.handle(),
        vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, .imageExtent = {size_.width, size_.height, 1}});
    letHostRead(commands, vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferWrite);
}

}  // namespace apertura
