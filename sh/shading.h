#pragma once
// The lighting formulas of shaders/, as C++ through GLM: the same text that the GPU runs, in float32.
#include <glm/glm.hpp>

namespace apertura {

using namespace glm;

using AperturaFloat = float;
using AperturaVec2 = vec2;
using AperturaVec3 = vec3;
using AperturaVec4 = vec4;
constexpr float aperturaSmall(double x) { return float(x); }
constexpr float aperturaLarge(double x) { return float(x); }

// The depths of a shadow map, as soft_shadow.glsl reads them.
struct ShadowDepths {
    virtual ~ShadowDepths() = default;
    virtual float at(ivec2 texel) const = 0;
};
inline float aperturaShadowDepth(const ShadowDepths& map, ivec2 texel) { return map.at(texel); }
#define APERTURA_SHADOW_MAP const ShadowDepths&

#define APERTURA_CPP
#define APERTURA_FN inline
#define APERTURA_STD140 alignas(16)
#include "apertura/shaders/background.glsl"
#include "apertura/shaders/compose.glsl"
#include "apertura/shaders/evaluate.glsl"
#include "apertura/shaders/frame.glsl"
#include "apertura/shaders/lattice.glsl"
#include "apertura/shaders/models.glsl"
#include "apertura/shaders/soft_shadow.glsl"
#include "apertura/shaders/texels.glsl"
#include "apertura/shaders/tone.glsl"
#include "apertura/shaders/visible.glsl"

// The lights of a frame.
#define APERTURA_LIGHT_LIST const AperturaLight*
inline const AperturaLight& aperturaLightAt(const AperturaLight* lights, int i) { return lights[i]; }
#include "apertura/shaders/lights.glsl"
#undef APERTURA_LIGHT_LIST
#undef APERTURA_CPP
#undef APERTURA_SHADOW_MAP
#undef APERTURA_FN
#undef APERTURA_STD140

}  // namespace apertura
