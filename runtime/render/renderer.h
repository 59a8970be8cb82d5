#pragma once
// Draws a baked scene with Vulkan, off-screen or to a target of the caller's.
#include <memory>
#include <span>

#include "runtime/asset/asset.h"
#include "runtime/asset/picture.h"
#include "runtime/asset/view.h"
#include "runtime/render/vulkan.h"
#include "sh/models.h"

namespace apertura {

// The formulas that the lights of a view need: LIGHTS_...
int lightClassOf(const View& view);

class Renderer {
public:
    // Uploads the geometry, once. `gpu` and `asset` must outlive it. `frames`: how many may be recorded whose
    // commands the device has not finished.
    Renderer(const Gpu& gpu, const Asset& asset, int frames = 2);
    ~Renderer();

    // Uploads the parameters of a model (made from the four numbers, or the one that the asset stores) and makes
    // its pipeline, from the one shader, for lights of a class and targets of a format; what is there already it
    // leaves. Takes up to seconds, and the device's queue: on another thread than the one that records or
    // submits only while that one does neither. Throws Error where the asset does not hold the model, or its
    // parameters are too large for the device.
    void prepare(const Model& model, int lightClass, VkFormat format);

    // Clears the target to the sky and draws the scene over it. Allocates nothing, waits for nothing and compiles
    // nothing; the view's width and height do not matter. `frame`, 0 .. frames - 1: the device must have finished
    // what was recorded with that number before. All frames run on one queue. Throws Error unless the model is
    // prepared for lightClassOf(view) and the target's format.
    void record(VkCommandBuffer commands, const RenderTarget& target, const View& view, const Model& model, int frame) const;

    // The scene through one model, off-screen. Prepares what is missing. Throws Error as `prepare` does, or where
    // the picture is too large for the device.
    Picture draw(const View& view, const Model& model);

    // The same three of the baseline: N.L, a shadow map of 2048 texels a side and percentage-closer soft shadows;
    // no occlusion of the sky. They draw views with one light, from a direction, and throw Error at others.
    void prepareShadowMapped(VkFormat format);
    void recordShadowMapped(VkCommandBuffer commands, const RenderTarget& target, const View& view, int frame) const;
    Picture drawShadowMapped(const View& view);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

// irradianceThrough and skyIrradiance (x, y) of a model on the device, for each of `inputs`; `lightClass` LIGHTS_... With `half` in
// 16-bit floats, for a device that offers them.
std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const Evaluation> inputs, bool half = false);

}  // namespace apertura
