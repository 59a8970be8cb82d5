#include "runtime/render/vulkan.h"

#include <algorithm>
#include <cstring>

#include "runtime/asset/error.h"

namespace apertura {
namespace {

const char* const kValidation = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    static_cast<std::vector<std::string>*>(user)->push_back(data->pMessage);
    return VK_FALSE;
}

bool hasLayer(const char* wanted) {
    uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(),
                       [&](const VkLayerProperties& l) { return std::strcmp(l.layerName, wanted) == 0; });
}

// The family with graphics and compute; UINT32_MAX where the device has none or is too old.
uint32_t usableFamily(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3) return UINT32_MAX;
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    for (uint32_t i = 0; i < count; ++i) {
        constexpr VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
        if ((families[i].queueFlags & both) == both) return i;
    }
    return UINT32_MAX;
}

int rank(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    switch (properties.deviceType) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 3;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 2;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 1;
        default: return 0;
    }
}

}  // namespace

void check(VkResult result, const char* call) {
    if (result != VK_SUCCESS)
        throw Error(std::string("Vulkan: ") + call + " failed with code " + std::to_string(result));
}

Gpu::Gpu(const GpuOptions& options) : messages_(std::make_unique<std::vector<std::string>>()) {
    try {
        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "apertura", 1, "apertura", 1,
                                      VK_API_VERSION_1_3};
        VkInstanceCreateInfo instance{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        instance.pApplicationInfo = &application;
        VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
        messenger.messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT
                              | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        messenger.pfnUserCallback = keepMessage;
        messenger.pUserData = messages_.get();
        const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
        if (options.validate) {
            if (!hasLayer(kValidation)) throw Error("Vulkan: the validation layer is not installed");
            instance.enabledLayerCount = 1;
            instance.ppEnabledLayerNames = &kValidation;
            instance.enabledExtensionCount = 1;
            instance.ppEnabledExtensionNames = &extension;
            instance.pNext = &messenger;
        }
        check(vkCreateInstance(&instance, nullptr, &instance_), "vkCreateInstance");
        if (options.validate) {
            const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
                vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
            check(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
        }

        uint32_t count = 0;
        vkEnumeratePhysicalDevices(instance_, &count, nullptr);
        std::vector<VkPhysicalDevice> devices(count);
        vkEnumeratePhysicalDevices(instance_, &count, devices.data());
        for (VkPhysicalDevice candidate : devices)
            if (usableFamily(candidate) != UINT32_MAX && (!physical_ || rank(candidate) > rank(physical_)))
                physical_ = candidate;
        if (!physical_) throw Error("Vulkan: no device with Vulkan 1.3; Mesa's lavapipe (mesa-vulkan-drivers) is one");
        family_ = usableFamily(physical_);
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(physical_, &properties);
        name_ = properties.deviceName;
        largestImage_ = properties.limits.maxImageDimension2D;
        largestBuffer_ = properties.limits.maxStorageBufferRange;
        if (properties.limits.timestampComputeAndGraphics) clockTick_ = properties.limits.timestampPeriod * 1e-9;

        const float priority = 1;
        VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
        queue.queueFamilyIndex = family_;
        queue.queueCount = 1;
        queue.pQueuePriorities = &priority;
        VkPhysicalDeviceVulkan13Features features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
        features.dynamicRendering = VK_TRUE;
        features.synchronization2 = VK_TRUE;
        features.maintenance4 = VK_TRUE;  // glslang states workgroup sizes by id
        VkPhysicalDeviceVulkan12Features offered{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
        VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &offered};
        vkGetPhysicalDeviceFeatures2(physical_, &all);
        hasHalf_ = offered.shaderFloat16;
        VkPhysicalDeviceVulkan12Features more{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &features};
        more.shaderFloat16 = offered.shaderFloat16;
        VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &more};
        device.queueCreateInfoCount = 1;
        device.pQueueCreateInfos = &queue;
        VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables{
            VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR};
        executables.pipelineExecutableInfo = VK_TRUE;
        const char* const executableProperties = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
        if (options.statistics) {
            features.pNext = &executables;
            device.enabledExtensionCount = 1;
            device.ppEnabledExtensionNames = &executableProperties;
        }
        check(vkCreateDevice(physical_, &device, nullptr, &device_), "vkCreateDevice");
        vkGetDeviceQueue(device_, family_, 0, &queue_);
        VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
        pool.queueFamilyIndex = family_;
        check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
    } catch (...) {
        release();
        throw;
    }
}

Gpu::~Gpu() { release(); }

