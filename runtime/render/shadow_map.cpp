#include "runtime/render/shadow_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/render/draw.h"
#include "scene.vert.h"
#include "shadow.frag.h"
#include "shadow.vert.h"

namespace apertura {
namespace {

constexpr uint32_t kTexels = 2048;  // a side

// For the pass that shades; without the map, for the one that draws it.
GpuBindings makeBindings(const Gpu& gpu, std::initializer_list<const GpuBuffer*> buffers, const GpuImage* map) {
    constexpr vk::ShaderStageFlags both = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
    constexpr vk::DescriptorType types[] = {vk::DescriptorType::eUniformBuffer, vk::DescriptorType::eStorageBuffer,
                                            vk::DescriptorType::eStorageBuffer, vk::DescriptorType::eUniformBuffer};
    std::vector<GpuBindings::Binding> slots;
    for (const GpuBuffer* buffer : buffers) slots.push_back({types[slots.size()], both, buffer});
    if (map) slots.push_back({vk::DescriptorType::eSampledImage, vk::ShaderStageFlagBits::eFragment, nullptr, map});
    return {gpu, slots};
}

}  // namespace

ShadowMap::ShadowMap(const Gpu& gpu, const GpuBuffer& frame, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds)
    : bounds_(bounds),
      map_(gpu, {kTexels, kTexels}, kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment | vk::ImageUsageFlagBits::eSampled, vk::ImageAspectFlagBits::eDepth),
      view_(gpu, sizeof(ShadowView), vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host),
      bindings_(makeBindings(gpu, {&frame, &vertices, &indices, &view_}, &map_)),
      mapBindings_(makeBindings(gpu, {&frame, &vertices, &indices, &view_}, nullptr)),
      mapping_(makePipeline(gpu, {.vertex = shadow_vert}, mapBindings_)),
      shading_(makePipeline(gpu, {.vertex = scene_vert, .fragment = shadow_frag}, bindings_)) {}

void ShadowMap::aim(const Light& light) {
    const vec3 towards(light.cap.axis), right = tangentTo(towards), up = cross(towards, right);
    vec3 low(1e30f), high(-1e30f);
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 p(corner & 1 ? bounds_.high.x : bounds_.low.x, corner & 2 ? bounds_.high.y : bounds_.low.y,
                     corner & 4 ? bounds_.high.z : bounds_.low.z);
        const vec3 seen(dot(p, right), dot(p, up), dot(p, towards));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const vec3 size = glm::max(high - low, vec3(1e-6f)) * 1.02f, centre = 0.5f * (low + high);
    // Rows: x and y over the extent, z from 0 at the far end to 1 at the near one.
    auto row = [](const vec3& axis, float scale, float shift) { return vec4(axis * scale, shift); };
    ShadowView view;
    view.toLight = transpose(mat4(row(right, 2 / size.x, -2 * centre.x / size.x), row(up, -2 / size.y, 2 * centre.y / size.y),
                                  row(towards, 1 / size.z, 0.5f - centre.z / size.z), vec4(0, 0, 0, 1)));
    view.right = vec4(right, 1 / size.x);
    view.up = vec4(up, 1 / size.y);
    view.towards = vec4(towards, 1 / size.z);
    const float s = light.cap.sinRadius;
    view.shape = vec4(s / std::sqrt(std::max(1 - s * s, 1e-6f)), kTexels, std::max(size.x, size.y) / kTexels, 0);
    std::memcpy(view_.data(), &view, sizeof view);
}

void ShadowMap::draw(vk::CommandBuffer commands, uint32_t vertices) const {
    map_.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
    drawTriangles(commands, nullptr, map_, {kTexels, kTexels}, vec3(0), *mapping_, mapBindings_, vertices);
    map_.transition(commands, vk::ImageLayout::eDepthAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
}

}  // namespace apertura
