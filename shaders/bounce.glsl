// Light that bounces: what the surfaces around a receiver reflect to it. GLSL and C++ include this text.
#ifndef APERTURA_BOUNCE_GLSL
#define APERTURA_BOUNCE_GLSL
#include "cap.glsl"

// Where a renderer takes from what surfaces reflect.
const int APERTURA_BOUNCES_NONE = 0;   // nothing: light comes straight
const int APERTURA_BOUNCES_GIVEN = 1;  // one albedo, of all that blocks the sky
const int APERTURA_BOUNCES_OWN = 2;    // the lit surface's own albedo
const int APERTURA_BOUNCES_BAKED = 3;  // what was baked (bake --bounce)

// What comes by way of other surfaces.
struct AperturaBounce {
    vec3 share;    // rgb, 0..1: from a sky of one radiance, of what that sky gives where nothing blocks it
    vec3 towards;  // the mean direction, outwards, in which this light enters the scene; its length, 0..1, is 1 where it is the only one
};

// Surfaces absorb at least so much: what a small opening transfers grows with the albedo by 1 / (1 - albedo), and with that all that its
// bytes and its rays err by.
const float APERTURA_LEAST_ABSORBED = 0.05f;

// The irradiance under a sky of one radiance, of what that sky gives where nothing blocks it, rgb, 0..1, with all bounces: Umenhoffer, Toth
// and Szirmay-Kalos, "Efficient methods for ambient lighting", 2009, with blockers at any distance. They reflect as if the receiver's
// openness were theirs. Its RMSE is .04 over canyon, terrain, colonnade and arcade at an albedo of .5, of .13 without it, and .07 of .31
// at .8 (bake/README.md).
//   open      the receiver's openness, 0..1: the sky's irradiance without bounces, of the same
//   absorbed  1 - albedo of the surfaces that block it, rgb, APERTURA_LEAST_ABSORBED..1
APERTURA_FN vec3 aperturaAmbientTransfer(float open, vec3 absorbed) {
    vec3 d = absorbed * (1.0f - open) + open;
    float two = d.x * d.y;
    float one = 1.0f / (two * d.z);  // a reciprocal takes as long as eight other operations
    float other = one * d.z;
    return open * vec3(other * d.y, other * d.x, one * two);
}

// The light that comes by way of surfaces comes from a wider part of the sky than what is seen of it: its mean direction is shorter than
// the opening's. The best of four over nine scenes.
const float APERTURA_SPREAD = 0.6f;

// The longest `towards` that is taken for what it is: the lobe is then nineteen times as bright as its mean.
const float APERTURA_NARROWEST = 0.9f;

// By the transfer above: light enters where the opening is.
//   sky         E of a sky of unit radiance, 0..pi
//   visibility  D, A, sr
APERTURA_FN AperturaBounce aperturaBounceAround(float sky, vec4 visibility, vec3 absorbed) {
    float open = min(sky * float(1.0f / APERTURA_PI), 1.0f);
    AperturaBounce b;
    b.share = aperturaAmbientTransfer(open, absorbed) - vec3(open);
    b.towards = APERTURA_SPREAD * vec3(visibility) / max(visibility.w, 1e-6f);
    return b;
}

// What surfaces reflect of a light at infinity of unit radiance, rgb, W/m2/(W/m2/sr). By directions it is share (e + 1) / 4 ((1 + c) /
// 2)^e, c the cosine to `towards`: 1 / 4 over the whole sphere on average, with the mean cosine e / (e + 2). Over nine scenes it errs by .2
// to .4 of what there is, RMS, where SH bands 0 and 1 err by .25 to .55 (bake/README.md). It is never more than what the light gives a
// surface that faces it.
APERTURA_FN vec3 aperturaBouncedLight(AperturaBounce bounce, AperturaCapLight light) {
    float size = length(bounce.towards);
    float reach = min(size, APERTURA_NARROWEST);
    float exponent = 2.0f * reach / (1.0f - reach);
    float facing = 0.5f + 0.5f * dot(bounce.towards, vec3(light.axis)) / max(size, 1e-6f);
    float lobe = (0.25f * exponent + 0.25f) * pow(clamp(facing, 1e-6f, 1.0f), exponent);
    return float(light.area) * min(lobe * bounce.share, vec3(1.0f));
}

#endif
