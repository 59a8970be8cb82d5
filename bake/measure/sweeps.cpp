#include "apertura/bake/measure/sweeps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apertura {

using glm::dvec3;

dvec3 tilted(double angle, double turn) { return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)}; }

dvec3 away(const dvec3& axis, double angle) {
    const dvec3 across = glm::normalize(glm::cross(dvec3(0, 1, 0), axis));
    return std::cos(angle) * axis + std::sin(angle) * across;
}

namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180;
const dvec3 kUp(0, 0, 1);

template <typename Frame>
Sweep makeSweep(std::string_view name, std::string_view what, int frames, Frame&& frame) {
    Sweep out{name, what, {}};
    for (int i = 0; i < frames; ++i) out.frames.push_back(frame(double(i) / (frames - 1)));
    for (size_t i = 1; i < out.frames.size(); ++i) {
        SweepFrame &now = out.frames[i], &before = out.frames[i - 1];
        const double moved = 2 * std::asin(std::min(0.5 * glm::length(now.light - before.light), 1.0));
        const bool alone = now.aperture == before.aperture && now.apertureRadius == before.apertureRadius
                        && now.lightRadius == before.lightRadius;
        now.moved = alone ? moved : 0;
    }
    return out;
}

// A light that crosses an aperture from outside one edge to outside the other. Angles in radians.
Sweep crossing(std::string_view name, std::string_view what, double aperture, double light, double tilt, int frames) {
    const double reach = aperture + 1.5 * light;
    return makeSweep(name, what, frames, [=](double t) {
        const dvec3 axis = tilted(tilt);
        return SweepFrame{axis, aperture, away(axis, reach * (2 * t - 1)), light};
    });
}

}  // namespace

// Lights and apertures that shrink end at 3 seconds of arc, the resolution of an axis in float32.
std::vector<Sweep> singularSweeps() {
    const double sun = 0.00465;
    std::vector<Sweep> out;
    out.push_back(makeSweep("light opposite the axis", "a 30 degree light passes through the antipode of a 60 degree aperture's axis", 201,
                            [](double t) {
                                const dvec3 axis = tilted(50 * kDegree);
                                return SweepFrame{axis, 60 * kDegree, away(-axis, (t - 0.5) * 0.2), 30 * kDegree};
                            }));
    out.push_back(
        makeSweep("equal caps, one direction", "aperture and light are the same cap, and both shrink to nothing", 201, [](double t) {
            const double r = 0.5 * std::pow(10, -4.5 * t);
            return SweepFrame{tilted(0.4), r, tilted(0.4), r};
        }));
    out.push_back(crossing("through distance 0", "a 5 degree light crosses a 5 degree aperture: equal radii, d from 2r through 0 to 2r",
                           5 * kDegree, 5 * kDegree, 0.5, 401));
    out.push_back(
        crossing("equal radii of 30 degrees", "a 30 degree light crosses a 30 degree aperture", 30 * kDegree, 30 * kDegree, 0.4, 401));
    out.push_back(crossing("sun over a 50 degree aperture", "its edges", 50 * kDegree, sun, 0.2, 4001));
    out.push_back(crossing("sun over a 2 degree aperture", "its edges", 2 * kDegree, sun, 0.5, 401));
    out.push_back(makeSweep("sun across the horizon", "everything is open", 201, [=](double t) {
        return SweepFrame{kUp, pi / 2, tilted(pi / 2 + sun * (1.5 - 3 * t)), sun};
    }));
    out.push_back(makeSweep("15 degree light across the horizon", "everything is open", 401, [](double t) {
        return SweepFrame{kUp, pi / 2, tilted(pi / 2 + 15 * kDegree * (1.5 - 3 * t)), 15 * kDegree};
    }));
    out.push_back(makeSweep(
        "15 degree light across the horizon, aperture aside", "of an aperture of 60 degrees that the horizon cuts", 401, [](double t) {
            return SweepFrame{tilted(70 * kDegree), 60 * kDegree, tilted(pi / 2 + 15 * kDegree * (1.5 - 3 * t)), 15 * kDegree};
        }));
    out.push_back(
        makeSweep("half a sky of light", "90 degrees, over a 30 degree aperture that tilts from 0 to 90 degrees", 201, [](double t) {
            return SweepFrame{tilted(t * pi / 2), 30 * kDegree, kUp, pi / 2};
        }));
    out.push_back(makeSweep("light shrinks to nothing", "at the edge of a 30 degree aperture", 201, [](double t) {
        return SweepFrame{tilted(0.3), 30 * kDegree, away(tilted(0.3), 30 * kDegree), 0.5 * std::pow(10, -4.5 * t)};
    }));
    out.push_back(makeSweep("aperture shrinks to nothing", "inside a 5 degree light", 201, [](double t) {
        return SweepFrame{tilted(0.3), 0.5 * std::pow(10, -4.5 * t), away(tilted(0.3), 2 * kDegree), 5 * kDegree};
    }));
    out.push_back(
        makeSweep("aperture opens to all", "from a hemisphere to everything and beyond, under a 5 degree light", 201, [](double t) {
            SweepFrame f{kUp, pi / 2, tilted(1.2), 5 * kDegree};
            f.areaScale = 1 + 1e-6 + t * t;
            return f;
        }));
    out.push_back(makeSweep("axis of another length", "0.9995 to 1.0005, as 8 bits give, sun inside and at the edge", 201, [=](double t) {
        SweepFrame f{tilted(0.3), 0.6, away(tilted(0.3), 0.6), sun};
        f.axisLength = 0.9995 + 0.001 * t;
        return f;
    }));
    out.push_back(makeSweep("axis of no length", "1 to 0, under a 5 degree light", 201, [](double t) {
        SweepFrame f{tilted(0.3), 0.6, tilted(0.5), 5 * kDegree};
        f.axisLength = 1 - t;
        return f;
    }));
    out.push_back(crossing("3 and 10 degrees: just below", "a light of 2.99 degrees crosses an aperture of 40", 40 * kDegree,
                           2.99 * kDegree, 0.5, 801));
    out.push_back(crossing("3 and 10 degrees: above 3", "a light of 3.05 degrees", 40 * kDegree, 3.05 * kDegree, 0.5, 801));
    out.push_back(crossing("3 and 10 degrees: below 10", "a light of 9.95 degrees", 40 * kDegree, 9.95 * kDegree, 0.5, 401));
    out.push_back(crossing("3 and 10 degrees: above 10", "a light of 10.05 degrees", 40 * kDegree, 10.05 * kDegree, 0.5, 401));
    return out;
}

}  // namespace apertura
