#pragma once
// The images of a window.
#include <optional>
#include <vector>

#include "apertura/runtime/render/resources.h"

namespace apertura {

// Made for the surface of a Gpu. Calls that use the queue hold its lock.
class Swapchain {
public:
    // `wanted`: pixels, where the surface leaves the size to us.
    Swapchain(const Gpu& gpu, vk::Extent2D wanted);

    // Makes the images anew, and the surface too where it is lost. The device must have finished with them.
    void renew(vk::Extent2D wanted);

    // The next image to draw to, which `ready` is signalled for; nullopt: the window has changed, renew.
    std::optional<uint32_t> acquire(vk::Semaphore ready);
    // Shows it once `drawn` is signalled. False: the window has changed, renew.
    bool present(uint32_t image, vk::Semaphore drawn);

    bool isVisible() const { return !views_.empty(); }  // false: the window has no area
    vk::Format format() const { return format_; }       // an _SRGB format: pixels take linear radiance
    vk::Extent2D size() const { return size_; }
    uint32_t count() const { return uint32_t(views_.size()); }
    vk::Image image(uint32_t i) const { return images_[i]; }
    vk::ImageView view(uint32_t i) const { return *views_[i]; }

private:
    void make(vk::Extent2D wanted);

    const Gpu& gpu_;
    bool surfaceLost_ = false;
    vk::Format format_ = vk::Format::eUndefined;
    vk::Extent2D size_;
    vk::raii::SwapchainKHR chain_ = nullptr;
    std::vector<vk::Image> images_;
    std::vector<vk::raii::ImageView> views_;
};

}  // namespace apertura
