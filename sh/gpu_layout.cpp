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

static_assert(sizeof(Light) == 96);
static_assert(offsetof(Light, cap) == 0 && offsetof(Light, sphere) == 64 && offsetof(Light, radiance) == 80);

static_assert(sizeof(Frame) == 112 + 96 * MAX_LIGHTS);
static_assert(offsetof(Frame, toClip) == 0 && offsetof(Frame, sky) == 64 && offsetof(Frame, albedo) == 80);
static_assert(offsetof(Frame, counts) == 96 && offsetof(Frame, lights) == 112);

static_assert(sizeof(SceneVertex) == 32);
static_assert(offsetof(SceneVertex, position) == 0 && offsetof(SceneVertex, normal) == 16);

static_assert(sizeof(Evaluation) == 48 + 16 * APERTURA_MAX_SLOTS);
static_assert(offsetof(Evaluation, normal) == 0 && offsetof(Evaluation, light) == 16 && offsetof(Evaluation, visibility) == 32
              && offsetof(Evaluation, params) == 48);

}  // namespace apertura
