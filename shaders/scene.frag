#version 450
#extension GL_GOOGLE_include_directive : require
#include "lattice.glsl"
#include "texels.glsl"
#include "vertex_params.glsl"
AperturaLight aperturaLightAt(int frameOfAll, int i) { return frame.lights[i]; }
#include "lights.glsl"
#define APERTURA_PAINT_CONSTANT 5
#include "paint.glsl"

layout(std430, set = 0, binding = 6) readonly buffer SoftTable { vec4 softNodes[]; };
vec4 aperturaSoftNode(int i) { return softNodes[i]; }
#include "soft_table.glsl"

// One pipeline per model and class of lights. This text is compiled several times, so that each calls aperturaIrradianceThrough in one
// place: drivers copy it, with every model, to each.
//   APERTURA_CORNERS    0: the parameters are interpolated; 3: the light at the three corners is, because the lobes of neighbouring
//                       samples need not correspond, and so at four texels; 1: one corner, to count what it costs; 4: the vertex shader
//                       has read the parameters (scene.vert), and they are interpolated on the way
//   APERTURA_ONE_LIGHT  1: for frames of just one light; 0: of any number
layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
#if APERTURA_CORNERS == 4
layout(location = 2) in vec4 seenHere;
layout(location = 3) in vec4 slot;
layout(location = 4) in vec4 skyHere;
layout(location = 5) in vec3 bounceShare;
layout(location = 6) in vec3 bounceTowards;
#else
layout(location = 2) in vec2 place;
layout(location = 3) flat in float pitch;
layout(location = 4) flat in uvec3 firstCell;
layout(location = 5) flat in vec3 facing;
#endif

layout(constant_id = 3) const bool onFaces = false;   // some faces have samples of their own
layout(constant_id = 4) const bool onTexels = false;  // some meshes have images
layout(constant_id = 8) const int bounces = APERTURA_BOUNCES_NONE;

layout(location = 0) out vec4 colour;  // reflected radiance, linear

AperturaIrradiance irradiance = AperturaIrradiance(vec3(0.0), vec3(0.0), 0.0);
vec4 visibility = vec4(0.0);
AperturaBounce bounce = AperturaBounce(vec3(0.0), vec3(0.0));

void addLight(AperturaReceiver receiver, float share, int i) {
    AperturaCapLight cap = aperturaCapSeenFrom(worldPosition, frame.lights[i], lightClass);
#if APERTURA_ONE_LIGHT
    float e = aperturaIrradianceThrough(model, receiver, cap, lightClass);
#else
    float e = aperturaIrradianceBeside(model, receiver, worldPosition, 0, i, lightClass);
#endif
    irradiance = aperturaWithLight(irradiance, frame.lights[i], cap, share * e, frame.sky);
}

void addReceiver(AperturaReceiver receiver, float share) {
#if APERTURA_ONE_LIGHT
    addLight(receiver, share, 0);
#else
    for (int i = 0; i < frame.counts.x; ++i) addLight(receiver, share, i);
#endif
#if APERTURA_CORNERS != 4
    irradiance.sky += share * aperturaSkyIrradiance(model, receiver);
    visibility += share * receiver.visibility;
#endif
}

#if APERTURA_CORNERS != 4
// The four texels of one of a footprint's places in one of its two mips, and their shares.
vec4 texelShares(AperturaTexelFootprint footprint, int cell, out uvec4 texels) {
    int width = int(firstCell.y), height = int(firstCell.z);
    int tap = cell % footprint.taps, upper = cell / footprint.taps;
    int level = int(footprint.level) + upper;
    vec2 at = place + (float(tap) - 0.5 * float(footprint.taps - 1)) * footprint.step;
    AperturaTexelCell found = aperturaTexelCellAt(aperturaPlaceInMip(at, width, height, level), aperturaMipSize(width, level),
                                                  aperturaMipSize(height, level));
    texels = firstCell.x + uint(aperturaFirstOfMip(width, height, level)) + uvec4(found.texels);
    float part = fract(footprint.level);
    return (upper == 1 ? part : 1.0 - part) / float(footprint.taps) * found.weights;
}

