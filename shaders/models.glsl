// The visibility models: the irradiance that each gives for one light and for the sky.
// GLSL and C++ include this text; sh/models.cpp names the models and says what they store.
#ifndef APERTURA_MODELS_GLSL
#define APERTURA_MODELS_GLSL
#include "rivals.glsl"
#include "several.glsl"

// Returned by aperturaIrradianceThrough for an unknown model: irradiance is never below zero.
const AperturaFloat APERTURA_NO_FORMULA = -AperturaFloat(1.0);

// Visibility averaged over a cap light, 0..1, from its SH bands 0 to `bands` (1, 2 or 4).
APERTURA_FN AperturaFloat aperturaShVisibility(AperturaReceiver receiver, AperturaCapLight light, int bands) {
    AperturaVec4 blur = aperturaCapBlur(light.height);
    AperturaFloat v = (receiver.visibility.w + AperturaFloat(3.0) * blur.x * dot(AperturaVec3(receiver.visibility), light.axis))
                    / (AperturaFloat(4.0) * APERTURA_PI);
    if (bands >= 2) {
        AperturaHighBands y = aperturaHighBands(light.axis);
        v += blur.y * (dot(y.c[0], receiver.params[0]) + y.c[1].x * receiver.params[1].x);
        if (bands >= 4) {
            AperturaVec3 band3 = AperturaVec3(y.c[1].y * receiver.params[1].y, y.c[1].z * receiver.params[1].z,
                                              y.c[1].w * receiver.params[1].w);
            v += blur.z * (band3.x + band3.y + band3.z + dot(y.c[2], receiver.params[2]));
            v += blur.w * (dot(y.c[3], receiver.params[3]) + dot(y.c[4], receiver.params[4]) + y.c[5].x * receiver.params[5].x);
        }
    }
    return clamp(v, AperturaFloat(0.0), AperturaFloat(1.0));
}

// E, at most that of the whole sky, dot(normal, D), which is known exactly: no large light shines through an opening that
// is smaller than its formula's error. Only APERTURA_LIGHTS_ANY needs it.
APERTURA_FN AperturaFloat aperturaAtMostTheSky(AperturaFloat e, AperturaReceiver receiver, int lightClass) {
    return lightClass == APERTURA_LIGHTS_ANY ? min(e, max(dot(receiver.normal, AperturaVec3(receiver.visibility)), AperturaFloat(0.0))) : e;
}

APERTURA_FN AperturaFloat aperturaIrradianceThroughAnti(AperturaReceiver receiver, AperturaCapLight light, int lightClass) {
    AperturaVec3 n = receiver.normal;
    AperturaTwoCaps caps = aperturaTwoCapsIn(receiver);
    AperturaFloat cap = aperturaIrradianceThroughAperture(n, caps.first, light, lightClass);
    AperturaFloat anti = aperturaUnoccludedIrradiance(n, light, lightClass)
                       - aperturaIrradianceThroughAperture(n, caps.second, light, lightClass);
    return mix(cap, max(anti, AperturaFloat(0.0)), caps.weight);
}

APERTURA_FN AperturaFloat aperturaIrradianceThroughCapAnti(AperturaReceiver receiver, AperturaCapLight light, int lightClass) {
    AperturaTwoCaps caps = aperturaTwoCapsIn(receiver);
    return aperturaIrradianceThroughTwoCaps(receiver.normal, caps.first, caps.second, caps.axesDot, caps.weight, light, lightClass);
}

