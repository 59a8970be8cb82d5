#pragma once
// What visibility loses between the rays and a pixel: by its bytes, and by what is mixed between vertices or texels.
#include <string>
#include <string_view>
#include <vector>

#include "sh/models.h"

namespace apertura {

// The worst that bytes do to visibility of one kind, over many directions, and of the radius over areas within a tenth.
struct DecodeError {
    int bits;          // a component, 8 or 16
    double open;       // A / 2 pi, 0..1
    double capness;    // |D| over that of a cap of the same area, 0..1
    double axis;       // degrees between the axes
    double axisBound;  // degrees, of packingError
    double radius;     // degrees, of the cap of the same area
    double radiusBound;
};
std::vector<DecodeError> decodeErrors(int bits);

// How far a model's light leaves what it is at the two ends of an edge, or the four texels of a coarser one, when what
// the renderer mixes is mixed: E / (L pi sin^2 r), over lights from everywhere above the surface.
struct MixingError {
    std::string model;
    std::string_view between;  // which two
    double lightRadius;        // degrees
    double below, above;       // darker than the darker end, brighter than the brighter one
    double path;               // the largest distance from the straight way between the ends
};
// Models whose light is interpolated, not their numbers, do not leave it: empty.
std::vector<MixingError> mixingErrors(const Model& model);

}  // namespace apertura
