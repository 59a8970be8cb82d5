#pragma once
// The lighting formulas of shaders/, as C++ through GLM: the same text that the GPU runs, in float32.
#include <glm/glm.hpp>

namespace apertura {

using namespace glm;

using lpfloat = float;
using lpvec2 = vec2;
using lpvec3 = vec3;
using lpvec4 = vec4;
constexpr float lpsmall(double x) { return float(x); }
constexpr float lplarge(double x) { return float(x); }

// The depths of a shadow map, as soft_shadow.glsl reads them.
struct ShadowDepths {
    virtual ~ShadowDepths() = default;
    virtual float at(ivec2 texel) const = 0;
};
inline float shadowDepth(const ShadowDepths& map, ivec2 texel) { return map.at(texel); }
#define APERTURA_SHADOW_MAP const ShadowDepths&

#define APERTURA_CPP
#define APERTURA_FN inline
#define APERTURA_STD140 alignas(16)
#include "shaders/evaluate.glsl"
#include "shaders/frame.glsl"
#include "shaders/lattice.glsl"
#include "shaders/models.glsl"
#include "shaders/soft_shadow.glsl"
#include "shaders/texels.glsl"
#include "shaders/visible.glsl"
#undef APERTURA_CPP
#undef APERTURA_SHADOW_MAP
#undef APERTURA_FN
#undef APERTURA_STD140

}  // namespace apertura
