#include "runtime/render/shadow_map.h"

#include <algorithm>
#include <cmath>

#include "runtime/render/draw.h"
#include "scene.vert.h"
#include "shadow.frag.h"
#include "shadow.vert.h"

namespace apertura {
namespace {

constexpr uint32_t kTexels = 2048;  // per side

constexpr vk::ShaderStageFlags kBoth = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;

// Bindings of a pass: `shared`, which both passes read, and `map` for the pass that shades.
GpuBindings makeBindings(const Gpu& gpu, std::initializer_list<GpuBindings::Binding> shared, const GpuImage* map) {
    std::vector<GpuBindings::Binding> all(shared);
    if (map) all.push_back({vk::DescriptorType::eSampledImage, vk::ShaderStageFlagBits::eFragment, nullptr, map});
    return {gpu, all};
}

GpuBindings::Binding storage(const GpuBuffer& buffer) { return {vk::DescriptorType::eStorageBuffer, kBoth, &buffer}; }

ShadowView seenFrom(const Light& light, const Box& bounds) {
    const vec3 towards(light.cap.axis), right = tangentTo(towards), up = cross(towards, right);
    vec3 low(1e30f), high(-1e30f);
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 p(corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
                     corner & 4 ? bounds.high.z : bounds.low.z);
        const vec3 seen(dot(p, right), dot(p, up), dot(p, towards));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const vec3 size = glm::max(high - low, vec3(1e-6f)) * 1.02f, centre = 0.5f * (low + high);
    // Rows of the matrix: x and y cover the extent, z is 0 at the far end and 1 at the near one.
    auto row = [](const vec3& axis, float scale, float shift) { return vec4(axis * scale, shift); };
    ShadowView view;
    view.toLight = transpose(mat4(row(right, 2 / size.x, -2 * centre.x / size.x), row(up, -2 / size.y, 2 * centre.y / size.y),
                                  row(towards, 1 / size.z, 0.5f - centre.z / size.z), vec4(0, 0, 0, 1)));
    view.right = vec4(right, 1 / size.x);
    view.up = vec4(up, 1 / size.y);
    view.towards = vec4(towards, 1 / size.z);
    const float s = light.cap.sinRadius;
    view.shape = vec4(s / std::sqrt(std::max(1 - s * s, 1e-6f)), kTexels, std::max(size.x, size.y) / kTexels, 0);
    return view;
}

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
    seen_.set(frame, seenFrom(view.lights[0], bounds_));
    const uint32_t offsets[] = {PerFrame<Frame>::offset(frame), PerFrame<ShadowView>::offset(frame)};
    // All frames share the map: the barrier makes the device wait until the last frame has read it.
    map_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
    const RenderTarget map{.depth = map_.view(), .size = {kTexels, kTexels}};
    drawTriangles(commands, map, vec3(0), {*mapping_, mapBindings_, offsets}, vertices);
    map_.transition(commands, vk::ImageLayout::eDepthAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    drawTriangles(commands, target, view.sky, {*shading->second, bindings_, offsets}, vertices);
}

}  // namespace apertura
