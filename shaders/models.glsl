// The visibility models: the irradiance that each gives for one light and for the sky.
// GLSL and C++ include this text; sh/models.cpp names the models and says what they store.
#ifndef APERTURA_MODELS_GLSL
#define APERTURA_MODELS_GLSL
#include "rivals.glsl"
#include "several.glsl"

// Returned by irradianceThrough for an unknown model: irradiance is never below zero.
const lpfloat NO_FORMULA = -lpfloat(1.0);

// Visibility averaged over a cap light, 0..1, from its SH bands 0 to `bands` (1, 2 or 4).
APERTURA_FN lpfloat shVisibility(Receiver receiver, CapLight light, int bands) {
    lpvec4 blur = capBlur(light.height);
    lpfloat v = (receiver.visibility.w + lpfloat(3.0) * blur.x * dot(lpvec3(receiver.visibility), light.axis)) / (lpfloat(4.0) * PI);
    if (bands >= 2) {
        HighBands y = highBands(light.axis);
        v += blur.y * (dot(y.c[0], receiver.params[0]) + y.c[1].x * receiver.params[1].x);
        if (bands >= 4) {
            lpvec3 band3 = lpvec3(y.c[1].y * receiver.params[1].y, y.c[1].z * receiver.params[1].z, y.c[1].w * receiver.params[1].w);
            v += blur.z * (band3.x + band3.y + band3.z + dot(y.c[2], receiver.params[2]));
            v += blur.w * (dot(y.c[3], receiver.params[3]) + dot(y.c[4], receiver.params[4]) + y.c[5].x * receiver.params[5].x);
        }
    }
    return clamp(v, lpfloat(0.0), lpfloat(1.0));
}

// E, at most that of the whole sky, dot(normal, D), which is known exactly: no large light shines through an opening that
// is smaller than its formula's error. Only LIGHTS_ANY needs it.
APERTURA_FN lpfloat atMostTheSky(lpfloat e, Receiver receiver, int lightClass) {
    return lightClass == LIGHTS_ANY ? min(e, max(dot(receiver.normal, lpvec3(receiver.visibility)), lpfloat(0.0))) : e;
}

APERTURA_FN lpfloat irradianceThroughAnti(Receiver receiver, CapLight light, int lightClass) {
    lpvec3 n = receiver.normal;
    TwoCaps caps = twoCapsIn(receiver);
    lpfloat cap = irradianceThroughAperture(n, caps.first, light, lightClass);
    lpfloat anti = unoccludedIrradiance(n, light, lightClass) - irradianceThroughAperture(n, caps.second, light, lightClass);
    return mix(cap, max(anti, lpfloat(0.0)), caps.weight);
}

APERTURA_FN lpfloat irradianceThroughCapAnti(Receiver receiver, CapLight light, int lightClass) {
    TwoCaps caps = twoCapsIn(receiver);
    return irradianceThroughTwoCaps(receiver.normal, caps.first, caps.second, caps.axesDot, caps.weight, light, lightClass);
}

// E of a cap light by the model that MODEL_AUTO chose for the receiver. A light over 10 degrees may be larger than the
// blocker that a soft aperture stands for, so LIGHTS_ANY evaluates MODEL_SOFT as a quadric without a bend, which divides
// the light into four. A chain of ifs, because Mesa compiles a switch over a value that differs between pixels to twice
// the cycles.
APERTURA_FN lpfloat irradianceThroughChoice(Receiver receiver, CapLight light, int lightClass) {
    lpvec3 n = receiver.normal;
    int chosen = choiceIn(receiver.params[CHOICE_SLOT]).model;
    if (chosen == MODEL_AO_AREA)
        return unoccludedIrradiance(n, light, lightClass) * min(receiver.visibility.w / (lpfloat(2.0) * PI), lpfloat(1.0));
    if (chosen == MODEL_APERTURE) return irradianceThroughAperture(n, onlyApertureIn(receiver), light, lightClass);
    if (chosen == MODEL_SOFT && lightClass != LIGHTS_ANY) return irradianceThroughSoft(n, softIn(receiver.params[0]), light, lightClass);
    if (chosen == MODEL_SOFT_2 || chosen == MODEL_FIRM_2) return irradianceThroughLobes(receiver, 2, light, lightClass);
    if (chosen == MODEL_SOFT || chosen == MODEL_SOFT_L2) return irradianceThroughQuadric(n, quadricIn(receiver), light, lightClass);
    if (chosen == MODEL_FIRM_3) return irradianceThroughLobes(receiver, 3, light, lightClass);
    if (chosen == MODEL_FIRM_4) return irradianceThroughLobes(receiver, 4, light, lightClass);
    return NO_FORMULA;
}

APERTURA_FN int azimuthsOf(int model) {
    return model == MODEL_HORIZON_4 ? 4 : model == MODEL_HORIZON_8 ? 8 : model == MODEL_HORIZON_16 ? 16 : 32;
}

