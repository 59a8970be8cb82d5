#pragma once
// A Vulkan device without a window, and the few things the renderer needs of it. Every call that fails
// throws Error naming the call.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace apertura {

struct GpuOptions {
    bool validate = false;  // load VK_LAYER_KHRONOS_validation and keep its messages
    bool statistics = false;  // enable VK_KHR_pipeline_executable_properties
};

// One device and one queue with graphics and compute; a GPU is preferred to a processor.
class Gpu {
public:
    explicit Gpu(const GpuOptions& options = {});
    ~Gpu();
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    VkDevice device() const { return device_; }
    const std::string& name() const { return name_; }
    uint32_t largestImage() const { return largestImage_; }  // pixels a side
    bool hasHalf() const { return hasHalf_; }  // shaders may compute in 16-bit floats
    double clockTick() const { return clockTick_; }         // seconds a timestamp; 0 where there are none
    VkDeviceSize largestBuffer() const { return largestBuffer_; }  // bytes that a shader can read
    // Warnings and errors of the validation layer so far.
    const std::vector<std::string>& messages() const { return *messages_; }

    uint32_t memoryType(uint32_t allowed, VkMemoryPropertyFlags wanted) const;
    // Records commands, runs them and waits for their end.
    void run(const std::function<void(VkCommandBuffer)>& record) const;

private:
    void release();

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    uint32_t family_ = 0, largestImage_ = 0;
    bool hasHalf_ = false;
    double clockTick_ = 0;
    VkDeviceSize largestBuffer_ = 0;
    std::string name_;
    std::unique_ptr<std::vector<std::string>> messages_;
};

void check(VkResult result, const char* call);

// A buffer with memory of its own.
class GpuBuffer {
public:
    enum class Place { Device, Host };
    GpuBuffer(const Gpu& gpu, VkDeviceSize bytes, VkBufferUsageFlags usage, Place place);
    ~GpuBuffer();
    GpuBuffer(const GpuBuffer&) = delete;
    GpuBuffer& operator=(const GpuBuffer&) = delete;

    VkBuffer handle() const { return buffer_; }
    VkDeviceSize bytes() const { return bytes_; }
    void* data() const { return mapped_; }  // Host only; coherent

private:
    const Gpu& gpu_;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize bytes_;
    void* mapped_ = nullptr;
};

// A buffer in device memory that holds `bytes`.
std::unique_ptr<GpuBuffer> upload(const Gpu& gpu, std::span<const std::byte> bytes, VkBufferUsageFlags usage);

// A two-dimensional image with one view and memory of its own.
class GpuImage {
public:
    GpuImage(const Gpu& gpu, uint32_t width, uint32_t height, VkFormat format, VkImageUsageFlags usage,
             VkImageAspectFlags aspect);
    ~GpuImage();
    GpuImage(const GpuImage&) = delete;
    GpuImage& operator=(const GpuImage&) = delete;

    VkImage handle() const { return image_; }
    VkImageView view() const { return view_; }
    // Moves it between layouts, with a full barrier.
    void transition(VkCommandBuffer commands, VkImageLayout from, VkImageLayout to) const;

private:
    const Gpu& gpu_;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkImageAspectFlags aspect_;
};

// Makes what `stage` wrote with `access` visible to the host once the commands have run.
void letHostRead(VkCommandBuffer commands, VkPipelineStageFlags2 stage, VkAccessFlags2 access);

// A shader module from SPIR-V words; destroyed with it.
class GpuShader {
public:
    GpuShader(const Gpu& gpu, std::span<const uint32_t> words);
    ~GpuShader();
    GpuShader(const GpuShader&) = delete;
    GpuShader& operator=(const GpuShader&) = delete;
    VkShaderModule handle() const { return module_; }

private:
    const Gpu& gpu_;
    VkShaderModule module_ = VK_NULL_HANDLE;
};

// One descriptor set of buffers, bindings 0, 1, ..., and a pipeline layout for it. Where a buffer is null
// there is the layout alone, to compile for.
class GpuBindings {
public:
    struct Binding {
        VkDescriptorType type;
        VkShaderStageFlags stages;
        const GpuBuffer* buffer;
        const GpuImage* image = nullptr;  // in SHADER_READ_ONLY_OPTIMAL, instead of a buffer
    };
    GpuBindings(const Gpu& gpu, std::span<const Binding> bindings);
    ~GpuBindings();
    GpuBindings(const GpuBindings&) = delete;
    GpuBindings& operator=(const GpuBindings&) = delete;

    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSet set() const { return set_; }

private:
    const Gpu& gpu_;
    VkDescriptorSetLayout setLayout_ = VK_NULL_HANDLE;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
};

}  // namespace apertura
