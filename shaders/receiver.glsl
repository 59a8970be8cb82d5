// The numbers of the visibility models, and what a shader holds of one receiver. GLSL and C++ include this text;
// sh/models.cpp names the models and says what they store.
#ifndef APERTURA_RECEIVER_GLSL
#define APERTURA_RECEIVER_GLSL
#include "aperture.glsl"
#include "soft.glsl"

const int APERTURA_MODEL_UNSHADOWED = 0;
const int APERTURA_MODEL_AO_AREA = 1;
const int APERTURA_MODEL_SH_L1 = 2;
const int APERTURA_MODEL_SH_L2 = 3;
const int APERTURA_MODEL_SH_L4 = 4;
const int APERTURA_MODEL_OAT = 5;
const int APERTURA_MODEL_APERTURE = 6;
const int APERTURA_MODEL_ALPHA = 7;
const int APERTURA_MODEL_ANTI = 8;
const int APERTURA_MODEL_SOFT = 9;
const int APERTURA_MODEL_FIRM_2 = 10;
const int APERTURA_MODEL_SOFT_2 = 11;
const int APERTURA_MODEL_SOFT_L2 = 12;
const int APERTURA_MODEL_FIRM_3 = 13;
const int APERTURA_MODEL_FIRM_4 = 14;
const int APERTURA_MODEL_MULTI_2 = 15;
const int APERTURA_MODEL_MULTI_3 = 16;
const int APERTURA_MODEL_MULTI_4 = 17;
const int APERTURA_MODEL_CAP_ANTI = 18;
const int APERTURA_MODEL_HORIZON_16 = 19;
const int APERTURA_MODEL_AUTO = 20;
const int APERTURA_MODEL_AO_COSINE = 21;
const int APERTURA_MODEL_XEGTAO = 22;
const int APERTURA_MODEL_XEGTAO_0 = 23;
const int APERTURA_MODEL_MICRO_SHADOW = 24;
const int APERTURA_MODEL_BENT_CONES = 25;
const int APERTURA_MODEL_HORIZON_4 = 26;
const int APERTURA_MODEL_HORIZON_8 = 27;
const int APERTURA_MODEL_HORIZON_32 = 28;
const int APERTURA_MODEL_CUBE_6 = 29;
const int APERTURA_MODEL_ZH3 = 30;
const int APERTURA_MODEL_ZH3_GUESS = 31;
const int APERTURA_MODEL_BITS_32 = 32;
const int APERTURA_MODEL_BITS_128 = 33;
const int APERTURA_MODEL_COUNT = 34;

// The most vec4s that the parameters of one point take, in any model.
const int APERTURA_MAX_SLOTS = 8;

// What one receiver sees. The slots of `params` hold, by model:
//   oat              0 aperture
//   aperture, alpha  0 aperture, 1 its opacity and terms
//   anti, cap-anti   0 and 1 two apertures, 2 and 3 the rest of AperturaTwoCaps
//   soft             0 slope and offset
//   soft-l2          0 slope and offset, 1 and 2 the bend
//   N lobes          0 .. N-1 slopes and offsets, N their Combination
//   N apertures      0 .. N-1 apertures, from N on the terms of two in a slot
//   sh-l2, sh-l4     SH coefficients of band 2 and above, in turn
//   horizon-N        sines of elevation, in turn: see horizon.glsl
//   cube-6           its faces: see rivals.glsl, as for the next two
//   zh3              the zonal coefficient, in x
//   bits-N           sectors, seven bits to a component
//   auto             what the chosen model has, and its Choice in APERTURA_CHOICE_SLOT
// The functions below, and packing (sh/params_packing.cpp), are all that know which component of a slot is what.
struct AperturaReceiver {
    AperturaVec3 normal;                      // unit
    AperturaVec4 visibility;                  // D, A, sr
    AperturaVec4 params[APERTURA_MAX_SLOTS];  // apertures have unit axes: see aperturaRenormalised
};

