#include "runtime/render/renderer.h"

#include <map>
#include <optional>
#include <tuple>

#include "light.comp.h"
#include "runtime/asset/faces.h"
#include "runtime/render/draw.h"
#include "runtime/render/scene_shaders.h"
#include "runtime/render/shadow_map.h"

namespace apertura {
namespace {

const std::string kTooManyLights = "a view has at most " + std::to_string(MAX_LIGHTS) + " lights";
constexpr VkFormat kPictureFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

glm::vec3 unitNormal(const glm::mat3& normals, const glm::vec3& normal) {
    const glm::vec3 n = normals * normal;
    const float length = glm::length(n);
    return length > 0 ? n / length : glm::vec3(0, 1, 0);
}

// Calls use(visibility, params, normal) for each sample in the order of the shaders: all vertices, then all samples on faces. `params` is
// null where the asset stores none, and normal() makes the normal about which the sample looks.
void forSamples(const Asset& asset, const auto& use) {
    for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
        const Instance& instance = asset.scene.instances[i];
        const Surface& surface = asset.scene.surfaces[size_t(instance.surface)];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        const SeenByInstance& seen = asset.seen[i];
        for (size_t v = 0; v < surface.positions.size(); ++v)
            use(seen.visibility[v], seen.allParams.empty() ? nullptr : &seen.allParams[v],
                [&] { return unitNormal(normals, surface.normals[v]); });
    }
    for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
        const SeenOnFaces& faces = asset.seen[i].faces;
        for (size_t t = 0; t < faces.levels.size(); ++t) {
            const int steps = latticeSteps(std::max(faces.level(t), 1));
            for (int k = 0; faces.level(t) > 0 && k < latticeSize(steps); ++k) {
                const size_t at = faces.first[t] + size_t(k);
                use(faces.visibility[at], faces.allParams.empty() ? nullptr : &faces.allParams[at],
                    [&] { return lookingNormal(asset.scene, int(i), int(t), latticePoint(k, steps)); });
            }
        }
    }
}

// What is drawn, as the shaders read it.
struct Geometry {
    std::vector<SceneVertex> vertices;
    std::vector<uint32_t> indices;
    std::vector<vec4> seen;
    uint32_t corners = 0;  // of all triangles; behind them in the indices stand the faces, if there are samples on any
    bool onFaces = false;

    explicit Geometry(const Asset& asset) {
        for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
            const Instance& instance = asset.scene.instances[i];
            const Surface& surface = asset.scene.surfaces[size_t(instance.surface)];
            const glm::mat3 normals = normalMatrix(instance.toWorld);
            const auto first = uint32_t(vertices.size());
            for (size_t v = 0; v < surface.positions.size(); ++v)
                vertices.push_back(
                    {instance.toWorld * glm::vec4(surface.positions[v], 1), vec4(unitNormal(normals, surface.normals[v]), 0)});
            for (const auto& t : surface.triangles)
                for (const uint32_t index : t) indices.push_back(first + index);
            onFaces |= !asset.seen[i].faces.visibility.empty();
        }
        corners = uint32_t(indices.size());
        forSamples(asset, [&](const Visibility& v, const ModelParams*, const auto&) { seen.emplace_back(v.direction, v.area); });
        if (!onFaces) return;
        if (seen.size() >= size_t(1) << 28) throw Error(asset.scene.name + ": has too many samples on faces to be drawn");
        auto first = uint32_t(vertices.size());
        for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
            const SeenOnFaces& faces = asset.seen[i].faces;
            const size_t triangles = asset.scene.surfaces[size_t(asset.scene.instances[i].surface)].triangles.size();
            for (size_t t = 0; t < triangles; ++t)
                indices.push_back(faces.level(t) ? (first + faces.first[t]) << 4 | uint32_t(faces.level(t)) : 0);
            first += uint32_t(faces.visibility.size());
        }
    }
};

