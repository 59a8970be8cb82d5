#pragma once
// Where the sun stands.

namespace apertura {

// Radians above the horizontal, and from north by east.
struct SunPosition {
    double elevation, azimuth;
};

// The sun's declination, radians, on a day of the year, 1 .. 366: within .0006 of the almanac's. Spencer, "Fourier Series Representation of
// the Position of the Sun", 1971.
double sunDeclination(double day);

// `latitude` and `declination` in radians, `hour` of true solar time: 12 when the sun stands in the south, or in the north.
SunPosition sunAt(double latitude, double declination, double hour);

}  // namespace apertura
