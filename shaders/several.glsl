// The light that several lobes or apertures let through together. GLSL and C++ include this text.
#ifndef APERTURA_SEVERAL_GLSL
#define APERTURA_SEVERAL_GLSL
#include "receiver.glsl"

// The mean visibility of `count` lobes, 2 to 4, from the mean products of their factors. Lobes 0 and 1 of three or more,
// and lobes 2 and 3 of four, may be a pair: its factor is 1 - the product of the two.
APERTURA_FN lpfloat combineLobes(int count, MeanProducts m, Combination c) {
    lpfloat product = m.all;
    if (count >= 3 && c.pairs > lpfloat(0.5))
        product = count >= 4 && c.pairs > lpfloat(1.5) ? lpfloat(1.0) - m.pair.x - m.pair.y + m.all : m.last - m.all;
    return c.complement > lpfloat(0.5) ? lpfloat(1.0) - product : product;
}

// The mean products of `count` lobes or apertures, 2 to 4, over a light.
//   p                 the mean of what each lets through (lobes) or blocks (apertures)
//   along             dot of each slope or axis with the light's axis
//   inverseDeviation  inverseDeviationOfLobe or inverseDeviationOfCap of each
APERTURA_FN MeanProducts productsOver(Receiver receiver, int count, lpvec4 p, lpvec4 along, lpvec4 inverseDeviation, CapLight light) {
    lpvec3 s[4];
    for (int k = 0; k < 4; ++k) s[k] = lpvec3(receiver.params[min(k, count - 1)]);
    lpfloat w1 = edgeAlignment(covariance(dot(s[0], s[1]), along.x, along.y, light) * inverseDeviation.x * inverseDeviation.y);
    lpvec2 w2 = lpvec2(lpfloat(0.0));
    lpvec3 w3 = lpvec3(lpfloat(0.0));
    for (int k = 0; k < 2 && count >= 3; ++k)
        w2[k] = edgeAlignment(covariance(dot(s[k], s[2]), along[k], along.z, light) * inverseDeviation[k] * inverseDeviation.z);
    for (int k = 0; k < 3 && count >= 4; ++k)
        w3[k] = edgeAlignment(covariance(dot(s[k], s[3]), along[k], along.w, light) * inverseDeviation[k] * inverseDeviation.w);
    return meanProducts(count, p, w1, w2, w3);
}

// E of a cap light through `count` lobes, 2 to 4.
APERTURA_FN lpfloat irradianceThroughLobes(Receiver receiver, int count, CapLight light, int lightClass) {
    lpvec3 n = receiver.normal;
    Combination combine = combinationIn(receiver.params[count]);
    lpvec4 p = lpvec4(lpfloat(1.0));
    lpvec4 along = lpvec4(lpfloat(0.0));
    lpvec4 inverseDeviation = lpvec4(lpfloat(0.0));
    lpfloat visible = lpfloat(0.0);
    if (lightClass == LIGHTS_ANY) {
        FourLights four = quarters(n, light);
        for (int i = 0; i < 4; ++i) {
            CapLight part = four.part;
            part.axis = four.axis[i];
            for (int k = 0; k < count; ++k) {
                SoftAperture lobe = softIn(receiver.params[k]);
                along[k] = dot(lobe.slope, part.axis);
                p[k] = softStepOverLight(n, lobe.offset + along[k], lobe.slope, part, lobeQuarter(count));
                inverseDeviation[k] = inverseDeviationOfLobe(lobe.slope, along[k], part);
            }
            visible += four.weight[i] * combineLobes(count, productsOver(receiver, count, p, along, inverseDeviation, part), combine);
        }
    } else {
        for (int k = 0; k < count; ++k) {
            SoftAperture lobe = softIn(receiver.params[k]);
            along[k] = dot(lobe.slope, light.axis);
            p[k] = lightClass == LIGHTS_SUN   ? softStep(lobe.offset + along[k])
                 : lightClass == LIGHTS_SMALL ? lobeOverMedium(lobe, light)
                                              : softStepOverLight(n, lobe.offset + along[k], lobe.slope, light, lobeDisc());
            inverseDeviation[k] = inverseDeviationOfLobe(lobe.slope, along[k], light);
        }
        if (lightClass == LIGHTS_SUN) return unoccludedIrradiance(n, light, lightClass) * combineLobes(count, plainProducts(p), combine);
        visible = combineLobes(count, productsOver(receiver, count, p, along, inverseDeviation, light), combine);
    }
    return unoccludedIrradiance(n, light, lightClass) * visible;
}

// The fraction of a cap light, 0..1, that at least one of `count` apertures, 1 to 4, lets through: 1 - the product of
// what each blocks.
APERTURA_FN lpfloat visibleFractionOfUnion(Receiver receiver, int count, CapLight light, int lightClass) {
    lpvec4 kept = lpvec4(lpfloat(1.0));
    lpvec4 along = lpvec4(lpfloat(0.0));
    lpvec4 inverseDeviation = lpvec4(lpfloat(0.0));
    for (int k = 0; k < count; ++k) {
        Aperture aperture = apertureOfUnion(receiver, count, k);
        along[k] = dot(aperture.axis, light.axis);
        inverseDeviation[k] = inverseDeviationOfCap(along[k], light);
        kept[k] = lpfloat(1.0) - visibleFraction(receiver.normal, aperture, light, lightClass);
    }
    return lpfloat(1.0) - productsOver(receiver, count, kept, along, inverseDeviation, light).all;
}

#endif
