#pragma once
// The handles of a Gpu, and the objects created on it, each of which owns its Vulkan handles. A failed call throws Error.
// Include this only to work with handles: vulkan_raii.hpp takes seconds to compile.
#define VULKAN_HPP_NO_STRUCT_CONSTRUCTORS  // allows designated initialisers
#include <vulkan/vulkan_raii.hpp>

#include <atomic>
#include <cstring>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/render/vulkan.h"

namespace apertura {

// Members are destroyed from the last to the first. The messenger writes to `messages`: the struct must not move.
struct GpuHandles {
    std::vector<std::string> messages;
    vk::raii::Context context;
    vk::raii::Instance instance = nullptr;
    vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
    vk::raii::SurfaceKHR surface = nullptr;
    std::function<VkSurfaceKHR(VkInstance)> makeSurface;
    vk::raii::PhysicalDevice physical = nullptr;
    vk::raii::Device device = nullptr;
    vk::raii::Queue queue = nullptr;
    uint32_t family = 0;   // of the queue
    std::mutex queueLock;  // held while something is submitted or presented
    struct {
        std::atomic<uint64_t> pipelines = 0, allocations = 0, copiesToHost = 0, allocatedBytes = 0;
    } counters;

    // Makes the surface anew, as after a loss. Throws Error if that fails.
    void renewSurface();
};

// Returns what `call` returns; turns vk::SystemError into Error.
template <class Call>
auto checked(const Call& call) {
    try {
        return call();
    } catch (const vk::SystemError& e) {
        throw Error(std::string("Vulkan: ") + e.what());
    }
}

// Creates a handle on the device. `arguments`: those of its constructor after the device.
template <class Handle, class... Arguments>
Handle make(const Gpu& gpu, const Arguments&... arguments) {
    return checked([&] { return Handle(gpu.handles().device, arguments...); });
}

// Device memory that is counted while it is held.
class GpuMemory {
public:
    GpuMemory() = default;
    GpuMemory(const Gpu& gpu, const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags wanted);
    GpuMemory(GpuMemory&& other) noexcept { *this = std::move(other); }
    GpuMemory& operator=(GpuMemory&& other) noexcept;
    ~GpuMemory() { release(); }
    const vk::raii::DeviceMemory& operator*() const { return memory_; }

private:
    void release() noexcept;
    vk::raii::DeviceMemory memory_ = nullptr;
    GpuHandles* handles_ = nullptr;
    VkDeviceSize bytes_ = 0;
};

// A buffer with its own memory, of `bytes` bytes or 16, whichever is more.
class GpuBuffer {
public:
    enum class Place { Device, Host };
    GpuBuffer(const Gpu& gpu, VkDeviceSize bytes, vk::BufferUsageFlags usage, Place place);

    vk::Buffer handle() const { return *buffer_; }
    void* data() const { return mapped_; }  // Place::Host only, else null; coherent

private:
    GpuMemory memory_;
    vk::raii::Buffer buffer_;
    void* mapped_ = nullptr;
};

// A buffer in device memory that holds `bytes`.
GpuBuffer upload(const Gpu& gpu, std::span<const std::byte> bytes, vk::BufferUsageFlags usage);

// A two-dimensional image with its mips, one view of all and its own memory.
class GpuImage {
public:
    GpuImage(const Gpu& gpu, vk::Extent2D size, vk::Format format, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect,
             uint32_t mips = 1);

    vk::Image handle() const { return *image_; }
    vk::ImageView view() const { return *view_; }
    // Changes the layout, with a full barrier.
    void transition(vk::CommandBuffer commands, vk::ImageLayout from, vk::ImageLayout to) const;

private:
    GpuMemory memory_;
    vk::raii::Image image_;
    vk::raii::ImageView view_ = nullptr;
    vk::ImageAspectFlags aspect_;
};

// An image for shaders to read, in SHADER_READ_ONLY_OPTIMAL. `mips`: the pixels of each, row by row from the top; the first has `size`,
// each other one half of that before, rounded down.
GpuImage uploadImage(const Gpu& gpu, vk::Extent2D size, vk::Format format, const std::vector<std::span<const std::byte>>& mips);

// Makes what `stage` wrote with `access` visible to the host once the commands have run.
void letHostRead(vk::CommandBuffer commands, vk::PipelineStageFlags2 stage, vk::AccessFlags2 access);

// One descriptor set with bindings 0, 1, ... and its pipeline layout. If a buffer is null there is the layout alone, which
// is enough to compile pipelines.
class GpuBindings {
public:
    struct Binding {
        vk::DescriptorType type;
        vk::ShaderStageFlags stages;
        const GpuBuffer* buffer;
        const GpuImage* image = nullptr;     // instead of a buffer, in SHADER_READ_ONLY_OPTIMAL
        VkDeviceSize range = VK_WHOLE_SIZE;  // of the buffer, bytes
        vk::Sampler sampler{};               // of the image, for eCombinedImageSampler
    };
    // `second`: the layout of set 1, if pipelines have one.
    GpuBindings(const Gpu& gpu, std::span<const Binding> bindings, vk::DescriptorSetLayout second = {});

    vk::PipelineLayout layout() const { return *layout_; }
    // `offsets`: bytes, one per dynamic buffer, in the order of the bindings.
    void bind(vk::CommandBuffer commands, vk::PipelineBindPoint point, std::span<const uint32_t> offsets = {}) const;

private:
    vk::raii::DescriptorSetLayout setLayout_ = nullptr;
    vk::raii::DescriptorPool pool_ = nullptr;
    vk::raii::DescriptorSet set_ = nullptr;
    vk::raii::PipelineLayout layout_ = nullptr;
};

// One T per frame in flight, in a uniform buffer that is bound at the frame's offset.
template <class T>
class PerFrame {
public:
    PerFrame(const Gpu& gpu, int frames)
        : buffer_(gpu, VkDeviceSize(offset(frames)), vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host) {}

    // Bytes. A multiple of 256, the largest alignment that Vulkan lets a device require.
    static uint32_t offset(int frame) { return uint32_t(frame) * ((sizeof(T) + 255) / 256 * 256); }
    void set(int frame, const T& value) const {
        std::memcpy(static_cast<std::byte*>(buffer_.data()) + offset(frame), &value, sizeof value);
    }
    GpuBindings::Binding binding(vk::ShaderStageFlags stages) const {
        return {vk::DescriptorType::eUniformBufferDynamic, stages, &buffer_, nullptr, sizeof(T)};
    }

private:
    GpuBuffer buffer_;
};

// Values of the specialisation constants 0, 1, ...; `values` must outlive the struct.
struct Constants {
    explicit Constants(std::span<const int32_t> values);
    Constants(const Constants&) = delete;
    std::vector<vk::SpecializationMapEntry> entries;
    vk::SpecializationInfo info;
};

// A compute pipeline, and a shader module, from SPIR-V in `words`. `constants`: specialisation constants 0, 1, ...
vk::raii::Pipeline makeComputePipeline(const Gpu& gpu, std::span<const uint32_t> words, std::span<const int32_t> constants,
                                       const GpuBindings& bindings, vk::PipelineCreateFlags flags = {});
vk::raii::ShaderModule makeShader(const Gpu& gpu, std::span<const uint32_t> words);

}  // namespace apertura
