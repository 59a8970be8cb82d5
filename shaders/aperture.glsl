// One aperture and one cap light: the published formula and ours. GLSL and C++ include this text.
#ifndef APERTURA_APERTURE_GLSL
#define APERTURA_APERTURE_GLSL
#include "edges.glsl"

// The open directions around a point, as one spherical cap.
struct Aperture {
    vec3 axis;     // unit
    float height;  // 1 - cos(radius) = area / 2 pi: 0 closed, 1 a hemisphere, 2 everything
    vec3 terms;    // capTermsOf(height), made once with it
};

// The pseudo-angle of a cap, 1 over it, and 1 over the sine of the radius.
APERTURA_FN vec3 capTermsOf(float height) {
    float h = clamp(height, 0.0f, 2.0f);
    float angle = pseudoAngle(h);
    return vec3(angle, 1.0f / max(angle, 1e-9f), inversesqrt(max(h * (2.0f - h), 1e-18f)));
}

APERTURA_FN Aperture makeAperture(vec3 axis, float height) { return Aperture(axis, height, capTermsOf(height)); }

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
APERTURA_FN float oatIrradianceThroughAperture(vec3 normal, Aperture aperture, CapLight light) {
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

// 1 less the cosine between two unit axes, with no cancellation where they nearly agree.
APERTURA_FN float distanceOf(vec3 a, vec3 b) {
    vec3 difference = a - b;
    return 0.5f * dot(difference, difference);
}

// The share of a disc beyond a chord, from how far the chord has gone across it, 0..1. Within 0.0016, and no
// steeper than the exact one.
APERTURA_FN float discFraction(float x) {
    float bulge = x - x * x;
    return x + bulge * (2.0f * x - 1.0f) * (0.7458f - 0.88f * bulge);
}

// How a light lies to an aperture, from the distance between their axes.
struct Overlap {
    float share;     // of the smaller of the two caps, inside the other: 0..1
    float distance;  // distanceOf the axes
    float inverse;   // 1 over the pseudo-angle between the axes
};

APERTURA_FN Overlap overlapOf(float distance, float height, vec3 capTerms, CapLight light, int lightClass) {
    float R = capTerms.x;
    float inverseR = capTerms.y;
    float r = light.angle;
    Overlap o;
    o.distance = max(distance, 1e-20f);
    float root = inversesqrt(o.distance);
    float d = o.distance * root * (1.3946f + 0.233f * o.distance);
    o.inverse = lightClass != LIGHTS_ANY ? root * (0.7165f - 0.1033f * o.distance)
                                  : root * (0.717f - 0.1198f * o.distance + 0.02f * o.distance * o.distance);
    // x: how far the light has come in, 0 touching from outside .. 1 nested.
    float x = clamp((R + r - d) * 0.5f * max(inverseR, light.inverseAngle), 0.0f, 1.0f);
    float k = min(R * light.inverseAngle, r * inverseR);
    float larger = lightClass != LIGHTS_ANY ? height : max(height, light.height);
    float middle = x - x * x;
    float bulge = k * (0.2736f * larger - 0.2736f - 0.1778f * k) + (0.573f - 0.71f * middle - 0.153f * k) * (2.0f * x - 1.0f);
    o.share = clamp(x + middle * bulge, 0.0f, 1.0f);
    return o;
}

// Of the light's solid angle, what is inside.
APERTURA_FN float overlapOfLight(Overlap o, float height, CapLight light) { return o.share * min(height * light.inverseHeight, 1.0f); }

// The cosine to the normal of the overlap's centroid, from those of the aperture's axis and the light's: it lies
// on the way t from the one to the other.
APERTURA_FN float centroidCosine(Overlap o, float na, float nl, vec3 capTerms, CapLight light, int lightClass) {
    float t = clamp(0.5f + 0.5f * (capTerms.x - light.angle) * o.inverse, 0.0f, 1.0f);
    float z = na + t * (nl - na);
    float sag = (t - t * t) * o.distance;  // 1 less the length of the way's point, nearly
    return lightClass == LIGHTS_MEDIUM ? z + z * sag : z * inversesqrt(max(1.0f - 2.0f * sag, 1e-6f));
}

// E of a cap light through an aperture, cut by the receiver's horizon.
// A fit of our own to the exact overlap of three caps: tests/aperture_test.cpp holds it to 0.003 RMS
// and 0.035 max of the light's own E, for light radii 0.27..45 degrees.
APERTURA_FN float irradianceThroughAperture(vec3 normal, Aperture aperture, CapLight light, int lightClass) {
    Overlap o = overlapOf(distanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light, lightClass);
    if (lightClass >= LIGHTS_SMALL) return unoccludedIrradiance(normal, light, lightClass) * overlapOfLight(o, aperture.height, light);
    float H = o.share * min(aperture.height, light.height);
    float z = centroidCosine(o, dot(normal, aperture.axis), dot(normal, light.axis), aperture.terms, light, lightClass);
    float s2 = H * (2.0f - H);
    // The overlap's rim is the light's own, or less where it is the smaller.
    vec2 rim = lightClass == LIGHTS_MEDIUM ? vec2(light.rim, light.rimSlope) : rimOf(sqrt(s2));
    float e = PI * s2 * horizonCosine(z, rim.x, rim.y);
    return lightClass == LIGHTS_MEDIUM ? e : min(e, irradianceAboveHorizon(normal, light));
}

// The share of a light's E inside an aperture. Of a light up to 10 degrees it is the share of its solid angle: that its
// open part lies higher or lower above the horizon than its middle is left out.
APERTURA_FN float visibleFraction(vec3 normal, Aperture aperture, CapLight light, int lightClass) {
    if (lightClass != LIGHTS_ANY) {
        Overlap o = overlapOf(distanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light, lightClass);
        return overlapOfLight(o, aperture.height, light);
    }
    return clamp(irradianceThroughAperture(normal, aperture, light, lightClass) / max(irradianceAboveHorizon(normal, light), 1e-12f), 0.0f, 1.0f);
}

// The share of a light's E inside an aperture of any height: one over a hemisphere is what its complement
// leaves; its size is that one's already.
APERTURA_FN float visibleFractionOfEither(vec3 normal, Aperture aperture, CapLight light, int lightClass) {
    if (lightClass >= LIGHTS_SMALL) {  // its edge is a chord across the light's disc
        float inside = (dot(aperture.axis, light.axis) - 1.0f + aperture.height) * aperture.terms.z;
        return discFraction(clamp(0.5f + 0.5f * inside * light.inverseSin, 0.0f, 1.0f));
    }
    bool large = aperture.height > 1.0f;
    float height = large ? 2.0f - aperture.height : aperture.height;
    float share = 0.0f;
    if (lightClass == LIGHTS_MEDIUM) {
        float side = large ? -1.0f : 1.0f;
        Overlap o = overlapOf(1.0f - side * dot(aperture.axis, light.axis), height, aperture.terms, light, lightClass);
        float nl = dot(normal, light.axis);
        float z = centroidCosine(o, side * dot(normal, aperture.axis), nl, aperture.terms, light, lightClass);
        float open = horizonCosine(nl, light.rim, light.rimSlope);
        float seen = horizonCosine(z, light.rim, light.rimSlope);
        share = clamp(overlapOfLight(o, height, light) * seen / max(open, 1e-6f), 0.0f, 1.0f);
    } else {
        Aperture cap = Aperture(large ? -aperture.axis : aperture.axis, height, aperture.terms);
        share = visibleFraction(normal, cap, light, lightClass);
    }
    return large ? 1.0f - share : share;
}

// 1 over the deviation of an aperture's plane across a light. `along`: the cosine between their axes, both unit.
APERTURA_FN float inverseDeviationOfCap(float along, CapLight light) { return inversesqrt(max(covariance(1.0f, along, along, light), 1e-12f)); }

// E of a cap light through the intersection of two apertures or, where `complement` is 1, through what it
// leaves. A cap less an anti-cap is one with a large cap, its complement; two caps are what two large ones
// leave. How much of the light both hold depends on how their edges lie to each other as the light sees it.
// `between`: the cosine between their axes.
APERTURA_FN float irradianceThroughTwoCaps(vec3 normal, Aperture a, Aperture b, float between, float complement, CapLight light, int lightClass) {
    float p = visibleFractionOfEither(normal, a, light, lightClass);
    float q = visibleFractionOfEither(normal, b, light, lightClass);
    float alongA = dot(a.axis, light.axis);
    float alongB = dot(b.axis, light.axis);
    float correlation = covariance(between, alongA, alongB, light) * inverseDeviationOfCap(alongA, light) * inverseDeviationOfCap(alongB, light);
    float both = meanOfTwo(p, q, edgeAlignment(correlation));
    return unoccludedIrradiance(normal, light, lightClass) * (complement > 0.5f ? 1.0f - both : both);
}

#endif
