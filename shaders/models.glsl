// The visibility models, by number: what each makes of one light and of the sky.
// GLSL and C++ include this text; sh/models.h names them.
#ifndef APERTURA_MODELS_GLSL
#define APERTURA_MODELS_GLSL
#include "aperture.glsl"
#include "soft.glsl"

const int MODEL_AO = 0;
const int MODEL_SH_L1 = 1;
const int MODEL_OAT = 2;
const int MODEL_APERTURE = 3;
const int MODEL_SOFT = 4;
const int MODEL_COUNT = 5;

// What one receiver sees, in the forms that the models read; all three from the same four numbers.
struct Receiver {
    vec3 normal;          // unit
    vec3 visibleDirection; // D, sr
    float visibleArea;    // A, sr, 0..2 pi
    Aperture aperture;
    SoftAperture soft;
};

// A receiver from what a vertex carries (sh/vertex_visibility.h) and the rasteriser interpolates.
APERTURA_FN Receiver interpolatedReceiver(vec3 normal, vec4 visibility, vec4 aperture, vec4 soft) {
    vec3 axis = vec3(aperture);
    float squared = dot(axis, axis);
    return Receiver(normal, vec3(visibility), visibility.w,
                    Aperture(squared > 1e-8f ? axis * inversesqrt(squared) : normal, aperture.w),
                    SoftAperture(vec3(soft), soft.w));
}

// Visibility averaged over a cap light, from the bands 0 and 1: the cap scales band 1 by (1 + cos r) / 2.
APERTURA_FN float shVisibility(Receiver receiver, CapLight light) {
    float band1 = 3.0f * (1.0f - 0.5f * light.height) * dot(receiver.visibleDirection, light.axis);
    return clamp((receiver.visibleArea + band1) / (4.0f * PI), 0.0f, 1.0f);
}

// E of a cap light at the receiver.
APERTURA_FN float lightThrough(int model, Receiver receiver, CapLight light) {
    if (model == MODEL_OAT) return oatLightThroughAperture(receiver.normal, receiver.aperture, light);
    if (model == MODEL_APERTURE) return lightThroughAperture(receiver.normal, receiver.aperture, light);
    if (model == MODEL_SOFT) return lightThroughSoft(receiver.normal, receiver.soft, light);
    float open = lightAboveHorizon(receiver.normal, light);
    if (model == MODEL_SH_L1) return open * shVisibility(receiver, light);
    return open * receiver.visibleArea / (2.0f * PI);
}

// E of a sky of unit radiance all around. From the four numbers it is exactly dot(normal, D); the
// published method and plain occlusion know only the cap, or its area.
APERTURA_FN float skyThrough(int model, Receiver receiver) {
    if (model == MODEL_OAT)
        return 2.0f * PI * receiver.aperture.height
             * max(dot(receiver.normal, receiver.aperture.axis), 0.0f);
    if (model == MODEL_AO) return 0.5f * receiver.visibleArea;
    return max(dot(receiver.normal, receiver.visibleDirection), 0.0f);
}

#endif
