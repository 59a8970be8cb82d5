#include "apertura/runtime/render/renderer.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <tuple>

#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/render/background.h"
#include "apertura/runtime/render/batches.h"
#include "apertura/runtime/render/draw.h"
#include "apertura/runtime/render/geometry.h"
#include "apertura/runtime/render/scene_shaders.h"
#include "apertura/runtime/render/shadow_map.h"
#include "apertura/sh/soft.h"
#include "light.comp.h"

namespace apertura {
namespace {

const std::string kTooManyLights = "a view has at most " + std::to_string(APERTURA_MAX_LIGHTS) + " lights";
constexpr VkFormat kPictureFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

template <class T>
GpuBuffer uploadStorage(const Gpu& gpu, const std::vector<T>& values, vk::BufferUsageFlags usage = {}) {
    if (sizeof(T) * values.size() > gpu.largestBuffer())
        throw Error("Vulkan: " + gpu.name() + " binds no more than " + std::to_string(gpu.largestBuffer())
                    + " bytes at once, and an image of visibility needs " + std::to_string(sizeof(T) * values.size()));
    return upload(gpu, std::as_bytes(std::span(values)), vk::BufferUsageFlagBits::eStorageBuffer | usage);
}

GpuBuffer uploadParams(const Gpu& gpu, const Asset& asset, const GeometryPart& part, const Model& model) {
    const bool stored = storedModel(asset.info) == &model;
    if (!stored && !model.fromVisibility)
        throw Error(asset.scene.name + ": was baked with --model " + asset.info.model + " and does not hold " + std::string(model.name)
                    + "; bake it with --model " + std::string(model.name));
    std::vector<vec4> slots;
    if (model.slots > 0) {
        slots.reserve((part.vertices + part.moreSamples) * size_t(model.slots));
        forSamples(asset, part, [&](const Visibility& visibility, const ModelParams* own, const auto& normal) {
            // Of texels, `soft` is made in the shader.
            if (model.id == APERTURA_MODEL_SOFT && slots.size() >= part.vertices && hasTexels(asset) && !hasSamplesOnFaces(asset)) return;
            const ModelParams params = toParams(model, visibility, stored ? own : nullptr, normal());
            slots.insert(slots.end(), params.begin(), params.begin() + model.slots);
        });
    }
    if (slots.empty()) slots.emplace_back(0);  // Vulkan allows no empty buffer
    return uploadStorage(gpu, slots);
}

GpuBuffer uploadSeen(const Gpu& gpu, const Asset& asset, const GeometryPart& part) {
    std::vector<vec4> seen;
    seen.reserve(part.vertices + part.moreSamples);
    forSamples(asset, part, [&](const Visibility& v, const ModelParams*, const auto&) { seen.emplace_back(v.direction, v.area); });
    return uploadStorage(gpu, seen);
}

void requireOneDirectional(const View& view) {
    if (view.lights.size() != 1 || aperturaIsSphere(view.lights[0])) throw Error("a shadow map is drawn of one light from a direction");
}

// Of lit vertices with room for so many lights: the vec4s after the first light, and all floats, the sky's among them.
int moreThanOne(int lights) { return (std::max(lights, 1) + 2) / 4; }
int litFloats(int lights) { return 2 + 4 * moreThanOne(lights); }

// Which pipeline of a model draws so many lights: with lights at pixels one of any number, or one made for a single light, and with lights
// at vertices one by the vec4s that are interpolated.
int variantOf(LightAt at, int lights) { return at == LightAt::Vertices ? 1 + moreThanOne(lights) : lights == 1 ? -1 : 0; }

// No buffer of a part is then larger than the device binds, whatever the model and the number of lights.
PartLimits partLimits(const Gpu& gpu, int frames) {
    const auto bytes = size_t(gpu.largestBuffer());
    constexpr size_t kNumbered = size_t(1) << 28;  // samples: see GeometryPart and scene.vert
    return {.vertices = std::min(bytes / sizeof(AperturaSceneVertex),
                                 bytes / (size_t(frames) * size_t(litFloats(APERTURA_MAX_LIGHTS)) * sizeof(float))),
            .samples = std::min(bytes / (APERTURA_MAX_SLOTS * sizeof(vec4)), kNumbered),
            .triangles = bytes / (5 * sizeof(uint32_t))};
}

}  // namespace

struct Renderer::State {
    // What the shaders read of one model in one part of the geometry.
    struct ModelBuffers {
        std::optional<GpuBuffer> litVertices;  // where light is evaluated at vertices
        GpuBindings bindings;
    };

