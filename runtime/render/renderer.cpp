#include "runtime/render/renderer.h"

#include <map>
#include <optional>
#include <tuple>

#include "runtime/render/draw.h"
#include "runtime/render/shadow_map.h"
#include "scene.frag.h"
#include "scene.vert.h"

namespace apertura {
namespace {

constexpr VkFormat kPictureFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

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
            out.push_back({instance.toWorld * glm::vec4(surface.positions[v], 1), vec4(length > 0 ? n / length : glm::vec3(0, 1, 0), 0),
                           vec4(seen.direction, seen.area)});
        }
        for (const auto& t : surface.triangles)
            for (uint32_t index : t) indices.push_back(first + index);
    }
    return out;
}

GpuBuffer uploadParams(const Gpu& gpu, const Asset& asset, const Model& model) {
    const bool stored = storedModel(asset.info) == &model;
    if (!stored && !model.fromVisibility)
        throw Error(asset.scene.name + ": was baked with --model " + asset.info.model + " and does not hold " + std::string(model.name)
                    + "; bake it with --model " + std::string(model.name));
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
    if (slots.empty()) slots.emplace_back(0);  // Vulkan allows no empty buffer
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

void requireOneDirectional(const View& view) {
    if (view.lights.size() != 1 || isSphere(view.lights[0])) throw Error("a shadow map is drawn of one light from a direction");
}

}  // namespace

struct Renderer::Parts {
    struct AllParams {
        GpuBuffer buffer;
        GpuBindings bindings;
    };

    Parts(const Gpu& gpu_, const Asset& asset_, int frames_, const std::vector<SceneVertex>& corners, const std::vector<uint32_t>& order)
        : gpu(gpu_),
          asset(asset_),
          box(worldBounds(asset_.scene)),
          frames(frames_),
          indexCount(uint32_t(order.size())),
          vertices(uploadGeometry(gpu_, asset_, corners)),
          indices(uploadGeometry(gpu_, asset_, order)),
          lit(gpu_, frames_ + 1) {}

    const AllParams& paramsOf(const Model& model);
    void light(int frame, const View& view, VkExtent2D size) const;
    Picture picture(const View& view, const std::function<void(VkCommandBuffer, const RenderTarget&)>& record) const;

    const Gpu& gpu;
    const Asset& asset;
    Box box;
    int frames;  // of the caller; `draw` uses one more, number `frames`
    uint32_t indexCount;
    GpuBuffer vertices, indices;
    PerFrame<Frame> lit;
    std::optional<ShadowMap> shadow;
    std::map<int, AllParams> allParams;                                      // by model
    std::map<std::tuple<int, int, VkFormat>, vk::raii::Pipeline> pipelines;  // by model, light class and format
};

int lightClassOf(const View& view) {
    int out = LIGHTS_SUN;
    for (const Light& light : view.lights) out = std::min(out, isSphere(light) ? LIGHTS_ANY : lightClassOf(light.cap.sinRadius));
    return out;
}

Renderer::Renderer(const Gpu& gpu, const Asset& asset, int frames) {
    std::vector<uint32_t> indices;
    const std::vector<SceneVertex> vertices = toVertices(asset, indices);
    parts_ = std::make_unique<Parts>(gpu, asset, frames, vertices, indices);
}

Renderer::~Renderer() = default;

const Renderer::Parts::AllParams& Renderer::Parts::paramsOf(const Model& model) {
    if (const auto found = allParams.find(model.id); found != allParams.end()) return found->second;
    GpuBuffer buffer = uploadParams(gpu, asset, model);
    constexpr vk::ShaderStageFlags vertex = vk::ShaderStageFlagBits::eVertex, fragment = vk::ShaderStageFlagBits::eFragment;
    const GpuBindings::Binding slots[] = {lit.binding(vertex | fragment),
                                          {vk::DescriptorType::eStorageBuffer, vertex | fragment, &vertices},
                                          {vk::DescriptorType::eStorageBuffer, vertex, &indices},
                                          {vk::DescriptorType::eStorageBuffer, fragment, &buffer}};
    GpuBindings bindings(gpu, slots);
    return allParams.insert({model.id, AllParams{std::move(buffer), std::move(bindings)}}).first->second;
}

