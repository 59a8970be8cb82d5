#pragma once
// A Vulkan device without a window, and where it draws. Every call that fails throws Error naming the call.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace apertura {

struct GpuOptions {
    bool validate = false;    // load VK_LAYER_KHRONOS_validation and keep its messages
    bool statistics = false;  // enable VK_KHR_pipeline_executable_properties
};

struct GpuHandles;  // runtime/render/resources.h

// One device and one queue with graphics and compute; a GPU is preferred to a processor.
class Gpu {
public:
    explicit Gpu(const GpuOptions& options = {});
    ~Gpu();

    const GpuHandles& handles() const { return *handles_; }
    const std::string& name() const { return name_; }
    uint32_t largestImage() const { return largestImage_; }        // pixels a side
    bool hasHalf() const { return hasHalf_; }                      // shaders may compute in 16-bit floats
    double clockTick() const { return clockTick_; }                // seconds a timestamp; 0 where there are none
    VkDeviceSize largestBuffer() const { return largestBuffer_; }  // bytes that a shader can read
    // Warnings and errors of the validation layer so far.
    const std::vector<std::string>& messages() const;

    // Records commands, runs them and waits for their end.
    void run(const std::function<void(VkCommandBuffer)>& record) const;

private:
    std::unique_ptr<GpuHandles> handles_;
    uint32_t largestImage_ = 0;
    bool hasHalf_ = false;
    double clockTick_ = 0;
    VkDeviceSize largestBuffer_ = 0;
    std::string name_;
};

// Images of one size, of a swapchain or others. Pixels hold linear radiance: for a display, a format that
// encodes sRGB by itself.
struct RenderTarget {
    VkImageView colour;  // in COLOR_ATTACHMENT_OPTIMAL
    VkFormat format;     // of `colour`
    VkImageView depth;   // D32_SFLOAT, in DEPTH_ATTACHMENT_OPTIMAL; holds nothing before or after
    VkExtent2D size;     // pixels
};

}  // namespace apertura
