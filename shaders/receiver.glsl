// The numbers of the visibility models, and what a shader holds of one receiver. GLSL and C++ include this text;
// sh/models.cpp names the models and says what they store.
#ifndef APERTURA_RECEIVER_GLSL
#define APERTURA_RECEIVER_GLSL
#include "aperture.glsl"
#include "soft.glsl"

const int MODEL_UNSHADOWED = 0;
const int MODEL_AO_AREA = 1;
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
const int MODEL_HORIZON_16 = 19;
const int MODEL_AUTO = 20;
const int MODEL_AO_COSINE = 21;
const int MODEL_XEGTAO = 22;
const int MODEL_XEGTAO_0 = 23;
const int MODEL_MICRO_SHADOW = 24;
const int MODEL_BENT_CONES = 25;
const int MODEL_HORIZON_4 = 26;
const int MODEL_HORIZON_8 = 27;
const int MODEL_HORIZON_32 = 28;
const int MODEL_CUBE_6 = 29;
const int MODEL_ZH3 = 30;
const int MODEL_ZH3_GUESS = 31;
const int MODEL_BITS_32 = 32;
const int MODEL_BITS_128 = 33;
const int MODEL_COUNT = 34;

// The most vec4s that the parameters of one point take, in any model.
const int MAX_SLOTS = 8;

// What one receiver sees. The slots of `params` hold, by model:
//   oat              0 aperture
//   aperture, alpha  0 aperture, 1 its opacity and terms
//   anti, cap-anti   0 and 1 two apertures, 2 and 3 the rest of TwoCaps
//   soft             0 slope and offset
//   soft-l2          0 slope and offset, 1 and 2 the bend
//   N lobes          0 .. N-1 slopes and offsets, N their Combination
//   N apertures      0 .. N-1 apertures, from N on the terms of two in a slot
//   sh-l2, sh-l4     SH coefficients of band 2 and above, in turn
//   horizon-N        sines of elevation, in turn: see horizon.glsl
//   cube-6           its faces: see rivals.glsl, as for the next two
//   zh3              the zonal coefficient, in x
//   bits-N           sectors, seven bits to a component
//   auto             what the chosen model has, and its Choice in CHOICE_SLOT
// The functions below, and packing (sh/params_packing.cpp), are all that know which component of a slot is what.
struct Receiver {
    lpvec3 normal;             // unit
    lpvec4 visibility;         // D, A, sr
    lpvec4 params[MAX_SLOTS];  // apertures have unit axes: see renormalised
};

APERTURA_FN SoftAperture softIn(lpvec4 slot) { return SoftAperture(lpvec3(slot), slot.w); }

// The aperture of a slot. `terms` stand elsewhere, or are not needed.
APERTURA_FN Aperture apertureIn(lpvec4 slot, lpvec3 terms) { return Aperture(lpvec3(slot), slot.w, terms); }
APERTURA_FN lpvec4 slotOf(Aperture aperture) { return lpvec4(aperture.axis, aperture.height); }

// The one aperture of `aperture` and `alpha`; opacityIn: the fraction of the light that it lets through, 0..1.
APERTURA_FN Aperture onlyApertureIn(Receiver receiver) {
    lpvec4 second = receiver.params[1];
    return apertureIn(receiver.params[0], lpvec3(second.y, second.z, second.w));
}
APERTURA_FN lpfloat opacityIn(Receiver receiver) { return receiver.params[1].x; }
APERTURA_FN Receiver withAperture(Receiver receiver, Aperture aperture, lpfloat opacity) {
    receiver.params[0] = slotOf(aperture);
    receiver.params[1] = lpvec4(opacity, aperture.terms);
    return receiver;
}

// The apertures of `anti` and `cap-anti`.
struct TwoCaps {
    Aperture first;
    Aperture second;
    lpfloat weight;   // anti: the weight of the anti-aperture, 0..1; cap-anti: 1 where the intersection is blocked, 0 where it is open
    lpfloat axesDot;  // cap-anti: the cosine between the two axes
};
APERTURA_FN TwoCaps twoCapsIn(Receiver receiver) {
    lpvec4 rest = receiver.params[2];
    lpvec4 terms = receiver.params[3];
    return TwoCaps(apertureIn(receiver.params[0], lpvec3(terms.x, terms.y, rest.z)),
                   apertureIn(receiver.params[1], lpvec3(terms.z, terms.w, rest.w)), rest.x, rest.y);
}
APERTURA_FN Receiver withTwoCaps(Receiver receiver, TwoCaps caps) {
    receiver.params[0] = slotOf(caps.first);
    receiver.params[1] = slotOf(caps.second);
    receiver.params[2] = lpvec4(caps.weight, caps.axesDot, caps.first.terms.z, caps.second.terms.z);
    receiver.params[3] = lpvec4(caps.first.terms.x, caps.first.terms.y, caps.second.terms.x, caps.second.terms.y);
    return receiver;
}

