// Light that bounces: what the surfaces around a receiver reflect to it. GLSL and C++ include this text.
#ifndef APERTURA_BOUNCE_GLSL
#define APERTURA_BOUNCE_GLSL
#include "sky.glsl"

// What comes by way of other surfaces.
struct AperturaBounce {
    vec3 share;    // rgb, 0..1: from a sky of one radiance, of what that sky gives where nothing blocks it
    vec3 towards;  // the mean direction, outwards, in which this light enters the scene; its length, 0..1, is 1 where it is the only one
};

// A whiter surface counts as this white: the transfer of a small opening grows with it by 1 / (1 - albedo), and with that all that its
// bytes and its rays err by.
const float APERTURA_WHITEST = 0.95f;

// The irradiance under a sky of one radiance, of what that sky gives where nothing blocks it, rgb, 0..1, with all bounces: Umenhoffer, Toth
// and Szirmay-Kalos, "Efficient methods for ambient lighting", 2009, with blockers at any distance. They reflect as if the receiver's
// openness were theirs. Its RMSE is .04 over canyon, terrain, colonnade and arcade at an albedo of .5, of .13 without it, and .07 of .31
// at .8 (bake/README.md).
//   open    the receiver's openness, 0..1: the sky's irradiance without bounces, of the same
//   albedo  of the surfaces that block it, rgb, 0..1
APERTURA_FN vec3 aperturaAmbientTransfer(float open, vec3 albedo) {
    vec3 lost = (1.0f - open) * (vec3(1.0f) - min(albedo, vec3(APERTURA_WHITEST)));
    return vec3(open) / (vec3(open) + lost);
}

// By the transfer above: light enters where the opening is.
//   sky         E of a sky of unit radiance, 0..pi
//   visibility  D, A, sr
APERTURA_FN AperturaBounce aperturaBounceAround(float sky, vec4 visibility, vec3 albedo) {
    float open = clamp(sky / float(APERTURA_PI), 0.0f, 1.0f);
    AperturaBounce b;
    b.share = aperturaAmbientTransfer(open, albedo) - vec3(open);
    b.towards = vec3(visibility) / max(visibility.w, 1e-6f);
    return b;
}

// Irradiance that surfaces reflect of a sky, rgb, W/m2.
APERTURA_FN vec3 aperturaBouncedSky(AperturaBounce bounce, AperturaSky sky) {
    return float(APERTURA_PI) * bounce.share * aperturaSkyMean(sky, bounce.towards);
}

// And of a light at infinity of unit radiance, rgb, W/m2/(W/m2/sr). Seen from afar the surfaces together reflect as one that looks along
// `towards`: SH bands 0 and 1 of what they make of light from each direction.
APERTURA_FN vec3 aperturaBouncedLight(AperturaBounce bounce, AperturaCapLight light) {
    return float(light.area) * max(0.25f + 0.75f * dot(bounce.towards, vec3(light.axis)), 0.0f) * bounce.share;
}

#endif
