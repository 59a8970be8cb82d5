#pragma once
// A height field's horizons as a source of occlusion, in place of rays.
#include "apertura/bake/sampling/horizons.h"
#include "apertura/bake/sampling/occlusion.h"

namespace apertura {

// What a sweep found, for points whose (x, z) lie on a texel of the field or near one: they take the horizon of the nearest. The field's
// middle lies over the world's origin, as fullMesh has it. Between azimuths horizons are interpolated.
class HorizonOcclusion : public OcclusionSource {
public:
    // `azimuths` is even. Takes 2 bytes for each texel and azimuth. Throws Cancelled.
    HorizonOcclusion(const HeightField& field, int azimuths, const HorizonOptions& options, const Progress& progress = {});
    void occluded(const SurfacePoint& point, std::span<const glm::vec3> directions, uint8_t* blocked) const override;

private:
    int width_, height_, azimuths_;
    double spacingX_, spacingZ_;
    std::vector<int16_t> heights_;  // 32767 sin h of each texel, azimuth by azimuth
};

}  // namespace apertura