void addAround(vec3 normal) {
    // The three samples about the pixel, or four texels.
    uvec4 around = uvec4(firstCell, 0);
    vec4 shares = vec4(1.0 - place.x - place.y, place, 0.0);
    if (onFaces) {
        AperturaLatticeCell cell = aperturaLatticeCellFromFirst(place, pitch);
        around.xyz += uvec3(cell.samples);
        shares.xyz = cell.weights;
    }
    // In an image: four texels at each place that the pixel covers, in one mip or two.
    int cells = 1;
    bool inImage = onTexels && pitch == 0.0;
    AperturaTexelFootprint footprint;
    if (onTexels) {
        vec2 across = dFdx(place), down = dFdy(place);  // of all pixels, beside those of other triangles too
        if (inImage) {
            footprint = aperturaTexelFootprint(across, down, aperturaMipCount(int(firstCell.y), int(firstCell.z)));
            cells = footprint.taps * (fract(footprint.level) > 0.0 ? 2 : 1);
        }
    }
    const int corners = onTexels ? 4 : 3;
#if APERTURA_CORNERS == 1
    addReceiver(receiverOf(around[0], normal), shares[0]);
#else
#if APERTURA_CORNERS == 0
    AperturaReceiver receiver;
    receiver.normal = normal;
    receiver.visibility = vec4(0.0);
    for (int k = 0; k < APERTURA_MAX_SLOTS; ++k) receiver.params[k] = vec4(0.0);
#endif
    for (int cell = 0; cell < cells; ++cell) {
        if (inImage) shares = texelShares(footprint, cell, around);
        for (int c = 0; c < corners; ++c) {
            if (bounces == APERTURA_BOUNCES_BAKED) {
                AperturaBounce own = bounceOf(around[c]);
                bounce.share += shares[c] * own.share;
                bounce.towards += shares[c] * own.towards;
            }
#if APERTURA_CORNERS == 3
            addReceiver(receiverOf(around[c], normal), shares[c]);
#else
            receiver.visibility += shares[c] * seen[around[c]];
            for (uint k = 0; k < slots && !(inImage && model == APERTURA_MODEL_SOFT); ++k)
                receiver.params[k] += shares[c] * allParams[around[c] * slots + k];
#endif
        }
    }
#if APERTURA_CORNERS == 0
    // What is filtered is converted after: a texel that is closed and one that is open are half open between them.
    if (inImage && model == APERTURA_MODEL_SOFT)
        receiver.params[0] = aperturaLimitSharpness(
            aperturaSoftFrom(receiver.visibility.xyz, receiver.visibility.w, dot(facing, facing) > 0.0 ? facing : normal));
    addReceiver(aperturaRenormalised(model, receiver), 1.0);
#endif
#endif
}
#endif

void main() {
    vec4 base = baseColour();
    vec3 normal = normalize(worldNormal);
#if APERTURA_CORNERS == 4
    AperturaReceiver receiver;
    receiver.normal = normal;
    receiver.visibility = seenHere;
    for (int k = 0; k < APERTURA_MAX_SLOTS; ++k) receiver.params[k] = k == 0 ? slot : vec4(0.0);
    if (APERTURA_ONE_LIGHT == 1 && aperturaIsPointFor(model, lightClass)) receiver.params[0].xyz = vec3(0.0);  // see scene.vert
    addReceiver(aperturaRenormalised(model, receiver), 1.0);
    irradiance.sky = skyHere.w;
    visibility = seenHere;
    vec3 mean = skyHere.rgb;
    if (bounces == APERTURA_BOUNCES_BAKED) bounce = AperturaBounce(bounceShare, bounceTowards);
#else
    addAround(normal);
#if APERTURA_CORNERS == 1
    // What three corners share is not counted thrice: see cost.cpp.
    vec3 mean = aperturaSkyThrough(APERTURA_MODEL_UNSHADOWED, normal, visibility, frame.sky);
#else
    vec3 mean = aperturaSkyThrough(model, normal, visibility, frame.sky);
#endif
#endif
    vec3 fromSky = APERTURA_CORNERS == 4 ? mean : irradiance.sky * mean;
    if (bounces != APERTURA_BOUNCES_NONE) {
        if (bounces != APERTURA_BOUNCES_BAKED) bounce = aperturaBounceAround(irradiance.sky, visibility, absorbedAround(bounces, base));
        fromSky = aperturaSkyBounced(irradiance.sky, mean, bounce);
    }
#if APERTURA_ONE_LIGHT
    vec3 sum = irradiance.lights + aperturaSkyBeside(irradiance, fromSky);
#else
    vec3 sum = aperturaSumOf(irradiance, fromSky, frame.brightest.rgb);
#endif
    if (bounces != APERTURA_BOUNCES_NONE) sum += aperturaBouncedLights(bounce, 0, APERTURA_ONE_LIGHT == 1 ? 1 : frame.counts.x, lightClass);
    colour = painting(base, sum);
}
