#include "runtime/render/renderer.h"

#include <cassert>
#include <cstring>
#include <map>
#include <optional>

#include "runtime/render/draw.h"
#include "runtime/render/shadow_map.h"
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

GpuBuffer uploadParams(const Gpu& gpu, const Asset& asset, const Model& model) {
    const bool stored = storedModel(asset.info) == &model;
    if (!stored && !model.fromVisibility)
        throw Error(asset.scene.name + ": was baked with --model " + asset.info.model + " and does not hold "
                    + std::string(model.name) + "; bake it with --model " + std::string(model.name));
    std::vector<vec4> slots;
    for (size_t i = 0; i < asset.scene.instances.size() && model.slots > 0; ++i) {
        const Instance& instance = asset.scene.instances[i];
        const Surface& surface = asset.scene.surfaces[instance.surface];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        const SeenByInstance& seen = asset.seen[i];
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            const glm::vec3 n = normals * surface.normals[v];
            const float length = glm::length(n);
            const ModelParams params = toParams(model, seen.visibility[v], stored && !seen.allParams.empty() ? &seen.allParams[v] : nullptr,
                                     length > 0 ? n / length : glm::vec3(0, 1, 0));
            slots.insert(slots.end(), params.begin(), params.begin() + model.slots);
        }
    }
    if (slots.empty()) slots.emplace_back(0);  // a buffer cannot be empty
    if (slots.size() * sizeof(vec4) > gpu.largestBuffer())
        throw Error(asset.scene.name + ": the parameters of " + std::string(model.name) + " are too large for " + gpu.name());
    return upload(gpu, std::as_bytes(std::span(slots)), vk::BufferUsageFlagBits::eStorageBuffer);
}

template <class T>
GpuBuffer uploadGeometry(const Gpu& gpu, const Asset& asset, const std::vector<T>& values) {
    if (values.size() * sizeof(T) > gpu.largestBuffer())
        throw Error(asset.scene.name + ": has too many vertices or triangles for " + gpu.name());
    return upload(gpu, std::as_bytes(std::span(values)), vk::BufferUsageFlagBits::eStorageBuffer);
}

}  // namespace

struct Renderer::Parts {
    struct AllParams {
        GpuBuffer buffer;
        GpuBindings bindings;
    };

    Parts(const Gpu& gpu_, const Asset& asset_, const std::vector<SceneVertex>& corners, const std::vector<uint32_t>& order)
        : gpu(gpu_),
          asset(asset_),
          box(worldBounds(asset_.scene)),
          indexCount(uint32_t(order.size())),
          vertices(uploadGeometry(gpu_, asset_, corners)),
          indices(uploadGeometry(gpu_, asset_, order)),
          frame(gpu_, sizeof(Frame), vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host) {}

    const AllParams& paramsOf(const Model& model);
    vk::Pipeline pipeline(const Model& model, int lightClass, const GpuBindings& bindings);
    Picture picture(const View& view, vk::Pipeline drawing, const GpuBindings& bindings, const ShadowMap* before);

    const Gpu& gpu;
    const Asset& asset;
    Box box;
    uint32_t indexCount;
    GpuBuffer vertices, indices, frame;
    std::optional<ShadowMap> shadow;
    std::map<int, AllParams> allParams;                           // by model
    std::map<std::pair<int, int>, vk::raii::Pipeline> pipelines;  // by model and class of lights
};

Renderer::Renderer(const Gpu& gpu, const Asset& asset) {
    std::vector<uint32_t> indices;
    const std::vector<SceneVertex> vertices = toVertices(asset, indices);
    parts_ = std::make_unique<Parts>(gpu, asset, vertices, indices);
}

Renderer::~Renderer() = default;

const Renderer::Parts::AllParams& Renderer::Parts::paramsOf(const Model& model) {
    if (const auto found = allParams.find(model.id); found != allParams.end()) return found->second;
    GpuBuffer buffer = uploadParams(gpu, asset, model);
    constexpr vk::ShaderStageFlags vertex = vk::ShaderStageFlagBits::eVertex, fragment = vk::ShaderStageFlagBits::eFragment;
    const GpuBindings::Binding slots[] = {{vk::DescriptorType::eUniformBuffer, vertex | fragment, &frame},
                                          {vk::DescriptorType::eStorageBuffer, vertex | fragment, &vertices},
                                          {vk::DescriptorType::eStorageBuffer, vertex, &indices},
                                          {vk::DescriptorType::eStorageBuffer, fragment, &buffer}};
    GpuBindings bindings(gpu, slots);
    return allParams.insert({model.id, AllParams{std::move(buffer), std::move(bindings)}}).first->second;
}

