#pragma once
// Draws what is seen beside the scene: the sky and the lights themselves.
#include <array>
#include <map>
#include <mutex>
#include <optional>

#include "apertura/runtime/asset/sky.h"
#include "apertura/runtime/render/draw.h"

namespace apertura {

class Background {
public:
    // `lit` must outlive it.
    Background(const Gpu& gpu, const PerFrame<AperturaFrame>& lit);

    // Uploads the sky's picture, unless it is there; the device must have finished with the one before. Throws Error if it is too large for
    // the device.
    void setSky(const Gpu& gpu, const PerFrame<AperturaFrame>& lit, const Sky& sky);
    bool shows(const Sky& sky) const { return sky.picture() == picture_; }

    // Creates the pipelines for targets of this format; others may draw meanwhile.
    void prepare(const Gpu& gpu, vk::Format format);
    // Draws over what nothing covers yet, or stands farther than a lamp. `offset`: bytes, of a frame in `lit`.
    void draw(const DrawPass& pass, vk::Format format, bool lamps, uint32_t offset) const;

private:
    void bind(const Gpu& gpu, const PerFrame<AperturaFrame>& lit);

    std::shared_ptr<const Picture> picture_;
    vk::raii::Sampler sampler_;
    GpuImage image_;
    std::optional<GpuBindings> bindings_;
    std::map<vk::Format, std::array<vk::raii::Pipeline, 2>> pipelines_;  // without lamps, and with some
    mutable std::mutex lock_;                                            // of them
};

}  // namespace apertura
