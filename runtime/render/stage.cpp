#include "apertura/runtime/render/stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "background.vert.h"
#include "compose.frag.h"

namespace apertura {
namespace {

constexpr auto kColour = vk::Format(Stage::kFormat);
constexpr auto kTruth = vk::Format::eR32G32B32A32Sfloat;

vk::Extent2D times(vk::Extent2D size, int samples) { return {size.width * uint32_t(samples), size.height * uint32_t(samples)}; }

}  // namespace

Stage::Stage(const Gpu& gpu, vk::Extent2D size, vk::Format shown, int frames) : gpu_(gpu), size_(size), compose_(gpu, frames) {
    constexpr auto both = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
    constexpr auto colour = vk::ImageUsageFlagBits::eColorAttachment | vk::ImageUsageFlagBits::eSampled
                          | vk::ImageUsageFlagBits::eTransferSrc | vk::ImageUsageFlagBits::eTransferDst;
    if (2 * std::max(size.width, size.height) > gpu.largestImage())
        throw Error("Vulkan: " + gpu.name() + " draws windows of at most " + std::to_string(gpu.largestImage() / 2) + " pixels a side");
    for (int f = 0; f < frames; ++f) {
        std::vector<GpuImage> colours, depths;
        for (int picture = 0; picture < 2; ++picture)
            for (const int samples : {1, 2}) {
                colours.emplace_back(gpu, times(size, samples), kColour, colour, vk::ImageAspectFlagBits::eColor);
                depths.emplace_back(gpu, times(size, samples), kDepthFormat, vk::ImageUsageFlagBits::eDepthStencilAttachment,
                                    vk::ImageAspectFlagBits::eDepth);
            }
        frames_.push_back({std::move(colours),
                           std::move(depths),
                           {},
                           GpuImage(gpu, size, kTruth, vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                                    vk::ImageAspectFlagBits::eColor),
                           GpuBuffer(gpu, sizeof(vec4) * VkDeviceSize(size.width) * size.height, vk::BufferUsageFlagBits::eTransferSrc,
                                     GpuBuffer::Place::Host)});
    }
    // Black, and in the layout that frames find them in.
    gpu.run([&](vk::CommandBuffer commands) {
        const auto blacken = [&](const GpuImage& image) {
            image.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
            commands.clearColorImage(image.handle(), vk::ImageLayout::eTransferDstOptimal,
                                     vk::ClearColorValue(std::array{0.0f, 0.0f, 0.0f, 1.0f}),
                                     vk::ImageSubresourceRange{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1});
            image.transition(commands, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
        };
        for (const Frame& frame : frames_) {
            for (const GpuImage& image : frame.colours) blacken(image);
            blacken(frame.truth);
            for (const GpuImage& image : frame.depths)
                image.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eDepthAttachmentOptimal);
        }
    });
    const auto sampled = [&](const GpuImage& image) {
        return GpuBindings::Binding{.type = vk::DescriptorType::eSampledImage, .stages = both, .image = &image};
    };
    for (Frame& frame : frames_)
        for (const int samples : {1, 2})
            for (const bool isTruth : {false, true}) {
                const GpuBindings::Binding slots[] = {compose_.binding(both), sampled(frame.colours[imageOf(0, samples)]),
                                                      sampled(isTruth ? frame.truth : frame.colours[imageOf(1, samples)])};
                frame.bindings.emplace_back(gpu, slots);
            }
    pipeline_ = makePipeline(gpu, {.vertex = background_vert, .fragment = compose_frag, .covers = DrawShaders::Covers::Equal},
                             frames_[0].bindings[0], shown);
}

RenderTarget Stage::target(int frame, int picture, int samples) const {
    const Frame& f = frames_[size_t(frame)];
    const size_t image = imageOf(picture, samples);
    return {f.colours[image].view(), kFormat, f.depths[image].view(), times(size_, samples)};
}

void Stage::record(vk::CommandBuffer commands, int frame, const Composition& c, vk::ImageView to, const Draw& draw,
                   const vk::raii::QueryPool* clock) const {
    Frame& f = frames_[size_t(frame)];
    const auto stamp = [&](uint32_t i) {
        if (clock) commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, **clock, 3 * uint32_t(frame) + i);
    };
    if (clock) commands.resetQueryPool(**clock, 3 * uint32_t(frame), 3);
    stamp(0);
    if (f.truthIsNew) {
        f.truth.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
        commands.copyBufferToImage(f.staging.handle(), f.truth.handle(), vk::ImageLayout::eTransferDstOptimal,
                                   vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                                       .imageExtent = {size_.width, size_.height, 1}});
        f.truth.transition(commands, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
        f.truthIsNew = false;
    }
    for (int picture = 0; picture < 2; ++picture) {
        if (!c.redraw || (picture == 1 && (c.split >= 1 || c.isTruth))) continue;
        const GpuImage& image = f.colours[imageOf(picture, c.samples)];
        image.transition(commands, vk::ImageLayout::eShaderReadOnlyOptimal, vk::ImageLayout::eColorAttachmentOptimal);
        draw(picture, target(frame, picture, c.samples));
        image.transition(commands, vk::ImageLayout::eColorAttachmentOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    }
    stamp(1);
    compose_.set(frame, {vec4(std::round(c.split * size_.width), float(std::exp2(c.exposure)), c.toned ? 1 : 0, c.heat ? 1 : 0),
                         ivec4(c.samples, c.isTruth ? 1 : c.samples, 0, 0)});
    // Depth is neither tested nor written, but the pipeline has the format of one.
    const DrawPass pass(commands, {to, VkFormat(), f.depths[imageOf(0, 1)].view(), size_});
    pass.use(*pipeline_);
    const uint32_t offset = PerFrame<AperturaCompose>::offset(frame);
    pass.draw(f.bindings[kindOf(c.samples, c.isTruth)], {&offset, 1}, 3);
    stamp(2);
}

void Stage::setTruth(const Picture& picture) {
    if (picture.width != int(size_.width) || picture.height != int(size_.height)) return;
    gpu_.waitIdle();
    for (Frame& frame : frames_) {
        auto* to = static_cast<vec4*>(frame.staging.data());
        for (const glm::vec3& p : picture.pixels) *to++ = vec4(p, 1);
        frame.truthIsNew = true;
    }
}

Picture Stage::read(int frame, int picture, int samples) const {
    const vk::Extent2D size = times(size_, samples);
    const GpuImage& image = frames_[size_t(frame)].colours[imageOf(picture, samples)];
    const GpuBuffer result(gpu_, sizeof(glm::u16vec4) * VkDeviceSize(size.width) * size.height, vk::BufferUsageFlagBits::eTransferDst,
                           GpuBuffer::Place::Host);
    gpu_.waitIdle();
    ++gpu_.handles().counters.copiesToHost;
    gpu_.run([&](vk::CommandBuffer commands) {
        image.transition(commands, vk::ImageLayout::eShaderReadOnlyOptimal, vk::ImageLayout::eTransferSrcOptimal);
        commands.copyImageToBuffer(image.handle(), vk::ImageLayout::eTransferSrcOptimal, result.handle(),
                                   vk::BufferImageCopy{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                                       .imageExtent = {size.width, size.height, 1}});
        letHostRead(commands, vk::PipelineStageFlagBits2::eCopy, vk::AccessFlagBits2::eTransferWrite);
        image.transition(commands, vk::ImageLayout::eTransferSrcOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    });
    Picture out{int(size.width), int(size.height), {}};
    const auto* from = static_cast<const glm::u16vec4*>(result.data());
    for (size_t i = 0; i < size_t(size.width) * size.height; ++i) out.pixels.emplace_back(glm::unpackHalf(from[i]));
    return samples == 2 ? halved(out) : out;
}

}  // namespace apertura
