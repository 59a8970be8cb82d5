#pragma once
// How far light jumps where an asset's triangles meet.
#include <string>
#include <vector>

#include "apertura/runtime/asset/asset.h"

namespace apertura {

// Over edges that two triangles of one plane share, points on them and lights: the difference of E / (L pi sin^2 r) between the two sides.
struct Seam {
    std::string model;
    double radius;  // of the lights, degrees
    bool unequal;   // edges between faces of unequal density; else between equal ones
    size_t edges;   // how many there are
    double rms, max;
};

//   models  that the asset can be drawn with
//   radii   degrees
//   edges   at most so many of each kind are measured, spread over all
std::vector<Seam> measureSeams(const Asset& asset, const std::vector<const Model*>& models, const std::vector<double>& radii, size_t edges,
                               uint32_t seed);

}  // namespace apertura
