// Checks that the structs shared by GLSL and C++ have the same layout. std140 and std430 align a vec3 to 16 bytes, put
// the next member directly behind it, and pad a struct to a multiple of 16.
#include <cstddef>

#include "apertura/sh/shading.h"

namespace apertura {

static_assert(sizeof(AperturaCapLight) == 64 && alignof(AperturaCapLight) == 16);
static_assert(offsetof(AperturaCapLight, axis) == 0 && offsetof(AperturaCapLight, sinRadius) == 12
              && offsetof(AperturaCapLight, height) == 16);
static_assert(offsetof(AperturaCapLight, area) == 20 && offsetof(AperturaCapLight, rim) == 24 && offsetof(AperturaCapLight, angle) == 32);
static_assert(offsetof(AperturaCapLight, inverseSin) == 40 && offsetof(AperturaCapLight, shrink) == 48
              && offsetof(AperturaCapLight, axialWeight) == 56);

static_assert(sizeof(AperturaLight) == 128);
static_assert(offsetof(AperturaLight, cap) == 0 && offsetof(AperturaLight, sphere) == 64 && offsetof(AperturaLight, radiance) == 80
              && offsetof(AperturaLight, behind) == 96 && offsetof(AperturaLight, before) == 112);

static_assert(sizeof(AperturaFrame) == 352 + 128 * APERTURA_MAX_LIGHTS);
static_assert(offsetof(AperturaFrame, toClip) == 0 && offsetof(AperturaFrame, sky) == 64 && offsetof(AperturaFrame, eye) == 208);
static_assert(offsetof(AperturaFrame, background) == 224 && offsetof(AperturaFrame, rays) == 240
              && offsetof(AperturaFrame, brightest) == 288 && offsetof(AperturaFrame, albedo) == 304);
static_assert(offsetof(AperturaFrame, around) == 320 && offsetof(AperturaFrame, counts) == 336 && offsetof(AperturaFrame, lights) == 352);

static_assert(sizeof(AperturaSceneVertex) == 32);
static_assert(offsetof(AperturaSceneVertex, position) == 0 && offsetof(AperturaSceneVertex, normal) == 16);

static_assert(sizeof(AperturaCompose) == 32 && offsetof(AperturaCompose, samples) == 16);
static_assert(sizeof(AperturaVertexPaint) == 32 && offsetof(AperturaVertexPaint, colour) == 16);
static_assert(sizeof(AperturaMaterial) == 32 && offsetof(AperturaMaterial, emissive) == 16);

static_assert(sizeof(AperturaEvaluation) == 48 + 16 * APERTURA_MAX_SLOTS);
static_assert(offsetof(AperturaEvaluation, normal) == 0 && offsetof(AperturaEvaluation, light) == 16
              && offsetof(AperturaEvaluation, visibility) == 32 && offsetof(AperturaEvaluation, params) == 48);

}  // namespace apertura