void Renderer::Parts::light(int frame, const View& view, VkExtent2D size) const {
    if (frame < 0 || frame > frames) throw Error("there is no frame " + std::to_string(frame) + " in flight");
    if (view.lights.size() > size_t(MAX_LIGHTS)) throw Error("a view has at most " + std::to_string(MAX_LIGHTS) + " lights");
    const float nearest = std::max(1e-4f * glm::length(box.high - box.low), 1e-9f);
    Frame out{};
    out.toClip = clipTransform(view.camera, double(size.width) / size.height, nearest);
    out.sky = vec4(view.sky, 0);
    out.albedo = vec4(view.albedo, 0);
    out.counts.x = int(view.lights.size());
    std::copy(view.lights.begin(), view.lights.end(), out.lights);
    lit.set(frame, out);
}

void Renderer::prepare(const Model& model, int lightClass, VkFormat format) {
    const GpuBindings& bindings = parts_->paramsOf(model).bindings;
    const std::tuple key(model.id, lightClass, format);
    if (parts_->pipelines.contains(key)) return;
    const int32_t constants[] = {model.id, lightClass, model.slots, model.mixes};
    parts_->pipelines.emplace(key, makePipeline(parts_->gpu, {scene_vert, scene_frag, constants}, bindings, vk::Format(format)));
}

void Renderer::record(VkCommandBuffer commands, const RenderTarget& target, const View& view, const Model& model, int frame) const {
    const auto pipeline = parts_->pipelines.find({model.id, lightClassOf(view), target.format});
    if (pipeline == parts_->pipelines.end())
        throw Error("the renderer is not prepared for " + std::string(model.name) + " with these lights and this format");
    parts_->light(frame, view, target.size);
    const uint32_t offset = PerFrame<Frame>::offset(frame);
    drawTriangles(commands, target, view.sky, {*pipeline->second, parts_->allParams.at(model.id).bindings, {&offset, 1}},
                  parts_->indexCount);
}

Picture Renderer::draw(const View& view, const Model& model) {
    prepare(model, lightClassOf(view), kPictureFormat);
    return parts_->picture(
        view, [&](VkCommandBuffer commands, const RenderTarget& target) { record(commands, target, view, model, parts_->frames); });
}

void Renderer::prepareShadowMapped(VkFormat format) {
    Parts& p = *parts_;
    ShadowMap& shadow = p.shadow ? *p.shadow : p.shadow.emplace(p.gpu, p.lit, p.vertices, p.indices, p.box, p.frames + 1);
    shadow.prepare(p.gpu, format);
}

void Renderer::recordShadowMapped(VkCommandBuffer commands, const RenderTarget& target, const View& view, int frame) const {
    requireOneDirectional(view);
    const std::optional<ShadowMap>& shadow = parts_->shadow;
    if (!shadow) throw Error("the shadow map is not prepared");
    parts_->light(frame, view, target.size);
    shadow->record(commands, target, view, frame, parts_->indexCount);
}

Picture Renderer::drawShadowMapped(const View& view) {
    requireOneDirectional(view);
    prepareShadowMapped(kPictureFormat);
    return parts_->picture(
        view, [&](VkCommandBuffer commands, const RenderTarget& target) { recordShadowMapped(commands, target, view, parts_->frames); });
}

Picture Renderer::Parts::picture(const View& view, const std::function<void(VkCommandBuffer, const RenderTarget&)>& record) const {
    const vk::Extent2D size{uint32_t(view.width) * 2, uint32_t(view.height) * 2};
    if (std::max(size.width, size.height) > gpu.largestImage())
        throw Error("Vulkan: " + gpu.name() + " draws pictures of at most " + std::to_string(gpu.largestImage() / 2) + " pixels a side");
    const Offscreen images(gpu, size, vk::Format(kPictureFormat));
    gpu.run([&](VkCommandBuffer commands) {
        images.begin(commands);
        record(commands, images.target());
        images.end(commands);
    });
    Picture out{int(size.width), int(size.height), {}};
    const auto* pixels = static_cast<const vec4*>(images.pixels());
    out.pixels.assign(pixels, pixels + size_t(size.width) * size.height);
    return halved(out);
}

}  // namespace apertura