GpuBuffer uploadParams(const Gpu& gpu, const Asset& asset, const Model& model) {
    const bool stored = storedModel(asset.info) == &model;
    if (!stored && !model.fromVisibility)
        throw Error(asset.scene.name + ": was baked with --model " + asset.info.model + " and does not hold " + std::string(model.name)
                    + "; bake it with --model " + std::string(model.name));
    std::vector<vec4> slots;
    if (model.slots > 0)
        forSamples(asset, [&](const Visibility& visibility, const ModelParams* own, const auto& normal) {
            const ModelParams params = toParams(model, visibility, stored ? own : nullptr, normal());
            slots.insert(slots.end(), params.begin(), params.begin() + model.slots);
        });
    if (slots.empty()) slots.emplace_back(0);  // Vulkan allows no empty buffer
    if (slots.size() * sizeof(vec4) > gpu.largestBuffer())
        throw Error(asset.scene.name + ": the parameters of " + std::string(model.name) + " are too large for " + gpu.name());
    return upload(gpu, std::as_bytes(std::span(slots)), vk::BufferUsageFlagBits::eStorageBuffer);
}

template <class T>
GpuBuffer uploadGeometry(const Gpu& gpu, const Asset& asset, const std::vector<T>& values, vk::BufferUsageFlags usage = {}) {
    if (values.size() * sizeof(T) > gpu.largestBuffer())
        throw Error(asset.scene.name + ": has too many vertices or triangles for " + gpu.name());
    return upload(gpu, std::as_bytes(std::span(values)), vk::BufferUsageFlagBits::eStorageBuffer | usage);
}

void requireOneDirectional(const View& view) {
    if (view.lights.size() != 1 || isSphere(view.lights[0])) throw Error("a shadow map is drawn of one light from a direction");
}

// Of lit vertices with room for so many lights: the vec4s after the first light, and all floats, the sky's among them.
int moreThanOne(int lights) { return (std::max(lights, 1) + 2) / 4; }
int litFloats(int lights) { return 2 + 4 * moreThanOne(lights); }

// Which pipeline of a model draws so many lights: with lights at pixels one of any number, or one made for a single light, and with lights
// at vertices one by the vec4s that are interpolated.
int variantOf(LightAt at, int lights) { return at == LightAt::Vertices ? 1 + moreThanOne(lights) : lights == 1 ? -1 : 0; }

}  // namespace

struct Renderer::Parts {
    // What the shaders read of one model.
    struct ModelBuffers {
        int litFloats;  // of a vertex; 0 where light is evaluated at pixels
        std::optional<GpuBuffer> litVertices;
        GpuBindings bindings;
    };

    Parts(const Gpu& gpu_, const Asset& asset_, int frames_, const Geometry& geometry)
        : gpu(gpu_),
          asset(asset_),
          box(worldBounds(asset_.scene)),
          frames(frames_),
          indexCount(geometry.corners),
          vertexCount(uint32_t(geometry.vertices.size())),
          onFaces(geometry.onFaces),
          vertices(uploadGeometry(gpu_, asset_, geometry.vertices)),
          indices(uploadGeometry(gpu_, asset_, geometry.indices, vk::BufferUsageFlagBits::eIndexBuffer)),
          seen(uploadGeometry(gpu_, asset_, geometry.seen)),
          noVertices(gpu_, 0, vk::BufferUsageFlagBits::eStorageBuffer, GpuBuffer::Place::Device),
          lit(gpu_, frames_ + 1) {}

    const GpuBuffer& paramsOf(const Model& model);
    const ModelBuffers& buffersOf(const Model& model, int litFloats);
    VkDeviceSize litFloatsAFrame(int litFloats) const { return VkDeviceSize(vertexCount) * VkDeviceSize(litFloats); }
    void light(int frame, const View& view, VkExtent2D size, int litFloats = 0) const;
    Picture picture(const View& view, const std::function<void(VkCommandBuffer, const RenderTarget&)>& record) const;

