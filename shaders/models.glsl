// The visibility models, by number: what each makes of one light and of the sky.
// GLSL and C++ include this text; sh/models.cpp names them and says what they store.
#ifndef APERTURA_MODELS_GLSL
#define APERTURA_MODELS_GLSL
#include "aperture.glsl"
#include "harmonics.glsl"
#include "horizon.glsl"
#include "soft.glsl"

const int MODEL_UNSHADOWED = 0;
const int MODEL_AO = 1;
const int MODEL_SH_L1 = 2;
const int MODEL_SH_L2 = 3;
const int MODEL_SH_L4 = 4;
const int MODEL_OAT = 5;
const int MODEL_APERTURE = 6;
const int MODEL_ALPHA = 7;
const int MODEL_ANTI = 8;
const int MODEL_SOFT = 9;
const int MODEL_FIRM_2 = 10;
const int MODEL_SOFT_2 = 11;
const int MODEL_SOFT_L2 = 12;
const int MODEL_FIRM_3 = 13;
const int MODEL_FIRM_4 = 14;
const int MODEL_MULTI_2 = 15;
const int MODEL_MULTI_3 = 16;
const int MODEL_MULTI_4 = 17;
const int MODEL_CAP_ANTI = 18;
const int MODEL_HORIZON = 19;
const int MODEL_AUTO = 20;
const int MODEL_COUNT = 21;

// The vec4s that a model's form of one point takes in the shader, at most.
const int MAX_SLOTS = 6;

// What one receiver sees. `form` is the model's own (sh/models.cpp says what stands in each slot).
struct Receiver {
    vec3 normal;      // unit
    vec4 visibility;  // D, A, sr
    vec4 form[MAX_SLOTS];  // axes unit: see settled
};

APERTURA_FN SoftAperture softIn(vec4 slot) { return SoftAperture(vec3(slot), slot.w); }

APERTURA_FN Aperture apertureIn(vec4 slot, vec3 size) { return Aperture(vec3(slot), slot.w, size); }

// An axis made unit again; where nothing is left of it the normal is the best guess.
APERTURA_FN vec4 unitAxis(vec4 slot, vec3 normal) {
    vec3 axis = vec3(slot);
    float squared = dot(axis, axis);
    return vec4(squared > 1e-8f ? axis * inversesqrt(squared) : normal, slot.w);
}

// A receiver whose form was interpolated, ready for its model: the axes of apertures have become shorter, and
// their sizes are made anew.
APERTURA_FN Receiver settled(int model, Receiver receiver) {
    if (model == MODEL_OAT || model == MODEL_APERTURE || model == MODEL_ALPHA || model == MODEL_ANTI)
        receiver.form[0] = unitAxis(receiver.form[0], receiver.normal);
    if (model == MODEL_ANTI) receiver.form[1] = unitAxis(receiver.form[1], receiver.normal);
    vec3 size = sizeOf(receiver.form[0].w);
    if (model == MODEL_APERTURE || model == MODEL_ALPHA) receiver.form[1] = vec4(receiver.form[1].x, size.x, size.y, size.z);
    if (model == MODEL_ANTI) {
        vec3 other = sizeOf(receiver.form[1].w);
        receiver.form[2] = vec4(receiver.form[2].x, 0.0f, size.z, other.z);
        receiver.form[3] = vec4(size.x, size.y, other.x, other.y);
    }
    return receiver;
}

// Visibility averaged over a cap light, from its SH up to band `bands`.
APERTURA_FN float shVisibility(Receiver receiver, CapLight light, int bands) {
    vec4 blur = capBlur(light.height);
    float v = (receiver.visibility.w + 3.0f * blur.x * dot(vec3(receiver.visibility), light.axis)) / (4.0f * PI);
    if (bands >= 2) {
        HighBands y = highBands(light.axis);
        v += blur.y * (dot(y.c[0], receiver.form[0]) + y.c[1].x * receiver.form[1].x);
        if (bands >= 4) {
            vec3 band3 = vec3(y.c[1].y * receiver.form[1].y, y.c[1].z * receiver.form[1].z, y.c[1].w * receiver.form[1].w);
            v += blur.z * (band3.x + band3.y + band3.z + dot(y.c[2], receiver.form[2]));
            v += blur.w * (dot(y.c[3], receiver.form[3]) + dot(y.c[4], receiver.form[4]) + y.c[5].x * receiver.form[5].x);
        }
    }
    return clamp(v, 0.0f, 1.0f);
}

// What `count` lobes, two to four, let through together. Lobe 0 and 1 of more than two, and 2 and 3 of four, may
// make a pair: how.w of those pairs let through what their product leaves of 1. Where how.x is 1, so do all.
APERTURA_FN float lobesTogether(int count, MeanProducts m, vec4 how) {
    float through = m.all;
    if (count >= 3 && how.w > 0.5f) through = count >= 4 && how.w > 1.5f ? 1.0f - m.pair.x - m.pair.y + m.all : m.last - m.all;
    return how.x > 0.5f ? 1.0f - through : through;
}