    struct Part {
        GeometryPart geometry;
        std::vector<Batch> batches;
        GpuBuffer vertices, indices, seen, paint, bounces;
        std::map<int, GpuBuffer> allParams;                   // by model
        std::map<std::pair<int, int>, ModelBuffers> buffers;  // by model and floats of a lit vertex, 0: lit at pixels

        Part(const Gpu& gpu, const Asset& asset, GeometryPart all, bool onFaces, bool onTexels)
            : geometry(std::move(all)),
              batches(batchesOf(asset, geometry)),
              vertices(uploadStorage(gpu, verticesOf(asset, geometry))),
              indices(uploadStorage(gpu, indicesOf(asset, geometry, onFaces, onTexels), vk::BufferUsageFlagBits::eIndexBuffer)),
              seen(uploadSeen(gpu, asset, geometry)),
              paint(uploadStorage(gpu, paintOf(asset, geometry))),
              bounces(uploadStorage(gpu, apertura::bouncesOf(asset, geometry))) {}
        uint32_t indexCount() const { return uint32_t(3 * geometry.triangles); }
        size_t litFloatsAFrame(int floats) const { return geometry.vertices * size_t(floats); }
    };

    State(const Gpu& gpu_, const Asset& asset_, int frames_)
        : gpu(gpu_),
          asset(asset_),
          box(worldBounds(asset_.scene)),
          frames(frames_),
          onFaces(hasSamplesOnFaces(asset_)),
          onTexels(hasTexels(asset_)),
          painted(!asset_.scene.materials.empty()),
          materials(gpu_, asset_.scene),
          // Nothing else reads it.
          softNodes(upload(gpu_, std::as_bytes(onTexels ? apertura::softNodes() : apertura::softNodes().first(1)),
                           vk::BufferUsageFlagBits::eStorageBuffer)),
          noVertices(gpu_, 0, vk::BufferUsageFlagBits::eStorageBuffer, GpuBuffer::Place::Device) {
        for (GeometryPart& part : splitGeometry(asset_, partLimits(gpu_, frames_ + 1))) {
            vertexCount += part.vertices;
            parts.emplace_back(gpu_, asset_, std::move(part), onFaces, onTexels);
        }
        for (const auto kind : {Material::Alpha::Opaque, Material::Alpha::Mask, Material::Alpha::Blend})
            for (const Part& part : parts)
                if ((kinds.empty() || kinds.back() != kind)
                    && std::any_of(part.batches.begin(), part.batches.end(), [&](const Batch& b) { return b.alpha == kind; }))
                    kinds.push_back(kind);
        lit.emplace(gpu_, (frames_ + 1) * int(parts.size()));
        background.emplace(gpu_, *lit);
    }

    // Held by those who read the maps below and those of parts while they do, and alone by those who add to them while they do. One thread
    // at a time adds.
    mutable std::shared_mutex lock;

    const GpuBuffer& paramsOf(Part& part, const Model& model);
    const ModelBuffers& buffersOf(Part& part, const Model& model, int floats);
    // What lights a part in a frame: its place in `lit`.
    int litSlot(int frame, size_t part) const { return frame * int(parts.size()) + int(part); }
    void light(int frame, const View& view, VkExtent2D size, int floats = 0) const;
    // `pipelineOf`: for each of `kinds`.
    void drawScene(vk::CommandBuffer commands, const RenderTarget& target, const View& view, int frame, std::span<const BoundPart> bound,
                   const std::function<vk::Pipeline(size_t)>& pipelineOf) const;
    Picture picture(const View& view, const std::function<void(VkCommandBuffer, const RenderTarget&)>& record) const;

