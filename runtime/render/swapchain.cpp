#include "apertura/runtime/render/swapchain.h"

#include <algorithm>

namespace apertura {

Swapchain::Swapchain(const Gpu& gpu, vk::Extent2D wanted) : gpu_(gpu) { make(wanted); }

void Swapchain::renew(vk::Extent2D wanted) {
    views_.clear();
    if (surfaceLost_) {
        chain_ = nullptr;
        checked([&] { gpu_.handles().renewSurface(); });
        surfaceLost_ = false;
    }
    make(wanted);
}

void Swapchain::make(vk::Extent2D wanted) {
    checked([&] {
        const GpuHandles& handles = gpu_.handles();
        const vk::SurfaceKHR surface = *handles.surface;
        vk::SurfaceFormatKHR chosen{};
        for (const vk::SurfaceFormatKHR& f : handles.physical.getSurfaceFormatsKHR(surface))
            if (chosen.format == vk::Format::eUndefined && f.colorSpace == vk::ColorSpaceKHR::eSrgbNonlinear
                && (f.format == vk::Format::eB8G8R8A8Srgb || f.format == vk::Format::eR8G8B8A8Srgb))
                chosen = f;
        if (chosen.format == vk::Format::eUndefined) throw Error("Vulkan: " + gpu_.name() + " shows no sRGB images in this window");
        const vk::SurfaceCapabilitiesKHR can = handles.physical.getSurfaceCapabilitiesKHR(surface);
        const bool free = can.currentExtent.width == UINT32_MAX;
        size_ = free ? vk::Extent2D{std::clamp(wanted.width, can.minImageExtent.width, can.maxImageExtent.width),
                                    std::clamp(wanted.height, can.minImageExtent.height, can.maxImageExtent.height)}
                     : can.currentExtent;
        format_ = chosen.format;
        views_.clear();
        if (size_.width == 0 || size_.height == 0) return;
        uint32_t count = std::max(can.minImageCount + 1, 3u);
        if (can.maxImageCount > 0) count = std::min(count, can.maxImageCount);
        const vk::raii::SwapchainKHR old = std::move(chain_);
        chain_ = vk::raii::SwapchainKHR(handles.device, vk::SwapchainCreateInfoKHR{.surface = surface,
                                                                                   .minImageCount = count,
                                                                                   .imageFormat = chosen.format,
                                                                                   .imageColorSpace = chosen.colorSpace,
                                                                                   .imageExtent = size_,
                                                                                   .imageArrayLayers = 1,
                                                                                   .imageUsage = vk::ImageUsageFlagBits::eColorAttachment,
                                                                                   .preTransform = can.currentTransform,
                                                                                   .compositeAlpha = vk::CompositeAlphaFlagBitsKHR::eOpaque,
                                                                                   .presentMode = vk::PresentModeKHR::eFifo,
                                                                                   .clipped = true,
                                                                                   .oldSwapchain = *old});
        images_.clear();
        for (const VkImage image : chain_.getImages()) {
            images_.emplace_back(image);
            views_.emplace_back(handles.device, vk::ImageViewCreateInfo{.image = image,
                                                                        .viewType = vk::ImageViewType::e2D,
                                                                        .format = format_,
                                                                        .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1}});
        }
    });
}

std::optional<uint32_t> Swapchain::acquire(vk::Semaphore ready) {
    if (!isVisible()) return std::nullopt;
    try {
        const auto [result, image] = chain_.acquireNextImage(UINT64_MAX, ready);
        return image;
    } catch (const vk::OutOfDateKHRError&) {
        return std::nullopt;
    } catch (const vk::SurfaceLostKHRError&) {
        surfaceLost_ = true;
        return std::nullopt;
    } catch (const vk::SystemError& e) {
        throw Error(std::string("Vulkan: ") + e.what());
    }
}

bool Swapchain::present(uint32_t image, vk::Semaphore drawn) {
    try {
        const std::lock_guard hold(gpu_.handles().queueLock);
        return gpu_.handles().queue.presentKHR({.waitSemaphoreCount = 1,
                                                .pWaitSemaphores = &drawn,
                                                .swapchainCount = 1,
                                                .pSwapchains = &*chain_,
                                                .pImageIndices = &image})
            == vk::Result::eSuccess;
    } catch (const vk::OutOfDateKHRError&) {
        return false;
    } catch (const vk::SurfaceLostKHRError&) {
        surfaceLost_ = true;
        return false;
    } catch (const vk::SystemError& e) {
        throw Error(std::string("Vulkan: ") + e.what());
    }
}

}  // namespace apertura
