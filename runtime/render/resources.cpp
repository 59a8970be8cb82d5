#include "apertura/runtime/render/resources.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace apertura {
namespace {}  // namespace

GpuMemory::GpuMemory(const Gpu& gpu, const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags wanted) {
    const vk::PhysicalDeviceMemoryProperties memory = gpu.handles().physical.getMemoryProperties();
    uint32_t type = 0;
    while (type < memory.memoryTypeCount
           && !((needs.memoryTypeBits >> type & 1) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted))
        ++type;
    if (type == memory.memoryTypeCount) throw Error("Vulkan: " + gpu.name() + " has no memory of the kind that is needed");
    memory_ = make<vk::raii::DeviceMemory>(gpu, vk::MemoryAllocateInfo{.allocationSize = needs.size, .memoryTypeIndex = type});
    handles_ = &gpu.handles();
    bytes_ = needs.size;
    ++handles_->counters.allocations;
    handles_->counters.allocatedBytes += bytes_;
}

GpuMemory& GpuMemory::operator=(GpuMemory&& other) noexcept {
    if (this == &other) return *this;
    release();
    memory_ = std::move(other.memory_);
    handles_ = std::exchange(other.handles_, nullptr);
    bytes_ = other.bytes_;
    return *this;
}

void GpuMemory::release() noexcept {
    if (handles_) handles_->counters.allocatedBytes -= bytes_;
    handles_ = nullptr;
}

GpuBuffer::GpuBuffer(const Gpu& gpu, VkDeviceSize bytes, vk::BufferUsageFlags usage, Place place)
    : buffer_(make<vk::raii::Buffer>(gpu, vk::BufferCreateInfo{.size = std::max<VkDeviceSize>(bytes, 16), .usage = usage})) {
    using Property = vk::MemoryPropertyFlagBits;
    const bool host = place == Place::Host;
    memory_ = GpuMemory(gpu, buffer_.getMemoryRequirements(),
                        host ? Property::eHostVisible | Property::eHostCoherent : vk::MemoryPropertyFlags(Property::eDeviceLocal));
    checked([&] {
        buffer_.bindMemory(**memory_, 0);
        if (host) mapped_ = (*memory_).mapMemory(0, VK_WHOLE_SIZE);
    });
}

GpuBuffer upload(const Gpu& gpu, std::span<const std::byte> bytes, vk::BufferUsageFlags usage) {
    const GpuBuffer staging(gpu, bytes.size(), vk::BufferUsageFlagBits::eTransferSrc, GpuBuffer::Place::Host);
    std::memcpy(staging.data(), bytes.data(), bytes.size());
    GpuBuffer out(gpu, bytes.size(), usage | vk::BufferUsageFlagBits::eTransferDst, GpuBuffer::Place::Device);
    gpu.run([&](vk::CommandBuffer commands) { commands.copyBuffer(staging.handle(), out.handle(), vk::BufferCopy{.size = bytes.size()}); });
    return out;
}

GpuImage::GpuImage(const Gpu& gpu, vk::Extent2D size, vk::Format format, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect,
                   uint32_t mips)
    : image_(make<vk::raii::Image>(gpu, vk::ImageCreateInfo{.imageType = vk::ImageType::e2D,
                                                            .format = format,
                                                            .extent = {size.width, size.height, 1},
                                                            .mipLevels = mips,
                                                            .arrayLayers = 1,
                                                            .usage = usage})),
      aspect_(aspect) {
    memory_ = GpuMemory(gpu, image_.getMemoryRequirements(), vk::MemoryPropertyFlagBits::eDeviceLocal);
    checked([&] { image_.bindMemory(**memory_, 0); });
    view_ = make<vk::raii::ImageView>(
        gpu, vk::ImageViewCreateInfo{
                 .image = *image_, .viewType = vk::ImageViewType::e2D, .format = format, .subresourceRange = {aspect, 0, mips, 0, 1}});
}

void GpuImage::transition(vk::CommandBuffer commands, vk::ImageLayout from, vk::ImageLayout to) const {
    const vk::ImageMemoryBarrier2 barrier{.srcStageMask = vk::PipelineStageFlagBits2::eAllCommands,
                                          .srcAccessMask = vk::AccessFlagBits2::eMemoryWrite,
                                          .dstStageMask = vk::PipelineStageFlagBits2::eAllCommands,
                                          .dstAccessMask = vk::AccessFlagBits2::eMemoryRead | vk::AccessFlagBits2::eMemoryWrite,
                                          .oldLayout = from,
                                          .newLayout = to,
                                          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                          .image = *image_,
                                          .subresourceRange = {aspect_, 0, VK_REMAINING_MIP_LEVELS, 0, 1}};
    commands.pipelineBarrier2({.imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier});
}

