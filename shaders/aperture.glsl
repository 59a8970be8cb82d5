// One aperture and one cap light: the formula published in 2006, and ours. GLSL and C++ include this text.
#ifndef APERTURA_APERTURE_GLSL
#define APERTURA_APERTURE_GLSL
#include "edges.glsl"

// The open directions around a point, as one spherical cap.
struct Aperture {
    lpvec3 axis;     // unit
    lpfloat height;  // 1 - cos(radius) = area / 2 pi: 0 closed, 1 a hemisphere, 2 everything
    lpvec3 terms;    // capTermsOf(height), computed once when the aperture is made
};

// x: pseudoAngle(height), y: 1 / x, z: 1 / sin(radius). `height` is clamped to 0..2.
APERTURA_FN lpvec3 capTermsOf(lpfloat height) {
    lpfloat h = clamp(height, lpfloat(0.0), lpfloat(2.0));
    lpfloat angle = pseudoAngle(h);
    return lpvec3(angle, lpfloat(1.0) / max(angle, lpsmall(1e-9)), inversesqrt(max(h * (lpfloat(2.0) - h), lpsmall(1e-18))));
}

APERTURA_FN Aperture makeAperture(lpvec3 axis, lpfloat height) { return Aperture(axis, height, capTermsOf(height)); }

// The radius in radians of a cap of this height (clamped to 0..2), within 1e-7: acos(1 - height) after Abramowitz and
// Stegun, "Handbook of Mathematical Functions", 1964, 4.4.46. The built-in acos differs between devices.
APERTURA_FN lpfloat capRadius(lpfloat height) {
    lpfloat h = clamp(height, lpfloat(0.0), lpfloat(2.0));
    lpfloat x = abs(lpfloat(1.0) - h);
    lpfloat p = -lpfloat(0.0012624911);
    p = p * x + lpfloat(0.0066700901);
    p = p * x - lpfloat(0.0170881256);
    p = p * x + lpfloat(0.0308918810);
    p = p * x - lpfloat(0.0501743046);
    p = p * x + lpfloat(0.0889789874);
    p = p * x - lpfloat(0.2145988016);
    p = p * x + lpfloat(1.5707963050);
    lpfloat radius = sqrt(min(h, lpfloat(2.0) - h)) * p;
    return h > lpfloat(1.0) ? PI - radius : radius;
}

// BASELINE, as published: Oat, "Ambient Aperture Lighting", SIGGRAPH course 2006. The overlap's area eases between
// touching and nested; its direction is the average of the axes. Two faults are the method's own: E / (pi sin^2 r) errs
// by 0.19 RMS (0.69 max), and E is NaN where axis = -light.axis.
APERTURA_FN lpfloat oatIrradianceThroughAperture(lpvec3 normal, Aperture aperture, CapLight light) {
    lpfloat r0 = capRadius(aperture.height);
    lpfloat r1 = capRadius(light.height);
    lpfloat d = capRadius(lpfloat(1.0) - dot(aperture.axis, light.axis));
    lpfloat area = lpfloat(2.0) * PI * min(aperture.height, light.height);
    lpfloat difference = abs(r0 - r1);
    if (d >= r0 + r1) {
        area = lpfloat(0.0);
    } else if (d > difference) {
        area *= smoothstep(lpfloat(0.0), lpfloat(1.0), lpfloat(1.0) - (d - difference) / (r0 + r1 - difference));
    }
    return area * max(dot(normal, normalize(aperture.axis + light.axis)), lpfloat(0.0));
}

// 1 - dot(a, b) for unit vectors, without cancellation where they nearly agree.
APERTURA_FN lpfloat distanceOf(lpvec3 a, lpvec3 b) {
    lpvec3 difference = a - b;
    return lpfloat(0.5) * dot(difference, difference);
}

// The fraction of a disc on one side of a chord. x: how far the chord has moved across the disc, 0..1. Within 0.0016, and
// no steeper than the exact function.
APERTURA_FN lpfloat discFraction(lpfloat x) {
    lpfloat bulge = x - x * x;
    return x + bulge * (lpfloat(2.0) * x - lpfloat(1.0)) * (lpfloat(0.7458) - lpfloat(0.88) * bulge);
}

// The overlap of a light and an aperture.
struct Overlap {
    lpfloat share;     // fraction of the smaller cap that lies inside the other, 0..1
    lpfloat distance;  // distanceOf the two axes
    lpfloat inverse;   // 1 / the pseudo-angle between the axes
};

