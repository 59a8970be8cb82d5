#pragma once
// Draws a baked scene with Vulkan, off-screen or to the caller's target.
#include <memory>
#include <span>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/asset/view.h"
#include "apertura/runtime/render/vulkan.h"
#include "apertura/sh/models.h"

namespace apertura {

// The class that covers all lights of a view, APERTURA_LIGHTS_...; APERTURA_LIGHTS_ANY if one is a sphere.
int lightClassOf(const View& view);

// Where light is evaluated. Vertices: once a vertex and frame, in a compute pass, which costs less wherever fewer vertices than pixels are
// drawn. For models that do not mix the picture is the same under suns and other lights of up to 3 degrees; under larger ones and lamps,
// which a vertex sees a little differently from its pixels, nearly so (tests/light_at_test.cpp). Samples on faces are read at pixels alone.
enum class LightAt { Pixels, Vertices };

// One thread may prepare while another one records frames: what is not prepared yet is not drawn with. `prepareSky` waits for all frames,
// and no other call may run beside it.
class Renderer {
public:
    // Uploads the geometry, in parts if the device binds no buffer of its size.
    //   gpu, asset  must outlive the renderer
    //   frames      frames in flight: how many may be recorded before the device has finished the first; 2 is usual
    Renderer(const Gpu& gpu, const Asset& asset, int frames = 2);
    ~Renderer();

    // The better of the two: vertices, where the model does not mix, no face has samples of its own, and there are fewer
    // vertices than corners of so many pixels. `draw` shades four pixels for one of the picture.
    LightAt betterLightAt(const Model& model, double pixels) const;

    // Uploads a model's parameters and creates its pipelines; does nothing if all exist. It takes up to seconds.
    //   model       the one that the asset stores, or one that is derived from the four numbers
    //   lightClass  APERTURA_LIGHTS_..., see lightClassOf
    //   format      of the target's colour
    //   mostLights  of a frame. 1 makes a faster pipeline, which serves frames of just one light; others any number. At the vertices,
    //               each light takes 4 bytes a vertex and frame
    //   bounces     APERTURA_BOUNCES_..., see bouncesOf
    // Throws Error if the asset does not hold the model, the device has too little memory, or mostLights is above APERTURA_MAX_LIGHTS.
    void prepare(const Model& model, int lightClass, VkFormat format, LightAt at = LightAt::Pixels, int mostLights = APERTURA_MAX_LIGHTS,
                 int bounces = 0);

    // Of a view of the asset, where what surfaces reflect is taken from: APERTURA_BOUNCES_...
    int bouncesOf(const View& view) const;

    // Uploads the picture of a sky, unless it is there already; a sky of one radiance needs none. Throws Error if it is too large.
    void prepareSky(const Sky& sky);

    // Clears the target and draws the scene, the sky about it and lights that are seen. Allocates nothing, waits for nothing, compiles
    // nothing.
    //   view   its width and height are ignored
    //   frame  0 .. frames - 1; the device must have finished what was recorded with this number before
    // All frames must run on one queue. Throws Error unless `model` is prepared for lightClassOf(view), the format, `at`, bounces and as
    // many lights, or if its sky's picture is not, and if `frame` is out of range or the view has more than APERTURA_MAX_LIGHTS lights.
    void record(VkCommandBuffer commands, const RenderTarget& target, const View& view, const Model& model, int frame,
                LightAt at = LightAt::Pixels) const;

    // Draws a picture off-screen with one model and prepares what is missing. Throws Error as `prepare` does, or if the
    // picture is too large for the device.
    Picture draw(const View& view, const Model& model, LightAt at = LightAt::Pixels);

    // The same three functions for the baseline: N.L, a shadow map of 2048 x 2048 texels with percentage-closer soft
    // shadows, and a sky that nothing blocks. The last two throw Error unless the view has exactly one light, a directional one;
    // recordShadowMapped also if it is not prepared for the format or the sky.
    void prepareShadowMapped(VkFormat format);
    void recordShadowMapped(VkCommandBuffer commands, const RenderTarget& target, const View& view, int frame) const;
    Picture drawShadowMapped(const View& view);

private:
    struct State;
    std::unique_ptr<State> state_;
};

// Evaluates a model on the device: x is aperturaIrradianceThrough, y aperturaSkyIrradiance, one element per input.
//   model, lightClass  APERTURA_MODEL_..., APERTURA_LIGHTS_...
//   half               compute in 16-bit floats; needs Gpu::hasHalf
std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const AperturaEvaluation> inputs,
                                   bool half = false);

}  // namespace apertura