    const Gpu& gpu;
    const Asset& asset;
    Box box;
    int frames;  // of the caller; `draw` uses one more, number `frames`
    uint32_t indexCount, vertexCount;
    bool onFaces;
    GpuBuffer vertices, indices, seen, noVertices;
    PerFrame<Frame> lit;
    std::optional<ShadowMap> shadow;
    std::map<int, GpuBuffer> allParams;                                           // by model
    std::map<std::pair<int, int>, ModelBuffers> buffers;                          // by model and litFloats
    std::map<std::tuple<int, int, VkFormat, int>, vk::raii::Pipeline> pipelines;  // by model, light class, format and variantOf
    std::map<std::pair<int, int>, vk::raii::Pipeline> vertexLights;               // by model and light class
};

int lightClassOf(const View& view) {
    int out = LIGHTS_SUN;
    for (const Light& light : view.lights) out = std::min(out, isSphere(light) ? LIGHTS_ANY : lightClassOf(light.cap.sinRadius));
    return out;
}

Renderer::Renderer(const Gpu& gpu, const Asset& asset, int frames) {
    parts_ = std::make_unique<Parts>(gpu, asset, frames, Geometry(asset));
}

Renderer::~Renderer() = default;

const GpuBuffer& Renderer::Parts::paramsOf(const Model& model) {
    if (const auto found = allParams.find(model.id); found != allParams.end()) return found->second;
    return allParams.emplace(model.id, uploadParams(gpu, asset, model)).first->second;
}

const Renderer::Parts::ModelBuffers& Renderer::Parts::buffersOf(const Model& model, int litFloats) {
    if (const auto found = buffers.find({model.id, litFloats}); found != buffers.end()) return found->second;
    const GpuBuffer& params = paramsOf(model);
    std::optional<GpuBuffer> litVertices;
    if (litFloats > 0) {
        const VkDeviceSize bytes = sizeof(float) * VkDeviceSize(frames + 1) * litFloatsAFrame(litFloats);
        if (bytes > gpu.largestBuffer()) throw Error(asset.scene.name + ": the lights at its vertices are too large for " + gpu.name());
        litVertices.emplace(gpu, bytes, vk::BufferUsageFlagBits::eStorageBuffer, GpuBuffer::Place::Device);
    }
    constexpr auto storage = vk::DescriptorType::eStorageBuffer;
    constexpr vk::ShaderStageFlags vertex = vk::ShaderStageFlagBits::eVertex,
                                   shading = vk::ShaderStageFlagBits::eFragment | vk::ShaderStageFlagBits::eCompute;
    const GpuBindings::Binding slots[] = {lit.binding(vertex | shading),
                                          {storage, vertex | shading, &vertices},
                                          {storage, vertex, &indices},
                                          {storage, shading, &params},
                                          {storage, vertex | shading, litVertices ? &*litVertices : &noVertices},
                                          {storage, vertex | shading, &seen}};
    GpuBindings bindings(gpu, slots);
    return buffers.emplace(std::pair(model.id, litFloats), ModelBuffers{litFloats, std::move(litVertices), std::move(bindings)})
        .first->second;
}

void Renderer::Parts::light(int frame, const View& view, VkExtent2D size, int litFloats) const {
    if (frame < 0 || frame > frames) throw Error("there is no frame " + std::to_string(frame) + " in flight");
    if (view.lights.size() > size_t(MAX_LIGHTS)) throw Error(kTooManyLights);
    const float nearest = std::max(1e-4f * glm::length(box.high - box.low), 1e-9f);
    Frame out{};
    out.toClip = clipTransform(view.camera, double(size.width) / size.height, nearest);
    out.sky = vec4(view.sky, 0);
    out.albedo = vec4(view.albedo, 0);
    out.counts.x = int(view.lights.size());
    out.counts.y = int(VkDeviceSize(frame) * litFloatsAFrame(litFloats));
    out.counts.z = litFloats;
    out.counts.w = onFaces ? int(indexCount) : 0;
    std::copy(view.lights.begin(), view.lights.end(), out.lights);
    lit.set(frame, out);
}