// E of a cap light by the rivals of rivals.glsl and horizon.glsl; NO_FORMULA for other models.
APERTURA_FN lpfloat irradianceByRival(int model, Receiver receiver, CapLight light, int lightClass) {
    lpfloat open = unoccludedIrradiance(receiver.normal, light, lightClass);
    switch (model) {
        case MODEL_AO_COSINE: return open * opennessOf(receiver);
        case MODEL_XEGTAO:
        case MODEL_XEGTAO_0: return open * xegtaoVisibility(receiver, light, model == MODEL_XEGTAO ? lpfloat(0.1) : lpfloat(0.0));
        case MODEL_MICRO_SHADOW: return open * microShadow(receiver, light);
        case MODEL_BENT_CONES: return open * coneVisibility(receiver, light);
        case MODEL_HORIZON_4:
        case MODEL_HORIZON_8:
        case MODEL_HORIZON_16:
        case MODEL_HORIZON_32: return irradianceOverHorizon(receiver, azimuthsOf(model), light, lightClass);
        case MODEL_CUBE_6: return open * cubeVisibility(receiver, light);
        case MODEL_ZH3:
        case MODEL_ZH3_GUESS:
            return open * zonalVisibility(receiver, light, model == MODEL_ZH3 ? receiver.params[0].x : guessedZonal(receiver));
        case MODEL_BITS_32:
        case MODEL_BITS_128: return open * sectorVisibility(receiver, model == MODEL_BITS_32 ? 4 : 8, light, lightClass);
        default: return NO_FORMULA;
    }
}

// E of a cap light at the receiver, by the formula of `model`; NO_FORMULA for a number that is no model's.
//   model       MODEL_..., best a specialisation constant
//   receiver    its params as toParams (sh/models.h) makes them; see renormalised where they were interpolated
//   lightClass  of the LIGHTS_... that cover the light, the one with the smallest radius; best a constant, too
APERTURA_FN lpfloat irradianceThrough(int model, Receiver receiver, CapLight light, int lightClass) {
    lpvec3 n = receiver.normal;
    lpfloat open = unoccludedIrradiance(n, light, lightClass);
    lpfloat e = NO_FORMULA;
    switch (model) {
        case MODEL_UNSHADOWED: e = open; break;
        case MODEL_AO_AREA: e = open * min(receiver.visibility.w / (lpfloat(2.0) * PI), lpfloat(1.0)); break;
        case MODEL_SH_L1: e = open * shVisibility(receiver, light, 1); break;
        case MODEL_SH_L2: e = open * shVisibility(receiver, light, 2); break;
        case MODEL_SH_L4: e = open * shVisibility(receiver, light, 4); break;
        case MODEL_OAT: e = oatIrradianceThroughAperture(n, apertureIn(receiver.params[0], lpvec3(lpfloat(0.0))), light); break;
        case MODEL_APERTURE: e = irradianceThroughAperture(n, onlyApertureIn(receiver), light, lightClass); break;
        case MODEL_ALPHA: e = opacityIn(receiver) * irradianceThroughAperture(n, onlyApertureIn(receiver), light, lightClass); break;
        case MODEL_ANTI: e = irradianceThroughAnti(receiver, light, lightClass); break;
        case MODEL_SOFT:
            e = atMostTheSky(irradianceThroughSoft(n, softIn(receiver.params[0]), light, lightClass), receiver, lightClass);
            break;
        case MODEL_FIRM_2:
        case MODEL_SOFT_2: e = atMostTheSky(irradianceThroughLobes(receiver, 2, light, lightClass), receiver, lightClass); break;
        case MODEL_SOFT_L2:
            e = atMostTheSky(irradianceThroughQuadric(n, quadricIn(receiver), light, lightClass), receiver, lightClass);
            break;
        case MODEL_FIRM_3: e = atMostTheSky(irradianceThroughLobes(receiver, 3, light, lightClass), receiver, lightClass); break;
        case MODEL_FIRM_4: e = atMostTheSky(irradianceThroughLobes(receiver, 4, light, lightClass), receiver, lightClass); break;
        case MODEL_MULTI_2: e = atMostTheSky(open * visibleFractionOfUnion(receiver, 2, light, lightClass), receiver, lightClass); break;
        case MODEL_MULTI_3: e = atMostTheSky(open * visibleFractionOfUnion(receiver, 3, light, lightClass), receiver, lightClass); break;
        case MODEL_MULTI_4: e = atMostTheSky(open * visibleFractionOfUnion(receiver, 4, light, lightClass), receiver, lightClass); break;
        case MODEL_CAP_ANTI: e = atMostTheSky(irradianceThroughCapAnti(receiver, light, lightClass), receiver, lightClass); break;
        case MODEL_AUTO: e = atMostTheSky(irradianceThroughChoice(receiver, light, lightClass), receiver, lightClass); break;
        default: e = irradianceByRival(model, receiver, light, lightClass); break;
    }
    return e;
}

// True for models whose sky is not made from D alone.
APERTURA_FN bool skyNeedsMore(int model) {
    switch (model) {
        case MODEL_AO_AREA:
        case MODEL_OAT:
        case MODEL_CUBE_6: return true;
        default: return false;
    }
}

// E of a sky of unit radiance all around. It is exactly dot(normal, D), which every asset has. MODEL_OAT knows only its
// cap, MODEL_AO_AREA only the area, MODEL_CUBE_6 its own faces.
APERTURA_FN lpfloat skyIrradiance(int model, Receiver receiver) {
    switch (model) {
        case MODEL_UNSHADOWED: return PI;
        case MODEL_AO_AREA: return lpfloat(0.5) * receiver.visibility.w;
        case MODEL_OAT:
            return lpfloat(2.0) * PI * apertureIn(receiver.params[0], lpvec3(lpfloat(0.0))).height
                 * max(dot(receiver.normal, apertureIn(receiver.params[0], lpvec3(lpfloat(0.0))).axis), lpfloat(0.0));
        case MODEL_CUBE_6: return skyThroughCube(receiver);
        default: return max(dot(receiver.normal, lpvec3(receiver.visibility)), lpfloat(0.0));
    }
}

#endif
