#pragma once
// The error of the visibility models against ray-traced truth.
#include <string>
#include <vector>

#include "bake/measure/truth.h"
#include "runtime/asset/asset.h"
#include "sh/models.h"

namespace apertura {

struct MeasureOptions {
    std::vector<const Model*> models;                    // all where empty
    std::vector<double> lightRadii{0.27, 1, 5, 15, 30};  // degrees, above 0, at most 45
    int receivers = 600;
    int rays = 4096;         // a receiver, for the models made at the receivers
    int lightSamples = 256;  // rays a light and receiver, for the truth
    uint32_t seed = 1;
    double tolerance = 0.05;  // of `auto`
    int threads = 0;
};

// Errors of E / (L pi sin^2 r) over all receivers and lights.
struct MeasureRow {
    std::string model;
    std::string source;      // sh, rays or fit
    double numbers = 0;      // a point that the light's formula reads; of `auto`, their mean
    double bytes = 0;        // a point in an asset of 8 bits: the four numbers and what is stored beside them
    double lightRadius = 0;  // degrees
    double rmse = 0, bias = 0, max = 0;
    double rmsTruth = 0;  // of the truth itself
    double noise = 0;     // of the truth's own sampling, as an rmse
    double ambient = 0;   // rmse of the irradiance from an even sky, over pi
    // Light that the model lets through where truth is blocked throughout, of lights 6 degrees and more above the surface: the largest,
    // and what one in a hundred exceeds. 0 where there are none.
    double leakMax = 0, leak99 = 0;
    std::vector<float> receiverRmse;  // of each receiver alone
};

// How an aperture or the light through it changes on its way, against the one at the receiver.
struct PathRow {
    std::string stage;                          // which step of the way
    std::string source;                         // sh: four coefficients travel; rays: the aperture itself does
    double directionRms = 0, directionMax = 0;  // degrees between the axes
    double radiusRms = 0, radiusMax = 0;        // degrees
    double irradianceRms = 0;                   // of `aperture`'s E / (L pi sin^2 r), light radius 5 degrees
};

struct Measurement {
    std::string scene;
    int receivers = 0;
    std::vector<glm::vec3> positions;  // of the receivers, metres
    std::vector<MeasureRow> rows;
    double unreached = 0;  // the share of receivers where `auto` found no model within its tolerance
    std::vector<PathRow> paths;
};

// Each model made at the receivers themselves, from coefficients and straight from the rays: the model's
// own error; and where the two sources part. Throws Error, Cancelled.
Measurement measureScene(const Scene& scene, const MeasureOptions& options, const Progress& progress = {});

// Each model interpolated from what the asset stores, as the renderer does: the whole error.
Measurement measureAsset(const Asset& asset, const MeasureOptions& options, const Progress& progress = {});

}  // namespace apertura
