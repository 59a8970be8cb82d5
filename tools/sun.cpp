#include "tools/sun.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apertura {

using std::numbers::pi;

double sunDeclination(double day) {
    const double g = 2 * pi * (day - 1) / 365;
    return 0.006918 - 0.399912 * std::cos(g) + 0.070257 * std::sin(g) - 0.006758 * std::cos(2 * g) + 0.000907 * std::sin(2 * g)
         - 0.002697 * std::cos(3 * g) + 0.00148 * std::sin(3 * g);
}

SunPosition sunAt(double latitude, double declination, double hour) {
    const double angle = (hour - 12) * pi / 12;
    const double up = std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(angle);
    const double east = -std::cos(declination) * std::sin(angle);
    const double north = std::cos(latitude) * std::sin(declination) - std::sin(latitude) * std::cos(declination) * std::cos(angle);
    return {std::asin(std::clamp(up, -1.0, 1.0)), std::atan2(east, north)};
}

}  // namespace apertura
