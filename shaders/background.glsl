// What a ray sees that meets no surface. GLSL and C++ include this text.
#ifndef APERTURA_BACKGROUND_GLSL
#define APERTURA_BACKGROUND_GLSL
#include "frame.glsl"

// Where a direction (unit) lies in an equirectangular picture of the sky, from its top left corner, each 0..1: the middle is north, -Z; to
// the right lies east, +X; the top row is the zenith, +Y.
APERTURA_FN vec2 aperturaPlaceInSky(vec3 direction) {
    return vec2(0.5f + 0.5f / APERTURA_PI * atan(direction.x, -direction.z),
                0.5f - 1.0f / APERTURA_PI * asin(clamp(direction.y, -1.0f, 1.0f)));
}

// True if a directional light is seen along the ray (unit).
APERTURA_FN bool aperturaIsWithin(AperturaCapLight light, vec3 ray) {
    vec3 aside = ray - light.axis;
    return dot(aside, aside) <= 2.0f * light.height;
}

// Metres along a ray (unit) from `eye` to a lamp; <= 0 if it misses it, or begins in it.
//   sphere  its centre, and its radius in w
APERTURA_FN float aperturaDistanceToLamp(vec4 sphere, vec3 eye, vec3 ray) {
    vec3 toCentre = vec3(sphere) - eye;
    float along = dot(toCentre, ray);
    vec3 aside = toCentre - along * ray;
    float inside = sphere.w * sphere.w - dot(aside, aside);
    return inside > 0.0f ? along - sqrt(inside) : -1.0f;
}

#endif
