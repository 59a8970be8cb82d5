// One aperture and one cap light: the formula published in 2006, and ours. GLSL and C++ include this text.
#ifndef APERTURA_APERTURE_GLSL
#define APERTURA_APERTURE_GLSL
#include "edges.glsl"

// The open directions around a point, as one spherical cap.
struct AperturaAperture {
    AperturaVec3 axis;     // unit
    AperturaFloat height;  // 1 - cos(radius) = area / 2 pi: 0 closed, 1 a hemisphere, 2 everything
    AperturaVec3 terms;    // aperturaCapTermsOf(height), computed once when the aperture is made
};

// x: aperturaPseudoAngle(height), y: 1 / x, z: 1 / sin(radius). `height` is clamped to 0..2.
APERTURA_FN AperturaVec3 aperturaCapTermsOf(AperturaFloat height) {
    AperturaFloat h = clamp(height, AperturaFloat(0.0), AperturaFloat(2.0));
    AperturaFloat angle = aperturaPseudoAngle(h);
    return AperturaVec3(angle, AperturaFloat(1.0) / max(angle, aperturaSmall(1e-9)),
                        inversesqrt(max(h * (AperturaFloat(2.0) - h), aperturaSmall(1e-18))));
}

APERTURA_FN AperturaAperture aperturaMakeAperture(AperturaVec3 axis, AperturaFloat height) {
    return AperturaAperture(axis, height, aperturaCapTermsOf(height));
}

// The radius in radians of a cap of this height (clamped to 0..2), within 1e-7: acos(1 - height) after Abramowitz and
// Stegun, "Handbook of Mathematical Functions", 1964, 4.4.46. The built-in acos differs between devices.
APERTURA_FN AperturaFloat aperturaCapRadius(AperturaFloat height) {
    AperturaFloat h = clamp(height, AperturaFloat(0.0), AperturaFloat(2.0));
    AperturaFloat x = abs(AperturaFloat(1.0) - h);
    AperturaFloat p = -AperturaFloat(0.0012624911);
    p = p * x + AperturaFloat(0.0066700901);
    p = p * x - AperturaFloat(0.0170881256);
    p = p * x + AperturaFloat(0.0308918810);
    p = p * x - AperturaFloat(0.0501743046);
    p = p * x + AperturaFloat(0.0889789874);
    p = p * x - AperturaFloat(0.2145988016);
    p = p * x + AperturaFloat(1.5707963050);
    AperturaFloat radius = sqrt(min(h, AperturaFloat(2.0) - h)) * p;
    return h > AperturaFloat(1.0) ? APERTURA_PI - radius : radius;
}

// BASELINE, as published: Oat, "Ambient Aperture Lighting", SIGGRAPH course 2006. The overlap's area eases between
// touching and nested; its direction is the average of the axes. Two faults are the method's own: E / (pi sin^2 r) errs
// by 0.19 RMS (0.69 max), and E is NaN where axis = -light.axis.
APERTURA_FN AperturaFloat aperturaOatIrradianceThroughAperture(AperturaVec3 normal, AperturaAperture aperture, AperturaCapLight light) {
    AperturaFloat r0 = aperturaCapRadius(aperture.height);
    AperturaFloat r1 = aperturaCapRadius(light.height);
    AperturaFloat d = aperturaCapRadius(AperturaFloat(1.0) - dot(aperture.axis, light.axis));
    AperturaFloat area = AperturaFloat(2.0) * APERTURA_PI * min(aperture.height, light.height);
    AperturaFloat difference = abs(r0 - r1);
    if (d >= r0 + r1) {
        area = AperturaFloat(0.0);
    } else if (d > difference) {
        area *= smoothstep(AperturaFloat(0.0), AperturaFloat(1.0), AperturaFloat(1.0) - (d - difference) / (r0 + r1 - difference));
    }
    return area * max(dot(normal, normalize(aperture.axis + light.axis)), AperturaFloat(0.0));
}

