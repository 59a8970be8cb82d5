#pragma once
// The camera and the lights of a picture, the same for the Vulkan renderer and for the ray-traced reference.
#include <array>
#include <optional>
#include <vector>

#include "apertura/runtime/asset/scene.h"
#include "apertura/runtime/asset/sky.h"
#include "apertura/sh/shading.h"

namespace apertura {

struct View {
    Camera camera;
    int width = 960, height = 540;  // pixels; each is the mean of 2 x 2 samples
    // At most APERTURA_MAX_LIGHTS. Lights that are seen in one direction hide each other: those at infinity the later ones in this list,
    // lamps all that is farther.
    std::vector<AperturaLight> lights;
    Sky sky;  // where no light is
    // What is seen where no surface and no light is, rgb, W/m2/sr, whatever the sky is that lights the scene; nothing: the sky.
    std::optional<glm::vec3> background;
    glm::vec3 albedo{0.8f};  // rgb, 0..1, of scenes without materials
    bool plain = false;      // all surfaces have that albedo: materials only let through
    // Reflections on other surfaces that light may take on its way. The reference follows so many, by the materials' base colours; models
    // estimate all of them (shaders/bounce.glsl).
    int bounces = 0;
    // From what they do: what the asset stores (bake --bounce) and, where it stores nothing or the view is plain, as if all that blocks the
    // sky had one albedo; so in any case; or as if it had that of the surface itself.
    enum class Around { Baked, Given, Own } around = Around::Baked;
    glm::vec3 aroundAlbedo{0.5f};  // rgb, 0..1; see meanAlbedo (asset/materials.h)
};

// A light at infinity.
//   direction  towards it, of any length
//   radius     angular, radians, 0 < radius <= pi/4
//   radiance   rgb, W/m2/sr
AperturaLight directionalLight(const glm::vec3& direction, double radius, const glm::vec3& radiance);
// A glowing sphere: `centre` and `radius` > 0 in metres, `radiance` rgb in W/m2/sr.
AperturaLight sphereLight(const glm::vec3& centre, double radius, const glm::vec3& radiance);

// The view's lights, each with what is behind it and before it (AperturaLight): what the shaders and aperturaIrradianceBeside take.
std::vector<AperturaLight> arrangedLights(const View& view);

// World to Vulkan's clip space: y down, depth 1 at `nearest` metres and 0 at infinity. `aspect`: width over height.
glm::mat4 clipTransform(const Camera& camera, double aspect, double nearest);

// rays of AperturaFrame, for pictures of this aspect. Their sum is not unit.
std::array<vec4, 3> raysOf(const Camera& camera, double aspect);

// World direction, not unit, through the point (u, v) of the picture; u and v are 0..1 from its top left corner.
glm::vec3 rayThrough(const Camera& camera, double aspect, double u, double v);

constexpr int kShadowTexels = 2048;  // of a shadow map, a side

// How a shadow map of a directional light sees a scene with these bounds (world, metres): its texels cover all of it.
AperturaShadowView shadowViewOf(const AperturaLight& light, const Box& bounds);

}  // namespace apertura
