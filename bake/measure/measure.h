#pragma once
// Errors of the visibility models relative to ray-traced truth.
#include <string>
#include <vector>

#include "apertura/bake/measure/bounces.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/sh/models.h"

namespace apertura {

struct MeasureOptions {
    std::vector<const Model*> models;
    bool only = false;                                   // `models` alone, even where it is empty; false: all, where it is
    bool shadowMap = true;                               // and the baseline of a shadow map
    std::vector<double> lightRadii{0.27, 1, 5, 15, 30};  // degrees, above 0, at most 45
    int receivers = 600;
    int rays = 4096;         // per receiver, to compute the models from
    int lightSamples = 256;  // rays per light and receiver, for the truth
    uint32_t seed = 1;
    double tolerance = 0.05;  // RMSE that `auto` keeps within
    int bounces = 0;          // that light takes in the truth of the sky, which is then compared with what bounce.glsl makes of it, too
    Albedo albedo;            // of what reflects it
    int threads = 0;          // 0: one per core
};

// Errors of one model for lights of one radius, over all receivers and lights: model less truth, both E / (L pi sin^2 r).
struct MeasureRow {
    std::string model;
    std::string source;      // the model is computed from: sh, rays or fit
    double numbers = 0;      // per point, that the light's formula reads; for `auto` the mean
    double bytes = 0;        // per point of an asset: the four numbers and what is stored beside them; 8 bits each from measureScene,
                             // which gives a rival's bytes as its authors pack it, alone
    double lightRadius = 0;  // degrees
    double rmse = 0, bias = 0, max = 0;
    double rmsTruth = 0;                // RMS of the truth itself
    double noise = 0;                   // RMS of the truth's own sampling error
    double ambient = 0;                 // RMSE of the irradiance from a uniform sky, over pi
    double unbounced = 0, bounced = 0;  // the same where light bounces: without what surfaces reflect, and with it; 0 if none does
    double own = 0, ambientOwn = 0;     // measureAsset: rmse and ambient of the model made at the same receivers themselves
    // measureAsset, of lights up to Appearance::kLargest: see mottleOf, and Appearance::edge. 0 where there is none.
    double mottle = 0, edge = 0;
    // Light that the model lets through where the truth is 0, for lights with a cosine to the normal over 0.1 (6 degrees
    // above the surface): the maximum and the 99th percentile. 0 if there are no such lights.
    double leakMax = 0, leak99 = 0;
    double texelsPerMetre = 0;        // of a shadow map, the mean over the lights; 0 for models
    std::vector<float> receiverRmse;  // one per receiver
};

// How far an aperture, and the light through it, differ after one stage of storage from those at the receiver.
struct PathRow {
    std::string stage;                          // quantisation, interpolation ...
    std::string source;                         // sh: the four coefficients are stored; rays: the aperture itself
    double directionRms = 0, directionMax = 0;  // degrees between the axes
    double radiusRms = 0, radiusMax = 0;        // degrees
    double irradianceRms = 0;                   // of model `aperture`: E / (L pi sin^2 r), light radius 5 degrees
};

struct Measurement {
    std::string scene;
    int receivers = 0, buried = 0;     // measured, and left out because nobody can see them
    std::vector<glm::vec3> positions;  // of the receivers, world, metres
    std::vector<MeasureRow> rows;
    double unreached = 0;  // fraction of receivers where no model came within the tolerance of `auto`
    std::vector<PathRow> paths;
    std::vector<BounceRow> bounces;  // of the ways to know what surfaces reflect, if light bounces
};

// The model's own error: each model is computed at the receivers themselves, from the coefficients and straight from rays.
// `paths` says where the two differ. Throws Error naming the scene where the region has no area; Cancelled.
Measurement measureScene(const Scene& scene, const MeasureOptions& options, const Progress& progress = {});

// The whole error: each model is interpolated from what the asset stores, as the renderer does, beside what it errs
// at the receivers themselves. `unreached` stays 0 and `paths` empty. Throws as measureScene does.
Measurement measureAsset(const Asset& asset, const MeasureOptions& options, const Progress& progress = {});

}  // namespace apertura
