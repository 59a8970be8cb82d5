#pragma once
// Frames one after another: numbered pictures, or a film by ffmpeg.
#include <functional>
#include <string>
#include <vector>

#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {

struct Film {
    int frames = 0;       // 0: one picture
    double rate = 24;     // frames a second
    std::string sunPath;  // AZIMUTH,ELEVATION:AZIMUTH,ELEVATION[:...], degrees

    bool isFilm(const std::string& out) const { return out.ends_with(".mp4") || out.ends_with(".webp"); }
    std::vector<std::string> filesOf(const std::string& out) const;  // all that will be written
    // Throws CLI::ValidationError; Error where a film is wanted and ffmpeg is not installed.
    void check(const std::string& out) const;
    // Where the sun stands in frame i, azimuth and elevation in degrees: from point to point at an even speed.
    std::pair<double, double> sunIn(int frame) const;
    // Calls draw(i) for each frame and writes what it gives: `out` with %04d is a name for each; one that ends in .mp4 or .webp is a film,
    // which ffmpeg makes. Whole or, of a film, not at all. Throws Error naming `out`, and Cancelled.
    void write(const std::string& out, const std::function<Picture(int)>& draw) const;
};

}  // namespace apertura
