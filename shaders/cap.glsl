// Lights as spherical caps, and the irradiance of one that nothing blocks. GLSL and C++ (through
// sh/shading.h) both include this text, so that the tests check the number the shader computes.
//
// Conventions of every text in this folder: directions are unit vectors that point away from the
// receiver; E is irradiance for unit radiance (W/m2 per W/m2/sr), never divided by pi.
#ifndef APERTURA_CAP_GLSL
#define APERTURA_CAP_GLSL
#ifndef APERTURA_FN
#define APERTURA_FN
#endif

const float PI = 3.14159265358979f;

// A light of uniform radiance that fills the cap {w : dot(w, axis) >= cos(radius)}, radius <= pi/2.
struct CapLight {
    vec3 axis;       // unit, towards the light's centre
    float sinRadius; // 0..1
    float height;    // 1 - cos(radius), 0..1
};

// A cap's height 1 - cos(radius) from sin(radius), for radii up to pi/2, without cancellation.
APERTURA_FN float heightFromSin(float sinRadius) {
    return sinRadius * sinRadius / (1.0f + sqrt(max(1.0f - sinRadius * sinRadius, 0.0f)));
}

// The light of a sphere of `radius` metres whose centre lies `toCentre` metres from the receiver.
// From inside the sphere it is a half-space of light.
APERTURA_FN CapLight sphereLight(vec3 toCentre, float radius) {
    float inverseDistance = inversesqrt(max(dot(toCentre, toCentre), 1e-20f));
    float s = min(radius * inverseDistance, 1.0f);
    return CapLight(toCentre * inverseDistance, s, heightFromSin(s));
}

// E / (pi s^2) of an unblocked cap light of sine radius s at cosine z = dot(normal, axis), cut by the
// receiver's horizon. Within 0.001 (0.00025 RMS) of the closed form for radii up to 45 degrees, and never
// more than 1.006 for larger ones.
APERTURA_FN float horizonCosine(float z, float s) {
    float s2 = s * s;
    float k = sqrt(s) * (0.4595f + 0.0607f * s2 + 0.0732f * s2 * s2);
    float slope = (1.1268f - 0.2418f * s2 - 0.012f * s2 * s2) / max(s, 1e-6f);
    float below = max(k * (1.0f - slope * abs(z)), 0.0f);
    return max(z, 0.0f) + below * below;
}

// E of an unblocked cap light on a surface with `normal`.
APERTURA_FN float lightAboveHorizon(vec3 normal, CapLight light) {
    return PI * light.sinRadius * light.sinRadius
         * horizonCosine(dot(normal, light.axis), light.sinRadius);
}

#endif
