// One aperture and one cap light: the published formula and ours. GLSL and C++ include this text.
#ifndef APERTURA_APERTURE_GLSL
#define APERTURA_APERTURE_GLSL
#include "cap.glsl"

// The open directions around a point, as one spherical cap.
struct Aperture {
    vec3 axis;     // unit
    float height;  // 1 - cos(radius) = area / 2 pi: 0 closed, 1 a hemisphere, 2 everything
};

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

// An angle from the height of its cap, without trigonometry. Within 4 %.
// The same law for the aperture, the light and the distance between them, so that its error cancels.
APERTURA_FN float pseudoAngle(float height) {
    return sqrt(height) * (1.3946f + 0.233f * height);
}

// E of a cap light through an aperture, cut by the receiver's horizon.
// A fit of our own to the exact overlap of three caps: tests/aperture_test.cpp holds it to 0.003 RMS
// and 0.035 max of the light's own E, for light radii 0.27..45 degrees.
APERTURA_FN float lightThroughAperture(vec3 normal, Aperture aperture, CapLight light) {
    float h0 = aperture.height;
    float h1 = light.height;
    float R = pseudoAngle(h0);
    float r = pseudoAngle(h1);
    float hd = max(1.0f - dot(aperture.axis, light.axis), 1e-7f);
    float d = pseudoAngle(hd);
    // x: how far the light has come in, 0 touching from outside .. 1 nested.
    float x = clamp((R + r - d) * 0.5f / max(min(R, r), 1e-6f), 0.0f, 1.0f);
    float k = min(R, r) / max(max(R, r), 1e-6f);
    float bulge = k * (0.2736f * (max(h0, h1) - 1.0f) - 0.1778f * k)
                + (0.4375f - 0.1141f * k) * (2.0f * x - 1.0f);
    float H = clamp(x + (x - x * x) * bulge, 0.0f, 1.0f) * min(h0, h1);
    // The overlap's centroid lies on the way t from the aperture's axis to the light's.
    float t = clamp(0.5f + 0.5f * (R - r) / d, 0.0f, 1.0f);
    float na = dot(normal, aperture.axis);
    float nl = dot(normal, light.axis);
    float z = (na + t * (nl - na)) * inversesqrt(max(1.0f - 2.0f * t * (1.0f - t) * hd, 1e-6f));
    float s2 = H * (2.0f - H);
    return PI * s2 * horizonCosine(z, sqrt(s2));
}

#endif
