#include "sh/soft.h"

#include <algorithm>

namespace apertura {
namespace {

const vec4 kNodes[] = {
#include "soft_table.inc"
};

inline vec4 softNode(int i) { return kNodes[i]; }

#define APERTURA_FN inline
#include "shaders/soft_table.glsl"
#undef APERTURA_FN

static_assert(std::size(kNodes) == size_t(SOFT_AREAS * SOFT_PSIS * SOFT_REACHES));

}  // namespace

std::span<const vec4> softNodes() { return kNodes; }

SoftAperture toSoft(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const vec4 soft = softFrom(v.direction, v.area, normal);
    return {vec3(soft), soft.w};
}

vec4 limitedLobe(const vec4& lobe) { return limitSharpness(lobe); }

}  // namespace apertura