// 1 - dot(a, b) for unit vectors, without cancellation where they nearly agree.
APERTURA_FN AperturaFloat aperturaDistanceOf(AperturaVec3 a, AperturaVec3 b) {
    AperturaVec3 difference = a - b;
    return AperturaFloat(0.5) * dot(difference, difference);
}

// The fraction of a disc on one side of a chord. x: how far the chord has moved across the disc, 0..1. Within 0.0012, and
// no steeper than the exact function. Fitted: tools/fit/chord.cpp.
APERTURA_FN AperturaFloat aperturaDiscFraction(AperturaFloat x) {
    AperturaFloat bulge = x - x * x;
    return x + bulge * (AperturaFloat(2.0) * x - AperturaFloat(1.0)) * (AperturaFloat(0.7660) - AperturaFloat(0.9886) * bulge);
}

// The overlap of a light and an aperture.
struct AperturaOverlap {
    AperturaFloat share;     // fraction of the smaller cap that lies inside the other, 0..1
    AperturaFloat distance;  // aperturaDistanceOf the two axes
    AperturaFloat inverse;   // 1 / the pseudo-angle between the axes
};

// `distance`: aperturaDistanceOf the two axes. `height`, `capTerms`: the height and terms of the aperture. Fitted: tools/fit/overlap.cpp,
// and the reciprocals of the angle, which save a root: inverse_angle.cpp and inverse_angle_medium.cpp.
APERTURA_FN AperturaOverlap aperturaOverlapOf(AperturaFloat distance, AperturaFloat height, AperturaVec3 capTerms, AperturaCapLight light,
                                              int lightClass) {
    AperturaFloat R = capTerms.x;
    AperturaFloat inverseR = capTerms.y;
    AperturaFloat r = light.angle;
    AperturaOverlap o;
    o.distance = max(distance, aperturaSmall(1e-20));
    AperturaFloat root = inversesqrt(o.distance);
    AperturaFloat d = o.distance * root * aperturaPseudoAngleOverRoot(o.distance);
    o.inverse = lightClass != APERTURA_LIGHTS_ANY
                  ? root * (AperturaFloat(0.7054) - AperturaFloat(0.0833) * o.distance)
                  : root
                        * (AperturaFloat(0.71188) - AperturaFloat(0.10650) * o.distance + AperturaFloat(0.01124) * o.distance * o.distance);
    // x: how far the light has come in, from 0 where it touches from outside to 1 where one is inside the other.
    AperturaFloat x = clamp((R + r - d) * AperturaFloat(0.5) * max(inverseR, light.inverseAngle), AperturaFloat(0.0), AperturaFloat(1.0));
    AperturaFloat k = min(R * light.inverseAngle, r * inverseR);
    AperturaFloat larger = lightClass != APERTURA_LIGHTS_ANY ? height : max(height, light.height);
    AperturaFloat middle = x - x * x;
    AperturaFloat bulge = k * (AperturaFloat(0.2904) * larger - AperturaFloat(0.2904) - AperturaFloat(0.1778) * k)
                        + (AperturaFloat(0.5603) - AperturaFloat(0.6492) * middle - AperturaFloat(0.1474) * k)
                              * (AperturaFloat(2.0) * x - AperturaFloat(1.0));
    o.share = clamp(x + middle * bulge, AperturaFloat(0.0), AperturaFloat(1.0));
    return o;
}

// The fraction of the light's solid angle that is inside the aperture, 0..1. `height`: of the aperture.
APERTURA_FN AperturaFloat aperturaOverlapOfLight(AperturaOverlap o, AperturaFloat height, AperturaCapLight light) {
    return o.share * min(height * light.inverseHeight, AperturaFloat(1.0));
}