// E of a cap light by the model that APERTURA_MODEL_AUTO chose for the receiver. A light over 10 degrees may be larger than the
// blocker that a soft aperture stands for, so APERTURA_LIGHTS_ANY evaluates APERTURA_MODEL_SOFT as a quadric without a bend, which divides
// the light into four. A chain of ifs, because Mesa compiles a switch over a value that differs between pixels to twice
// the cycles.
APERTURA_FN AperturaFloat aperturaIrradianceThroughChoice(AperturaReceiver receiver, AperturaCapLight light, int lightClass) {
    AperturaVec3 n = receiver.normal;
    int chosen = aperturaChoiceIn(receiver.params[APERTURA_CHOICE_SLOT]).model;
    if (chosen == APERTURA_MODEL_AO_AREA)
        return aperturaUnoccludedIrradiance(n, light, lightClass)
             * min(receiver.visibility.w / (AperturaFloat(2.0) * APERTURA_PI), AperturaFloat(1.0));
    if (chosen == APERTURA_MODEL_APERTURE) return aperturaIrradianceThroughAperture(n, aperturaOnlyApertureIn(receiver), light, lightClass);
    if (chosen == APERTURA_MODEL_SOFT && lightClass != APERTURA_LIGHTS_ANY)
        return aperturaIrradianceThroughSoft(n, aperturaSoftIn(receiver.params[0]), light, lightClass);
    if (chosen == APERTURA_MODEL_SOFT_2 || chosen == APERTURA_MODEL_FIRM_2)
        return aperturaIrradianceThroughLobes(receiver, 2, light, lightClass);
    if (chosen == APERTURA_MODEL_SOFT || chosen == APERTURA_MODEL_SOFT_L2)
        return aperturaIrradianceThroughQuadric(n, aperturaQuadricIn(receiver), light, lightClass);
    if (chosen == APERTURA_MODEL_FIRM_3) return aperturaIrradianceThroughLobes(receiver, 3, light, lightClass);
    if (chosen == APERTURA_MODEL_FIRM_4) return aperturaIrradianceThroughLobes(receiver, 4, light, lightClass);
    return APERTURA_NO_FORMULA;
}

APERTURA_FN int aperturaAzimuthsOf(int model) {
    return model == APERTURA_MODEL_HORIZON_4 ? 4 : model == APERTURA_MODEL_HORIZON_8 ? 8 : model == APERTURA_MODEL_HORIZON_16 ? 16 : 32;
}

// E of a cap light by the rivals of rivals.glsl and horizon.glsl; APERTURA_NO_FORMULA for other models.
APERTURA_FN AperturaFloat aperturaIrradianceByRival(int model, AperturaReceiver receiver, AperturaCapLight light, int lightClass) {
    AperturaFloat open = aperturaUnoccludedIrradiance(receiver.normal, light, lightClass);
    switch (model) {
        case APERTURA_MODEL_AO_COSINE: return open * aperturaOpennessOf(receiver);
        case APERTURA_MODEL_XEGTAO:
        case APERTURA_MODEL_XEGTAO_0:
            return open
                 * aperturaXegtaoVisibility(receiver, light, model == APERTURA_MODEL_XEGTAO ? AperturaFloat(0.1) : AperturaFloat(0.0));
        case APERTURA_MODEL_MICRO_SHADOW: return open * aperturaMicroShadow(receiver, light);
        case APERTURA_MODEL_BENT_CONES: return open * aperturaConeVisibility(receiver, light);
        case APERTURA_MODEL_HORIZON_4:
        case APERTURA_MODEL_HORIZON_8:
        case APERTURA_MODEL_HORIZON_16:
        case APERTURA_MODEL_HORIZON_32: return aperturaIrradianceOverHorizon(receiver, aperturaAzimuthsOf(model), light, lightClass);
        case APERTURA_MODEL_CUBE_6: return open * aperturaCubeVisibility(receiver, light);
        case APERTURA_MODEL_ZH3:
        case APERTURA_MODEL_ZH3_GUESS:
            return open
                 * aperturaZonalVisibility(receiver, light,
                                           model == APERTURA_MODEL_ZH3 ? receiver.params[0].x : aperturaGuessedZonal(receiver));
        case APERTURA_MODEL_BITS_32:
        case APERTURA_MODEL_BITS_128:
            return open * aperturaSectorVisibility(receiver, model == APERTURA_MODEL_BITS_32 ? 4 : 8, light, lightClass);
        default: return APERTURA_NO_FORMULA;
    }
}

