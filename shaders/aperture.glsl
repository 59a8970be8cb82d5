// One aperture and one cap light: the published formula and ours. GLSL and C++ include this text.
#ifndef APERTURA_APERTURE_GLSL
#define APERTURA_APERTURE_GLSL
#include "cap.glsl"

// The open directions around a point, as one spherical cap.
struct Aperture {
    vec3 axis;     // unit
    float height;  // 1 - cos(radius) = area / 2 pi: 0 closed, 1 a hemisphere, 2 everything
    vec2 angle;    // anglesOf(height), made once with it
};

// The pseudo-angle of a cap and 1 over it.
APERTURA_FN vec2 anglesOf(float height) {
    float angle = pseudoAngle(clamp(height, 0.0f, 2.0f));
    return vec2(angle, 1.0f / max(angle, 1e-5f));
}

APERTURA_FN Aperture makeAperture(vec3 axis, float height) { return Aperture(axis, height, anglesOf(height)); }

// Radius of a cap of this height, radians, within 1e-7: acos(1 - height) after Abramowitz and Stegun,
// "Handbook of Mathematical Functions", 1964, 4.4.46. The built-in acos differs between devices.
APERTURA_FN float capRadius(float height) {
    float h = clamp(height, 0.0f, 2.0f);
    float x = abs(1.0f - h);
    float p = -0.0012624911f;
    p = p * x + 0.0066700901f;
    p = p * x - 0.0170881256f;
    p = p * x + 0.0308918810f;
    p = p * x - 0.0501743046f;
    p = p * x + 0.0889789874f;
    p = p * x - 0.2145988016f;
    p = p * x + 1.5707963050f;
    float radius = sqrt(min(h, 2.0f - h)) * p;
    return h > 1.0f ? PI - radius : radius;
}

// BASELINE, as published: Oat, "Ambient Aperture Lighting", SIGGRAPH course 2006. The overlap's area
// eases between touching and nested; its direction is the average of the axes. E is off by 0.19 RMS
// (0.69 max) of the light's own, and not a number where axis = -light.axis: both are the method's.
APERTURA_FN float oatLightThroughAperture(vec3 normal, Aperture aperture, CapLight light) {
    float r0 = capRadius(aperture.height);
    float r1 = capRadius(light.height);
    float d = capRadius(1.0f - dot(aperture.axis, light.axis));
    float area = 2.0f * PI * min(aperture.height, light.height);
    float difference = abs(r0 - r1);
    if (d >= r0 + r1) {
        area = 0.0f;
    } else if (d > difference) {
        area *= smoothstep(0.0f, 1.0f, 1.0f - (d - difference) / (r0 + r1 - difference));
    }
    return area * max(dot(normal, normalize(aperture.axis + light.axis)), 0.0f);
}

// The share of a small light's disc inside an aperture: its edge is a chord across the disc. Within 0.0011
// RMS of exact up to 2 degrees while the aperture is the larger.
APERTURA_FN float chordShare(Aperture aperture, CapLight light) {
    float h = aperture.height;
    float inside = (dot(aperture.axis, light.axis) - 1.0f + h) * inversesqrt(max(h * (2.0f - h), 1e-8f));
    float x = clamp(0.5f + 0.5f * inside * light.inverseSin, 0.0f, 1.0f);
    return x * (1.0f + 0.6687f * (1.0f - x) * (2.0f * x - 1.0f));
}

// E of a cap light through an aperture, cut by the receiver's horizon.
// A fit of our own to the exact overlap of three caps: tests/aperture_test.cpp holds it to 0.003 RMS
// and 0.035 max of the light's own E, for light radii 0.27..45 degrees.
APERTURA_FN float lightThroughAperture(vec3 normal, Aperture aperture, CapLight light, int size) {
    if (size == LIGHTS_SMALL) return lightOnSurface(normal, light, size) * chordShare(aperture, light);
    float h0 = aperture.height;
    float h1 = light.height;
    float R = aperture.angle.x;
    float inverseR = aperture.angle.y;
    float r = light.angle;
    float hd = max(1.0f - dot(aperture.axis, light.axis), 1e-7f);
    float rootD = inversesqrt(hd);
    float d = hd * rootD * (1.3946f + 0.233f * hd);
    float inverseD = rootD * (0.717f - 0.1198f * hd + 0.02f * hd * hd);
    // x: how far the light has come in, 0 touching from outside .. 1 nested.
    float x = clamp((R + r - d) * 0.5f * max(inverseR, light.inverseAngle), 0.0f, 1.0f);
    float k = min(R * light.inverseAngle, r * inverseR);
    float bulge = k * (0.2736f * (max(h0, h1) - 1.0f) - 0.1778f * k)
                + (0.4375f - 0.1141f * k) * (2.0f * x - 1.0f);
    float H = clamp(x + (x - x * x) * bulge, 0.0f, 1.0f) * min(h0, h1);
    // The overlap's centroid lies on the way t from the aperture's axis to the light's.
    float t = clamp(0.5f + 0.5f * (R - r) * inverseD, 0.0f, 1.0f);
    float na = dot(normal, aperture.axis);
    float nl = dot(normal, light.axis);
    float z = (na + t * (nl - na)) * inversesqrt(max(1.0f - 2.0f * t * (1.0f - t) * hd, 1e-6f));
    float s2 = H * (2.0f - H);
    // The overlap's rim is the light's own, or less where it is the smaller.
    vec2 rim = size == LIGHTS_MEDIUM ? vec2(light.rim, light.rimSlope) : rimOf(sqrt(s2));
    return PI * s2 * horizonCosine(z, rim.x, rim.y);
}

// The share of a light inside an aperture of any height: one over a hemisphere is what its complement
// leaves; its angles are that one's already.
APERTURA_FN float apertureShare(vec3 normal, Aperture aperture, CapLight light, int size) {
    if (size == LIGHTS_SMALL) return chordShare(aperture, light);
    bool large = aperture.height > 1.0f;
    Aperture cap = Aperture(large ? -aperture.axis : aperture.axis, large ? 2.0f - aperture.height : aperture.height, aperture.angle);
    float share = clamp(lightThroughAperture(normal, cap, light, size) / max(lightAboveHorizon(normal, light), 1e-12f), 0.0f, 1.0f);
    return large ? 1.0f - share : share;
}

// E of a cap light through the intersection of two apertures or, where `inverse` is 1, through what it
// leaves. A cap less an anti-cap is one with a large cap, its complement; two caps are what two large ones
// leave. How much of the light both hold depends on how their edges lie to each other as the light sees it.
APERTURA_FN float lightThroughTwoCaps(vec3 normal, Aperture a, Aperture b, float inverse, CapLight light, int size) {
    float p = apertureShare(normal, a, light, size);
    float q = apertureShare(normal, b, light, size);
    float al = dot(a.axis, light.axis);
    float bl = dot(b.axis, light.axis);
    float mm = max((1.0f - al * al) * (1.0f - bl * bl), 1e-12f);
    float inverseM = inversesqrt(mm);
    float c = clamp((dot(a.axis, b.axis) - al * bl) * inverseM, -1.0f, 1.0f);
    float w = c * (0.64f + 0.36f * c * c);
    if (size != LIGHTS_SMALL) w = w / (1.0f + 0.15f * light.sinRadius * light.sinRadius * inverseM);
    float both = p * q + abs(w) * ((w > 0.0f ? min(p, q) : max(p + q - 1.0f, 0.0f)) - p * q);
    return lightOnSurface(normal, light, size) * (inverse > 0.5f ? 1.0f - both : both);
}

#endif
