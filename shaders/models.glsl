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
        v += blur.y * (dot(y.c[0], receiver.params[0]) + y.c[1].x * receiver.params[1].x);
        if (bands >= 4) {
            vec3 band3 = vec3(y.c[1].y * receiver.params[1].y, y.c[1].z * receiver.params[1].z, y.c[1].w * receiver.params[1].w);
            v += blur.z * (band3.x + band3.y + band3.z + dot(y.c[2], receiver.params[2]));
            v += blur.w * (dot(y.c[3], receiver.params[3]) + dot(y.c[4], receiver.params[4]) + y.c[5].x * receiver.params[5].x);
        }
    }
    return clamp(v, 0.0f, 1.0f);
}

// E of a cap light by one model's formula.
APERTURA_FN float irradianceThroughModel(int model, Receiver receiver, CapLight light, int lightClass) {
    vec3 n = receiver.normal;
    vec3 zero = vec3(0.0f);  // the published formula makes its own of the height
    if (model == MODEL_OAT) return oatIrradianceThroughAperture(n, apertureIn(receiver.params[0], zero), light);
    // Where the sizes of the caps stand: sh/models.cpp puts them there.
    if (model == MODEL_APERTURE || model == MODEL_ALPHA) {
        float e = irradianceThroughAperture(n, apertureIn(receiver.params[0], vec3(receiver.params[1].y, receiver.params[1].z, receiver.params[1].w)), light, lightClass);
        return model == MODEL_ALPHA ? receiver.params[1].x * e : e;
    }
    vec4 sizes = receiver.params[3];  // of two
    vec4 combine = receiver.params[2];
    Aperture first = apertureIn(receiver.params[0], vec3(sizes.x, sizes.y, combine.z));
    Aperture second = apertureIn(receiver.params[1], vec3(sizes.z, sizes.w, combine.w));
    if (model == MODEL_ANTI) {
        float cap = irradianceThroughAperture(n, first, light, lightClass);
        float anti = unoccludedIrradiance(n, light, lightClass) - irradianceThroughAperture(n, second, light, lightClass);
        return mix(cap, max(anti, 0.0f), combine.x);
    }
    if (model == MODEL_CAP_ANTI) return irradianceThroughTwoCaps(n, first, second, combine.y, combine.x, light, lightClass);
    if (model == MODEL_SOFT) return irradianceThroughSoft(n, softIn(receiver.params[0]), light, lightClass);
    if (model == MODEL_SOFT_2 || model == MODEL_FIRM_2) return irradianceThroughLobes(receiver, 2, light, lightClass);
    if (model == MODEL_FIRM_3) return irradianceThroughLobes(receiver, 3, light, lightClass);
    if (model == MODEL_FIRM_4) return irradianceThroughLobes(receiver, 4, light, lightClass);
    if (model == MODEL_SOFT_L2)
        return irradianceThroughQuadric(n, SoftQuadric(vec3(receiver.params[0]), receiver.params[0].w, receiver.params[1], receiver.params[2].x),
                                   light, lightClass);
    if (model == MODEL_HORIZON)
        return irradianceOverHorizon(n, receiver.params[0], receiver.params[1], receiver.params[2], receiver.params[3], light, lightClass);
    float open = unoccludedIrradiance(n, light, lightClass);
    if (model == MODEL_MULTI_2 || model == MODEL_MULTI_3 || model == MODEL_MULTI_4) {
        int count = model == MODEL_MULTI_2 ? 2 : (model == MODEL_MULTI_3 ? 3 : 4);
        return open * visibleFractionOfUnion(receiver, count, light, lightClass);
    }
    if (model == MODEL_SH_L1) return open * shVisibility(receiver, light, 1);
    if (model == MODEL_SH_L2) return open * shVisibility(receiver, light, 2);
    if (model == MODEL_SH_L4) return open * shVisibility(receiver, light, 4);
    if (model == MODEL_AO) return open * min(receiver.visibility.w / (2.0f * PI), 1.0f);
    return open;
}

// The same for `auto` too, which holds the number of its own choice for this point in params[4].y.
APERTURA_FN float irradianceThroughChoice(int model, Receiver receiver, CapLight light, int lightClass) {
    if (model != MODEL_AUTO) return irradianceThroughModel(model, receiver, light, lightClass);
    int chosen = int(receiver.params[4].y + 0.5f);
    if (chosen == MODEL_AO) return irradianceThroughModel(MODEL_AO, receiver, light, lightClass);
    if (chosen == MODEL_APERTURE) return irradianceThroughModel(MODEL_APERTURE, receiver, light, lightClass);
    // Of a light over 10 degrees, which may be larger than the blocker that a soft aperture stands for, a quadric that
    // does not bend: it takes the light in four parts.
    if (chosen == MODEL_SOFT && lightClass != LIGHTS_ANY) return irradianceThroughModel(MODEL_SOFT, receiver, light, lightClass);
    if (chosen == MODEL_SOFT_2 || chosen == MODEL_FIRM_2) return irradianceThroughLobes(receiver, 2, light, lightClass);
    if (chosen == MODEL_SOFT || chosen == MODEL_SOFT_L2) return irradianceThroughModel(MODEL_SOFT_L2, receiver, light, lightClass);
    if (chosen == MODEL_FIRM_3) return irradianceThroughLobes(receiver, 3, light, lightClass);
    return irradianceThroughLobes(receiver, 4, light, lightClass);
}

// E of a sky of unit radiance all around. It is exactly dot(normal, D), which every asset has; the
// published method and plain occlusion know only the cap, or its area.
APERTURA_FN float skyIrradiance(int model, Receiver receiver) {
    if (model == MODEL_OAT) {
        Aperture aperture = makeAperture(vec3(receiver.params[0]), receiver.params[0].w);
        return 2.0f * PI * aperture.height * max(dot(receiver.normal, aperture.axis), 0.0f);
    }
    if (model == MODEL_UNSHADOWED) return PI;
    if (model == MODEL_AO) return 0.5f * receiver.visibility.w;
    return max(dot(receiver.normal, vec3(receiver.visibility)), 0.0f);
}

// E of a cap light at the receiver. `lightClass`: the least of LIGHTS_... that covers it. No light brings more than all of the sky
// does, which is known exactly: so no large one shines through an opening that is smaller than its formula's error.
APERTURA_FN float irradianceThrough(int model, Receiver receiver, CapLight light, int lightClass) {
    float e = irradianceThroughChoice(model, receiver, light, lightClass);
    bool bounded = model >= MODEL_SOFT && model != MODEL_HORIZON && lightClass == LIGHTS_ANY;
    return bounded ? min(e, skyIrradiance(model, receiver)) : e;
}

#endif