    const Gpu& gpu;
    const Asset& asset;
    Box box;
    int frames;  // of the caller; `draw` uses one more, number `frames`
    bool onFaces, onTexels, painted;
    Materials materials;
    std::vector<Material::Alpha> kinds;  // of its materials, the opaque ones first
    size_t vertexCount = 0;
    std::vector<Part> parts;
    GpuBuffer softNodes;
    GpuBuffer noVertices;
    std::optional<PerFrame<AperturaFrame>> lit;  // one for each frame and part
    std::optional<Background> background;
    std::unique_ptr<ShadowMap> shadow;
    // By model, light class, format, variantOf and bouncesOf, one for each of `kinds`.
    std::map<std::tuple<int, int, VkFormat, int, int>, std::vector<vk::raii::Pipeline>> pipelines;
    std::map<std::pair<int, int>, vk::raii::Pipeline> vertexLights;  // by model and light class
};

int lightClassOf(const View& view) {
    int out = APERTURA_LIGHTS_SUN;
    for (const AperturaLight& light : view.lights)
        out = std::min(out, aperturaIsSphere(light) ? APERTURA_LIGHTS_ANY : lightClassOf(light.cap.sinRadius));
    return out;
}

int Renderer::bouncesOf(const View& view) const { return bounceSourceOf(view, state_->asset); }

Renderer::Renderer(const Gpu& gpu, const Asset& asset, int frames) : state_(std::make_unique<State>(gpu, asset, frames)) {}

Renderer::~Renderer() = default;

const GpuBuffer& Renderer::State::paramsOf(Part& part, const Model& model) {
    if (const auto found = part.allParams.find(model.id); found != part.allParams.end()) return found->second;
    GpuBuffer made = uploadParams(gpu, asset, part.geometry, model);
    const std::unique_lock hold(lock);
    return part.allParams.emplace(model.id, std::move(made)).first->second;
}

const Renderer::State::ModelBuffers& Renderer::State::buffersOf(Part& part, const Model& model, int floats) {
    if (const auto found = part.buffers.find({model.id, floats}); found != part.buffers.end()) return found->second;
    const GpuBuffer& params = paramsOf(part, model);
    std::optional<GpuBuffer> litVertices;
    if (floats > 0)
        litVertices.emplace(gpu, sizeof(float) * size_t(frames + 1) * part.litFloatsAFrame(floats), vk::BufferUsageFlagBits::eStorageBuffer,
                            GpuBuffer::Place::Device);
    constexpr auto storage = vk::DescriptorType::eStorageBuffer;
    constexpr vk::ShaderStageFlags vertex = vk::ShaderStageFlagBits::eVertex,
                                   shading = vk::ShaderStageFlagBits::eFragment | vk::ShaderStageFlagBits::eCompute;
    const GpuBindings::Binding slots[] = {lit->binding(vertex | shading),
                                          {storage, vertex | shading, &part.vertices},
                                          {storage, vertex, &part.indices},
                                          {storage, vertex | shading, &params},
                                          {storage, vertex | shading, litVertices ? &*litVertices : &noVertices},
                                          {storage, vertex | shading, &part.seen},
                                          {storage, shading, &softNodes},
                                          {storage, vertex, &part.paint},
                                          {storage, vertex | shading, &part.bounces}};
    GpuBindings bindings(gpu, slots, materials.layout());
    const std::unique_lock hold(lock);
    return part.buffers.emplace(std::pair(model.id, floats), ModelBuffers{std::move(litVertices), std::move(bindings)}).first->second;
}

void Renderer::State::light(int frame, const View& view, VkExtent2D size, int floats) const {
    if (frame < 0 || frame > frames) throw Error("there is no frame " + std::to_string(frame) + " in flight");
    if (view.lights.size() > size_t(APERTURA_MAX_LIGHTS)) throw Error(kTooManyLights);
    if (view.sky.picture() && !background->shows(view.sky)) throw Error("the renderer is not prepared for this picture of the sky");
    const float nearest = std::max(1e-4f * glm::length(box.high - box.low), 1e-9f);
    AperturaFrame out{};
    const double aspect = double(size.width) / size.height;
    const std::vector<AperturaLight> lights = arrangedLights(view);
    out.toClip = clipTransform(view.camera, aspect, nearest);
    out.sky = view.sky.bands();
    out.eye = vec4(view.camera.eye, 0);
    out.background = view.background ? vec4(*view.background, 0) : vec4(vec3(out.sky.bands[0]), view.sky.picture() ? 1 : 0);
    const std::array<vec4, 3> rays = raysOf(view.camera, aspect);
    std::copy(rays.begin(), rays.end(), out.rays);
    out.albedo = vec4(view.albedo, view.plain ? 1 : 0);
    out.around = vec4(max(1.0f - (view.plain ? view.albedo : view.aroundAlbedo), vec3(APERTURA_LEAST_ABSORBED)), 0);
    out.counts.x = int(lights.size());
    out.counts.z = floats;
    std::copy(lights.begin(), lights.end(), out.lights);
    for (const AperturaLight& light : lights) out.brightest = max(out.brightest, light.radiance);
    for (size_t part = 0; part < parts.size(); ++part) {
        out.counts.y = int(size_t(frame) * parts[part].litFloatsAFrame(floats));
        out.counts.w = onFaces || onTexels ? int(parts[part].indexCount()) : 0;
        lit->set(litSlot(frame, part), out);
    }
}

LightAt Renderer::betterLightAt(const Model& model, double pixels) const {
    return !model.mixes && !state_->onFaces && !state_->onTexels && double(state_->vertexCount) < 3 * pixels ? LightAt::Vertices
                                                                                                             : LightAt::Pixels;
}

void Renderer::prepare(const Model& model, int lightClass, VkFormat format, LightAt at, int mostLights, int bounces) {
    if (mostLights < 0 || mostLights > APERTURA_MAX_LIGHTS) throw Error(kTooManyLights);
    State& p = *state_;
    p.background->prepare(p.gpu, vk::Format(format));
    const bool atVertices = at == LightAt::Vertices;
    for (State::Part& part : p.parts) p.buffersOf(part, model, atVertices ? litFloats(mostLights) : 0);
    const GpuBindings& bindings = p.parts[0].buffers.at({model.id, atVertices ? litFloats(mostLights) : 0}).bindings;
    const int variant = variantOf(at, mostLights);
    const Corners corners = cornersFor(model, p.onFaces || p.onTexels);
    const int added = model.id == APERTURA_MODEL_UNSHADOWED ? APERTURA_BOUNCES_NONE : bounces;  // it has all of the sky already
    const auto pipeline = [&](Material::Alpha kind) {
        const int32_t atPixels[] = {model.id, lightClass, model.slots, p.onFaces, p.onTexels, p.painted, int(kind), variant < 0, added},
                      interpolated[] = {model.id, moreThanOne(mostLights), lightClass, p.painted, int(kind), added};
        DrawShaders shaders = atVertices ? DrawShaders{lit_vert, lit_frag, interpolated}
                                         : DrawShaders{sceneVertex(corners), sceneFragment(corners, variant < 0), atPixels};
        shaders.blends = kind == Material::Alpha::Blend;
        return makePipeline(p.gpu, shaders, bindings, vk::Format(format));
    };
    if (const std::tuple key(model.id, lightClass, format, variant, bounces); !p.pipelines.contains(key)) {
        std::vector<vk::raii::Pipeline> made;
        for (const Material::Alpha kind : p.kinds) made.push_back(pipeline(kind));
        const std::unique_lock hold(p.lock);
        p.pipelines.emplace(key, std::move(made));
    }
    if (const std::pair key(model.id, lightClass); atVertices && !p.vertexLights.contains(key)) {
        const int32_t constants[] = {model.id, lightClass, model.slots};
        vk::raii::Pipeline made = makeComputePipeline(p.gpu, light_comp, constants, bindings);
        const std::unique_lock hold(p.lock);
        p.vertexLights.emplace(key, std::move(made));
    }
}

void Renderer::record(VkCommandBuffer to, const RenderTarget& target, const View& view, const Model& model, int frame, LightAt at) const {
    const vk::CommandBuffer commands(to);
    const State& p = *state_;
    const std::shared_lock hold(p.lock);
    // The least of the variants that are prepared and take as many lights.
    if (view.lights.size() > size_t(APERTURA_MAX_LIGHTS)) throw Error(kTooManyLights);
    const auto lights = int(view.lights.size());
    const auto prepared = [&](int room) {
        return p.pipelines.find({model.id, lightClassOf(view), target.format, variantOf(at, room), bouncesOf(view)});
    };
    int room = lights;
    auto pipeline = prepared(room);
    while (pipeline == p.pipelines.end() && room < APERTURA_MAX_LIGHTS)
        if (variantOf(at, ++room) >= 0) pipeline = prepared(room);  // the pipeline of one light draws no frame of none
    if (pipeline == p.pipelines.end())
        throw Error("the renderer is not prepared for " + std::string(model.name) + " with these lights and this format");
    const int floats = at == LightAt::Vertices ? litFloats(room) : 0;
    p.light(frame, view, target.size, floats);
    const auto each = [&](const auto& use) {
        for (size_t i = 0; i < p.parts.size(); ++i)
            use(p.parts[i], p.parts[i].buffers.at({model.id, floats}).bindings, PerFrame<AperturaFrame>::offset(p.litSlot(frame, i)));
    };
    if (at == LightAt::Vertices) {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *p.vertexLights.at({model.id, lightClassOf(view)}));
        each([&](const State::Part& part, const GpuBindings& bindings, uint32_t offset) {
            bindings.bind(commands, vk::PipelineBindPoint::eCompute, {&offset, 1});
            commands.dispatch(uint32_t(std::min((part.geometry.vertices + 63) / 64, size_t(65535))), 1,
                              1);  // the most that any device takes
        });
        const vk::MemoryBarrier2 written{.srcStageMask = vk::PipelineStageFlagBits2::eComputeShader,
                                         .srcAccessMask = vk::AccessFlagBits2::eShaderStorageWrite,
                                         .dstStageMask = vk::PipelineStageFlagBits2::eVertexShader,
                                         .dstAccessMask = vk::AccessFlagBits2::eShaderStorageRead};
        commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &written});
    }
    const bool indexed = at == LightAt::Vertices || cornersFor(model, p.onFaces || p.onTexels) == Corners::Interpolated;
    std::vector<BoundPart> bound;
    each([&](const State::Part& part, const GpuBindings& bindings, uint32_t offset) {
        bound.push_back({&bindings, {offset}, indexed ? &part.indices : nullptr, &part.batches});
    });
    p.drawScene(commands, target, view, frame, bound, [&](size_t kind) { return *pipeline->second[kind]; });
}

