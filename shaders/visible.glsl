// How much of a light a receiver sees, apart from what the light would give unblocked: so that a moving blocker or a second
// light can be correlated with what was baked. GLSL and C++ include this text.
#ifndef APERTURA_VISIBLE_GLSL
#define APERTURA_VISIBLE_GLSL
#include "models.glsl"

struct AperturaLightVisibility {
    AperturaFloat mean;  // E / E unoccluded, 0..1
    // The direction in which visibility grows across the light, as long as its edge is sharp. One lobe: its slope. Several: twice the
    // gradient of what they let through at the light's centre, which is the slope of one lobe with its edge there. Zero for models
    // without a case below: their visibility counts as even over the light.
    AperturaVec3 slope;
};

// The slope of `count` lobes that are combined: the sum over lobes k of dV/dp_k slope_k / (1 + f_k^2)^1.5, with V the combination, f_k
// what aperturaSoftStep takes, and 1 / (1 + f^2) = 4 p (1 - p).
APERTURA_FN AperturaVec3 aperturaSlopeOfLobes(AperturaReceiver receiver, int count, AperturaCapLight light) {
    AperturaCombination c = aperturaCombinationIn(receiver.params[count]);
    AperturaVec4 p = AperturaVec4(AperturaFloat(1.0));
    for (int k = 0; k < count; ++k) p[k] = aperturaLobeAt(aperturaSoftIn(receiver.params[k]), light);
    bool firstPair = count >= 3 && c.pairs > AperturaFloat(0.5);
    bool secondPair = count >= 4 && c.pairs > AperturaFloat(1.5);
    AperturaFloat first = p.x * p.y;
    AperturaFloat second = p.z * p.w;
    AperturaFloat byFirst = (firstPair ? AperturaFloat(-1.0) : AperturaFloat(1.0)) * (secondPair ? AperturaFloat(1.0) - second : second);
    AperturaFloat bySecond = (secondPair ? AperturaFloat(-1.0) : AperturaFloat(1.0)) * (firstPair ? AperturaFloat(1.0) - first : first);
    AperturaVec4 partial = AperturaVec4(byFirst * p.y, byFirst * p.x, bySecond * p.w, bySecond * p.z);
    AperturaVec3 sum = AperturaVec3(AperturaFloat(0.0));
    for (int k = 0; k < count; ++k) {
        AperturaFloat middle = max(AperturaFloat(4.0) * p[k] * (AperturaFloat(1.0) - p[k]), AperturaFloat(0.0));
        sum += partial[k] * middle * sqrt(middle) * aperturaSoftIn(receiver.params[k]).slope;
    }
    return c.complement > AperturaFloat(0.5) ? -sum : sum;
}

// The sharpness that stands for a cap's hard edge where it crosses the light: as much as 16-bit floats can square
// (tools/fit/cap_slope.cpp).
const AperturaFloat APERTURA_CAP_SLOPE = AperturaFloat(240.0);

// AperturaLightVisibility::slope of a model. `mean`: its visibility's mean over the light.
APERTURA_FN AperturaVec3 aperturaSlopeOfVisibility(int model, AperturaReceiver receiver, AperturaCapLight light, AperturaFloat mean) {
    int form = model == APERTURA_MODEL_AUTO ? aperturaChoiceIn(receiver.params[APERTURA_CHOICE_SLOT]).model : model;
    switch (form) {
        case APERTURA_MODEL_APERTURE:
        case APERTURA_MODEL_ALPHA: {
            // No edge, where the cap holds all of the light or none.
            AperturaFloat inside = form == APERTURA_MODEL_ALPHA ? mean / max(aperturaOpacityIn(receiver), aperturaSmall(1e-6)) : mean;
            inside = clamp(inside, AperturaFloat(0.0), AperturaFloat(1.0));
            return APERTURA_CAP_SLOPE * AperturaFloat(4.0) * inside * (AperturaFloat(1.0) - inside) * aperturaOnlyApertureIn(receiver).axis;
        }
        case APERTURA_MODEL_SOFT: return aperturaSoftIn(receiver.params[0]).slope;
        case APERTURA_MODEL_FIRM_2:
        case APERTURA_MODEL_SOFT_2: return aperturaSlopeOfLobes(receiver, 2, light);
        case APERTURA_MODEL_FIRM_3: return aperturaSlopeOfLobes(receiver, 3, light);
        case APERTURA_MODEL_FIRM_4: return aperturaSlopeOfLobes(receiver, 4, light);
        case APERTURA_MODEL_SOFT_L2:
            return aperturaQuadricIn(receiver).slope + AperturaFloat(2.0) * aperturaBendTimes(aperturaQuadricIn(receiver), light.axis);
        default: return AperturaVec3(AperturaFloat(0.0));
    }
}

APERTURA_FN AperturaLightVisibility aperturaVisibilityOfLight(int model, AperturaReceiver receiver, AperturaCapLight light,
                                                              int lightClass) {
    AperturaLightVisibility v;
    AperturaFloat open = aperturaUnoccludedIrradiance(receiver.normal, light, lightClass);
    v.mean = clamp(aperturaIrradianceThrough(model, receiver, light, lightClass) / max(open, aperturaSmall(1e-12)), AperturaFloat(0.0),
                   AperturaFloat(1.0));
    v.slope = aperturaSlopeOfVisibility(model, receiver, light, v.mean);
    return v;
}

// What a light that stands in front of another leaves of it: 1 - the fraction of its E that `nearer` covers, as a visibility with an edge.
APERTURA_FN AperturaLightVisibility aperturaLeftBy(AperturaVec3 normal, AperturaCapLight nearer, AperturaCapLight light, int lightClass) {
    AperturaLightVisibility v;
    AperturaFloat covered = aperturaVisibleFraction(normal, aperturaMakeAperture(nearer.axis, nearer.height), light, lightClass);
    v.mean = AperturaFloat(1.0) - covered;
    v.slope = -APERTURA_CAP_SLOPE * AperturaFloat(4.0) * covered * v.mean * nearer.axis;
    return v;
}

// The mean over the light of the product of two visibilities, as of what was baked and of a blocker that moves: a blocker whose edge
// is the baked one takes hardly more away. For two hard lobes and lights of 1 to 9 degrees within 0.04 RMS of quadrature (the product
// of their means 0.054), and for one edge twice within 0.05 (0.108): tests/edges_test.cpp.
APERTURA_FN AperturaFloat aperturaMeanOfBoth(AperturaLightVisibility a, AperturaLightVisibility b, AperturaCapLight light) {
    AperturaFloat alongA = dot(a.slope, light.axis);
    AperturaFloat alongB = dot(b.slope, light.axis);
    AperturaFloat correlation = aperturaCovariance(dot(a.slope, b.slope), alongA, alongB, light)
                              * aperturaInverseDeviationOfLobe(a.slope, alongA, light)
                              * aperturaInverseDeviationOfLobe(b.slope, alongB, light);
    return aperturaMeanOfTwo(a.mean, b.mean, aperturaEdgeAlignment(correlation));
}

// Both at once, as one visibility: the edge of each shows where the other is open.
APERTURA_FN AperturaLightVisibility aperturaBoth(AperturaLightVisibility a, AperturaLightVisibility b, AperturaCapLight light) {
    AperturaLightVisibility v;
    v.mean = aperturaMeanOfBoth(a, b, light);
    v.slope = b.mean * a.slope + a.mean * b.slope;
    return v;
}

#endif
