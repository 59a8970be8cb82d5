#include "apertura/sh/cap_reference.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

namespace apertura {
namespace {

using glm::dvec3;
constexpr double kPi = std::numbers::pi;

enum class Relation { Disjoint, Inside, Outside, Crossing };

struct Arc {
    double begin, end;  // radians along the circle, begin <= end
};

double angleBetween(const dvec3& a, const dvec3& b) { return 2 * std::atan2(glm::length(a - b), glm::length(a + b)); }

// Where the boundary circle of `ci` lies with respect to `cj`; d is the angle between their axes. The decision is
// symmetric for a pair, so that two circles never disagree on whether they cross. Of two equal caps, the first counts.
Relation circleAgainstCap(const ExactCap& ci, const ExactCap& cj, double d, bool first) {
    if (d >= ci.radius + cj.radius) return Relation::Disjoint;
    if (ci.radius + cj.radius + d >= 2 * kPi) return Relation::Inside;  // together they cover the sphere
    const bool iInJ = d + ci.radius <= cj.radius, jInI = d + cj.radius <= ci.radius;
    if (iInJ && jInI) return first ? Relation::Inside : Relation::Outside;
    if (iInJ) return Relation::Inside;
    if (jInI) return Relation::Outside;
    return Relation::Crossing;
}

// Half the arc, in radians, of circle i inside cap j, by the half-angle formula of spherical triangles.
double clipHalfAngle(double ri, double rj, double d) {
    const double s = (ri + rj + d) / 2;
    const double opposite = std::max(0.0, std::sin(s - ri) * std::sin(s - d));
    const double adjacent = std::max(0.0, std::sin(s) * std::sin(s - rj));
    return 2 * std::atan2(std::sqrt(opposite), std::sqrt(adjacent));
}

void frame(const dvec3& a, dvec3& u, dvec3& v) {
    u = glm::normalize(glm::cross(std::abs(a.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0), a));
    v = glm::cross(a, u);
}

std::vector<Arc> intersect(const std::vector<Arc>& arcs, const Arc& keep) {
    std::vector<Arc> out;
    for (const Arc& arc : arcs)
        for (double turn : {-2 * kPi, 0.0, 2 * kPi}) {
            const Arc cut{std::max(arc.begin, keep.begin + turn), std::min(arc.end, keep.end + turn)};
            if (cut.begin < cut.end) out.push_back(cut);
        }
    return out;
}

}  // namespace

dvec3 vectorIrradiance(std::span<const ExactCap> caps) {
    dvec3 sum(0);
    for (size_t i = 0; i < caps.size(); ++i) {
        const auto& [a, r] = caps[i];
        dvec3 u, v;
        frame(a, u, v);
        std::vector<Arc> arcs{{0, 2 * kPi}};
        for (size_t j = 0; j < caps.size() && !arcs.empty(); ++j) {
            if (i == j) continue;
            const double d = angleBetween(a, caps[j].axis);
            switch (circleAgainstCap(caps[i], caps[j], d, i < j)) {
                case Relation::Disjoint: return dvec3(0);
                case Relation::Inside: break;
                case Relation::Outside: arcs.clear(); break;
                case Relation::Crossing: {
                    const double half = clipHalfAngle(r, caps[j].radius, d);
                    const double middle = std::atan2(glm::dot(v, caps[j].axis), glm::dot(u, caps[j].axis));
                    arcs = intersect(arcs, {middle - half, middle + half});
                }
            }
        }
        const double sinR = std::sin(r), cosR = std::cos(r);
        for (const Arc& arc : arcs)
            sum += 0.5
                 * (sinR * sinR * (arc.end - arc.begin) * a
                    - sinR * cosR * ((std::sin(arc.end) - std::sin(arc.begin)) * u - (std::cos(arc.end) - std::cos(arc.begin)) * v));
    }
    return sum;
}

}  // namespace apertura
