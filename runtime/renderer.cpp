#include "runtime/renderer.h"

#include <cassert>
#include <array>
#include <cstring>

#include "runtime/error.h"
#include "scene.frag.h"
#include "scene.vert.h"

namespace apertura {
namespace {

constexpr VkFormat kColour = VK_FORMAT_R32G32B32A32_SFLOAT, kDepth = VK_FORMAT_D32_SFLOAT;

std::vector<SceneVertex> toVertices(const Asset& asset, std::vector<uint32_t>& indices) {
    std::vector<SceneVertex> out;
    for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
        const Instance& instance = asset.scene.instances[i];
        const Surface& surface = asset.scene.surfaces[instance.surface];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        const auto first = uint32_t(out.size());
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            const glm::vec3 n = normals * surface.normals[v];
            const float length = glm::length(n);
            const Visibility& seen = asset.seen[i].visibility[v];
            out.push_back({instance.toWorld * glm::vec4(surface.positions[v], 1),
                           vec4(length > 0 ? n / length : glm::vec3(0, 1, 0), 0), vec4(seen.direction, seen.area)});
        }
        for (const auto& t : surface.triangles)
            for (uint32_t index : t) indices.push_back(first + index);
    }
    return out;
}

// A specialisation constant each, 0, 1, ...
template <size_t N>
struct Constants {
    std::array<int32_t, N> values;
    std::array<VkSpecializationMapEntry, N> entries;
    VkSpecializationInfo info;
    explicit Constants(const std::array<int32_t, N>& given) : values(given) {
        for (uint32_t i = 0; i < N; ++i) entries[i] = {i, uint32_t(i * sizeof(int32_t)), sizeof(int32_t)};
        info = {uint32_t(N), entries.data(), N * sizeof(int32_t), values.data()};
    }
};

}  // namespace

