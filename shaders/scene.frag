#version 450
#extension GL_GOOGLE_include_directive : require
#include "lattice.glsl"
#include "texels.glsl"
#include "vertex_params.glsl"

// One pipeline per model and class of lights. This text is compiled several times, so that each calls irradianceThrough in one place:
// drivers copy it, with every model, to each.
//   APERTURA_CORNERS    0: the parameters are interpolated; 3: the light at the three corners is, because the lobes of neighbouring
//                       samples need not correspond, and so at four texels; 1: one corner, to count what it costs
//   APERTURA_ONE_LIGHT  1: for frames of just one light; 0: of any number
layout(location = 0) in vec3 worldPosition;
layout(location = 1) in vec3 worldNormal;
layout(location = 2) in vec2 place;
layout(location = 3) flat in float pitch;
layout(location = 4) flat in uvec3 firstCell;

layout(constant_id = 3) const bool onFaces = false;   // some faces have samples of their own
layout(constant_id = 4) const bool onTexels = false;  // some meshes have images

layout(location = 0) out vec4 colour;  // reflected radiance, linear

vec3 irradiance = vec3(0.0);
float lit = 0.0;  // the lights' E for unit radiance
float sky = 0.0;  // the sky's

void addLight(Receiver receiver, float share, Light light) {
    float e = share * irradianceThrough(model, receiver, capSeenFrom(worldPosition, light, lightClass), lightClass);
    irradiance += e * light.radiance.rgb;
    lit += e;
}

void addReceiver(Receiver receiver, float share) {
#if APERTURA_ONE_LIGHT
    addLight(receiver, share, frame.lights[0]);
#else
    for (int i = 0; i < frame.counts.x; ++i) addLight(receiver, share, frame.lights[i]);
#endif
    sky += share * skyIrradiance(model, receiver);
}

void main() {
    vec3 normal = normalize(worldNormal);
    // The three samples about the pixel, or four texels.
    uvec4 around = uvec4(firstCell, 0);
    vec4 shares = vec4(1.0 - place.x - place.y, place, 0.0);
    if (onFaces) {
        LatticeCell cell = latticeCellFromFirst(place, pitch);
        around.xyz += uvec3(cell.samples);
        shares.xyz = cell.weights;
    }
    if (onTexels && pitch == 0.0) {
        TexelCell cell = texelCellAt(place, int(firstCell.y), int(firstCell.z));
        around = firstCell.x + uvec4(cell.texels);
        shares = cell.weights;
    }
    const int corners = onTexels ? 4 : 3;
#if APERTURA_CORNERS == 3
    for (int c = 0; c < corners; ++c) addReceiver(receiverOf(around[c], normal), shares[c]);
#elif APERTURA_CORNERS == 1
    addReceiver(receiverOf(around[0], normal), shares[0]);
#else
    Receiver receiver;
    receiver.normal = normal;
    receiver.visibility = vec4(0.0);
    for (int k = 0; k < MAX_SLOTS; ++k) receiver.params[k] = vec4(0.0);
    for (int c = 0; c < corners; ++c) {
        receiver.visibility += shares[c] * seen[around[c]];
        for (uint k = 0; k < slots; ++k) receiver.params[k] += shares[c] * allParams[around[c] * slots + k];
    }
    addReceiver(renormalised(model, receiver), 1.0);
#endif
    // The sky fills the part of the opening that the lights leave.
    irradiance += max(sky - lit, 0.0) * frame.sky.rgb;
    colour = vec4(frame.albedo.rgb / PI * irradiance, 1.0);
}
