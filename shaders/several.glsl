// The light that several lobes or apertures let through together. GLSL and C++ include this text.
#ifndef APERTURA_SEVERAL_GLSL
#define APERTURA_SEVERAL_GLSL
#include "receiver.glsl"

// The mean visibility of `count` lobes, 2 to 4, from the mean products of their factors. Lobes 0 and 1 of three or more,
// and lobes 2 and 3 of four, may be a pair: its factor is 1 - the product of the two.
APERTURA_FN AperturaFloat aperturaCombineLobes(int count, AperturaMeanProducts m, AperturaCombination c) {
    AperturaFloat product = m.all;
    if (count >= 3 && c.pairs > AperturaFloat(0.5))
        product = count >= 4 && c.pairs > AperturaFloat(1.5) ? AperturaFloat(1.0) - m.pair.x - m.pair.y + m.all : m.last - m.all;
    return c.complement > AperturaFloat(0.5) ? AperturaFloat(1.0) - product : product;
}

// The mean products of `count` lobes or apertures, 2 to 4, over a light.
//   p                 the mean of what each lets through (lobes) or blocks (apertures)
//   along             dot of each slope or axis with the light's axis
//   inverseDeviation  aperturaInverseDeviationOfLobe or aperturaInverseDeviationOfCap of each
APERTURA_FN AperturaMeanProducts aperturaProductsOver(AperturaReceiver receiver, int count, AperturaVec4 p, AperturaVec4 along,
                                                      AperturaVec4 inverseDeviation, AperturaCapLight light) {
    AperturaVec3 s[4];
    for (int k = 0; k < 4; ++k) s[k] = AperturaVec3(receiver.params[min(k, count - 1)]);
    AperturaFloat w1 = aperturaEdgeAlignment(aperturaCovariance(dot(s[0], s[1]), along.x, along.y, light) * inverseDeviation.x
                                             * inverseDeviation.y);
    AperturaVec2 w2 = AperturaVec2(AperturaFloat(0.0));
    AperturaVec3 w3 = AperturaVec3(AperturaFloat(0.0));
    for (int k = 0; k < 2 && count >= 3; ++k)
        w2[k] = aperturaEdgeAlignment(aperturaCovariance(dot(s[k], s[2]), along[k], along.z, light) * inverseDeviation[k]
                                      * inverseDeviation.z);
    for (int k = 0; k < 3 && count >= 4; ++k)
        w3[k] = aperturaEdgeAlignment(aperturaCovariance(dot(s[k], s[3]), along[k], along.w, light) * inverseDeviation[k]
                                      * inverseDeviation.w);
    return aperturaMeanProducts(count, p, w1, w2, w3);
}

// E of a cap light through `count` lobes, 2 to 4.
APERTURA_FN AperturaFloat aperturaIrradianceThroughLobes(AperturaReceiver receiver, int count, AperturaCapLight light, int lightClass) {
    AperturaVec3 n = receiver.normal;
    AperturaCombination combine = aperturaCombinationIn(receiver.params[count]);
    AperturaVec4 p = AperturaVec4(AperturaFloat(1.0));
    AperturaVec4 along = AperturaVec4(AperturaFloat(0.0));
    AperturaVec4 inverseDeviation = AperturaVec4(AperturaFloat(0.0));
    AperturaFloat visible = AperturaFloat(0.0);
    if (lightClass == APERTURA_LIGHTS_ANY) {
        AperturaFourLights four = aperturaQuarters(n, light);
        for (int i = 0; i < 4; ++i) {
            AperturaCapLight part = four.part;
            part.axis = four.axis[i];
            for (int k = 0; k < count; ++k) {
                AperturaSoftAperture lobe = aperturaSoftIn(receiver.params[k]);
                along[k] = dot(lobe.slope, part.axis);
                p[k] = aperturaSoftStepOverLight(n, lobe.offset + along[k], lobe.slope, part, aperturaLobeQuarter(count));
                inverseDeviation[k] = aperturaInverseDeviationOfLobe(lobe.slope, along[k], part);
            }
            visible += four.weight[i]
                     * aperturaCombineLobes(count, aperturaProductsOver(receiver, count, p, along, inverseDeviation, part), combine);
        }
    } else {
        for (int k = 0; k < count; ++k) {
            AperturaSoftAperture lobe = aperturaSoftIn(receiver.params[k]);
            along[k] = dot(lobe.slope, light.axis);
            p[k] = lightClass == APERTURA_LIGHTS_SUN ? aperturaSoftStep(lobe.offset + along[k])
                 : lightClass == APERTURA_LIGHTS_SMALL
                     ? aperturaLobeOverMedium(lobe, light)
                     : aperturaSoftStepOverLight(n, lobe.offset + along[k], lobe.slope, light, aperturaLobeDisc());
            inverseDeviation[k] = aperturaInverseDeviationOfLobe(lobe.slope, along[k], light);
        }
        if (lightClass == APERTURA_LIGHTS_SUN)
            return aperturaUnoccludedIrradiance(n, light, lightClass) * aperturaCombineLobes(count, aperturaPlainProducts(p), combine);
        visible = aperturaCombineLobes(count, aperturaProductsOver(receiver, count, p, along, inverseDeviation, light), combine);
    }
    return aperturaUnoccludedIrradiance(n, light, lightClass) * visible;
}

// The fraction of a cap light, 0..1, that at least one of `count` apertures, 1 to 4, lets through: 1 - the product of
// what each blocks.
APERTURA_FN AperturaFloat aperturaVisibleFractionOfUnion(AperturaReceiver receiver, int count, AperturaCapLight light, int lightClass) {
    AperturaVec4 kept = AperturaVec4(AperturaFloat(1.0));
    AperturaVec4 along = AperturaVec4(AperturaFloat(0.0));
    AperturaVec4 inverseDeviation = AperturaVec4(AperturaFloat(0.0));
    for (int k = 0; k < count; ++k) {
        AperturaAperture aperture = aperturaApertureOfUnion(receiver, count, k);
        along[k] = dot(aperture.axis, light.axis);
        inverseDeviation[k] = aperturaInverseDeviationOfCap(along[k], light);
        kept[k] = AperturaFloat(1.0) - aperturaVisibleFraction(receiver.normal, aperture, light, lightClass);
    }
    return AperturaFloat(1.0) - aperturaProductsOver(receiver, count, kept, along, inverseDeviation, light).all;
}

#endif