// The products of `count` lobes over a light from what each lets through. `along`: dot(slope, light.axis).
APERTURA_FN MeanProducts lobeProducts(Receiver receiver, int count, vec4 p, vec4 along, CapLight light) {
    vec3 s[4];
    for (int k = 0; k < 4; ++k) s[k] = vec3(receiver.form[min(k, count - 1)]);
    float w1 = edgesOver(s[0], along.x, s[1], along.y, light);
    vec2 w2 = vec2(0.0f);
    vec3 w3 = vec3(0.0f);
    if (count >= 3) w2 = vec2(edgesOver(s[0], along.x, s[2], along.z, light), edgesOver(s[1], along.y, s[2], along.z, light));
    if (count >= 4)
        w3 = vec3(edgesOver(s[0], along.x, s[3], along.w, light), edgesOver(s[1], along.y, s[3], along.w, light), edgesOver(s[2], along.z, s[3], along.w, light));
    return meanProducts(count, p, w1, w2, w3);
}

// E of a cap light through `count` lobes, two to four; how they go together stands in the slot behind them.
APERTURA_FN float lightThroughLobes(Receiver receiver, int count, CapLight light, int size) {
    vec3 n = receiver.normal;
    vec4 how = receiver.form[count];
    vec4 p = vec4(1.0f);
    vec4 along = vec4(0.0f);
    float visible = 0.0f;
    if (size == LIGHTS_ANY) {
        FourLights four = quarters(n, light);
        for (int i = 0; i < 4; ++i) {
            CapLight part = four.part;
            part.axis = four.axis[i];
            for (int k = 0; k < count; ++k) {
                SoftAperture lobe = softIn(receiver.form[k]);
                along[k] = dot(lobe.slope, part.axis);
                p[k] = linkOverLight(n, lobe.offset + along[k], lobe.slope, part, quarterDisc());
            }
            visible += four.weight[i] * lobesTogether(count, lobeProducts(receiver, count, p, along, part), how);
        }
    } else {
        for (int k = 0; k < count; ++k) {
            SoftAperture lobe = softIn(receiver.form[k]);
            along[k] = dot(lobe.slope, light.axis);
            p[k] = size == LIGHTS_SUN     ? link(lobe.offset + along[k])
                 : size == LIGHTS_SMALL ? lobeOverMedium(lobe, light)
                                        : linkOverLight(n, lobe.offset + along[k], lobe.slope, light, mediumDisc());
        }
        if (size == LIGHTS_SUN) return lightOnSurface(n, light, size) * lobesTogether(count, plainProducts(p), how);
        visible = lobesTogether(count, lobeProducts(receiver, count, p, along, light), how);
    }
    return lightOnSurface(n, light, size) * visible;
}

// The share of a cap light that at least one of two to four apertures lets through: what the product of what each
// keeps back leaves of 1.
APERTURA_FN float shareOfAny(Receiver receiver, int count, CapLight light, int size) {
    vec4 kept = vec4(1.0f);
    vec4 cosine = vec4(0.0f);  // between their axes and the light's
    for (int k = 0; k < count; ++k) {
        vec4 slot = receiver.form[k];
        vec4 two = receiver.form[count + k / 2];
        vec2 own = (k & 1) == 0 ? vec2(two.x, two.y) : vec2(two.z, two.w);
        cosine[k] = dot(vec3(slot), light.axis);
        kept[k] = 1.0f - shareThroughAperture(receiver.normal, apertureIn(slot, vec3(own.x, own.y, 0.0f)), light, size);
    }
    vec3 a[4];
    for (int k = 0; k < 4; ++k) a[k] = vec3(receiver.form[min(k, count - 1)]);
    float w1 = rimsOver(dot(a[0], a[1]), cosine.x, cosine.y, light, size);
    vec2 w2 = vec2(0.0f);
    vec3 w3 = vec3(0.0f);
    if (count >= 3) w2 = vec2(rimsOver(dot(a[0], a[2]), cosine.x, cosine.z, light, size), rimsOver(dot(a[1], a[2]), cosine.y, cosine.z, light, size));
    if (count >= 4)
        w3 = vec3(rimsOver(dot(a[0], a[3]), cosine.x, cosine.w, light, size), rimsOver(dot(a[1], a[3]), cosine.y, cosine.w, light, size),
                  rimsOver(dot(a[2], a[3]), cosine.z, cosine.w, light, size));
    return 1.0f - meanProducts(count, kept, w1, w2, w3).all;
}