// `distance`: distanceOf the two axes. `height`, `capTerms`: the height and terms of the aperture.
APERTURA_FN Overlap overlapOf(lpfloat distance, lpfloat height, lpvec3 capTerms, CapLight light, int lightClass) {
    lpfloat R = capTerms.x;
    lpfloat inverseR = capTerms.y;
    lpfloat r = light.angle;
    Overlap o;
    o.distance = max(distance, lpsmall(1e-20));
    lpfloat root = inversesqrt(o.distance);
    lpfloat d = o.distance * root * (lpfloat(1.3946) + lpfloat(0.233) * o.distance);
    o.inverse = lightClass != LIGHTS_ANY ? root * (lpfloat(0.7165) - lpfloat(0.1033) * o.distance)
                                         : root * (lpfloat(0.717) - lpfloat(0.1198) * o.distance + lpfloat(0.02) * o.distance * o.distance);
    // x: how far the light has come in, from 0 where it touches from outside to 1 where one is inside the other.
    lpfloat x = clamp((R + r - d) * lpfloat(0.5) * max(inverseR, light.inverseAngle), lpfloat(0.0), lpfloat(1.0));
    lpfloat k = min(R * light.inverseAngle, r * inverseR);
    lpfloat larger = lightClass != LIGHTS_ANY ? height : max(height, light.height);
    lpfloat middle = x - x * x;
    lpfloat bulge = k * (lpfloat(0.2736) * larger - lpfloat(0.2736) - lpfloat(0.1778) * k)
                  + (lpfloat(0.573) - lpfloat(0.71) * middle - lpfloat(0.153) * k) * (lpfloat(2.0) * x - lpfloat(1.0));
    o.share = clamp(x + middle * bulge, lpfloat(0.0), lpfloat(1.0));
    return o;
}

// The fraction of the light's solid angle that is inside the aperture, 0..1. `height`: of the aperture.
APERTURA_FN lpfloat overlapOfLight(Overlap o, lpfloat height, CapLight light) {
    return o.share * min(height * light.inverseHeight, lpfloat(1.0));
}

// The cosine between the normal and the overlap's centroid. The centroid lies a fraction t of the way from the aperture's
// axis to the light's; `na` and `nl` are the cosines of these axes to the normal.
APERTURA_FN lpfloat centroidCosine(Overlap o, lpfloat na, lpfloat nl, lpvec3 capTerms, CapLight light, int lightClass) {
    lpfloat t = clamp(lpfloat(0.5) + lpfloat(0.5) * (capTerms.x - light.angle) * o.inverse, lpfloat(0.0), lpfloat(1.0));
    lpfloat z = na + t * (nl - na);
    lpfloat sag = (t - t * t) * o.distance;  // nearly 1 - the length of the point at t between the axes
    return lightClass == LIGHTS_MEDIUM ? z + z * sag : z * inversesqrt(max(lpfloat(1.0) - lpfloat(2.0) * sag, lpsmall(1e-6)));
}

// E of a cap light through an aperture, cut by the receiver's horizon. A fit of our own to the exact overlap of three
// caps. Error of E / (pi sin^2 r): 0.003 RMS (0.035 max) for light radii 0.27..45 degrees, 0.005 RMS in LIGHTS_SMALL
// (tests/aperture_test.cpp).
APERTURA_FN lpfloat irradianceThroughAperture(lpvec3 normal, Aperture aperture, CapLight light, int lightClass) {
    Overlap o = overlapOf(distanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light, lightClass);
    if (lightClass >= LIGHTS_SMALL) return unoccludedIrradiance(normal, light, lightClass) * overlapOfLight(o, aperture.height, light);
    lpfloat H = o.share * min(aperture.height, light.height);
    lpfloat z = centroidCosine(o, dot(normal, aperture.axis), dot(normal, light.axis), aperture.terms, light, lightClass);
    lpfloat s2 = H * (lpfloat(2.0) - H);
    // The rim of the overlap; LIGHTS_MEDIUM takes the light's own, which is the same or larger.
    lpvec2 rim = lightClass == LIGHTS_MEDIUM ? lpvec2(light.rim, light.rimSlope) : rimOf(sqrt(s2));
    lpfloat e = PI * s2 * horizonCosine(z, rim.x, rim.y);
    return lightClass == LIGHTS_MEDIUM ? e : min(e, irradianceAboveHorizon(normal, light));
}

