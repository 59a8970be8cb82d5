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

}  // namespace

ShadowMap::ShadowMap(const Gpu& gpu, const GpuBuffer& frame, const GpuBuffer& vertices, const GpuBuffer& indices, const Box& bounds)
    : gpu_(gpu),
      bounds_(bounds),
      map_(gpu, kTexels, kTexels, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT, VK_IMAGE_ASPECT_DEPTH_BIT) {
    view_ = std::make_unique<GpuBuffer>(gpu, sizeof(ShadowView), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GpuBuffer::Place::Host);
    constexpr VkShaderStageFlags both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    const GpuBindings::Binding slots[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, both, &frame},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, both, &vertices},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, both, &indices},
                                          {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, both, view_.get()},
                                          {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr, &map_}};
    bindings_ = std::make_unique<GpuBindings>(gpu, slots);
    mapBindings_ = std::make_unique<GpuBindings>(gpu, std::span(slots).first(4));
    const GpuShader sceneVertex(gpu, scene_vert), shadowVertex(gpu, shadow_vert), shadowFragment(gpu, shadow_frag);
    auto stage = [](VkShaderStageFlagBits which, const GpuShader& shader) {
        return VkPipelineShaderStageCreateInfo{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, which, shader.handle(), "main", nullptr};
    };
    const VkPipelineShaderStageCreateInfo drawing[] = {stage(VK_SHADER_STAGE_VERTEX_BIT, shadowVertex)};
    const VkPipelineShaderStageCreateInfo shading[] = {stage(VK_SHADER_STAGE_VERTEX_BIT, sceneVertex),
                                                       stage(VK_SHADER_STAGE_FRAGMENT_BIT, shadowFragment)};
    mapping_ = makePipeline(gpu, drawing, mapBindings_->layout(), false);
    shading_ = makePipeline(gpu, shading, bindings_->layout(), true);
}

ShadowMap::~ShadowMap() {
    vkDestroyPipeline(gpu_.device(), mapping_, nullptr);
    vkDestroyPipeline(gpu_.device(), shading_, nullptr);
}

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
    std::memcpy(view_->data(), &view, sizeof view);
}

void ShadowMap::draw(VkCommandBuffer commands, uint32_t vertices) const {
    map_.transition(commands, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
    drawTriangles(commands, nullptr, map_, {kTexels, kTexels}, vec3(0), mapping_, *mapBindings_, vertices);
    map_.transition(commands, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

}  // namespace apertura