// E of a cap light at the receiver, by the formula of `model`; APERTURA_NO_FORMULA for a number that is no model's.
//   model       APERTURA_MODEL_..., best a specialisation constant
//   receiver    its params as toParams (sh/models.h) makes them; see aperturaRenormalised where they were interpolated
//   lightClass  of the APERTURA_LIGHTS_... that cover the light, the one with the smallest radius; best a constant, too
APERTURA_FN AperturaFloat aperturaIrradianceThrough(int model, AperturaReceiver receiver, AperturaCapLight light, int lightClass) {
    AperturaVec3 n = receiver.normal;
    AperturaFloat open = aperturaUnoccludedIrradiance(n, light, lightClass);
    AperturaFloat e = APERTURA_NO_FORMULA;
    switch (model) {
        case APERTURA_MODEL_UNSHADOWED: e = open; break;
        case APERTURA_MODEL_AO_AREA: e = open * min(receiver.visibility.w / (AperturaFloat(2.0) * APERTURA_PI), AperturaFloat(1.0)); break;
        case APERTURA_MODEL_SH_L1: e = open * aperturaShVisibility(receiver, light, 1); break;
        case APERTURA_MODEL_SH_L2: e = open * aperturaShVisibility(receiver, light, 2); break;
        case APERTURA_MODEL_SH_L4: e = open * aperturaShVisibility(receiver, light, 4); break;
        case APERTURA_MODEL_OAT:
            e = aperturaOatIrradianceThroughAperture(n, aperturaApertureIn(receiver.params[0], AperturaVec3(AperturaFloat(0.0))), light);
            break;
        case APERTURA_MODEL_APERTURE: e = aperturaIrradianceThroughAperture(n, aperturaOnlyApertureIn(receiver), light, lightClass); break;
        case APERTURA_MODEL_ALPHA:
            e = aperturaOpacityIn(receiver) * aperturaIrradianceThroughAperture(n, aperturaOnlyApertureIn(receiver), light, lightClass);
            break;
        case APERTURA_MODEL_ANTI: e = aperturaIrradianceThroughAnti(receiver, light, lightClass); break;
        case APERTURA_MODEL_SOFT:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughSoft(n, aperturaSoftIn(receiver.params[0]), light, lightClass), receiver,
                                     lightClass);
            break;
        case APERTURA_MODEL_FIRM_2:
        case APERTURA_MODEL_SOFT_2:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughLobes(receiver, 2, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_SOFT_L2:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughQuadric(n, aperturaQuadricIn(receiver), light, lightClass), receiver,
                                     lightClass);
            break;
        case APERTURA_MODEL_FIRM_3:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughLobes(receiver, 3, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_FIRM_4:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughLobes(receiver, 4, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_MULTI_2:
            e = aperturaAtMostTheSky(open * aperturaVisibleFractionOfUnion(receiver, 2, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_MULTI_3:
            e = aperturaAtMostTheSky(open * aperturaVisibleFractionOfUnion(receiver, 3, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_MULTI_4:
            e = aperturaAtMostTheSky(open * aperturaVisibleFractionOfUnion(receiver, 4, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_CAP_ANTI:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughCapAnti(receiver, light, lightClass), receiver, lightClass);
            break;
        case APERTURA_MODEL_AUTO:
            e = aperturaAtMostTheSky(aperturaIrradianceThroughChoice(receiver, light, lightClass), receiver, lightClass);
            break;
        default: e = aperturaIrradianceByRival(model, receiver, light, lightClass); break;
    }
    return e;
}

// True where a model of one soft aperture takes a light for a point: it then needs offset + dot(slope, axis) of it alone.
APERTURA_FN bool aperturaIsPointFor(int model, int lightClass) { return model == APERTURA_MODEL_SOFT && lightClass == APERTURA_LIGHTS_SUN; }

// True for models whose sky is not made from D alone.
APERTURA_FN bool aperturaSkyNeedsMore(int model) {
    switch (model) {
        case APERTURA_MODEL_AO_AREA:
        case APERTURA_MODEL_OAT:
        case APERTURA_MODEL_CUBE_6: return true;
        default: return false;
    }
}

// E of a sky of unit radiance all around. It is exactly dot(normal, D), which every asset has. APERTURA_MODEL_OAT knows only its
// cap, APERTURA_MODEL_AO_AREA only the area, APERTURA_MODEL_CUBE_6 its own faces.
APERTURA_FN AperturaFloat aperturaSkyIrradiance(int model, AperturaReceiver receiver) {
    switch (model) {
        case APERTURA_MODEL_UNSHADOWED: return APERTURA_PI;
        case APERTURA_MODEL_AO_AREA: return AperturaFloat(0.5) * receiver.visibility.w;
        case APERTURA_MODEL_OAT:
            return AperturaFloat(2.0) * APERTURA_PI * aperturaApertureIn(receiver.params[0], AperturaVec3(AperturaFloat(0.0))).height
                 * max(dot(receiver.normal, aperturaApertureIn(receiver.params[0], AperturaVec3(AperturaFloat(0.0))).axis),
                       AperturaFloat(0.0));
        case APERTURA_MODEL_CUBE_6: return aperturaSkyThroughCube(receiver);
        default: return max(dot(receiver.normal, AperturaVec3(receiver.visibility)), AperturaFloat(0.0));
    }
}

#endif
