#include "apertura/runtime/render/shadow_map.h"

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

ShadowMap::ShadowMap(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, std::span<const Part> parts, const Box& bounds, int frames)
    : bounds_(bounds),
      map_(gpu, {kTexels, kTexels}, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment | vk::ImageUsageFlagBits::eSampled,
           vk::ImageAspectFlagBits::eDepth),
      seen_(gpu, frames) {
    for (const Part& part : parts) {
        const auto shared = {lit.binding(kBoth), storage(part.vertices), storage(part.indices), seen_.binding(kBoth)};
        parts_.push_back({makeBindings(gpu, shared, &map_), makeBindings(gpu, shared, nullptr), part.indexCount});
    }
    mapping_ = makePipeline(gpu, {.vertex = shadow_vert}, parts_[0].mapping, vk::Format::eUndefined);
}

void ShadowMap::prepare(const Gpu& gpu, VkFormat format) {
    if (!shading_.contains(format))
        shading_.emplace(format, makePipeline(gpu, {.vertex = scene_vert, .fragment = shadow_frag}, parts_[0].shading, vk::Format(format)));
}

void ShadowMap::drawParts(const DrawPass& pass, GpuBindings BoundPart::*bindings, int frame) const {
    for (size_t i = 0; i < parts_.size(); ++i) {
        const uint32_t offsets[] = {PerFrame<AperturaFrame>::offset(frame * int(parts_.size()) + int(i)),
                                    PerFrame<AperturaShadowView>::offset(frame)};
        pass.draw(parts_[i].*bindings, offsets, parts_[i].indexCount);
    }
}

void ShadowMap::recordMap(vk::CommandBuffer commands, const View& view, int frame) const {
    seen_.set(frame, shadowViewOf(view.lights[0], bounds_));
    // All frames share the map: the barrier makes the device wait until the last frame has read it.
    map_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
    {
        const DrawPass pass(commands, {.depth = map_.view(), .size = {kTexels, kTexels}});
        pass.use(**mapping_);
        drawParts(pass, &BoundPart::mapping, frame);
    }
    map_.transition(commands, vk::ImageLayout::eDepthAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
}

void ShadowMap::draw(const DrawPass& pass, VkFormat format, int frame) const {
    const auto shading = shading_.find(format);
    if (shading == shading_.end()) throw Error("the shadow map is not prepared for this format");
    pass.use(*shading->second);
    drawParts(pass, &BoundPart::shading, frame);
}

}  // namespace apertura
