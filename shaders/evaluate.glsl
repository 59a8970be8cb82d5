// One evaluation of a model, as evaluate.comp reads it: the same layout (std430) in GLSL and in C++.
#ifndef APERTURA_EVALUATE_GLSL
#define APERTURA_EVALUATE_GLSL
#include "models.glsl"

struct AperturaEvaluation {
    vec4 normal;      // xyz
    vec4 light;       // xyz: axis; w: sinRadius
    vec4 visibility;  // D, A
    vec4 params[APERTURA_MAX_SLOTS];
};

#endif
