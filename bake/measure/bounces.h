#pragma once
// Light that bounces, at receivers: the truth by paths, and what is made of it without them.
#include <span>
#include <string>

#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/paths.h"
#include "apertura/sh/sh4.h"
#include "apertura/sh/shading.h"

namespace apertura {

// What a receiver gets, with what surfaces reflect.
struct BounceTruth {
    float open = 0;                 // the sky of one radiance, without bounces, of what it gives where nothing blocks it, 0..1
    glm::vec3 sky{0};               // and with them
    std::vector<glm::vec3> lights;  // by surfaces alone, of a light of irradiance 1 on what faces it, from each of bounceLights()
    Visibility visibility;          // D, A
};

// 64 directions over the upper hemisphere, towards the lights of a BounceTruth.
std::vector<glm::vec3> bounceLights();

// Follows `rays` paths from each point. Noise of the shares: about 0.3 / sqrt(rays). Throws Cancelled.
std::vector<BounceTruth> traceBounces(const Tracer& tracer, std::span<const SurfacePoint> points, const Albedo& albedo, int bounces,
                                      int rays, uint32_t seed, const Progress& progress = {});

// The errors of one way to know what surfaces reflect, over all receivers, channels and lights.
struct BounceRow {
    std::string by;                   // none: without it; given: from one albedo; baked: as the asset stores it
    double sky = 0, skyBias = 0;      // RMSE and mean error of the sky's E, with the direct part, over pi
    double light = 0, lightBias = 0;  // of what surfaces reflect of a light at infinity, of its E on what faces it
};
BounceRow bounceRow(const std::string& by, std::span<const BounceTruth> truth, std::span<const AperturaBounce> made);

// Where the formulas of bounce.glsl break.
struct BounceSweep {
    std::string name;
    double albedo;
    int frames = 0, notFinite = 0;
    int outside = 0;      // less than without bounces, or more than all of the sky or of the light
    double steepest = 0;  // an opening that closes: the change of what surfaces give of the sky, over that of the openness. A light that
                          // moves: the change of what they give of it, of its E on what faces it, over the angle in radians
};
// Openings that close, closed rooms, and lights that move, with albedos from 0 to 1 and beyond.
std::vector<BounceSweep> bounceSweeps();

}  // namespace apertura