APERTURA_FN AperturaSoftAperture aperturaSoftIn(AperturaVec4 slot) { return AperturaSoftAperture(AperturaVec3(slot), slot.w); }

// The aperture of a slot. `terms` stand elsewhere, or are not needed.
APERTURA_FN AperturaAperture aperturaApertureIn(AperturaVec4 slot, AperturaVec3 terms) {
    return AperturaAperture(AperturaVec3(slot), slot.w, terms);
}
APERTURA_FN AperturaVec4 aperturaSlotOf(AperturaAperture aperture) { return AperturaVec4(aperture.axis, aperture.height); }

// The one aperture of `aperture` and `alpha`; aperturaOpacityIn: the fraction of the light that it lets through, 0..1.
APERTURA_FN AperturaAperture aperturaOnlyApertureIn(AperturaReceiver receiver) {
    AperturaVec4 second = receiver.params[1];
    return aperturaApertureIn(receiver.params[0], AperturaVec3(second.y, second.z, second.w));
}
APERTURA_FN AperturaFloat aperturaOpacityIn(AperturaReceiver receiver) { return receiver.params[1].x; }
APERTURA_FN AperturaReceiver aperturaWithAperture(AperturaReceiver receiver, AperturaAperture aperture, AperturaFloat opacity) {
    receiver.params[0] = aperturaSlotOf(aperture);
    receiver.params[1] = AperturaVec4(opacity, aperture.terms);
    return receiver;
}

// The apertures of `anti` and `cap-anti`.
struct AperturaTwoCaps {
    AperturaAperture first;
    AperturaAperture second;
    AperturaFloat weight;  // anti: the weight of the anti-aperture, 0..1; cap-anti: 1 where the intersection is blocked, 0 where it is open
    AperturaFloat axesDot;  // cap-anti: the cosine between the two axes
};
APERTURA_FN AperturaTwoCaps aperturaTwoCapsIn(AperturaReceiver receiver) {
    AperturaVec4 rest = receiver.params[2];
    AperturaVec4 terms = receiver.params[3];
    return AperturaTwoCaps(aperturaApertureIn(receiver.params[0], AperturaVec3(terms.x, terms.y, rest.z)),
                           aperturaApertureIn(receiver.params[1], AperturaVec3(terms.z, terms.w, rest.w)), rest.x, rest.y);
}
APERTURA_FN AperturaReceiver aperturaWithTwoCaps(AperturaReceiver receiver, AperturaTwoCaps caps) {
    receiver.params[0] = aperturaSlotOf(caps.first);
    receiver.params[1] = aperturaSlotOf(caps.second);
    receiver.params[2] = AperturaVec4(caps.weight, caps.axesDot, caps.first.terms.z, caps.second.terms.z);
    receiver.params[3] = AperturaVec4(caps.first.terms.x, caps.first.terms.y, caps.second.terms.x, caps.second.terms.y);
    return receiver;
}

// Aperture k of the `count` whose union is open. The union needs only two of its terms.
APERTURA_FN AperturaAperture aperturaApertureOfUnion(AperturaReceiver receiver, int count, int k) {
    AperturaVec4 two = receiver.params[count + k / 2];
    AperturaVec2 own = (k & 1) == 0 ? AperturaVec2(two.x, two.y) : AperturaVec2(two.z, two.w);
    return aperturaApertureIn(receiver.params[k], AperturaVec3(own.x, own.y, AperturaFloat(0.0)));
}
APERTURA_FN AperturaReceiver aperturaWithApertureOfUnion(AperturaReceiver receiver, int count, int k, AperturaAperture aperture) {
    receiver.params[k] = aperturaSlotOf(aperture);
    AperturaVec4 two = receiver.params[count + k / 2];
    AperturaVec4 own = AperturaVec4(aperture.terms.x, aperture.terms.y, aperture.terms.x, aperture.terms.y);
    receiver.params[count + k / 2] = (k & 1) == 0 ? AperturaVec4(own.x, own.y, two.z, two.w) : AperturaVec4(two.x, two.y, own.z, own.w);
    return receiver;
}