GpuImage uploadImage(const Gpu& gpu, vk::Extent2D size, vk::Format format, const std::vector<std::span<const std::byte>>& mips) {
    size_t bytes = 0;
    for (const auto& mip : mips) bytes += mip.size();
    const GpuBuffer staging(gpu, bytes, vk::BufferUsageFlagBits::eTransferSrc, GpuBuffer::Place::Host);
    GpuImage out(gpu, size, format, vk::ImageUsageFlagBits::eTransferDst | vk::ImageUsageFlagBits::eSampled,
                 vk::ImageAspectFlagBits::eColor, uint32_t(mips.size()));
    std::vector<vk::BufferImageCopy> copies;
    size_t first = 0;
    for (uint32_t i = 0; i < mips.size(); ++i) {
        std::memcpy(static_cast<std::byte*>(staging.data()) + first, mips[i].data(), mips[i].size());
        copies.push_back({.bufferOffset = first,
                          .imageSubresource = {vk::ImageAspectFlagBits::eColor, i, 0, 1},
                          .imageExtent = {std::max(size.width >> i, 1u), std::max(size.height >> i, 1u), 1}});
        first += mips[i].size();
    }
    gpu.run([&](vk::CommandBuffer commands) {
        out.transition(commands, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
        commands.copyBufferToImage(staging.handle(), out.handle(), vk::ImageLayout::eTransferDstOptimal, copies);
        out.transition(commands, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal);
    });
    return out;
}

void letHostRead(vk::CommandBuffer commands, vk::PipelineStageFlags2 stage, vk::AccessFlags2 access) {
    const vk::MemoryBarrier2 barrier{.srcStageMask = stage,
                                     .srcAccessMask = access,
                                     .dstStageMask = vk::PipelineStageFlagBits2::eHost,
                                     .dstAccessMask = vk::AccessFlagBits2::eHostRead};
    commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &barrier});
}

GpuBindings::GpuBindings(const Gpu& gpu, std::span<const Binding> bindings, vk::DescriptorSetLayout second) {
    std::vector<vk::DescriptorSetLayoutBinding> slots;
    std::vector<vk::DescriptorPoolSize> sizes;
    for (const Binding& b : bindings) {
        slots.push_back({.binding = uint32_t(slots.size()), .descriptorType = b.type, .descriptorCount = 1, .stageFlags = b.stages});
        sizes.push_back({b.type, 1});
    }
    setLayout_ = make<vk::raii::DescriptorSetLayout>(
        gpu, vk::DescriptorSetLayoutCreateInfo{.bindingCount = uint32_t(slots.size()), .pBindings = slots.data()});
    const vk::DescriptorSetLayout layouts[] = {*setLayout_, second};
    layout_ = make<vk::raii::PipelineLayout>(gpu, vk::PipelineLayoutCreateInfo{.setLayoutCount = second ? 2u : 1u, .pSetLayouts = layouts});
    if (std::any_of(bindings.begin(), bindings.end(), [](const Binding& b) { return !b.buffer && !b.image; })) return;
    pool_ = make<vk::raii::DescriptorPool>(gpu, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                                             .maxSets = 1,
                                                                             .poolSizeCount = uint32_t(sizes.size()),
                                                                             .pPoolSizes = sizes.data()});
    const vk::DescriptorSetAllocateInfo one{.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &*setLayout_};
    set_ = std::move(make<vk::raii::DescriptorSets>(gpu, one).front());
    for (uint32_t i = 0; i < bindings.size(); ++i) {
        vk::DescriptorBufferInfo buffer{.range = bindings[i].range};
        vk::DescriptorImageInfo image{.imageLayout = vk::ImageLayout::eShaderReadOnlyOptimal};
        vk::WriteDescriptorSet write{.dstSet = *set_, .dstBinding = i, .descriptorCount = 1, .descriptorType = bindings[i].type};
        if (bindings[i].image) {
            image.imageView = bindings[i].image->view();
            image.sampler = bindings[i].sampler;
            write.pImageInfo = &image;
        } else {
            buffer.buffer = bindings[i].buffer->handle();
            write.pBufferInfo = &buffer;
        }
        gpu.handles().device.updateDescriptorSets(write, nullptr);
    }
}

void GpuBindings::bind(vk::CommandBuffer commands, vk::PipelineBindPoint point, std::span<const uint32_t> offsets) const {
    commands.bindDescriptorSets(point, *layout_, 0, 1, &*set_, uint32_t(offsets.size()), offsets.data());
}

Constants::Constants(std::span<const int32_t> values) {
    for (uint32_t i = 0; i < values.size(); ++i) entries.push_back({i, uint32_t(i * sizeof(int32_t)), sizeof(int32_t)});
    info = {
        .mapEntryCount = uint32_t(entries.size()), .pMapEntries = entries.data(), .dataSize = values.size_bytes(), .pData = values.data()};
}

vk::raii::ShaderModule makeShader(const Gpu& gpu, std::span<const uint32_t> words) {
    return make<vk::raii::ShaderModule>(gpu, vk::ShaderModuleCreateInfo{.codeSize = words.size_bytes(), .pCode = words.data()});
}

vk::raii::Pipeline makeComputePipeline(const Gpu& gpu, std::span<const uint32_t> words, std::span<const int32_t> constants,
                                       const GpuBindings& bindings, vk::PipelineCreateFlags flags) {
    const vk::raii::ShaderModule shader = makeShader(gpu, words);
    const Constants values(constants);
    ++gpu.handles().counters.pipelines;
    return make<vk::raii::Pipeline>(
        gpu, nullptr,
        vk::ComputePipelineCreateInfo{
            .flags = flags,
            .stage = {.stage = vk::ShaderStageFlagBits::eCompute, .module = *shader, .pName = "main", .pSpecializationInfo = &values.info},
            .layout = bindings.layout()});
}

}  // namespace apertura