// The fraction of a light's E inside an aperture, 0..1. For lights up to 10 degrees it is the fraction of the solid
// angle, which neglects that the open part lies higher or lower above the horizon than the light's centre.
APERTURA_FN lpfloat visibleFraction(lpvec3 normal, Aperture aperture, CapLight light, int lightClass) {
    if (lightClass != LIGHTS_ANY) {
        Overlap o = overlapOf(distanceOf(aperture.axis, light.axis), aperture.height, aperture.terms, light, lightClass);
        return overlapOfLight(o, aperture.height, light);
    }
    return clamp(
        irradianceThroughAperture(normal, aperture, light, lightClass) / max(irradianceAboveHorizon(normal, light), lpsmall(1e-12)),
        lpfloat(0.0), lpfloat(1.0));
}

// visibleFraction for an aperture of any height. If it is larger than a hemisphere, the result is 1 - the fraction inside
// its complement, and its `terms` must be those of the complement.
APERTURA_FN lpfloat visibleFractionOfEither(lpvec3 normal, Aperture aperture, CapLight light, int lightClass) {
    if (lightClass >= LIGHTS_SMALL) {  // the aperture's edge is a chord across the light's disc
        lpfloat inside = (dot(aperture.axis, light.axis) - lpfloat(1.0) + aperture.height) * aperture.terms.z;
        return discFraction(clamp(lpfloat(0.5) + lpfloat(0.5) * inside * light.inverseSin, lpfloat(0.0), lpfloat(1.0)));
    }
    bool large = aperture.height > lpfloat(1.0);
    lpfloat height = large ? lpfloat(2.0) - aperture.height : aperture.height;
    lpfloat share = lpfloat(0.0);
    if (lightClass == LIGHTS_MEDIUM) {
        lpfloat side = large ? -lpfloat(1.0) : lpfloat(1.0);
        Overlap o = overlapOf(lpfloat(1.0) - side * dot(aperture.axis, light.axis), height, aperture.terms, light, lightClass);
        lpfloat nl = dot(normal, light.axis);
        lpfloat z = centroidCosine(o, side * dot(normal, aperture.axis), nl, aperture.terms, light, lightClass);
        lpfloat open = horizonCosine(nl, light.rim, light.rimSlope);
        lpfloat seen = horizonCosine(z, light.rim, light.rimSlope);
        share = clamp(overlapOfLight(o, height, light) * seen / max(open, lpsmall(1e-6)), lpfloat(0.0), lpfloat(1.0));
    } else {
        Aperture cap = Aperture(large ? -aperture.axis : aperture.axis, height, aperture.terms);
        share = visibleFraction(normal, cap, light, lightClass);
    }
    return large ? lpfloat(1.0) - share : share;
}

// 1 over the standard deviation of dot(axis, w) over a light's directions w, in the unit of `covariance`. `along`: the
// cosine between the two axes.
APERTURA_FN lpfloat inverseDeviationOfCap(lpfloat along, CapLight light) {
    return inversesqrt(max(covariance(lpfloat(1.0), along, along, light), lpsmall(1e-12)));
}

// E of a cap light through the intersection of two apertures or, where `complement` is 1, through the complement of the
// intersection. A cap minus an anti-cap is the intersection with a cap larger than a hemisphere; a union is the
// complement of the intersection of two complements. How much of the light is inside both depends on how their edges are
// aligned across it. `between`: the cosine between their axes.
APERTURA_FN lpfloat irradianceThroughTwoCaps(lpvec3 normal, Aperture a, Aperture b, lpfloat between, lpfloat complement, CapLight light,
                                             int lightClass) {
    lpfloat p = visibleFractionOfEither(normal, a, light, lightClass);
    lpfloat q = visibleFractionOfEither(normal, b, light, lightClass);
    lpfloat alongA = dot(a.axis, light.axis);
    lpfloat alongB = dot(b.axis, light.axis);
    lpfloat correlation = covariance(between, alongA, alongB, light) * inverseDeviationOfCap(alongA, light)
                        * inverseDeviationOfCap(alongB, light);
    lpfloat both = meanOfTwo(p, q, edgeAlignment(correlation));
    return unoccludedIrradiance(normal, light, lightClass) * (complement > lpfloat(0.5) ? lpfloat(1.0) - both : both);
}

#endif