// How lobes are combined: see aperturaCombineLobes (several.glsl).
struct AperturaCombination {
    AperturaFloat complement;  // 1: the product of the lobes is what is blocked; 0: it is what is open
    AperturaFloat pairs;       // how many pairs of lobes, 0 to 2, enter the product as 1 - their own product
};
APERTURA_FN AperturaCombination aperturaCombinationIn(AperturaVec4 slot) { return AperturaCombination(slot.x, slot.w); }
APERTURA_FN AperturaVec4 aperturaWithCombination(AperturaVec4 slot, AperturaCombination c) {
    return AperturaVec4(c.complement, slot.y, slot.z, c.pairs);
}

APERTURA_FN AperturaSoftQuadric aperturaQuadricIn(AperturaReceiver receiver) {
    return AperturaSoftQuadric(AperturaVec3(receiver.params[0]), receiver.params[0].w, receiver.params[1], receiver.params[2].x);
}
APERTURA_FN AperturaReceiver aperturaWithQuadric(AperturaReceiver receiver, AperturaSoftQuadric quadric) {
    receiver.params[0] = AperturaVec4(quadric.slope, quadric.offset);
    receiver.params[1] = quadric.bend;
    receiver.params[2].x = quadric.bendYz;
    return receiver;
}

// What APERTURA_MODEL_AUTO chose for a point.
struct AperturaChoice {
    int model;        // APERTURA_MODEL_...
    bool outOfReach;  // no model came within the tolerance
};
const int APERTURA_CHOICE_SLOT = 4;  // four lobes have their Combination in its other components
APERTURA_FN AperturaChoice aperturaChoiceIn(AperturaVec4 slot) {
    return AperturaChoice(int(slot.y + AperturaFloat(0.5)), slot.z > AperturaFloat(0.5));
}
APERTURA_FN AperturaVec4 aperturaWithChoice(AperturaVec4 slot, AperturaChoice choice) {
    return AperturaVec4(slot.x, AperturaFloat(choice.model), choice.outOfReach ? AperturaFloat(1.0) : AperturaFloat(0.0), slot.w);
}

// An aperture with its axis made unit again, or the normal in its place where nothing is left of it.
APERTURA_FN AperturaAperture aperturaRenormalisedAperture(AperturaVec4 slot, AperturaVec3 normal) {
    AperturaVec3 axis = AperturaVec3(slot);
    AperturaFloat squared = dot(axis, axis);
    return aperturaMakeAperture(squared > aperturaSmall(1e-8) ? axis * inversesqrt(squared) : normal, slot.w);
}

// A receiver whose parameters were interpolated, prepared for its model. Interpolation shortens the axes of apertures;
// they are made unit, and their terms are computed anew.
APERTURA_FN AperturaReceiver aperturaRenormalised(int model, AperturaReceiver receiver) {
    switch (model) {
        case APERTURA_MODEL_OAT:
            receiver.params[0] = aperturaSlotOf(aperturaRenormalisedAperture(receiver.params[0], receiver.normal));
            break;
        case APERTURA_MODEL_APERTURE:
        case APERTURA_MODEL_ALPHA:
            receiver = aperturaWithAperture(receiver, aperturaRenormalisedAperture(receiver.params[0], receiver.normal),
                                            aperturaOpacityIn(receiver));
            break;
        case APERTURA_MODEL_ANTI:
            receiver = aperturaWithTwoCaps(receiver, AperturaTwoCaps(aperturaRenormalisedAperture(receiver.params[0], receiver.normal),
                                                                     aperturaRenormalisedAperture(receiver.params[1], receiver.normal),
                                                                     aperturaTwoCapsIn(receiver).weight, AperturaFloat(0.0)));
            break;
        default: break;
    }
    return receiver;
}

#endif
