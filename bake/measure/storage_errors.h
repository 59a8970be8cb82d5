#pragma once
// Errors of visibility between the rays and a pixel: of packing into bytes and of interpolation between vertices or texels.
#include <string>
#include <string_view>
#include <vector>

#include "apertura/sh/models.h"

namespace apertura {

// The largest packing error for one area and |D|: of the axis over 1500 directions, of the radius over areas within 10 %.
// `...Bound`: what packingError promises.
struct DecodeError {
    int bits;          // per component, 8 or 16
    double open;       // A / 2 pi, 0..1
    double capness;    // |D| relative to a cap of the same area, 0..1
    double axis;       // degrees between the axis before and after
    double axisBound;  // degrees
    double radius;     // degrees, for the cap of the same area
    double radiusBound;
};
std::vector<DecodeError> decodeErrors(int bits);

// How far a model's light leaves the range between its values at the two ends of an edge when the renderer interpolates
// its parameters: the maximum of E / (L pi sin^2 r) along the edge, over lights from everywhere above the surface.
struct MixingError {
    std::string model;
    std::string_view between;  // names the two ends
    double lightRadius;        // degrees
    double below, above;       // below the darker end, above the brighter one
    double path;               // from the linear interpolation of the two values
};
// Empty for stored models, and for models whose light is interpolated instead of their parameters: that cannot leave it.
std::vector<MixingError> mixingErrors(const Model& model);

}  // namespace apertura
