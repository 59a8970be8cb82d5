// How much of a light a receiver sees, apart from what the light would give unblocked: so that a moving blocker or a second
// light can be correlated with what was baked. GLSL and C++ include this text.
#ifndef APERTURA_VISIBLE_GLSL
#define APERTURA_VISIBLE_GLSL
#include "models.glsl"

struct LightVisibility {
    lpfloat mean;  // E / E unoccluded, 0..1
    // The direction in which visibility grows across the light, as long as its edge is sharp. One lobe: its slope. Several: twice the
    // gradient of what they let through at the light's centre, which is the slope of one lobe with its edge there. Zero for models
    // without a case below: their visibility counts as even over the light.
    lpvec3 slope;
};

// The slope of `count` lobes that are combined: the sum over lobes k of dV/dp_k slope_k / (1 + f_k^2)^1.5, with V the combination, f_k
// what softStep takes, and 1 / (1 + f^2) = 4 p (1 - p).
APERTURA_FN lpvec3 slopeOfLobes(Receiver receiver, int count, CapLight light) {
    Combination c = combinationIn(receiver.params[count]);
    lpvec4 p = lpvec4(lpfloat(1.0));
    for (int k = 0; k < count; ++k) p[k] = lobeAt(softIn(receiver.params[k]), light);
    bool firstPair = count >= 3 && c.pairs > lpfloat(0.5);
    bool secondPair = count >= 4 && c.pairs > lpfloat(1.5);
    lpfloat first = p.x * p.y;
    lpfloat second = p.z * p.w;
    lpfloat byFirst = (firstPair ? lpfloat(-1.0) : lpfloat(1.0)) * (secondPair ? lpfloat(1.0) - second : second);
    lpfloat bySecond = (secondPair ? lpfloat(-1.0) : lpfloat(1.0)) * (firstPair ? lpfloat(1.0) - first : first);
    lpvec4 partial = lpvec4(byFirst * p.y, byFirst * p.x, bySecond * p.w, bySecond * p.z);
    lpvec3 sum = lpvec3(lpfloat(0.0));
    for (int k = 0; k < count; ++k) {
        lpfloat middle = max(lpfloat(4.0) * p[k] * (lpfloat(1.0) - p[k]), lpfloat(0.0));
        sum += partial[k] * middle * sqrt(middle) * softIn(receiver.params[k]).slope;
    }
    return c.complement > lpfloat(0.5) ? -sum : sum;
}

// The sharpness that stands for a cap's hard edge where it crosses the light.
const lpfloat CAP_SLOPE = lpfloat(100.0);

APERTURA_FN LightVisibility visibilityOfLight(int model, Receiver receiver, CapLight light, int lightClass) {
    LightVisibility v;
    lpfloat open = unoccludedIrradiance(receiver.normal, light, lightClass);
    v.mean = clamp(irradianceThrough(model, receiver, light, lightClass) / max(open, lpsmall(1e-12)), lpfloat(0.0), lpfloat(1.0));
    switch (model) {
        case MODEL_APERTURE:
        case MODEL_ALPHA: {
            // No edge, where the cap holds all of the light or none.
            lpfloat inside = model == MODEL_ALPHA ? v.mean / max(opacityIn(receiver), lpsmall(1e-6)) : v.mean;
            inside = clamp(inside, lpfloat(0.0), lpfloat(1.0));
            v.slope = CAP_SLOPE * lpfloat(4.0) * inside * (lpfloat(1.0) - inside) * onlyApertureIn(receiver).axis;
            break;
        }
        case MODEL_SOFT: v.slope = softIn(receiver.params[0]).slope; break;
        case MODEL_FIRM_2:
        case MODEL_SOFT_2: v.slope = slopeOfLobes(receiver, 2, light); break;
        case MODEL_FIRM_3: v.slope = slopeOfLobes(receiver, 3, light); break;
        case MODEL_FIRM_4: v.slope = slopeOfLobes(receiver, 4, light); break;
        case MODEL_SOFT_L2: v.slope = quadricIn(receiver).slope + lpfloat(2.0) * bendTimes(quadricIn(receiver), light.axis); break;
        default: v.slope = lpvec3(lpfloat(0.0)); break;
    }
    return v;
}

// The mean over the light of the product of two visibilities, as of what was baked and of a blocker that moves: a blocker whose edge
// is the baked one takes hardly more away. For two hard lobes and lights of 1 to 9 degrees within 0.04 RMS of quadrature (the product
// of their means 0.054), and for one edge twice within 0.05 (0.108): tests/edges_test.cpp.
APERTURA_FN lpfloat meanOfBoth(LightVisibility a, LightVisibility b, CapLight light) {
    lpfloat alongA = dot(a.slope, light.axis);
    lpfloat alongB = dot(b.slope, light.axis);
    lpfloat correlation = covariance(dot(a.slope, b.slope), alongA, alongB, light) * inverseDeviationOfLobe(a.slope, alongA, light)
                        * inverseDeviationOfLobe(b.slope, alongB, light);
    return meanOfTwo(a.mean, b.mean, edgeAlignment(correlation));
}

#endif
