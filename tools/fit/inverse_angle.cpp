// The reciprocal of the pseudo-angle between two axes, for lights of any size.
// fits shaders/aperture.glsl aperturaOverlapOf 0.71188 0.10650 0.01124
#include "fitted.h"

using namespace apertura;

// Relative, over all distances up to the opposite direction, those of small angles as often as those of large ones.
double error() {
    double sum = 0;
    const int n = 2000;
    for (int i = 0; i < n; ++i) {
        const double angle = 3.14159265 * (i + 0.5) / n, distance = 1 - std::cos(angle);
        const AperturaOverlap o = aperturaOverlapOf(float(distance), 1, vec3(1), AperturaCapLight{}, APERTURA_LIGHTS_ANY);
        sum += std::pow(double(o.inverse) * aperturaPseudoAngle(float(distance)) - 1, 2);
    }
    return std::sqrt(sum / n);
}
