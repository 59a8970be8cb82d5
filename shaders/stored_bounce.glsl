// What surfaces reflect to samples, as the asset stores it.
#ifndef APERTURA_STORED_BOUNCE_GLSL
#define APERTURA_STORED_BOUNCE_GLSL
#include "bounce.glsl"

// Of each sample: bytes of the square roots of the shares, and of `towards`.
layout(std430, set = 0, binding = 8) readonly buffer Bounces { uvec2 storedBounces[]; };

AperturaBounce bounceOf(uint place) {
    uvec2 words = storedBounces[place];
    vec3 root = unpackUnorm4x8(words.x).rgb;
    return AperturaBounce(root * root, unpackSnorm4x8(words.y).xyz);
}

#endif
