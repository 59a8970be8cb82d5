#pragma once
// Where visibility is stored: bytes against error, for `apertura chart`.
#include <string>
#include <vector>

#include "apertura/bake/measure/measure.h"

namespace apertura {

// Of `soft` in an asset of one scene, 256 rays a sample and 8 bits.
struct PlaceRow {
    std::string scene;
    std::string at;  // vertices, faces or texels
    int texels;      // of each image, across and down; 0: none, or a height map's own
    double bytes;    // of visibility in the file, of its vertices too; of images as PNG
    double rmse;     // of E / (L pi sin^2 r) between the samples, a light of 5 degrees
    double ambient;  // of the sky's E over pi
    double own;      // as rmse, of the model made at the receivers themselves
};

// Bakes the scene to vertices, to faces and, where its texture coordinates allow it, to images of several sizes; each time to a file beside
// `path` that is removed again.
std::vector<PlaceRow> measurePlaces(const Scene& scene, MeasureOptions measure, const std::string& path, const Progress& progress);

std::string toCsv(const std::vector<PlaceRow>& rows);

}  // namespace apertura
