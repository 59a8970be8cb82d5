#pragma once
// A frame of a window: pictures that are drawn to images of their own, shown beside each other.
#include <functional>
#include <vector>

#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/render/draw.h"
#include "apertura/sh/shading.h"

namespace apertura {

// What a frame shows.
struct Composition {
    double split = 1;      // 0..1 of the width, where the second picture begins; 1: there is none
    double exposure = 0;   // stops
    bool toned = false;    // by the neutral curve; false: cut off at 1
    bool heat = false;     // the first picture less the second, instead of the second
    bool isTruth = false;  // the second picture is the one of setTruth
    int samples = 1;       // of a pixel across and down, 1 or 2, of pictures that are drawn
    bool redraw = true;    // false: the pictures that this frame drew before are shown again
};

class Stage {
public:
    static constexpr VkFormat kFormat = VK_FORMAT_R16G16B16A16_SFLOAT;  // of the images that pictures are drawn to

    // `shown`: format of what it is composed to.
    Stage(const Gpu& gpu, vk::Extent2D size, vk::Format shown, int frames);

    vk::Extent2D size() const { return size_; }
    // Where picture 0 or 1 of a frame is drawn, with so many samples.
    RenderTarget target(int frame, int picture, int samples) const;

    // Records the drawing of both pictures, where they are wanted, and their composition over `to`, in COLOR_ATTACHMENT_OPTIMAL.
    //   draw   called with the picture, 0 or 1, and its target
    //   times  of a frame: a pool with room for three timestamps from 3 * frame on, or null
    using Draw = std::function<void(int, const RenderTarget&)>;
    void record(vk::CommandBuffer commands, int frame, const Composition& composition, vk::ImageView to, const Draw& draw,
                const vk::raii::QueryPool* times) const;

    // A picture of the stage's size to compare with. It is copied to the device by the next frames.
    void setTruth(const Picture& picture);

    // What a frame drew, each pixel the mean of its samples. Waits for the device.
    Picture read(int frame, int picture, int samples) const;

private:
    struct Frame {
        std::vector<GpuImage> colours, depths;  // for 1 and for 2 samples of picture 0, then of picture 1
        std::vector<GpuBindings> bindings;      // by kindOf
        GpuImage truth;
        GpuBuffer staging;
        bool truthIsNew = false;
    };
    static size_t imageOf(int picture, int samples) { return size_t(2 * picture + samples - 1); }
    static size_t kindOf(int samples, bool isTruth) { return size_t(2 * (samples - 1) + int(isTruth)); }

    const Gpu& gpu_;
    vk::Extent2D size_;
    PerFrame<AperturaCompose> compose_;
    mutable std::vector<Frame> frames_;
    vk::raii::Pipeline pipeline_ = nullptr;
};

}  // namespace apertura