vk::Pipeline Renderer::Parts::pipeline(const Model& model, int lightClass, const GpuBindings& bindings) {
    const std::pair key(model.id, lightClass);
    if (!pipelines.contains(key)) {
        const int32_t constants[] = {model.id, lightClass, model.slots, mayMix(model, storedModel(asset.info) == &model)};
        pipelines.emplace(key, makePipeline(gpu, {scene_vert, scene_frag, constants}, bindings));
    }
    return *pipelines.at(key);
}

Picture Renderer::draw(const View& view, const Model& model) {
    int lightClass = LIGHTS_SUN;
    for (const Light& light : view.lights)
        lightClass = std::min(lightClass, isSphere(light) ? LIGHTS_ANY : lightClassOf(light.cap.sinRadius));
    const GpuBindings& bindings = parts_->paramsOf(model).bindings;
    return parts_->picture(view, parts_->pipeline(model, lightClass, bindings), bindings, nullptr);
}

Picture Renderer::drawShadowMapped(const View& view) {
    if (view.lights.size() != 1 || isSphere(view.lights[0])) throw Error("a shadow map is drawn of one light from a direction");
    std::optional<ShadowMap>& shadow = parts_->shadow;
    if (!shadow) shadow.emplace(parts_->gpu, parts_->frame, parts_->vertices, parts_->indices, parts_->box);
    shadow->aim(view.lights[0]);
    return parts_->picture(view, shadow->pipeline(), shadow->bindings(), &*shadow);
}

Picture Renderer::Parts::picture(const View& view, vk::Pipeline drawing, const GpuBindings& bindings, const ShadowMap* before) {
    assert(view.lights.size() <= size_t(MAX_LIGHTS));
    const vk::Extent2D size{uint32_t(view.width) * 2, uint32_t(view.height) * 2};
    if (std::max(size.width, size.height) > gpu.largestImage())
        throw Error("Vulkan: " + gpu.name() + " draws pictures of at most " + std::to_string(gpu.largestImage() / 2)
                    + " pixels a side");
    const float nearest = std::max(1e-4f * glm::length(box.high - box.low), 1e-9f);
    Frame now{};
    now.toClip = clipTransform(view.camera, double(view.width) / view.height, nearest);
    now.sky = vec4(view.sky, 0);
    now.albedo = vec4(view.albedo, 0);
    now.counts.x = int(view.lights.size());
    std::copy(view.lights.begin(), view.lights.end(), now.lights);
    std::memcpy(frame.data(), &now, sizeof now);

    const GpuImage colour(gpu, size, kColourFormat, vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eTransferSrc,
                          vk::ImageAspectFlagBits::eColor);
    const GpuImage depth(gpu, size, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment, vk::ImageAspectFlagBits::eDepth);
    const size_t pixelCount = size_t(size.width) * size.height;
    const GpuBuffer result(gpu, pixelCount * sizeof(vec4), vk::BufferUsageFlagBits::eTransferDst, GpuBuffer::Place::Host);
    gpu.run([&](vk::CommandBuffer commands) {
        using Layout = vk::ImageLayout;
        if (before) before->draw(commands, indexCount);
        colour.transition(commands, Layout::eUndefined, Layout::eColorAttachmentOptimal);
        depth.transition(commands, Layout::eUndefined, Layout::eDepthAttachmentOptimal);
        drawTriangles(commands, &colour, depth, size, view.sky, drawing, bindings, indexCount);
        colour.transition(commands, Layout::eColorAttachmentOptimal, Layout::eTransferSrcOptimal);
        commands.copyImageToBuffer(colour.handle(), Layout::eTransferSrcOptimal, result.handle(),
                                   vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                                       .imageExtent = {size.width, size.height, 1}});
        letHostRead(commands, vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferWrite);
    });
    Picture out{int(size.width), int(size.height), {}};
    const auto* pixels = static_cast<const vec4*>(result.data());
    out.pixels.assign(pixels, pixels + pixelCount);
    return halved(out);
}

}  // namespace apertura
