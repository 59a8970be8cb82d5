#pragma once
// Horizons of a height field: what its surface hides of the sky, without rays.
#include <functional>
#include <span>

#include "apertura/bake/sampling/height_field.h"
#include "apertura/bake/sampling/progress.h"

namespace apertura {

// Slopes of the surface at each texel, metres a metre to the east and to the south: the mean over the triangles that meet there, which all
// cover the same area of the map. 0 where no triangle meets.
std::vector<glm::vec2> slopesOf(const HeightField& field);

struct HorizonOptions {
    double curvature = 0;  // metres that the ground falls by, a squared metre: (1 - refraction) / (2 radius); 0: the earth is flat
    int threads = 0;       // 0: all cores
    // findHorizons only:
    bool isExact = false;  // along a line through each texel itself; false: a sweep, which errs by .2 to .3 degrees (RMS) on mountains
    double farthest = 0;   // exact only: metres beyond which nothing hides anything; 0: no limit
    int band = 0;          // exact only: rows at once; 0: all
};

// Visibility of each texel in the hemisphere about the surface's normal there: A and D in the world (+x east, +y up, +z south).
struct OpenSky {
    std::vector<float> area;           // sr
    std::vector<glm::vec3> direction;  // sr
    int azimuths = 0;                  // that it was found from
    double areaError = 0;              // RMS of area / 2 pi,
    double directionError = 0;         // and of the angle to the true direction, degrees: at 128 texels with data, against exact horizons
};

constexpr int kMostAzimuths = 64;  // of openSky: more make what lines err no smaller

// By 8 azimuths, or by 16, 32 or kMostAzimuths: the fewest by which the area's error is no larger than `error`. Each stands for a sector of
// the sky as wide as they are apart. The result does not depend on the number of threads. Throws Cancelled.
OpenSky openSky(const HeightField& field, double error, const HorizonOptions& options, const Progress& progress = {});

// Calls use(k, row, tangents) from this thread: the tangents of the horizons of all texels from the field's row `row` on, row after row,
// towards azimuths[k], radians from north by east; -infinity where the surface has nothing in that direction, and at texels without data.
// Swept, it is called once for each azimuth, in any order, with all rows; two azimuths that are opposite to each other take hardly longer
// than one. Exact, it is called for each band of rows with each azimuth, in their order. The result does not depend on the number of
// threads nor on the bands. Throws Cancelled.
void findHorizons(const HeightField& field, std::span<const double> azimuths, const HorizonOptions& options,
                  const std::function<void(size_t, int, std::span<const float>)>& use, const Progress& progress = {});

}  // namespace apertura
