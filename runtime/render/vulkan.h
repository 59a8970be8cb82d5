#pragma once
// A Vulkan device without a window, and the targets that it draws to. Every Vulkan call that fails throws Error naming it.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace apertura {

struct GpuOptions {
    bool validate = false;                    // load VK_LAYER_KHRONOS_validation and keep its messages
    bool statistics = false;                  // enable VK_KHR_pipeline_executable_properties
    VkDeviceSize largestBuffer = UINT64_MAX;  // bytes: as if the device bound none that is larger
    // For a window: what the instance needs, and a function that makes a surface on it, or returns VK_NULL_HANDLE.
    std::vector<std::string> instanceExtensions{};
    std::function<VkSurfaceKHR(VkInstance)> makeSurface{};
};

// What was made and moved on a Gpu so far.
struct GpuCounters {
    uint64_t pipelines = 0, allocations = 0, copiesToHost = 0;
    uint64_t allocatedBytes = 0;  // that are still held
};

struct GpuHandles;  // runtime/render/resources.h

// One device with Vulkan 1.3 and one queue with graphics and compute, which presents to the surface where there is one. A GPU is preferred
// to a software device. The constructor throws Error if there is none, or no validation layer where that is asked for.
class Gpu {
public:
    explicit Gpu(const GpuOptions& options = {});
    ~Gpu();

    GpuHandles& handles() const { return *handles_; }
    const std::string& name() const { return name_; }
    uint32_t largestImage() const { return largestImage_; }        // pixels per side
    bool hasHalf() const { return hasHalf_; }                      // shaders may compute in 16-bit floats
    bool hasAnisotropy() const { return hasAnisotropy_; }          // textures may be filtered along a direction
    double clockTick() const { return clockTick_; }                // seconds per timestamp tick; 0: no timestamps
    VkDeviceSize largestBuffer() const { return largestBuffer_; }  // bytes of a storage buffer
    // Warnings and errors of the validation layer so far; empty without GpuOptions::validate.
    const std::vector<std::string>& messages() const;

    // Calls `record`, submits what it recorded and waits until the device has finished that. From any thread.
    void run(const std::function<void(VkCommandBuffer)>& record) const;
    // Waits for all that was submitted.
    void waitIdle() const;
    GpuCounters counters() const;

private:
    std::unique_ptr<GpuHandles> handles_;
    uint32_t largestImage_ = 0;
    bool hasHalf_ = false, hasAnisotropy_ = false;
    double clockTick_ = 0;
    VkDeviceSize largestBuffer_ = 0;
    std::string name_;
};

// Images to draw to, from a swapchain or elsewhere, all of one size. Pixels hold linear radiance: use an _SRGB format for
// a display.
struct RenderTarget {
    VkImageView colour;  // in COLOR_ATTACHMENT_OPTIMAL
    VkFormat format;     // of `colour`
    VkImageView depth;   // D32_SFLOAT, in DEPTH_ATTACHMENT_OPTIMAL; its content is not used and not kept
    VkExtent2D size;     // pixels
};

}  // namespace apertura
