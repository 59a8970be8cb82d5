#include "apertura/runtime/render/shadow_map.h"

#include "mask.frag.h"
#include "shadow.frag.h"
#include "shadow0.vert.h"
#include "shadow1.vert.h"

namespace apertura {
namespace {

constexpr uint32_t kTexels = kShadowTexels;

constexpr vk::ShaderStageFlags kBoth = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;

// Bindings of a pass: `shared`, which both passes read, and `map` for the pass that shades.
GpuBindings makeBindings(const Gpu& gpu, std::initializer_list<GpuBindings::Binding> shared, const GpuImage* map,
                         const Materials& materials) {
    std::vector<GpuBindings::Binding> all(shared);
    if (map) all.push_back({vk::DescriptorType::eSampledImage, vk::ShaderStageFlagBits::eFragment, nullptr, map});
    return {gpu, all, materials.layout()};
}

GpuBindings::Binding storage(const GpuBuffer& buffer) { return {vk::DescriptorType::eStorageBuffer, kBoth, &buffer}; }

}  // namespace

ShadowMap::ShadowMap(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, std::span<const Part> parts, const Materials& materials,
                     bool painted, const Box& bounds, int frames)
    : bounds_(bounds),
      materials_(materials),
      painted_(painted),
      map_(gpu, {kTexels, kTexels}, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment | vk::ImageUsageFlagBits::eSampled,
           vk::ImageAspectFlagBits::eDepth),
      seen_(gpu, frames) {
    for (const Part& part : parts) {
        const auto shared = {lit.binding(kBoth), storage(part.vertices), storage(part.indices), seen_.binding(kBoth), storage(part.paint)};
        parts_.push_back({makeBindings(gpu, shared, &map_, materials), makeBindings(gpu, shared, nullptr, materials), &part.batches});
    }
    const int32_t opaque[] = {painted, int(Material::Alpha::Opaque)}, masks[] = {painted, int(Material::Alpha::Mask)};
    mapping_ = makePipeline(gpu, {.vertex = shadow1_vert, .constants = opaque}, parts_[0].mapping, vk::Format::eUndefined);
    mappingMasks_ = makePipeline(gpu, {.vertex = shadow1_vert, .fragment = mask_frag, .constants = masks}, parts_[0].mapping,
                                 vk::Format::eUndefined);
}

void ShadowMap::prepare(const Gpu& gpu, VkFormat format) {
    for (const auto alpha : {Material::Alpha::Opaque, Material::Alpha::Mask, Material::Alpha::Blend}) {
        const int32_t constants[] = {painted_, int(alpha)};
        {
            const std::lock_guard hold(lock_);
            if (shading_.contains({format, alpha})) continue;
        }
        vk::raii::Pipeline made = makePipeline(
            gpu, {.vertex = shadow0_vert, .fragment = shadow_frag, .constants = constants, .blends = alpha == Material::Alpha::Blend},
            parts_[0].shading, vk::Format(format));
        const std::lock_guard hold(lock_);
        shading_.emplace(std::pair(format, alpha), std::move(made));
    }
}

std::vector<BoundPart> ShadowMap::bound(GpuBindings PartBindings::*bindings, int frame) const {
    std::vector<BoundPart> out;
    for (size_t i = 0; i < parts_.size(); ++i)
        out.push_back({&(parts_[i].*bindings),
                       {PerFrame<AperturaFrame>::offset(frame * int(parts_.size()) + int(i)), PerFrame<AperturaShadowView>::offset(frame)},
                       nullptr,
                       parts_[i].batches});
    return out;
}

void ShadowMap::recordMap(vk::CommandBuffer commands, const View& view, int frame) const {
    seen_.set(frame, shadowViewOf(view.lights[0], bounds_));
    // All frames share the map: the barrier makes the device wait until the last frame has read it.
    map_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
    {
        const DrawPass pass(commands, {.depth = map_.view(), .size = {kTexels, kTexels}});
        const std::vector<BoundPart> parts = bound(&PartBindings::mapping, frame);
        drawBatches(pass, parts, materials_, Material::Alpha::Opaque, **mapping_);
        drawBatches(pass, parts, materials_, Material::Alpha::Mask, **mappingMasks_);
    }
    map_.transition(commands, vk::ImageLayout::eDepthAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
}

std::vector<BoundPart> ShadowMap::shading(int frame) const { return bound(&PartBindings::shading, frame); }

vk::Pipeline ShadowMap::pipeline(VkFormat format, Material::Alpha alpha) const {
    const std::lock_guard hold(lock_);
    const auto found = shading_.find({format, alpha});
    if (found == shading_.end()) throw Error("the shadow map is not prepared for this format");
    return *found->second;
}

}  // namespace apertura
