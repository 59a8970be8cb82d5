#include "runtime/render/renderer.h"

#include <cassert>
#include <array>
#include <cstring>

#include "runtime/render/draw.h"
#include "runtime/asset/error.h"
#include "scene.frag.h"
#include "scene.vert.h"

namespace apertura {
namespace {

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

const Renderer::AllParams& Renderer::allParams(const Model& model) {
    AllParams& out = allParams_[model.id];
    if (out.bindings) return out;
    const bool stored = storedModel(asset_.info) == &model;
    if (!stored && !model.fromVisibility)
        throw Error(asset_.scene.name + ": was baked with --model " + asset_.info.model + " and does not hold "
                    + std::string(model.name) + "; bake it with --model " + std::string(model.name));
    std::vector<vec4> slots;
    for (size_t i = 0; i < asset_.scene.instances.size() && model.slots > 0; ++i) {
        const Instance& instance = asset_.scene.instances[i];
        const Surface& surface = asset_.scene.surfaces[instance.surface];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        const SeenByInstance& seen = asset_.seen[i];
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            const glm::vec3 n = normals * surface.normals[v];
            const float length = glm::length(n);
            const ModelParams params = toParams(model, seen.visibility[v], stored && !seen.allParams.empty() ? &seen.allParams[v] : nullptr,
                                     length > 0 ? n / length : glm::vec3(0, 1, 0));
            slots.insert(slots.end(), params.begin(), params.begin() + model.slots);
        }
    }
    if (slots.empty()) slots.emplace_back(0);  // a buffer cannot be empty
    if (slots.size() * sizeof(vec4) > gpu_.largestBuffer())
        throw Error(asset_.scene.name + ": the parameters of " + std::string(model.name) + " are too large for " + gpu_.name());
    out.buffer = upload(gpu_, std::as_bytes(std::span(slots)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const GpuBindings::Binding bindings[] = {
        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, frame_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, vertices_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_VERTEX_BIT, indices_.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_FRAGMENT_BIT, out.buffer.get()}};
    out.bindings = std::make_unique<GpuBindings>(gpu_, bindings);
    return out;
}

VkPipeline Renderer::pipeline(const Model& model, int lightClass, const GpuBindings& bindings) {
    VkPipeline& out = pipelines_[{model.id, lightClass}];
    if (out) return out;
    const Constants<4> constants({model.id, lightClass, model.slots, mayMix(model, storedModel(asset_.info) == &model)});
    const VkPipelineShaderStageCreateInfo stages[] = {
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_VERTEX_BIT,
         vertexShader_->handle(), "main", nullptr},
        {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_FRAGMENT_BIT,
         fragmentShader_->handle(), "main", &constants.info}};
    out = makePipeline(gpu_, stages, bindings.layout(), true);
    return out;
}

Picture Renderer::draw(const View& view, const Model& model) {
    int lightClass = LIGHTS_SUN;
    for (const Light& light : view.lights)
        lightClass = std::min(lightClass, isSphere(light) ? LIGHTS_ANY : lightClassOf(light.cap.sinRadius));
    const GpuBindings& bindings = *allParams(model).bindings;
    return picture(view, pipeline(model, lightClass, bindings), bindings, {});
}

Picture Renderer::drawShadowMapped(const View& view) {
    if (view.lights.size() != 1 || isSphere(view.lights[0])) throw Error("a shadow map is drawn of one light from a direction");
    if (!shadow_) shadow_ = std::make_unique<ShadowMap>(gpu_, *frame_, *vertices_, *indices_, worldBounds(asset_.scene));
    shadow_->aim(view.lights[0]);
    return picture(view, shadow_->pipeline(), shadow_->bindings(), [&](VkCommandBuffer commands) { shadow_->draw(commands, indexCount_); });
}

Picture Renderer::picture(const View& view, VkPipeline drawing, const GpuBindings& bindings, const std::function<void(VkCommandBuffer)>& before) {
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

    const GpuImage colour(gpu_, width, height, kColourFormat,
                          VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    const GpuImage depth(gpu_, width, height, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
    const GpuBuffer result(gpu_, VkDeviceSize(width) * height * sizeof(vec4), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           GpuBuffer::Place::Host);
    gpu_.run([&](VkCommandBuffer commands) {
        if (before) before(commands);
        colour.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        depth.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        drawTriangles(commands, &colour, depth, {width, height}, view.sky, drawing, bindings, indexCount_);
        colour.transition(commands, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        VkBufferImageCopy all{};
        all.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        all.imageExtent = {width, height, 1};
        vkCmdCopyImageToBuffer(commands, colour.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, result.handle(), 1, &all);
        letHostRead(commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    });
    Picture out{int(width), int(height), {}};
    const auto* pixels = static_cast<const vec4*>(result.data());
    out.pixels.assign(pixels, pixels + size_t(width) * height);
    return halved(out);
}

}  // namespace apertura
