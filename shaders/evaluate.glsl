// One evaluation of a model: what evaluate.comp reads, laid out alike (std430) in GLSL and in C++.
#ifndef APERTURA_EVALUATE_GLSL
#define APERTURA_EVALUATE_GLSL

struct Evaluation {
    vec4 normal;      // xyz; w: the light's sinRadius
    vec4 light;       // xyz: axis; w: height
    vec4 visibility;
    vec4 aperture;
    vec4 soft;
};

#endif
