#include "apertura/sh/soft.h"

#include <algorithm>

namespace apertura {
namespace {

const vec4 kNodes[] = {
#include "soft_table.inc"
};

inline vec4 aperturaSoftNode(int i) { return kNodes[i]; }

#define APERTURA_FN inline
#include "apertura/shaders/soft_table.glsl"
#undef APERTURA_FN

static_assert(std::size(kNodes) == size_t(APERTURA_SOFT_AREAS * APERTURA_SOFT_PSIS * APERTURA_SOFT_REACHES));

}  // namespace

std::span<const vec4> softNodes() { return kNodes; }

AperturaSoftAperture toSoft(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const vec4 soft = aperturaSoftFrom(v.direction, v.area, normal);
    return {vec3(soft), soft.w};
}

vec4 limitedLobe(const vec4& lobe) { return aperturaLimitSharpness(lobe); }

}  // namespace apertura
