#pragma once
// The lighting formulas of shaders/, as C++ through GLM: the same text that the GPU runs, in float32.
#include <glm/glm.hpp>

namespace apertura {

using namespace glm;

#define APERTURA_FN inline
#define APERTURA_STD140 alignas(16)
#include "shaders/evaluate.glsl"
#include "shaders/frame.glsl"
#include "shaders/models.glsl"
#include "shaders/shadow.glsl"
#undef APERTURA_FN
#undef APERTURA_STD140

}  // namespace apertura
