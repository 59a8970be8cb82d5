#pragma once
// What shines on a scene from where no light stands.
#include <memory>
#include <string>

#include "apertura/runtime/asset/picture.h"
#include "apertura/sh/shading.h"

namespace apertura {

// Radiance from all directions, rgb, W/m2/sr: the same everywhere, or that of an equirectangular picture (aperturaPlaceInSky). Copies
// share the picture.
class Sky {
public:
    Sky(const glm::vec3& radiance = {0.11f, 0.2f, 0.42f});  // NOLINT(google-explicit-constructor): a colour is a sky
    // Throws Error, which `name` begins, unless the picture is twice as wide as high and each of its numbers is 0..1e12.
    Sky(Picture picture, const std::string& name);

    // Radiance in a direction (unit), interpolated between the picture's pixels.
    glm::vec3 towards(const glm::vec3& direction) const;
    // The mean over a cap.
    glm::vec3 meanOver(const AperturaCapLight& cap) const;
    const AperturaSky& bands() const { return bands_; }
    const std::shared_ptr<const Picture>& picture() const { return picture_; }  // null: the same radiance everywhere

private:
    AperturaSky bands_{};
    std::shared_ptr<const Picture> picture_;
};

// Reads .exr or .hdr. Throws Error naming `path` as Sky does, or if it cannot be read. No other thread may be at work: see IsolatedWork.
Sky readSky(const std::string& path);

}  // namespace apertura
