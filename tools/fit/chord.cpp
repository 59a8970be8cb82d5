// The fraction of a disc on one side of a chord, no steeper than the exact one.
// fits shaders/aperture.glsl aperturaDiscFraction 0.7660 0.9886
#include "fitted.h"

using namespace apertura;

double error() {
    const double pi = 3.14159265358979;
    double most = 0, before = 0, steepest = 0;
    const int n = 1000;
    for (int i = 1; i <= n; ++i) {
        const double x = double(i) / n, turn = std::acos(1 - 2 * x), share = aperturaDiscFraction(float(x));
        most = std::max(most, std::abs(share - (turn - std::sin(turn) * std::cos(turn)) / pi));
        steepest = std::max(steepest, (share - before) * n);
        before = share;
    }
    // The middle is where the exact one is steepest: 4 / pi.
    return most + std::max(steepest - 4 / pi - 5e-4, 0.0);
}