// Aperture k of the `count` whose union is open. The union needs only two of its terms.
APERTURA_FN Aperture apertureOfUnion(Receiver receiver, int count, int k) {
    lpvec4 two = receiver.params[count + k / 2];
    lpvec2 own = (k & 1) == 0 ? lpvec2(two.x, two.y) : lpvec2(two.z, two.w);
    return apertureIn(receiver.params[k], lpvec3(own.x, own.y, lpfloat(0.0)));
}
APERTURA_FN Receiver withApertureOfUnion(Receiver receiver, int count, int k, Aperture aperture) {
    receiver.params[k] = slotOf(aperture);
    lpvec4 two = receiver.params[count + k / 2];
    lpvec4 own = lpvec4(aperture.terms.x, aperture.terms.y, aperture.terms.x, aperture.terms.y);
    receiver.params[count + k / 2] = (k & 1) == 0 ? lpvec4(own.x, own.y, two.z, two.w) : lpvec4(two.x, two.y, own.z, own.w);
    return receiver;
}

// How lobes are combined: see combineLobes (several.glsl).
struct Combination {
    lpfloat complement;  // 1: the product of the lobes is what is blocked; 0: it is what is open
    lpfloat pairs;       // how many pairs of lobes, 0 to 2, enter the product as 1 - their own product
};
APERTURA_FN Combination combinationIn(lpvec4 slot) { return Combination(slot.x, slot.w); }
APERTURA_FN lpvec4 withCombination(lpvec4 slot, Combination c) { return lpvec4(c.complement, slot.y, slot.z, c.pairs); }

APERTURA_FN SoftQuadric quadricIn(Receiver receiver) {
    return SoftQuadric(lpvec3(receiver.params[0]), receiver.params[0].w, receiver.params[1], receiver.params[2].x);
}
APERTURA_FN Receiver withQuadric(Receiver receiver, SoftQuadric quadric) {
    receiver.params[0] = lpvec4(quadric.slope, quadric.offset);
    receiver.params[1] = quadric.bend;
    receiver.params[2].x = quadric.bendYz;
    return receiver;
}

// What MODEL_AUTO chose for a point.
struct Choice {
    int model;        // MODEL_...
    bool outOfReach;  // no model came within the tolerance
};
const int CHOICE_SLOT = 4;  // four lobes have their Combination in its other components
APERTURA_FN Choice choiceIn(lpvec4 slot) { return Choice(int(slot.y + lpfloat(0.5)), slot.z > lpfloat(0.5)); }
APERTURA_FN lpvec4 withChoice(lpvec4 slot, Choice choice) {
    return lpvec4(slot.x, lpfloat(choice.model), choice.outOfReach ? lpfloat(1.0) : lpfloat(0.0), slot.w);
}

// An aperture with its axis made unit again, or the normal in its place where nothing is left of it.
APERTURA_FN Aperture renormalisedAperture(lpvec4 slot, lpvec3 normal) {
    lpvec3 axis = lpvec3(slot);
    lpfloat squared = dot(axis, axis);
    return makeAperture(squared > lpsmall(1e-8) ? axis * inversesqrt(squared) : normal, slot.w);
}

// A receiver whose parameters were interpolated, prepared for its model. Interpolation shortens the axes of apertures;
// they are made unit, and their terms are computed anew.
APERTURA_FN Receiver renormalised(int model, Receiver receiver) {
    switch (model) {
        case MODEL_OAT: receiver.params[0] = slotOf(renormalisedAperture(receiver.params[0], receiver.normal)); break;
        case MODEL_APERTURE:
        case MODEL_ALPHA:
            receiver = withAperture(receiver, renormalisedAperture(receiver.params[0], receiver.normal), opacityIn(receiver));
            break;
        case MODEL_ANTI:
            receiver = withTwoCaps(
                receiver, TwoCaps(renormalisedAperture(receiver.params[0], receiver.normal),
                                  renormalisedAperture(receiver.params[1], receiver.normal), twoCapsIn(receiver).weight, lpfloat(0.0)));
            break;
        default: break;
    }
    return receiver;
}

#endif