void Renderer::State::drawScene(vk::CommandBuffer commands, const RenderTarget& target, const View& view, int frame,
                                std::span<const BoundPart> bound, const std::function<vk::Pipeline(size_t)>& pipelineOf) const {
    const DrawPass pass(commands, target);
    const auto blend = std::find(kinds.begin(), kinds.end(), Material::Alpha::Blend);
    for (auto kind = kinds.begin(); kind != blend; ++kind)
        drawBatches(pass, bound, materials, *kind, pipelineOf(size_t(kind - kinds.begin())));
    background->draw(pass, vk::Format(target.format), std::any_of(view.lights.begin(), view.lights.end(), aperturaIsSphere),
                     PerFrame<AperturaFrame>::offset(litSlot(frame, 0)));
    if (blend != kinds.end()) drawBlended(pass, bound, materials, view.camera.eye, pipelineOf(size_t(blend - kinds.begin())));
}

void Renderer::prepareSky(const Sky& sky) { state_->background->setSky(state_->gpu, *state_->lit, sky); }

Picture Renderer::draw(const View& view, const Model& model, LightAt at) {
    prepare(model, lightClassOf(view), kPictureFormat, at, int(view.lights.size()), bouncesOf(view));
    prepareSky(view.sky);
    return state_->picture(
        view, [&](VkCommandBuffer commands, const RenderTarget& target) { record(commands, target, view, model, state_->frames, at); });
}

