// The soft aperture: visibility as a smooth step across a plane through the directions,
// V(w) = link(offset + dot(slope, w)), link(f) = 1/2 + f / (2 sqrt(1 + f^2)). It carries all four SH
// coefficients, where a cap carries three. A model of our own. GLSL and C++ include this text.
#ifndef APERTURA_SOFT_GLSL
#define APERTURA_SOFT_GLSL
#include "cap.glsl"

// The open directions around a point, soft-edged.
struct SoftAperture {
    vec3 slope;    // towards the open side; its length is the sharpness: 0 even haze, 10 a hard edge
    float offset;
};

// E of a cap light through a soft aperture, cut by the receiver's horizon.
// The light is averaged over its disc: `spread` is the variance of the plane across it, and `sunk`
// leans a light that the horizon cuts towards the part that is left. Within 0.014 RMS (0.15 max) of the
// model's own integral over the light, for radii 0.27..45 degrees: tests/soft_test.cpp.
APERTURA_FN float lightThroughSoft(vec3 normal, SoftAperture soft, CapLight light) {
    float z = dot(normal, light.axis);
    float s = light.sinRadius;
    float along = dot(soft.slope, light.axis);
    float sunk = max(0.47f * s - 0.21f * z, 0.0f);
    float f = soft.offset + along * (1.0f - 0.38f * light.height)
            + sunk * (dot(soft.slope, normal) - along * z);
    float spread = 0.215f * s * s * max(dot(soft.slope, soft.slope) - along * along, 0.0f);
    float visible = 0.5f + 0.5f * f * inversesqrt(1.0f + spread + f * f);
    return PI * s * s * horizonCosine(z, s) * visible;
}

#endif