// E of a cap light at the receiver. `size`: the least of LIGHTS_... that covers it.
APERTURA_FN float lightThroughOne(int model, Receiver receiver, CapLight light, int size) {
    vec3 n = receiver.normal;
    vec3 zero = vec3(0.0f);  // the published formula makes its own of the height
    if (model == MODEL_OAT) return oatLightThroughAperture(n, apertureIn(receiver.form[0], zero), light);
    // Where the sizes of the caps stand: sh/models.cpp puts them there.
    if (model == MODEL_APERTURE || model == MODEL_ALPHA) {
        float e = lightThroughAperture(n, apertureIn(receiver.form[0], vec3(receiver.form[1].y, receiver.form[1].z, receiver.form[1].w)), light, size);
        return model == MODEL_ALPHA ? receiver.form[1].x * e : e;
    }
    vec4 sizes = receiver.form[3];  // of two
    vec4 how = receiver.form[2];
    Aperture first = apertureIn(receiver.form[0], vec3(sizes.x, sizes.y, how.z));
    Aperture second = apertureIn(receiver.form[1], vec3(sizes.z, sizes.w, how.w));
    if (model == MODEL_ANTI) {
        float cap = lightThroughAperture(n, first, light, size);
        float anti = lightOnSurface(n, light, size) - lightThroughAperture(n, second, light, size);
        return mix(cap, max(anti, 0.0f), how.x);
    }
    if (model == MODEL_CAP_ANTI) return lightThroughTwoCaps(n, first, second, how.y, how.x, light, size);
    if (model == MODEL_SOFT) return lightThroughSoft(n, softIn(receiver.form[0]), light, size);
    if (model == MODEL_SOFT_2 || model == MODEL_FIRM_2) return lightThroughLobes(receiver, 2, light, size);
    if (model == MODEL_FIRM_3) return lightThroughLobes(receiver, 3, light, size);
    if (model == MODEL_FIRM_4) return lightThroughLobes(receiver, 4, light, size);
    if (model == MODEL_SOFT_L2)
        return lightThroughQuadric(n, SoftQuadric(vec3(receiver.form[0]), receiver.form[0].w, receiver.form[1], receiver.form[2].x),
                                   light, size);
    if (model == MODEL_HORIZON)
        return lightOverHorizon(n, receiver.form[0], receiver.form[1], receiver.form[2], receiver.form[3], light, size);
    float open = lightOnSurface(n, light, size);
    if (model == MODEL_MULTI_2 || model == MODEL_MULTI_3 || model == MODEL_MULTI_4) {
        int count = model == MODEL_MULTI_2 ? 2 : (model == MODEL_MULTI_3 ? 3 : 4);
        return open * shareOfAny(receiver, count, light, size);
    }
    if (model == MODEL_SH_L1) return open * shVisibility(receiver, light, 1);
    if (model == MODEL_SH_L2) return open * shVisibility(receiver, light, 2);
    if (model == MODEL_SH_L4) return open * shVisibility(receiver, light, 4);
    if (model == MODEL_AO) return open * min(receiver.visibility.w / (2.0f * PI), 1.0f);
    return open;
}

// The same for every model; `auto` holds the number of its own choice for this point in form[4].y.
APERTURA_FN float lightThrough(int model, Receiver receiver, CapLight light, int size) {
    if (model != MODEL_AUTO) return lightThroughOne(model, receiver, light, size);
    int chosen = int(receiver.form[4].y + 0.5f);
    if (chosen == MODEL_AO) return lightThroughOne(MODEL_AO, receiver, light, size);
    if (chosen == MODEL_APERTURE) return lightThroughOne(MODEL_APERTURE, receiver, light, size);
    if (chosen == MODEL_SOFT) return lightThroughOne(MODEL_SOFT, receiver, light, size);
    if (chosen == MODEL_SOFT_2 || chosen == MODEL_FIRM_2) return lightThroughLobes(receiver, 2, light, size);
    if (chosen == MODEL_SOFT_L2) return lightThroughOne(MODEL_SOFT_L2, receiver, light, size);
    if (chosen == MODEL_FIRM_3) return lightThroughLobes(receiver, 3, light, size);
    return lightThroughLobes(receiver, 4, light, size);
}

// E of a sky of unit radiance all around. It is exactly dot(normal, D), which every asset has; the
// published method and plain occlusion know only the cap, or its area.
APERTURA_FN float skyThrough(int model, Receiver receiver) {
    if (model == MODEL_OAT) {
        Aperture aperture = makeAperture(vec3(receiver.form[0]), receiver.form[0].w);
        return 2.0f * PI * aperture.height * max(dot(receiver.normal, aperture.axis), 0.0f);
    }
    if (model == MODEL_UNSHADOWED) return PI;
    if (model == MODEL_AO) return 0.5f * receiver.visibility.w;
    return max(dot(receiver.normal, vec3(receiver.visibility)), 0.0f);
}

#endif
