#include "apertura/runtime/render/background.h"

#include <glm/gtc/packing.hpp>

#include "background.vert.h"
#include "background0.frag.h"
#include "background1.frag.h"

namespace apertura {
namespace {

constexpr vk::Format kFormat = vk::Format::eR16G16B16A16Sfloat;

GpuImage imageOf(const Gpu& gpu, const Picture* picture) {
    static const Picture none{1, 1, {glm::vec3(0)}};
    const Picture& p = picture ? *picture : none;
    if (uint32_t(std::max(p.width, p.height)) > gpu.largestImage())
        throw Error("Vulkan: " + gpu.name() + " takes pictures of the sky of at most " + std::to_string(gpu.largestImage())
                    + " pixels a side");
    std::vector<glm::u16vec4> halves;
    halves.reserve(p.pixels.size());
    constexpr float kMost = 65504;  // the largest half
    for (const glm::vec3& pixel : p.pixels) halves.push_back(glm::packHalf(glm::vec4(glm::min(pixel, kMost), 1)));
    return uploadImage(gpu, {uint32_t(p.width), uint32_t(p.height)}, kFormat, {std::as_bytes(std::span(halves))});
}

}  // namespace

Background::Background(const Gpu& gpu, const PerFrame<AperturaFrame>& lit)
    : sampler_(make<vk::raii::Sampler>(gpu, vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                                                  .minFilter = vk::Filter::eLinear,
                                                                  .addressModeU = vk::SamplerAddressMode::eRepeat,
                                                                  .addressModeV = vk::SamplerAddressMode::eClampToEdge})),
      image_(imageOf(gpu, nullptr)) {
    bind(gpu, lit);
}

void Background::bind(const Gpu& gpu, const PerFrame<AperturaFrame>& lit) {
    constexpr auto both = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
    const GpuBindings::Binding slots[] = {
        lit.binding(both), {.type = vk::DescriptorType::eCombinedImageSampler, .stages = both, .image = &image_, .sampler = *sampler_}};
    bindings_.emplace(gpu, slots);
}

void Background::setSky(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, const Sky& sky) {
    if (shows(sky)) return;
    gpu.waitIdle();
    image_ = imageOf(gpu, sky.picture().get());
    picture_ = sky.picture();
    bind(gpu, lit);
}

void Background::prepare(const Gpu& gpu, vk::Format format) {
    {
        const std::lock_guard hold(lock_);
        if (pipelines_.contains(format)) return;
    }
    const auto pipeline = [&](std::span<const uint32_t> fragment) {
        return makePipeline(gpu, {.vertex = background_vert, .fragment = fragment, .covers = DrawShaders::Covers::Equal}, *bindings_,
                            format);
    };
    std::array made{pipeline(background0_frag), pipeline(background1_frag)};
    const std::lock_guard hold(lock_);
    pipelines_.emplace(format, std::move(made));
}

void Background::draw(const DrawPass& pass, vk::Format format, bool lamps, uint32_t offset) const {
    {
        const std::lock_guard hold(lock_);
        pass.use(*pipelines_.at(format)[lamps]);
    }
    pass.draw(*bindings_, {&offset, 1}, 3);
}

}  // namespace apertura
