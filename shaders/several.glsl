// What several lobes or apertures let through together. GLSL and C++ include this text.
#ifndef APERTURA_SEVERAL_GLSL
#define APERTURA_SEVERAL_GLSL
#include "receiver.glsl"

// What `count` lobes, two to four, let through together. Lobe 0 and 1 of more than two, and 2 and 3 of four, may
// make a pair: how.w of those pairs let through what their product leaves of 1. Where how.x is 1, so do all.
APERTURA_FN float lobesTogether(int count, MeanProducts m, vec4 how) {
    float through = m.all;
    if (count >= 3 && how.w > 0.5f) through = count >= 4 && how.w > 1.5f ? 1.0f - m.pair.x - m.pair.y + m.all : m.last - m.all;
    return how.x > 0.5f ? 1.0f - through : through;
}

// The products of `count` lobes or apertures over a light, from what each lets through or keeps back. `along`: dot of
// each one's slope or axis and the light's; `inverseDeviation`: of each, 1 over its deviation.
APERTURA_FN MeanProducts productsOver(Receiver receiver, int count, vec4 p, vec4 along, vec4 inverseDeviation, CapLight light) {
    vec3 s[4];
    for (int k = 0; k < 4; ++k) s[k] = vec3(receiver.form[min(k, count - 1)]);
    float w1 = edgeShare(covariance(dot(s[0], s[1]), along.x, along.y, light) * inverseDeviation.x * inverseDeviation.y);
    vec2 w2 = vec2(0.0f);
    vec3 w3 = vec3(0.0f);
    for (int k = 0; k < 2 && count >= 3; ++k) w2[k] = edgeShare(covariance(dot(s[k], s[2]), along[k], along.z, light) * inverseDeviation[k] * inverseDeviation.z);
    for (int k = 0; k < 3 && count >= 4; ++k) w3[k] = edgeShare(covariance(dot(s[k], s[3]), along[k], along.w, light) * inverseDeviation[k] * inverseDeviation.w);
    return meanProducts(count, p, w1, w2, w3);
}

// E of a cap light through `count` lobes, two to four; how they go together stands in the slot behind them.
APERTURA_FN float lightThroughLobes(Receiver receiver, int count, CapLight light, int size) {
    vec3 n = receiver.normal;
    vec4 how = receiver.form[count];
    vec4 p = vec4(1.0f);
    vec4 along = vec4(0.0f);
    vec4 inverseDeviation = vec4(0.0f);
    float visible = 0.0f;
    if (size == LIGHTS_ANY) {
        FourLights four = quarters(n, light);
        for (int i = 0; i < 4; ++i) {
            CapLight part = four.part;
            part.axis = four.axis[i];
            for (int k = 0; k < count; ++k) {
                SoftAperture lobe = softIn(receiver.form[k]);
                along[k] = dot(lobe.slope, part.axis);
                p[k] = linkOverLight(n, lobe.offset + along[k], lobe.slope, part, lobeQuarter(count));
                inverseDeviation[k] = inverseDeviationOfLobe(lobe.slope, along[k], part);
            }
            visible += four.weight[i] * lobesTogether(count, productsOver(receiver, count, p, along, inverseDeviation, part), how);
        }
    } else {
        for (int k = 0; k < count; ++k) {
            SoftAperture lobe = softIn(receiver.form[k]);
            along[k] = dot(lobe.slope, light.axis);
            p[k] = size == LIGHTS_SUN     ? link(lobe.offset + along[k])
                 : size == LIGHTS_SMALL ? lobeOverMedium(lobe, light)
                                        : linkOverLight(n, lobe.offset + along[k], lobe.slope, light, lobeDisc());
            inverseDeviation[k] = inverseDeviationOfLobe(lobe.slope, along[k], light);
        }
        if (size == LIGHTS_SUN) return lightOnSurface(n, light, size) * lobesTogether(count, plainProducts(p), how);
        visible = lobesTogether(count, productsOver(receiver, count, p, along, inverseDeviation, light), how);
    }
    return lightOnSurface(n, light, size) * visible;
}

// The share of a cap light that at least one of two to four apertures lets through: what the product of what each
// keeps back leaves of 1.
APERTURA_FN float shareOfAny(Receiver receiver, int count, CapLight light, int size) {
    vec4 kept = vec4(1.0f);
    vec4 along = vec4(0.0f);
    vec4 inverseDeviation = vec4(0.0f);
    for (int k = 0; k < count; ++k) {
        vec4 slot = receiver.form[k];
        vec4 two = receiver.form[count + k / 2];
        vec2 own = (k & 1) == 0 ? vec2(two.x, two.y) : vec2(two.z, two.w);
        along[k] = dot(vec3(slot), light.axis);
        inverseDeviation[k] = inverseDeviationOfCap(along[k], light);
        kept[k] = 1.0f - shareThroughAperture(receiver.normal, apertureIn(slot, vec3(own.x, own.y, 0.0f)), light, size);
    }
    return 1.0f - productsOver(receiver, count, kept, along, inverseDeviation, light).all;
}

#endif