// The cosine between the normal and the overlap's centroid. The centroid lies a fraction t of the way from the aperture's
// axis to the light's; `na` and `nl` are the cosines of these axes to the normal.
APERTURA_FN AperturaFloat aperturaCentroidCosine(AperturaOverlap o, AperturaFloat na, AperturaFloat nl, AperturaVec3 capTerms,
                                                 AperturaCapLight light, int lightClass) {
    AperturaFloat t = clamp(AperturaFloat(0.5) + AperturaFloat(0.5) * (capTerms.x - light.angle) * o.inverse, AperturaFloat(0.0),
                            AperturaFloat(1.0));
    AperturaFloat z = na + t * (nl - na);
    AperturaFloat sag = (t - t * t) * o.distance;  // nearly 1 - the length of the point at t between the axes
    return lightClass == APERTURA_LIGHTS_MEDIUM ? z + z * sag
                                                : z * inversesqrt(max(AperturaFloat(1.0) - AperturaFloat(2.0) * sag, aperturaSmall(1e-6)));
}

// E of a cap light through an aperture, cut by the receiver's horizon. A fit of our own to the exact overlap of three
// caps. Error of E / (pi sin^2 r): 0.0023 RMS (0.036 max) for light radii 0.27..45 degrees, 0.005 RMS in APERTURA_LIGHTS_SMALL;
// where half of the lights lie on the aperture's edge 0.0019 at 5 degrees, 0.0023 at 15, 0.0033 at 30, 0.0049 at 45
// (tests/aperture_test.cpp).
APERTURA_FN AperturaFloat aperturaIrradianceThroughAperture(AperturaVec3 normal, AperturaAperture aperture, AperturaCapLight light,
                                                            int lightClass) {
    AperturaOverlap o = aperturaOverlapOf(aperturaDistanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light,
                                          lightClass);
    if (lightClass >= APERTURA_LIGHTS_SMALL)
        return aperturaUnoccludedIrradiance(normal, light, lightClass) * aperturaOverlapOfLight(o, aperture.height, light);
    AperturaFloat H = o.share * min(aperture.height, light.height);
    AperturaFloat z = aperturaCentroidCosine(o, dot(normal, aperture.axis), dot(normal, light.axis), aperture.terms, light, lightClass);
    AperturaFloat s2 = H * (AperturaFloat(2.0) - H);
    // The rim of the overlap; APERTURA_LIGHTS_MEDIUM takes the light's own, which is the same or larger.
    AperturaVec2 rim = lightClass == APERTURA_LIGHTS_MEDIUM ? AperturaVec2(light.rim, light.rimSlope) : aperturaRimOf(sqrt(s2));
    AperturaFloat e = APERTURA_PI * s2 * aperturaHorizonCosine(z, rim.x, rim.y);
    return lightClass == APERTURA_LIGHTS_MEDIUM ? e : min(e, aperturaIrradianceAboveHorizon(normal, light));
}

// The fraction of a light's E inside an aperture, 0..1. For lights up to 10 degrees it is the fraction of the solid
// angle, which neglects that the open part lies higher or lower above the horizon than the light's centre.
APERTURA_FN AperturaFloat aperturaVisibleFraction(AperturaVec3 normal, AperturaAperture aperture, AperturaCapLight light, int lightClass) {
    if (lightClass != APERTURA_LIGHTS_ANY) {
        AperturaOverlap o = aperturaOverlapOf(aperturaDistanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light,
                                              lightClass);
        return aperturaOverlapOfLight(o, aperture.height, light);
    }
    return clamp(aperturaIrradianceThroughAperture(normal, aperture, light, lightClass)
                     / max(aperturaIrradianceAboveHorizon(normal, light), aperturaSmall(1e-12)),
                 AperturaFloat(0.0), AperturaFloat(1.0));
}

