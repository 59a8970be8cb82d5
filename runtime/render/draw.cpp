#include "runtime/render/draw.h"

namespace apertura {

vk::raii::Pipeline makePipeline(const Gpu& gpu, const DrawShaders& shaders, const GpuBindings& bindings) {
    const bool colour = !shaders.fragment.empty();
    const vk::raii::ShaderModule vertex = makeShader(gpu, shaders.vertex);
    const vk::raii::ShaderModule fragment = colour ? makeShader(gpu, shaders.fragment) : nullptr;
    const Constants constants(shaders.constants);
    const vk::PipelineShaderStageCreateInfo stages[] = {
        {.stage = vk::ShaderStageFlagBits::eVertex, .module = *vertex, .pName = "main"},
        {.stage = vk::ShaderStageFlagBits::eFragment, .module = *fragment, .pName = "main", .pSpecializationInfo = &constants.info}};
    const vk::PipelineVertexInputStateCreateInfo input{};
    const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
    const vk::PipelineViewportStateCreateInfo viewport{.viewportCount = 1, .scissorCount = 1};
    const vk::PipelineRasterizationStateCreateInfo raster{.lineWidth = 1};
    const vk::PipelineMultisampleStateCreateInfo samples{.rasterizationSamples = vk::SampleCountFlagBits::e1};
    const vk::PipelineDepthStencilStateCreateInfo depth{
        .depthTestEnable = true, .depthWriteEnable = true, .depthCompareOp = vk::CompareOp::eGreater};
    using Channel = vk::ColorComponentFlagBits;
    const vk::PipelineColorBlendAttachmentState attachment{.colorWriteMask = Channel::eR | Channel::eG | Channel::eB | Channel::eA};
    const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = colour ? 1u : 0u, .pAttachments = &attachment};
    const vk::DynamicState changing[] = {vk::DynamicState::eViewport, vk::DynamicState::eScissor};
    const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = uint32_t(std::size(changing)), .pDynamicStates = changing};
    const vk::PipelineRenderingCreateInfo rendering{.colorAttachmentCount = blend.attachmentCount,
                                                    .pColorAttachmentFormats = &kColourFormat,
                                                    .depthAttachmentFormat = kDepthFormat};
    return make<vk::raii::Pipeline>(gpu, nullptr, vk::GraphicsPipelineCreateInfo{.pNext = &rendering,
                                                                                 .stageCount = colour ? 2u : 1u,
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

void drawTriangles(vk::CommandBuffer commands, const GpuImage* colour, const GpuImage& depth, vk::Extent2D size, const glm::vec3& clear,
                   vk::Pipeline pipeline, const GpuBindings& bindings, uint32_t vertices) {
    const vk::RenderingAttachmentInfo target{.imageView = colour ? colour->view() : nullptr,
                                             .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                             .loadOp = vk::AttachmentLoadOp::eClear,
                                             .storeOp = vk::AttachmentStoreOp::eStore,
                                             .clearValue = vk::ClearColorValue(std::array{clear.r, clear.g, clear.b, 1.0f})};
    const vk::RenderingAttachmentInfo far{.imageView = depth.view(),
                                          .imageLayout = vk::ImageLayout::eDepthAttachmentOptimal,
                                          .loadOp = vk::AttachmentLoadOp::eClear,
                                          .storeOp = colour ? vk::AttachmentStoreOp::eDontCare : vk::AttachmentStoreOp::eStore,
                                          .clearValue = vk::ClearDepthStencilValue{0, 0}};
    const vk::Rect2D all{{0, 0}, size};
    commands.beginRendering({.renderArea = all,
                             .layerCount = 1,
                             .colorAttachmentCount = colour ? 1u : 0u,
                             .pColorAttachments = &target,
                             .pDepthAttachment = &far});
    commands.setViewport(0, vk::Viewport{0, 0, float(size.width), float(size.height), 0, 1});
    commands.setScissor(0, all);
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, pipeline);
    bindings.bind(commands, vk::PipelineBindPoint::eGraphics);
    commands.draw(vertices, 1, 0, 0);
    commands.endRendering();
}

}  // namespace apertura