LightAt Renderer::betterLightAt(const Model& model, double pixels) const {
    return !model.mixes && !parts_->onFaces && double(parts_->vertexCount) < 3 * pixels ? LightAt::Vertices : LightAt::Pixels;
}

void Renderer::prepare(const Model& model, int lightClass, VkFormat format, LightAt at, int mostLights) {
    if (mostLights < 0 || mostLights > MAX_LIGHTS) throw Error(kTooManyLights);
    Parts& p = *parts_;
    const bool atVertices = at == LightAt::Vertices;
    const GpuBindings& bindings = p.buffersOf(model, atVertices ? litFloats(mostLights) : 0).bindings;
    const int variant = variantOf(at, mostLights);
    const int32_t atPixels[] = {model.id, lightClass, model.slots, p.onFaces},
                  interpolated[] = {model.id, moreThanOne(mostLights), lightClass};
    if (const std::tuple key(model.id, lightClass, format, variant); !p.pipelines.contains(key))
        p.pipelines.emplace(
            key, makePipeline(p.gpu,
                              atVertices ? DrawShaders{lit_vert, lit_frag, interpolated}
                                         : DrawShaders{scene_vert,
                                                       sceneFragment(model.mixes ? Corners::Mixed : Corners::Three, variant < 0), atPixels},
                              bindings, vk::Format(format)));
    if (const std::pair key(model.id, lightClass); atVertices && !p.vertexLights.contains(key))
        p.vertexLights.emplace(key, makeComputePipeline(p.gpu, light_comp, atPixels, bindings));
}

void Renderer::record(VkCommandBuffer to, const RenderTarget& target, const View& view, const Model& model, int frame, LightAt at) const {
    const vk::CommandBuffer commands(to);
    const Parts& p = *parts_;
    // The least of the variants that are prepared and take as many lights.
    if (view.lights.size() > size_t(MAX_LIGHTS)) throw Error(kTooManyLights);
    const auto lights = int(view.lights.size());
    const auto prepared = [&](int room) { return p.pipelines.find({model.id, lightClassOf(view), target.format, variantOf(at, room)}); };
    int room = lights;
    auto pipeline = prepared(room);
    while (pipeline == p.pipelines.end() && room < MAX_LIGHTS)
        if (variantOf(at, ++room) >= 0) pipeline = prepared(room);  // the pipeline of one light draws no frame of none
    if (pipeline == p.pipelines.end())
        throw Error("the renderer is not prepared for " + std::string(model.name) + " with these lights and this format");
    const auto& [floats, litVertices, bindings] = p.buffers.at({model.id, at == LightAt::Vertices ? litFloats(room) : 0});
    p.light(frame, view, target.size, floats);
    const uint32_t offset = PerFrame<Frame>::offset(frame);
    if (at == LightAt::Vertices) {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *p.vertexLights.at({model.id, lightClassOf(view)}));
        bindings.bind(commands, vk::PipelineBindPoint::eCompute, {&offset, 1});
        commands.dispatch(std::min((p.vertexCount + 63) / 64, 65535u), 1, 1);  // the most that every device takes
        const vk::MemoryBarrier2 written{.srcStageMask = vk::PipelineStageFlagBits2::eComputeShader,
                                         .srcAccessMask = vk::AccessFlagBits2::eShaderStorageWrite,
                                         .dstStageMask = vk::PipelineStageFlagBits2::eVertexShader,
                                         .dstAccessMask = vk::AccessFlagBits2::eShaderStorageRead};
        commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &written});
    }
    drawTriangles(commands, target, view.sky, {*pipeline->second, bindings, {&offset, 1}, at == LightAt::Vertices ? &p.indices : nullptr},
                  p.indexCount);
}

Picture Renderer::draw(const View& view, const Model& model, LightAt at) {
    prepare(model, lightClassOf(view), kPictureFormat, at, int(view.lights.size()));
    return parts_->picture(
        view, [&](VkCommandBuffer commands, const RenderTarget& target) { record(commands, target, view, model, parts_->frames, at); });
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
