// An arcade round a court, as an architect models it: walls of two triangles, arches of quads, a roof with dormers that are pushed into it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/shapes.h"

namespace apertura {
namespace {

using glm::dvec3;

// Plan, metres from the middle of the court: the arches' inner and outer plane, and the outer wall's.
constexpr double kCourt = 6, kPier = 6.4, kWall = 9, kOuter = 9.4;
constexpr double kSpringing = 2.4;     // where arches begin,
constexpr double kWallTop = 4.2;       // the wall above them ends,
constexpr double kEaves = 4.2;         // the roof begins towards the court,
constexpr double kRidge = 5.8;         // and it meets the outer wall
constexpr int kBays = 4, kSteps = 10;  // arches a side, and quads an arch
constexpr double kRadius = kCourt / kBays - 0.25;

// One of the four sides: `along` it, `out` of the court.
struct Side {
    dvec3 along, out;
    dvec3 at(double a, double height, double o) const { return a * along + dvec3(0, height, 0) + o * out; }
};

void addArches(Surface& surface, const Side& side) {
    constexpr double bay = 2 * kCourt / kBays;
    for (int b = 0; b < kBays; ++b) {
        const double middle = -kCourt + (b + 0.5) * bay;
        std::vector<glm::dvec2> curve{{middle - bay / 2, kSpringing}};  // and the wall's edge above each of its points
        for (int k = 0; k <= kSteps; ++k) {
            const double turn = std::numbers::pi * k / kSteps;
            curve.emplace_back(middle - kRadius * std::cos(turn), kSpringing + kRadius * std::sin(turn));
        }
        curve.emplace_back(middle + bay / 2, kSpringing);
        for (size_t k = 0; k + 1 < curve.size(); ++k) {
            const glm::dvec2 p = curve[k], q = curve[k + 1];
            // To the court, to the arcade, and below.
            addPolygon(surface, {side.at(p.x, p.y, kCourt), side.at(q.x, q.y, kCourt), side.at(q.x, kWallTop, kCourt),
                                 side.at(p.x, kWallTop, kCourt)});
            addPolygon(surface,
                       {side.at(q.x, q.y, kPier), side.at(p.x, p.y, kPier), side.at(p.x, kWallTop, kPier), side.at(q.x, kWallTop, kPier)});
            addPolygon(surface, {side.at(q.x, q.y, kCourt), side.at(p.x, p.y, kCourt), side.at(p.x, p.y, kPier), side.at(q.x, q.y, kPier)});
        }
    }
}

// A slab of the given corners (of its upper face, counter-clockwise from above), `thickness` metres down.
void addSlab(Surface& surface, std::vector<dvec3> corners, double thickness) {
    const dvec3 down(0, -thickness, 0);
    addPolygon(surface, corners);
    for (size_t i = 0; i < corners.size(); ++i) {
        const dvec3 p = corners[i], q = corners[(i + 1) % corners.size()];
        addPolygon(surface, {p, p + down, q + down, q});
    }
    for (dvec3& corner : corners) corner += down;
    addPolygon(surface, std::vector<dvec3>(corners.rbegin(), corners.rend()));
}

void addDormer(Surface& surface, const Side& side, double middle) {
    constexpr double half = 0.55, front = 7, back = 9.2, low = 4.3, high = 5.5, peak = 6;
    const auto at = [&](double a, double height, double o) { return side.at(middle + a, height, o); };
    addPolygon(surface, {at(-half, low, front), at(half, low, front), at(half, high, front), at(0, peak, front), at(-half, high, front)});
    addPolygon(surface, {at(half, low, back), at(-half, low, back), at(-half, high, back), at(0, peak, back), at(half, high, back)});
    addPolygon(surface, {at(half, low, front), at(-half, low, front), at(-half, low, back), at(half, low, back)});
    for (const double s : {-1.0, 1.0}) {
        std::vector<dvec3> wall{at(s * half, low, front), at(s * half, high, front), at(s * half, high, back), at(s * half, low, back)};
        std::vector<dvec3> roof{at(s * half, high, front), at(0, peak, front), at(0, peak, back), at(s * half, high, back)};
        if (s > 0) std::reverse(wall.begin(), wall.end()), std::reverse(roof.begin(), roof.end());
        addPolygon(surface, wall), addPolygon(surface, roof);
    }
}

// The outer wall: from one end to the other, or about a gate.
void addWall(Surface& surface, const Side& side, bool gate) {
    const auto box = [&](double from, double to, double low, double high) {
        const dvec3 p = side.at(from, low, kWall), q = side.at(to, high, kOuter);
        addBox(surface, glm::min(p, q), glm::max(p, q), 1e9);
    };
    if (!gate) return box(-kOuter, kOuter, 0, kRidge);
    box(-kOuter, -1.2, 0, kRidge), box(1.2, kOuter, 0, kRidge), box(-1.2, 1.2, 3, kRidge);
}

}  // namespace

void makeArcade(BuiltinScene& out) {
    Surface floor, building, columns;
    addPanel(floor, {-kOuter - 6, 0, kOuter + 6}, {2 * kOuter + 12, 0, 0}, {0, 0, -2 * kOuter - 12}, 1e9);
    const dvec3 axes[] = {{1, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}};
    for (size_t s = 0; s < 4; ++s) {
        const Side side{axes[s], -axes[(s + 1) % 4]};
        addArches(building, side);
        addWall(building, side, s == 2);
        addSlab(building,
                {side.at(-kCourt + 0.3, kEaves, kCourt - 0.3), side.at(kCourt - 0.3, kEaves, kCourt - 0.3), side.at(kOuter, kRidge, kOuter),
                 side.at(-kOuter, kRidge, kOuter)},
                0.15);
        addDormer(building, side, -3), addDormer(building, side, 2.2);
        for (int b = 0; b < kBays; ++b) {
            const dvec3 foot = side.at(-kCourt + 2 * kCourt / kBays * b, 0, (kCourt + kPier) / 2);
            addFrustum(columns, foot, 0.2, 0.16, kSpringing, 12, 1);
        }
    }
    for (Surface* surface : {&floor, &building, &columns}) {
        out.scene.instances.push_back({int(out.scene.surfaces.size())});
        out.scene.surfaces.push_back(std::move(*surface));
        out.receives.push_back(true);
    }
    out.receiverBoxes = {{glm::vec3(-kOuter, -1, -kOuter), glm::vec3(kOuter, 10, kOuter)}};
    out.scene.cameras = {{{-4.5f, 1.8f, 8.2f}, {1.5f, 2.3f, -2}, 1.1f}};
}

}  // namespace apertura
