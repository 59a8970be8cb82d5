#pragma once
// The reciprocal of the pseudo-angle between two axes: relative errors, over all distances up to the opposite direction.
#include "fitted.h"

namespace apertura::test {

inline double inverseAngleError(int lightClass) {
    double sum = 0;
    const int n = 2000;
    for (int i = 0; i < n; ++i) {
        const double angle = pi * (i + 0.5) / n, distance = 1 - std::cos(angle);
        const AperturaOverlap o = aperturaOverlapOf(float(distance), 1, vec3(1), AperturaCapLight{}, lightClass);
        sum += std::pow(double(o.inverse) * aperturaPseudoAngle(float(distance)) - 1, 2);
    }
    return std::sqrt(sum / n);
}

}  // namespace apertura::test
