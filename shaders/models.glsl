// The visibility models: what each makes of one light and of the sky.
// GLSL and C++ include this text; sh/models.cpp names them and says what they store.
#ifndef APERTURA_MODELS_GLSL
#define APERTURA_MODELS_GLSL
#include "harmonics.glsl"
#include "horizon.glsl"
#include "several.glsl"

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

// E of a cap light by one model's formula.
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

// The same for `auto` too, which holds the number of its own choice for this point in form[4].y.
APERTURA_FN float lightThroughChosen(int model, Receiver receiver, CapLight light, int size) {
    if (model != MODEL_AUTO) return lightThroughOne(model, receiver, light, size);
    int chosen = int(receiver.form[4].y + 0.5f);
    if (chosen == MODEL_AO) return lightThroughOne(MODEL_AO, receiver, light, size);
    if (chosen == MODEL_APERTURE) return lightThroughOne(MODEL_APERTURE, receiver, light, size);
    // Of a light over 10 degrees, which may be larger than the blocker that a soft aperture stands for, a quadric that
    // does not bend: it takes the light in four parts.
    if (chosen == MODEL_SOFT && size != LIGHTS_ANY) return lightThroughOne(MODEL_SOFT, receiver, light, size);
    if (chosen == MODEL_SOFT_2 || chosen == MODEL_FIRM_2) return lightThroughLobes(receiver, 2, light, size);
    if (chosen == MODEL_SOFT || chosen == MODEL_SOFT_L2) return lightThroughOne(MODEL_SOFT_L2, receiver, light, size);
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

// E of a cap light at the receiver. `size`: the least of LIGHTS_... that covers it. No light brings more than all of the sky
// does, which is known exactly: so no large one shines through an opening that is smaller than its formula's error.
APERTURA_FN float lightThrough(int model, Receiver receiver, CapLight light, int size) {
    float e = lightThroughChosen(model, receiver, light, size);
    bool bounded = model >= MODEL_SOFT && model != MODEL_HORIZON && size == LIGHTS_ANY;
    return bounded ? min(e, skyThrough(model, receiver)) : e;
}

#endif
