#pragma once
// The colours of a scene: glTF materials and their textures, as the baker, the reference and the renderer use them.
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// A texture with its mips, each half of that before, rounded down, to one texel.
struct Texture {
    struct Mip {
        int width = 0, height = 0;
        std::vector<glm::u8vec4> texels;  // sRGB and alpha, row by row from the top
    };
    enum class Wrap { Repeat, Mirror, Clamp };
    std::shared_ptr<const std::vector<Mip>> mips;  // null: not loaded, which is white; textures of one image share them
    bool isLost = false;                           // its image is missing or broken
    Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
    bool nearest = false;  // not interpolated

    // Linear RGB and alpha at a place, interpolated between texels and mips. `level`: of the mips, >= 0; 0: the first.
    glm::vec4 at(const glm::vec2& place, float level = 0) const;
};

enum class TexturesFor { Rays, Pictures };  // those that let rays through, or all
// Decodes textures that are wanted and not there yet. Those that are missing or broken stay white, with a note. No other thread may be at
// work: see IsolatedWork. Throws Error where they take too much memory.
void loadTextures(Scene& scene, TexturesFor use);

// The base colour of a point of a surface, linear; its alpha: 0..1, how much of a ray it stops, 0 or 1 with a mask.
//   spread  metres of the surface over which it is seen, for mips; 0: the textures' first
glm::vec4 baseColourAt(const Scene& scene, const Surface& surface, size_t triangle, const glm::vec3& barycentrics, float spread = 0);
glm::vec3 emissionAt(const Scene& scene, const Surface& surface, size_t triangle, const glm::vec3& barycentrics, float spread = 0);

// The mean base colour of a scene's surfaces by their area, rgb, 0..1, from a texel of its size in the middle of each triangle; `plain` if
// it has no materials or no area.
glm::vec3 meanAlbedo(const Scene& scene, const glm::vec3& plain);

// The material of a surface; one of its own kind where a file with materials has none for it.
const Material& materialOf(const Scene& scene, const Surface& surface);

}  // namespace apertura