void Renderer::prepareShadowMapped(VkFormat format) {
    State& p = *state_;
    if (!p.shadow) {
        std::vector<ShadowMap::Part> parts;
        for (const State::Part& part : p.parts) parts.push_back({part.vertices, part.indices, part.paint, part.batches});
        auto made = std::make_unique<ShadowMap>(p.gpu, *p.lit, parts, p.materials, p.painted, p.box, p.frames + 1);
        const std::unique_lock hold(p.lock);
        p.shadow = std::move(made);
    }
    p.shadow->prepare(p.gpu, format);
    p.background->prepare(p.gpu, vk::Format(format));
}

void Renderer::recordShadowMapped(VkCommandBuffer commands, const RenderTarget& target, const View& view, int frame) const {
    requireOneDirectional(view);
    const std::shared_lock hold(state_->lock);
    const std::unique_ptr<ShadowMap>& shadow = state_->shadow;
    if (!shadow) throw Error("the shadow map is not prepared");
    state_->light(frame, view, target.size);
    for (const Material::Alpha kind : state_->kinds) shadow->pipeline(target.format, kind);  // throws before anything is recorded
    shadow->recordMap(commands, view, frame);
    state_->drawScene(commands, target, view, frame, shadow->shading(frame),
                      [&](size_t kind) { return shadow->pipeline(target.format, state_->kinds[kind]); });
}

Picture Renderer::drawShadowMapped(const View& view) {
    requireOneDirectional(view);
    prepareShadowMapped(kPictureFormat);
    prepareSky(view.sky);
    return state_->picture(
        view, [&](VkCommandBuffer commands, const RenderTarget& target) { recordShadowMapped(commands, target, view, state_->frames); });
}

Picture Renderer::State::picture(const View& view, const std::function<void(VkCommandBuffer, const RenderTarget&)>& record) const {
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
