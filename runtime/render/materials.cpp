#include "apertura/runtime/render/materials.h"

#include <algorithm>
#include <map>

#include "apertura/runtime/asset/materials.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr vk::Format kFormat = vk::Format::eR8G8B8A8Srgb;
constexpr VkDeviceSize kStride = 256;  // the largest alignment that Vulkan lets a device require
constexpr float kAnisotropy = 8;

vk::SamplerAddressMode modeOf(Texture::Wrap wrap) {
    switch (wrap) {
        case Texture::Wrap::Mirror: return vk::SamplerAddressMode::eMirroredRepeat;
        case Texture::Wrap::Clamp: return vk::SamplerAddressMode::eClampToEdge;
        default: return vk::SamplerAddressMode::eRepeat;
    }
}

GpuImage imageOf(const Gpu& gpu, const std::vector<Texture::Mip>& all, size_t& bytes) {
    std::vector<std::span<const std::byte>> mips;
    vk::Extent2D size;
    for (const Texture::Mip& mip : all) {
        if (uint32_t(std::max(mip.width, mip.height)) > gpu.largestImage()) continue;
        if (mips.empty()) size = vk::Extent2D{uint32_t(mip.width), uint32_t(mip.height)};
        mips.push_back(std::as_bytes(std::span(mip.texels)));
        bytes += mips.back().size();
    }
    return uploadImage(gpu, size, kFormat, mips);
}

AperturaMaterial constantsOf(const Material& m) { return {m.baseColour, vec4(m.emissive, m.cutoff)}; }

}  // namespace

vk::raii::DescriptorSetLayout Materials::makeLayout(const Gpu& gpu) {
    constexpr auto fragment = vk::ShaderStageFlagBits::eFragment;
    constexpr auto image = vk::DescriptorType::eCombinedImageSampler;
    const vk::DescriptorSetLayoutBinding slots[] = {
        {.binding = 0, .descriptorType = vk::DescriptorType::eUniformBuffer, .descriptorCount = 1, .stageFlags = fragment},
        {.binding = 1, .descriptorType = image, .descriptorCount = 1, .stageFlags = fragment},
        {.binding = 2, .descriptorType = image, .descriptorCount = 1, .stageFlags = fragment}};
    return make<vk::raii::DescriptorSetLayout>(
        gpu, vk::DescriptorSetLayoutCreateInfo{.bindingCount = uint32_t(std::size(slots)), .pBindings = slots});
}

vk::Sampler Materials::samplerFor(const Gpu& gpu, const Texture& texture) {
    const int key = int(texture.wrapU) + 4 * int(texture.wrapV) + 16 * int(texture.nearest);
    for (const auto& [known, sampler] : samplers_)
        if (known == key) return *sampler;
    const vk::Filter filter = texture.nearest ? vk::Filter::eNearest : vk::Filter::eLinear;
    const bool anisotropic = gpu.hasAnisotropy() && !texture.nearest;
    samplers_.emplace_back(key, make<vk::raii::Sampler>(gpu, vk::SamplerCreateInfo{.magFilter = filter,
                                                                                   .minFilter = filter,
                                                                                   .mipmapMode = vk::SamplerMipmapMode::eLinear,
                                                                                   .addressModeU = modeOf(texture.wrapU),
                                                                                   .addressModeV = modeOf(texture.wrapV),
                                                                                   .anisotropyEnable = anisotropic,
                                                                                   .maxAnisotropy = anisotropic ? kAnisotropy : 1,
                                                                                   .maxLod = VK_LOD_CLAMP_NONE}));
    return *samplers_.back().second;
}

Materials::Materials(const Gpu& gpu, const Scene& scene) : layout_(makeLayout(gpu)) {
    const Texture plain;
    images_.push_back(imageOf(gpu, {{1, 1, {glm::u8vec4(255)}}}, bytes_));
    std::vector<size_t> imageOfTexture(scene.textures.size(), 0);
    std::map<const void*, size_t> known;  // by the mips, which textures share
    for (size_t t = 0; t < scene.textures.size(); ++t) {
        if (!scene.textures[t]->mips) continue;
        const auto [place, isNew] = known.emplace(scene.textures[t]->mips.get(), images_.size());
        if (isNew) images_.push_back(imageOf(gpu, *scene.textures[t]->mips, bytes_));
        imageOfTexture[t] = place->second;
    }
    std::vector<Material> all{Material()};
    all.insert(all.end(), scene.materials.begin(), scene.materials.end());
    const auto count = uint32_t(all.size());
    constants_.emplace(gpu, kStride * count, vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host);
    const vk::DescriptorPoolSize sizes[] = {{vk::DescriptorType::eUniformBuffer, count},
                                            {vk::DescriptorType::eCombinedImageSampler, 2 * count}};
    pool_ = make<vk::raii::DescriptorPool>(gpu, vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                                             .maxSets = count,
                                                                             .poolSizeCount = uint32_t(std::size(sizes)),
                                                                             .pPoolSizes = sizes});
    const std::vector<vk::DescriptorSetLayout> layouts(count, *layout_);
    const vk::DescriptorSetAllocateInfo wanted{.descriptorPool = *pool_, .descriptorSetCount = count, .pSetLayouts = layouts.data()};
    for (vk::raii::DescriptorSet& set : make<vk::raii::DescriptorSets>(gpu, wanted)) sets_.push_back(std::move(set));
    for (uint32_t i = 0; i < count; ++i) {
        const AperturaMaterial constants = constantsOf(all[i]);
        std::memcpy(static_cast<std::byte*>(constants_->data()) + i * kStride, &constants, sizeof constants);
        const vk::DescriptorBufferInfo buffer{.buffer = constants_->handle(), .offset = i * kStride, .range = sizeof constants};
        vk::DescriptorImageInfo images[2];
        const int textures[] = {all[i].baseTexture, all[i].emissiveTexture};
        for (size_t k = 0; k < 2; ++k) {
            const bool has = textures[k] >= 0;
            images[k] = {.sampler = samplerFor(gpu, has ? *scene.textures[size_t(textures[k])] : plain),
                         .imageView = images_[has ? imageOfTexture[size_t(textures[k])] : 0].view(),
                         .imageLayout = vk::ImageLayout::eShaderReadOnlyOptimal};
        }
        const vk::WriteDescriptorSet writes[] = {{.dstSet = *sets_[i],
                                                  .dstBinding = 0,
                                                  .descriptorCount = 1,
                                                  .descriptorType = vk::DescriptorType::eUniformBuffer,
                                                  .pBufferInfo = &buffer},
                                                 {.dstSet = *sets_[i],
                                                  .dstBinding = 1,
                                                  .descriptorCount = 1,
                                                  .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                                  .pImageInfo = &images[0]},
                                                 {.dstSet = *sets_[i],
                                                  .dstBinding = 2,
                                                  .descriptorCount = 1,
                                                  .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                                  .pImageInfo = &images[1]}};
        gpu.handles().device.updateDescriptorSets(writes, nullptr);
    }
}

void Materials::bind(vk::CommandBuffer commands, vk::PipelineLayout layout, int material) const {
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, layout, 1, *sets_[size_t(material + 1)], nullptr);
}

}  // namespace apertura