// aperturaVisibleFraction for an aperture of any height. If it is larger than a hemisphere, the result is 1 - the fraction inside
// its complement, and its `terms` must be those of the complement.
APERTURA_FN AperturaFloat aperturaVisibleFractionOfEither(AperturaVec3 normal, AperturaAperture aperture, AperturaCapLight light,
                                                          int lightClass) {
    if (lightClass >= APERTURA_LIGHTS_SMALL) {  // the aperture's edge is a chord across the light's disc
        AperturaFloat inside = (dot(aperture.axis, light.axis) - AperturaFloat(1.0) + aperture.height) * aperture.terms.z;
        return aperturaDiscFraction(
            clamp(AperturaFloat(0.5) + AperturaFloat(0.5) * inside * light.inverseSin, AperturaFloat(0.0), AperturaFloat(1.0)));
    }
    bool large = aperture.height > AperturaFloat(1.0);
    AperturaFloat height = large ? AperturaFloat(2.0) - aperture.height : aperture.height;
    AperturaFloat share = AperturaFloat(0.0);
    if (lightClass == APERTURA_LIGHTS_MEDIUM) {
        AperturaFloat side = large ? -AperturaFloat(1.0) : AperturaFloat(1.0);
        AperturaOverlap o = aperturaOverlapOf(AperturaFloat(1.0) - side * dot(aperture.axis, light.axis), height, aperture.terms, light,
                                              lightClass);
        AperturaFloat nl = dot(normal, light.axis);
        AperturaFloat z = aperturaCentroidCosine(o, side * dot(normal, aperture.axis), nl, aperture.terms, light, lightClass);
        AperturaFloat open = aperturaHorizonCosine(nl, light.rim, light.rimSlope);
        AperturaFloat seen = aperturaHorizonCosine(z, light.rim, light.rimSlope);
        share = clamp(aperturaOverlapOfLight(o, height, light) * seen / max(open, aperturaSmall(1e-6)), AperturaFloat(0.0),
                      AperturaFloat(1.0));
    } else {
        AperturaAperture cap = AperturaAperture(large ? -aperture.axis : aperture.axis, height, aperture.terms);
        share = aperturaVisibleFraction(normal, cap, light, lightClass);
    }
    return large ? AperturaFloat(1.0) - share : share;
}

// 1 over the standard deviation of dot(axis, w) over a light's directions w, in the unit of aperturaCovariance. `along`: the
// cosine between the two axes.
APERTURA_FN AperturaFloat aperturaInverseDeviationOfCap(AperturaFloat along, AperturaCapLight light) {
    return inversesqrt(max(aperturaCovariance(AperturaFloat(1.0), along, along, light), aperturaSmall(1e-12)));
}

// E of a cap light through the intersection of two apertures or, where `complement` is 1, through the complement of the
// intersection. A cap minus an anti-cap is the intersection with a cap larger than a hemisphere; a union is the
// complement of the intersection of two complements. How much of the light is inside both depends on how their edges are
// aligned across it. `between`: the cosine between their axes.
APERTURA_FN AperturaFloat aperturaIrradianceThroughTwoCaps(AperturaVec3 normal, AperturaAperture a, AperturaAperture b,
                                                           AperturaFloat between, AperturaFloat complement, AperturaCapLight light,
                                                           int lightClass) {
    AperturaFloat p = aperturaVisibleFractionOfEither(normal, a, light, lightClass);
    AperturaFloat q = aperturaVisibleFractionOfEither(normal, b, light, lightClass);
    AperturaFloat alongA = dot(a.axis, light.axis);
    AperturaFloat alongB = dot(b.axis, light.axis);
    AperturaFloat correlation = aperturaCovariance(between, alongA, alongB, light) * aperturaInverseDeviationOfCap(alongA, light)
                              * aperturaInverseDeviationOfCap(alongB, light);
    AperturaFloat both = aperturaMeanOfTwo(p, q, aperturaEdgeAlignment(correlation));
    return aperturaUnoccludedIrradiance(normal, light, lightClass) * (complement > AperturaFloat(0.5) ? AperturaFloat(1.0) - both : both);
}

#endif
