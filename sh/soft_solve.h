#pragma once
// The soft aperture with given hemisphere integrals, solved in double precision: what the load-time
// table is made from and tested against.
#include <vector>

namespace apertura {

// Everything in the plane of the normal and D: n along the normal, t across it, towards D's side.
struct SoftProblem {
    double area;  // A, 0..2 pi, exclusive
    double n, t;  // D's components, sr; (A, D) strictly inside what a region of the hemisphere can have
};
struct SoftSolution {
    double n, t;  // slope
    double offset;
};

// softStep(f) = 1/2 + f / (2 sqrt(1 + f^2)) and its inverse on (0, 1).
double softStepExact(double f);
double softStepInverse(double v);

// The (offset, slope) whose visibility has the integrals of `problem` over the hemisphere about the
// normal. The problem is convex, so damped Newton steps always find its one solution; relative residual
// below 1e-9 unless the slope exceeds 1e4.
SoftSolution solveSoft(const SoftProblem& problem);

// How far (D_n - A/2, D_t) can lie from the haze (offset alone), in units of A/2 (1 - A/2 pi), by the
// direction psi in which it lies: radians from the normal, 0..pi. It is the curve that hard half-spaces
// of that area trace as they tilt, tabulated at `tilts` tilts.
class HardBoundary {
public:
    explicit HardBoundary(double area, int tilts = 257);
    double operator()(double psi) const;

private:
    std::vector<double> psi_, radius_;
};

}  // namespace apertura
