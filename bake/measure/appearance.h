#pragma once
// What the eye sees of a model and RMSE does not: mottle, which is error that changes from point to point, and how wide shadow edges are.
#include <cstdint>
#include <span>
#include <vector>

#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/sampling/tracer.h"
#include "apertura/runtime/asset/asset.h"

namespace apertura {

// A point, and then those within two edges of it, as indices.
using Patch = std::vector<uint32_t>;

// RMS, over patches and lights, of the error at a patch's point less the mean of the errors at its neighbours, where truth differs from
// their mean truth by less than kSmoothTruth: there a viewer expects an even surface. 0 where truth is smooth nowhere.
//   errors, truth  of each point and light, point after point
double mottleOf(std::span<const Patch> patches, std::span<const float> errors, std::span<const float> truth, size_t lights);
constexpr double kSmoothTruth = 0.02;

// How wide an edge is from 10 to 90 % of the light: what a straight ramp would have whose integral of v (1 - v) is the same, so that steps
// and smears count too. Where the light changes by less than half of itself there is no edge: 0.8 of the whole stretch then.
//   at       places along a line, rising, metres
//   visible  the share of the light that is seen there
double edgeWidth(std::span<const double> at, std::span<const float> visible);

// The truth that models drawn from an asset are judged by.
class Appearance {
public:
    // Traces it. `receivers`: points of the asset's surface; the stored points next to them are the patches' own, and edges are looked for
    // on the flat ones among their triangles. `radii`: of the lights, degrees, at most kLargest. All must outlive it. Throws Cancelled.
    Appearance(const Asset& asset, const Tracer& tracer, std::span<const SurfaceSample> receivers, std::vector<double> radii, uint32_t seed,
               const Progress& progress);
    static constexpr double kLargest = 6;  // degrees
    // Of light radius `radius`, one of `radii`.
    double mottle(const Model& model, double radius) const;
    // The mean width of the edges that the model draws over that of truth's; 0 where truth has none.
    double edge(const Model& model, double radius) const;

private:
    struct Place {
        int instance, triangle;
        glm::vec3 barycentrics, normal;
    };
    struct Edge {
        std::vector<Place> places;  // on a line across it
        std::vector<double> at;     // metres along the line
        glm::vec3 light;
        std::vector<double> width;  // of the truth's, metres, for each radius; 0 where that is as wide as the line
    };
    size_t indexOf(double radius) const;
    void addPatches(std::span<const SurfaceSample> receivers);
    std::vector<Edge> edgesAbout(const Tracer& tracer, const SurfaceSample& receiver, size_t index) const;

    const Asset& asset_;
    uint32_t seed_;
    std::vector<double> radii_;
    std::vector<Patch> patches_;             // which share no points
    std::vector<Place> points_;              // of all patches
    std::vector<glm::vec3> lights_;          // of each patch, kLights
    std::vector<std::vector<float>> truth_;  // of each radius, of each point and light
    std::vector<std::vector<Edge>> edges_;   // about each receiver
};

}  // namespace apertura