Renderer::Renderer(const Gpu& gpu, const Asset& asset) : gpu_(gpu), asset_(asset) {
    std::vector<uint32_t> indices;
    const std::vector<SceneVertex> vertices = toVertices(asset, indices);
    indexCount_ = uint32_t(indices.size());
    const Box box = worldBounds(asset.scene);
    nearest_ = std::max(1e-4f * glm::length(box.high - box.low), 1e-9f);
    if (std::max(vertices.size() * sizeof(SceneVertex), indices.size() * sizeof(uint32_t)) > gpu.largestBuffer())
        throw Error(asset.scene.name + ": has too many vertices or triangles for " + gpu.name());
    vertices_ = upload(gpu, std::as_bytes(std::span(vertices)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    indices_ = upload(gpu, std::as_bytes(std::span(indices)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    frame_ = std::make_unique<GpuBuffer>(gpu, sizeof(Frame), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GpuBuffer::Place::Host);
    vertexShader_ = std::make_unique<GpuShader>(gpu, scene_vert);
    fragmentShader_ = std::make_unique<GpuShader>(gpu, scene_frag);
}

Renderer::~Renderer() {
    for (const auto& [key, pipeline] : pipelines_) vkDestroyPipeline(gpu_.device(), pipeline, nullptr);
}

const Renderer::Forms& Renderer::forms(const Model& model) {
    Forms& out = forms_[model.id];
    if (out.bindings) return out;
    const bool stored = asset_.info.model == model.name;
    if (!stored && !model.fromVisibility)
        throw Error(asset_.scene.name + ": was baked with --model " + asset_.info.model + " and does not hold "
                    + std::string(model.name));
    std::vector<vec4> slots;
    for (size_t i = 0; i < asset_.scene.instances.size() && model.slots > 0; ++i) {
        const Instance& instance = asset_.scene.instances[i];
        const Surface& surface = asset_.scene.surfaces[instance.surface];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        const SeenByInstance& seen = asset_.seen[i];
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            const glm::vec3 n = normals * surface.normals[v];
            const float length = glm::length(n);
            const Form form = toForm(model, seen.visibility[v], stored && !seen.forms.empty() ? &seen.forms[v] : nullptr,
                                     length > 0 ? n / length : glm::vec3(0, 1, 0));
            slots.insert(slots.end(), form.begin(), form.begin() + model.slots);
        }
    }
    if (slots.empty()) slots.emplace_back(0);  // a buffer cannot be empty
    if (slots.size() * sizeof(vec4) > gpu_.largestBuffer())
        throw Error(asset_.scene.name + ": the forms of " + std::string(model.name) + " are too large for " + gpu_.name());
    out.buffer = upload(gpu_, std::as_bytes(std::span(slots)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const GpuBindings::Binding bindings[] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, frame_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, vertices_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT, indices_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT, out.buffer.get()}};
    out.bindings = std::make_unique<GpuBindings>(gpu_, bindings);
    return out;
}

VkPipeline Renderer::pipeline(const Model& model, int size, const GpuBindings& bindings) {
    VkPipeline& out = pipelines_[{model.id, size}];
    if (out) return out;
    const Constants<4> constants({model.id, size, model.slots, model.mixes});
    const VkPipelineShaderStageCreateInfo stages[] = {
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_VERTEX_BIT,
         vertexShader_->handle(), "main", nullptr},
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_FRAGMENT_BIT,
         fragmentShader_->handle(), "main", &constants.info}};
    const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_GREATER;
    VkPipelineColorBlendAttachmentState attachment{};
    attachment.colorWriteMask = 0xF;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &attachment;
    const VkDynamicState changing[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = uint32_t(std::size(changing));
    dynamic.pDynamicStates = changing;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachmentFormats = &kColour;
    rendering.depthAttachmentFormat = kDepth;
    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    info.stageCount = uint32_t(std::size(stages));
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = bindings.layout();
    check(vkCreateGraphicsPipelines(gpu_.device(), VK_NULL_HANDLE, 1, &info, nullptr, &out), "vkCreateGraphicsPipelines");
    return out;
}

Picture Renderer::draw(const View& view, const Model& model) {
    assert(view.lights.size() <= size_t(MAX_LIGHTS));
    const auto width = uint32_t(view.width) * 2, height = uint32_t(view.height) * 2;
    if (std::max(width, height) > gpu_.largestImage())
        throw Error("Vulkan: " + gpu_.name() + " draws pictures of at most " + std::to_string(gpu_.largestImage() / 2)
                    + " pixels a side");
    Frame frame{};
    frame.toClip = clipTransform(view.camera, double(view.width) / view.height, nearest_);
    frame.sky = vec4(view.sky, 0);
    frame.albedo = vec4(view.albedo, 0);
    frame.counts.x = int(view.lights.size());
    std::copy(view.lights.begin(), view.lights.end(), frame.lights);
    std::memcpy(frame_->data(), &frame, sizeof frame);

    const GpuImage colour(gpu_, width, height, kColour,
                          VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    const GpuImage depth(gpu_, width, height, kDepth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
    const GpuBuffer result(gpu_, VkDeviceSize(width) * height * sizeof(vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           GpuBuffer::Place::Host);
    int size = LIGHTS_SMALL;
    for (const Light& light : view.lights)
        size = std::min(size, light.place.w > 0 ? LIGHTS_ANY : lightsOf(light.shape.x));
    const GpuBindings& bindings = *forms(model).bindings;
    const VkPipeline drawing = pipeline(model, size, bindings);
    gpu_.run([&](VkCommandBuffer commands) {
        colour.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        depth.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        VkRenderingAttachmentInfo target{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
        target.imageView = colour.view();
        target.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        target.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        target.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
        target.clearValue.color = {{view.sky.r, view.sky.g, view.sky.b, 1}};
        VkRenderingAttachmentInfo far = target;
        far.imageView = depth.view();
        far.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
        far.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
        far.clearValue.depthStencil = {0, 0};
        VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
        rendering.renderArea = {{0, 0}, {width, height}};
        rendering.layerCount = 1;
        rendering.colorAttachmentCount = 1;
        rendering.pColorAttachments = &target;
        rendering.pDepthAttachment = &far;
        vkCmdBeginRendering(commands, &rendering);
        const VkViewport viewport{0, 0, float(width), float(height), 0, 1};
        vkCmdSetViewport(commands, 0, 1, &viewport);
        vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, drawing);
        const VkDescriptorSet set = bindings.set();
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, bindings.layout(), 0, 1, &set, 0, nullptr);
        vkCmdDraw(commands, indexCount_, 1, 0, 0);
        vkCmdEndRendering(commands);
        colour.transition(commands, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        VkBufferImageCopy all{};
        all.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        all.imageExtent = {width, height, 1};
        vkCmdCopyImageToBuffer(commands, colour.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, result.handle(), 1, &all);
        letHostRead(commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    });
    Picture picture{int(width), int(height), {}};
    const auto* pixels = static_cast<const vec4*>(result.data());
    picture.pixels.assign(pixels, pixels + size_t(width) * height);
    return halved(picture);
}

}  // namespace apertura
