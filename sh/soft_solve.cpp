#include "apertura/sh/soft_solve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

namespace apertura {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;
constexpr double kPi = std::numbers::pi;

// Gauss-Legendre nodes and weights on [-1, 1] by Newton's method on the Legendre polynomial.
struct Quadrature {
    static constexpr int n = 32;
    std::array<double, n> x, w;
    Quadrature() {
        for (int i = 0; i < n; ++i) {
            double z = std::cos(kPi * (i + 0.75) / (n + 0.5)), derivative = 1;
            for (int step = 0; step < 50; ++step) {
                double p0 = 1, p1 = z;
                for (int k = 2; k <= n; ++k) {
                    const double p2 = ((2 * k - 1) * z * p1 - (k - 1) * p0) / k;
                    p0 = p1;
                    p1 = p2;
                }
                derivative = n * (z * p1 - p0) / (z * z - 1);
                const double next = z - p1 / derivative;
                if (std::abs(next - z) < 1e-15) break;
                z = next;
            }
            x[i] = z;
            w[i] = 2 / ((1 - z * z) * derivative * derivative);
        }
    }
};

// Integrates over the hemisphere by circles around the slope's axis b, which leans `tilt` radians from the normal. Of the
// circle at angle theta from b, the hemisphere contains the arc |phi| <= reach around e, which is perpendicular to b on
// the normal's side. The integrand may have kinks at the angles `breaks`. Calls f(weight, cos theta, sin theta, reach).
template <typename F>
void overHemisphere(double tilt, std::vector<double> breaks, F&& f) {
    static const Quadrature quadrature;
    const double edge = std::abs(kPi / 2 - tilt);
    breaks.insert(breaks.end(), {0.0, edge, kPi - edge, kPi});
    std::sort(breaks.begin(), breaks.end());
    for (size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double middle = (breaks[k] + breaks[k + 1]) / 2, half = (breaks[k + 1] - breaks[k]) / 2;
        if (half < 1e-14) continue;
        for (int i = 0; i < Quadrature::n; ++i) {
            // The sine concentrates the nodes at both ends, where the reach behaves like a square root.
            const double u = quadrature.x[i] * kPi / 2;
            const double theta = middle + half * std::sin(u);
            const double c = std::cos(theta), s = std::sin(theta);
            const double q = -c * std::cos(tilt) / std::max(s * std::sin(tilt), 1e-300);
            const double reach = std::acos(std::clamp(q, -1.0, 1.0));
            f(quadrature.w[i] * kPi / 2 * half * std::cos(u) * s, c, s, reach);
        }
    }
}

struct Moments {
    double potential = 0;
    dvec3 value{0};  // A, D_n, D_t
    dmat3 slope{0};  // their derivatives with respect to offset, n, t
};

Moments moments(double offset, const dvec2& b) {
    const double sharp = glm::length(b);
    const dvec2 axis = sharp > 1e-12 ? b / sharp : dvec2(1, 0);
    const double tilt = std::atan2(std::abs(axis.y), axis.x);
    const double side = axis.y < 0 ? -1 : 1;
    const dvec2 e(std::abs(axis.y), -axis.x * side);
    std::vector<double> breaks;
    if (std::abs(offset) < sharp) breaks.push_back(std::acos(-offset / sharp));

    Moments m;
    overHemisphere(tilt, breaks, [&](double weight, double c, double s, double reach) {
        const double f = offset + sharp * c, root = std::sqrt(1 + f * f);
        const double v = softStepExact(f), dv = 0.5 / (root * root * root);
        const double m0 = 2 * reach, mb = c * m0, me = s * 2 * std::sin(reach);
        const double mbb = c * mb, mbe = c * me;
        const double mee = s * s * (reach + std::sin(reach) * std::cos(reach));
        m.potential += weight * m0 * 0.5 * (f + root);
        const dvec2 d = mb * axis + me * e;
        m.value += weight * v * dvec3(m0, d);
        const dvec2 p = axis, q = e;
        const double nn = mbb * p.x * p.x + 2 * mbe * p.x * q.x + mee * q.x * q.x;
        const double nt = mbb * p.x * p.y + mbe * (p.x * q.y + p.y * q.x) + mee * q.x * q.y;
        const double tt = mbb * p.y * p.y + 2 * mbe * p.y * q.y + mee * q.y * q.y;
        m.slope += weight * dv * dmat3(m0, d.x, d.y, d.x, nn, nt, d.y, nt, tt);
    });
    return m;
}

}  // namespace

double softStepExact(double f) { return 0.5 + 0.5 * f / std::sqrt(1 + f * f); }

double softStepInverse(double v) {
    const double g = 2 * v - 1;
    return g / std::sqrt(std::max(1 - g * g, 1e-300));
}

SoftSolution solveSoft(const SoftProblem& problem) {
    const dvec3 target(problem.area, problem.n, problem.t);
    const double mirror = target.z < 0 ? -1 : 1;
    dvec3 x(softStepInverse(problem.area / (2 * kPi)), 0, 0);
    const dvec3 wanted(target.x, target.y, target.z * mirror);
    Moments now = moments(x.x, dvec2(x.y, x.z));
    for (int iteration = 0; iteration < 200; ++iteration) {
        const dvec3 residual = now.value - wanted;
        if (glm::length(residual) < 1e-10 * problem.area) break;
        const dvec3 step = -(glm::inverse(now.slope) * residual);
        if (!std::isfinite(glm::length(step))) break;
        const double energy = now.potential - glm::dot(x, wanted), descent = glm::dot(step, residual);
        double scale = 1;
        Moments next;
        for (int k = 0; k < 40; ++k, scale *= 0.5) {
            const dvec3 y = x + scale * step;
            next = moments(y.x, dvec2(y.y, y.z));
            if (next.potential - glm::dot(y, wanted) <= energy + 1e-4 * scale * descent + 1e-13) break;
        }
        x += scale * step;
        now = next;
        if (std::hypot(x.y, x.z) > 1e4) break;
    }
    return {x.y, x.z * mirror, x.x};
}

HardBoundary::HardBoundary(double area, int tilts) {
    for (int i = 0; i < tilts; ++i) {
        const double tilt = kPi * i / (tilts - 1);
        const dvec2 axis(std::cos(tilt), std::sin(tilt)), e(std::sin(tilt), -std::cos(tilt));
        auto halfSpace = [&](double radius) {
            dvec3 sum(0);
            overHemisphere(tilt, {radius}, [&](double weight, double c, double s, double reach) {
                if (c > std::cos(radius)) sum += weight * dvec3(2 * reach, 2 * reach * c * axis + 2 * std::sin(reach) * s * e);
            });
            return sum;
        };
        double low = 0, high = kPi;
        for (int k = 0; k < 40; ++k) {
            const double middle = (low + high) / 2;
            (halfSpace(middle).x < area ? low : high) = middle;
        }
        const dvec3 d = halfSpace((low + high) / 2);
        const double n = d.y - area / 2, t = std::max(d.z, 0.0);
        psi_.push_back(std::atan2(t, n));
        radius_.push_back(std::hypot(n, t) / (area / 2 * (1 - area / (2 * kPi))));
    }
}

double HardBoundary::operator()(double psi) const {
    const size_t i = std::clamp<size_t>(std::lower_bound(psi_.begin(), psi_.end(), psi) - psi_.begin(), 1, psi_.size() - 1);
    const double t = (psi - psi_[i - 1]) / std::max(psi_[i] - psi_[i - 1], 1e-12);
    return radius_[i - 1] + std::clamp(t, 0.0, 1.0) * (radius_[i] - radius_[i - 1]);
}

}  // namespace apertura