void Gpu::release() {
    if (pool_) vkDestroyCommandPool(device_, pool_, nullptr);
    if (device_) vkDestroyDevice(device_, nullptr);
    if (messenger_) {
        const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

uint32_t Gpu::memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
        if ((allowed >> i & 1) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    throw Error("Vulkan: " + name_ + " has no memory of the kind that is needed");
}

void Gpu::run(const std::function<void(VkCommandBuffer)>& record) const {
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool_,
                                         VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr,
                                   VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, nullptr};
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    check(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
    check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    vkFreeCommandBuffers(device_, pool_, 1, &commands);
}

GpuBuffer::GpuBuffer(const Gpu& gpu, VkDeviceSize bytes, VkBufferUsageFlags usage, Place place)
    : gpu_(gpu), bytes_(std::max<VkDeviceSize>(bytes, 16)) {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = bytes_;
    info.usage = usage;
    check(vkCreateBuffer(gpu.device(), &info, nullptr, &buffer_), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(gpu.device(), buffer_, &needs);
    const bool host = place == Place::Host;
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size,
                                  gpu.memoryType(needs.memoryTypeBits,
                                                 host ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
                                                      : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    check(vkAllocateMemory(gpu.device(), &allocate, nullptr, &memory_), "vkAllocateMemory");
    check(vkBindBufferMemory(gpu.device(), buffer_, memory_, 0), "vkBindBufferMemory");
    if (host) check(vkMapMemory(gpu.device(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

GpuBuffer::~GpuBuffer() {
    vkDestroyBuffer(gpu_.device(), buffer_, nullptr);
    vkFreeMemory(gpu_.device(), memory_, nullptr);
}

std::unique_ptr<GpuBuffer> upload(const Gpu& gpu, std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
    GpuBuffer staging(gpu, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GpuBuffer::Place::Host);
    std::memcpy(staging.data(), bytes.data(), bytes.size());
    auto out = std::make_unique<GpuBuffer>(gpu, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                           GpuBuffer::Place::Device);
    gpu.run([&](VkCommandBuffer commands) {
        const VkBufferCopy all{0, 0, bytes.size()};
        vkCmdCopyBuffer(commands, staging.handle(), out->handle(), 1, &all);
    });
    return out;
}

GpuImage::GpuImage(const Gpu& gpu, uint32_t width, uint32_t height, VkFormat format, VkImageUsageFlags usage,
                   VkImageAspectFlags aspect)
    : gpu_(gpu), aspect_(aspect) {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {width, height, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage;
    check(vkCreateImage(gpu.device(), &info, nullptr, &image_), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(gpu.device(), image_, &needs);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size,
                                  gpu.memoryType(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)};
    check(vkAllocateMemory(gpu.device(), &allocate, nullptr, &memory_), "vkAllocateMemory");
    check(vkBindImageMemory(gpu.device(), image_, memory_, 0), "vkBindImageMemory");
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image_;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange = {aspect, 0, 1, 0, 1};
    check(vkCreateImageView(gpu.device(), &view, nullptr, &view_), "vkCreateImageView");
}

GpuImage::~GpuImage() {
    vkDestroyImageView(gpu_.device(), view_, nullptr);
    vkDestroyImage(gpu_.device(), image_, nullptr);
    vkFreeMemory(gpu_.device(), memory_, nullptr);
}

void GpuImage::transition(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const {
    VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image_;
    barrier.subresourceRange = {aspect_, 0, 1, 0, 1};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
}

void letHostRead(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkAccessFlags2 access) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = stage;
    barrier.srcAccessMask = access;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
}

GpuShader::GpuShader(const Gpu& gpu, std::span<const uint32_t> words) : gpu_(gpu) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    check(vkCreateShaderModule(gpu.device(), &info, nullptr, &module_), "vkCreateShaderModule");
}

GpuShader::~GpuShader() { vkDestroyShaderModule(gpu_.device(), module_, nullptr); }

GpuBindings::GpuBindings(const Gpu& gpu, std::span<const Binding> bindings) : gpu_(gpu) {
    std::vector<VkDescriptorSetLayoutBinding> slots;
    std::vector<VkDescriptorPoolSize> sizes;
    for (const Binding& binding : bindings) {
        slots.push_back({uint32_t(slots.size()), binding.type, 1, binding.stages, nullptr});
        sizes.push_back({binding.type, 1});
    }
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.bindingCount = uint32_t(slots.size());
    set.pBindings = slots.data();
    check(vkCreateDescriptorSetLayout(gpu.device(), &set, nullptr, &setLayout_), "vkCreateDescriptorSetLayout");
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &setLayout_;
    check(vkCreatePipelineLayout(gpu.device(), &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    if (std::any_of(bindings.begin(), bindings.end(), [](const Binding& b) { return !b.buffer && !b.image; })) return;
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = 1;
    pool.poolSizeCount = uint32_t(sizes.size());
    pool.pPoolSizes = sizes.data();
    check(vkCreateDescriptorPool(gpu.device(), &pool, nullptr, &pool_), "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr, pool_, 1, &setLayout_};
    check(vkAllocateDescriptorSets(gpu.device(), &allocate, &set_), "vkAllocateDescriptorSets");
    for (uint32_t i = 0; i < bindings.size(); ++i) {
        VkDescriptorBufferInfo buffer{VK_NULL_HANDLE, 0, VK_WHOLE_SIZE};
        VkDescriptorImageInfo image{VK_NULL_HANDLE, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set_;
        write.dstBinding = i;
        write.descriptorCount = 1;
        write.descriptorType = bindings[i].type;
        if (bindings[i].image) {
            image.imageView = bindings[i].image->view();
            write.pImageInfo = &image;
        } else {
            buffer.buffer = bindings[i].buffer->handle();
            write.pBufferInfo = &buffer;
        }
        vkUpdateDescriptorSets(gpu.device(), 1, &write, 0, nullptr);
    }
}

GpuBindings::~GpuBindings() {
    vkDestroyPipelineLayout(gpu_.device(), layout_, nullptr);
    vkDestroyDescriptorPool(gpu_.device(), pool_, nullptr);
    vkDestroyDescriptorSetLayout(gpu_.device(), setLayout_, nullptr);
}

}  // namespace apertura
