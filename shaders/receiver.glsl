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

// The vec4s that a model's form of one point takes in the shader, at most.
const int MAX_SLOTS = 6;

// What one receiver sees. `form` is the model's own (sh/models.cpp says what stands in each slot).
struct Receiver {
    vec3 normal;      // unit
    vec4 visibility;  // D, A, sr
    vec4 form[MAX_SLOTS];  // axes unit: see settled
};

APERTURA_FN SoftAperture softIn(vec4 slot) { return SoftAperture(vec3(slot), slot.w); }

APERTURA_FN Aperture apertureIn(vec4 slot, vec3 size) { return Aperture(vec3(slot), slot.w, size); }

// An axis made unit again; where nothing is left of it the normal is the best guess.
APERTURA_FN vec4 unitAxis(vec4 slot, vec3 normal) {
    vec3 axis = vec3(slot);
    float squared = dot(axis, axis);
    return vec4(squared > 1e-8f ? axis * inversesqrt(squared) : normal, slot.w);
}

// A receiver whose form was interpolated, ready for its model: the axes of apertures have become shorter, and
// their sizes are made anew.
APERTURA_FN Receiver settled(int model, Receiver receiver) {
    if (model == MODEL_OAT || model == MODEL_APERTURE || model == MODEL_ALPHA || model == MODEL_ANTI)
        receiver.form[0] = unitAxis(receiver.form[0], receiver.normal);
    if (model == MODEL_ANTI) receiver.form[1] = unitAxis(receiver.form[1], receiver.normal);
    vec3 size = sizeOf(receiver.form[0].w);
    if (model == MODEL_APERTURE || model == MODEL_ALPHA) receiver.form[1] = vec4(receiver.form[1].x, size.x, size.y, size.z);
    if (model == MODEL_ANTI) {
        vec3 other = sizeOf(receiver.form[1].w);
        receiver.form[2] = vec4(receiver.form[2].x, 0.0f, size.z, other.z);
        receiver.form[3] = vec4(size.x, size.y, other.x, other.y);
    }
    return receiver;
}

#endif
