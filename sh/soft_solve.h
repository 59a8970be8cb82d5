#pragma once
// The soft aperture with given hemisphere integrals, solved in double precision. The load-time table is made from it and
// tested with it.
#include <vector>

namespace apertura {

// Vectors lie in the plane of the normal and D: n along the normal, t perpendicular to it on the side of D.
struct SoftProblem {
    double area;  // A, 0..2 pi, exclusive
    double n, t;  // D's components, sr; (A, D) strictly inside what a region of the hemisphere can have
};
struct SoftSolution {
    double n, t;  // slope
    double offset;
};

// aperturaSoftStep(f) = 1/2 + f / (2 sqrt(1 + f^2)) and its inverse on (0, 1).
double softStepExact(double f);
double softStepInverse(double v);

// The (offset, slope) whose visibility has the integrals of `problem` over the hemisphere about the normal. The problem
// is convex, so damped Newton steps always find its one solution. The relative residual is below 1e-9, unless the slope
// exceeds 1e4.
SoftSolution solveSoft(const SoftProblem& problem);

// The greatest length that (D_n - A/2, D_t) can have, in units of A/2 (1 - A / 2 pi), as a function of its direction psi.
// At the origin visibility is an even haze (no slope); at the boundary it is a hard half-space of the same area. The
// curve is traced by tilting that half-space.
//   area   A, sr, 0..2 pi, exclusive
//   tilts  how many tilts are tabulated; linear between them
//   psi    radians from the normal, 0..pi
class HardBoundary {
public:
    explicit HardBoundary(double area, int tilts = 257);
    double operator()(double psi) const;

private:
    std::vector<double> psi_, radius_;
};

}  // namespace apertura
