#include "apertura/runtime/render/vulkan.h"

#include <algorithm>
#include <cstring>

#include "apertura/runtime/render/resources.h"

namespace apertura {
namespace {

const char* const kValidation = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL keepMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    static_cast<std::vector<std::string>*>(user)->push_back(data->pMessage);
    return VK_FALSE;
}

// The queue family with graphics and compute that presents to the surface; UINT32_MAX if there is none or the device lacks Vulkan 1.3.
uint32_t usableFamily(const vk::raii::PhysicalDevice& physical, vk::SurfaceKHR surface) {
    if (physical.getProperties().apiVersion < VK_API_VERSION_1_3) return UINT32_MAX;
    constexpr vk::QueueFlags both = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
    const auto families = physical.getQueueFamilyProperties();
    for (uint32_t i = 0; i < families.size(); ++i)
        if ((families[i].queueFlags & both) == both && (!surface || physical.getSurfaceSupportKHR(i, surface))) return i;
    return UINT32_MAX;
}

int rank(const vk::raii::PhysicalDevice& physical) {
    switch (physical.getProperties().deviceType) {
        case vk::PhysicalDeviceType::eDiscreteGpu: return 3;
        case vk::PhysicalDeviceType::eIntegratedGpu: return 2;
        case vk::PhysicalDeviceType::eVirtualGpu: return 1;
        default: return 0;
    }
}

void makeInstance(GpuHandles& out, const GpuOptions& options) {
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    const vk::ApplicationInfo application{.pApplicationName = "apertura", .pEngineName = "apertura", .apiVersion = VK_API_VERSION_1_3};
    const vk::DebugUtilsMessengerCreateInfoEXT messenger{.messageSeverity = Severity::eWarning | Severity::eError,
                                                         .messageType = Type::eGeneral | Type::eValidation | Type::ePerformance,
                                                         .pfnUserCallback = keepMessage,
                                                         .pUserData = &out.messages};
    std::vector<const char*> extensions;
    for (const std::string& name : options.instanceExtensions) extensions.push_back(name.c_str());
    vk::InstanceCreateInfo instance{.pApplicationInfo = &application};
    if (options.validate) {
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        const auto layers = out.context.enumerateInstanceLayerProperties();
        if (std::none_of(layers.begin(), layers.end(), [](const auto& l) { return std::strcmp(l.layerName, kValidation) == 0; }))
            throw Error("Vulkan: the validation layer is not installed");
        instance = {.pNext = &messenger, .pApplicationInfo = &application, .enabledLayerCount = 1, .ppEnabledLayerNames = &kValidation};
    }
    instance.enabledExtensionCount = uint32_t(extensions.size());
    instance.ppEnabledExtensionNames = extensions.data();
    out.instance = vk::raii::Instance(out.context, instance);
    if (options.validate) out.messenger = vk::raii::DebugUtilsMessengerEXT(out.instance, messenger);
}

// Creates device and queue of `out.physical`.
void makeDevice(GpuHandles& out, bool half, bool anisotropy, bool statistics) {
    const uint32_t family = usableFamily(out.physical, *out.surface);
    out.family = family;
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue{.queueFamilyIndex = family, .queueCount = 1, .pQueuePriorities = &priority};
    vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables{.pipelineExecutableInfo = true};
    vk::PhysicalDeviceVulkan13Features features{.pNext = statistics ? &executables : nullptr,
                                                .synchronization2 = true,
                                                .dynamicRendering = true,
                                                .maintenance4 = true};  // glslang writes workgroup sizes as LocalSizeId
    const vk::PhysicalDeviceVulkan12Features more{.pNext = &features, .shaderFloat16 = half};
    const vk::PhysicalDeviceFeatures core{.samplerAnisotropy = anisotropy};
    std::vector<const char*> extensions;
    if (statistics) extensions.push_back(VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME);
    if (*out.surface) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    out.device = vk::raii::Device(out.physical, vk::DeviceCreateInfo{.pNext = &more,
                                                                     .queueCreateInfoCount = 1,
                                                                     .pQueueCreateInfos = &queue,
                                                                     .enabledExtensionCount = uint32_t(extensions.size()),
                                                                     .ppEnabledExtensionNames = extensions.data(),
                                                                     .pEnabledFeatures = &core});
    out.queue = vk::raii::Queue(out.device, family, 0);
}

}  // namespace

void GpuHandles::renewSurface() {
    surface = nullptr;
    const VkSurfaceKHR made = makeSurface(*instance);
    if (!made) throw Error("Vulkan: there is no surface to draw to");
    surface = vk::raii::SurfaceKHR(instance, made);
}

Gpu::Gpu(const GpuOptions& options) : handles_(std::make_unique<GpuHandles>()) {
    checked([&] {
        makeInstance(*handles_, options);
        handles_->makeSurface = options.makeSurface;
        if (options.makeSurface) handles_->renewSurface();
        vk::raii::PhysicalDevice& physical = handles_->physical;
        for (vk::raii::PhysicalDevice& candidate : handles_->instance.enumeratePhysicalDevices())
            if (usableFamily(candidate, *handles_->surface) != UINT32_MAX && (!*physical || rank(candidate) > rank(physical)))
                physical = std::move(candidate);
        if (!*physical) throw Error("Vulkan: no device with Vulkan 1.3; Mesa's lavapipe (mesa-vulkan-drivers) is one");
        const vk::PhysicalDeviceProperties properties = physical.getProperties();
        name_ = properties.deviceName.data();
        largestImage_ = properties.limits.maxImageDimension2D;
        largestBuffer_ = std::min<VkDeviceSize>(properties.limits.maxStorageBufferRange, options.largestBuffer);
        if (properties.limits.timestampComputeAndGraphics) clockTick_ = properties.limits.timestampPeriod * 1e-9;
        hasHalf_ = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>()
                       .get<vk::PhysicalDeviceVulkan12Features>()
                       .shaderFloat16;
        hasAnisotropy_ = physical.getFeatures().samplerAnisotropy;
        makeDevice(*handles_, hasHalf_, hasAnisotropy_, options.statistics);
    });
}

Gpu::~Gpu() = default;

const std::vector<std::string>& Gpu::messages() const { return handles_->messages; }

void Gpu::run(const std::function<void(VkCommandBuffer)>& record) const {
    checked([&] {
        const vk::raii::CommandPool pool(handles_->device, vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eTransient,
                                                                                     .queueFamilyIndex = handles_->family});
        const vk::raii::CommandBuffers all(handles_->device, {.commandPool = *pool, .commandBufferCount = 1});
        const vk::raii::Fence done(handles_->device, vk::FenceCreateInfo{});
        const vk::raii::CommandBuffer& commands = all.front();
        commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        record(*commands);
        commands.end();
        {
            const std::lock_guard hold(handles_->queueLock);
            handles_->queue.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &*commands}, *done);
        }
        if (handles_->device.waitForFences(*done, true, UINT64_MAX) != vk::Result::eSuccess) throw Error("Vulkan: a wait ended early");
    });
}

void Gpu::waitIdle() const {
    checked([&] {
        const std::lock_guard hold(handles_->queueLock);
        handles_->queue.waitIdle();
    });
}

GpuCounters Gpu::counters() const {
    const auto& c = handles_->counters;
    return {c.pipelines, c.allocations, c.copiesToHost, c.allocatedBytes};
}

}  // namespace apertura
