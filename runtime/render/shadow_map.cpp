#include "runtime/render/shadow_map.h"

#include "runtime/render/draw.h"
#include "scene.vert.h"
#include "shadow.frag.h"
#include "shadow.vert.h"

namespace apertura {
namespace {

constexpr uint32_t kTexels = kShadowTexels;

constexpr vk::ShaderStageFlags kBoth = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;

// Bindings of a pass: `shared`, which both passes read, and `map` for the pass that shades.
GpuBindings makeBindings(const Gpu& gpu, std::initializer_list<GpuBindings::Binding> shared, const GpuImage* map) {
    std::vector<GpuBindings::Binding> all(shared);
    if (map) all.push_back({vk::DescriptorType::eSampledImage, vk::ShaderStageFlagBits::eFragment, nullptr, map});
    return {gpu, all};
}

GpuBindings::Binding storage(const GpuBuffer& buffer) { return {vk::DescriptorType::eStorageBuffer, kBoth, &buffer}; }

}  // namespace

ShadowMap::ShadowMap(const Gpu& gpu, const PerFrame<Frame>& lit, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds,
                     int frames)
    : bounds_(bounds),
      map_(gpu, {kTexels, kTexels}, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment | vk::ImageUsageFlagBits::eSampled,
           vk::ImageAspectFlagBits::eDepth),
      seen_(gpu, frames),
      bindings_(makeBindings(gpu, {lit.binding(kBoth), storage(vertices), storage(indices), seen_.binding(kBoth)}, &map_)),
      mapBindings_(makeBindings(gpu, {lit.binding(kBoth), storage(vertices), storage(indices), seen_.binding(kBoth)}, nullptr)),
      mapping_(makePipeline(gpu, {.vertex = shadow_vert}, mapBindings_, vk::Format::eUndefined)) {}

void ShadowMap::prepare(const Gpu& gpu, VkFormat format) {
    if (!shading_.contains(format))
        shading_.emplace(format, makePipeline(gpu, {.vertex = scene_vert, .fragment = shadow_frag}, bindings_, vk::Format(format)));
}

void ShadowMap::record(vk::CommandBuffer commands, const RenderTarget& target, const View& view, int frame, uint32_t vertices) const {
    const auto shading = shading_.find(target.format);
    if (shading == shading_.end()) throw Error("the shadow map is not prepared for this format");
    seen_.set(frame, shadowViewOf(view.lights[0], bounds_));
    const uint32_t offsets[] = {PerFrame<Frame>::offset(frame), PerFrame<ShadowView>::offset(frame)};
    // All frames share the map: the barrier makes the device wait until the last frame has read it.
    map_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
    const RenderTarget map{.depth = map_.view(), .size = {kTexels, kTexels}};
    drawTriangles(commands, map, vec3(0), {*mapping_, mapBindings_, offsets}, vertices);
    map_.transition(commands, vk::ImageLayout::eDepthAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    drawTriangles(commands, target, view.sky, {*shading->second, bindings_, offsets}, vertices);
}

}  // namespace apertura
