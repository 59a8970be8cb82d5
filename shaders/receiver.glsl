// The visibility models' numbers, and what a shader holds of one receiver. GLSL and C++ include this text; sh/models.cpp
// names the models and says what they store.
#ifndef APERTURA_RECEIVER_GLSL
#define APERTURA_RECEIVER_GLSL
#include "aperture.glsl"
#include "soft.glsl"

const int MODEL_UNSHADOWED = 0;
const int MODEL_AO = 1;
const int MODEL_SH_L1 = 2;
const int MODEL_SH_L2 = 3;
const int MODEL_SH_L4 = 4;
const int MODEL_OAT = 5;
const int MODEL_APERTURE = 6;
const int MODEL_ALPHA = 7;
const int MODEL_ANTI = 8;
const int MODEL_SOFT = 9;
const int MODEL_FIRM_2 = 10;
const int MODEL_SOFT_2 = 11;
const int MODEL_SOFT_L2 = 12;
const int MODEL_FIRM_3 = 13;
const int MODEL_FIRM_4 = 14;
const int MODEL_MULTI_2 = 15;
const int MODEL_MULTI_3 = 16;
const int MODEL_MULTI_4 = 17;
const int MODEL_CAP_ANTI = 18;
const int MODEL_HORIZON = 19;
const int MODEL_AUTO = 20;
const int MODEL_COUNT = 21;

// The vec4s that a model's parameters of one point take in the shader, at most.
const int MAX_SLOTS = 6;

// What one receiver sees. `params` are the model's own (sh/models.cpp says what stands in each slot).
struct Receiver {
    vec3 normal;      // unit
    vec4 visibility;  // D, A, sr
    vec4 params[MAX_SLOTS];  // axes unit: see renormalised
};

APERTURA_FN SoftAperture softIn(vec4 slot) { return SoftAperture(vec3(slot), slot.w); }

APERTURA_FN Aperture apertureIn(vec4 slot, vec3 terms) { return Aperture(vec3(slot), slot.w, terms); }

// An axis made unit again; where nothing is left of it the normal is the best guess.
APERTURA_FN vec4 unitAxis(vec4 slot, vec3 normal) {
    vec3 axis = vec3(slot);
    float squared = dot(axis, axis);
    return vec4(squared > 1e-8f ? axis * inversesqrt(squared) : normal, slot.w);
}

// A receiver whose parameters were interpolated, ready for its model: the axes of apertures have become shorter, and
// their sizes are made anew.
APERTURA_FN Receiver renormalised(int model, Receiver receiver) {
    if (model == MODEL_OAT || model == MODEL_APERTURE || model == MODEL_ALPHA || model == MODEL_ANTI)
        receiver.params[0] = unitAxis(receiver.params[0], receiver.normal);
    if (model == MODEL_ANTI) receiver.params[1] = unitAxis(receiver.params[1], receiver.normal);
    vec3 terms = capTermsOf(receiver.params[0].w);
    if (model == MODEL_APERTURE || model == MODEL_ALPHA) receiver.params[1] = vec4(receiver.params[1].x, terms.x, terms.y, terms.z);
    if (model == MODEL_ANTI) {
        vec3 other = capTermsOf(receiver.params[1].w);
        receiver.params[2] = vec4(receiver.params[2].x, 0.0f, terms.z, other.z);
        receiver.params[3] = vec4(terms.x, terms.y, other.x, other.y);
    }
    return receiver;
}

#endif
