#include "sh/soft.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sh/soft_grid.h"

namespace apertura {
namespace {

struct Column {
    float boundary;
    soft_grid::Node nodes[soft_grid::kReaches];
};
const Column kTable[soft_grid::kAreas * soft_grid::kPsis] = {
#include "soft_table.inc"
};
constexpr float kPi = std::numbers::pi_v<float>;

// The node below coordinate c (0..1) on an axis of `nodes` nodes, and the fraction of the way to the next one.
struct Cell {
    int index;
    float t;
    Cell(float c, int nodes) {
        const float scaled = std::clamp(c, 0.0f, 1.0f) * float(nodes - 1);
        index = std::min(int(scaled), nodes - 2);
        t = scaled - float(index);
    }
};

}  // namespace

SoftAperture toSoft(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const float x = std::clamp(v.area / (2 * kPi), soft_grid::kLeastArea, 1 - soft_grid::kLeastArea);
    // Where the area is clamped, the direction is scaled with it. If nothing or everything is open, visibility is an even
    // haze.
    const float open = v.area / (2 * kPi);
    const bool even = open <= 0 || open > x;
    const vec3 direction = even ? kPi * x * normal : v.direction * (x / open);
    const float n = dot(direction, normal);
    const vec3 across = direction - n * normal;
    const float t = even ? 0 : length(across);
    const float above = n - kPi * x;
    const float distance = std::sqrt(above * above + t * t);

    const float rootOpen = std::sqrt(x), rootBlocked = std::sqrt(1 - x);
    const Cell area(rootOpen / (rootOpen + rootBlocked), soft_grid::kAreas);
    const Cell turn(0.5f - 0.5f * above / std::max(std::abs(above) + t, 1e-20f), soft_grid::kPsis);
    const float w[4] = {(1 - area.t) * (1 - turn.t), (1 - area.t) * turn.t, area.t * (1 - turn.t), area.t * turn.t};
    const Column* first = &kTable[area.index * soft_grid::kPsis + turn.index];
    const Column* columns[4] = {first, first + 1, first + soft_grid::kPsis, first + soft_grid::kPsis + 1};
    float boundary = 0;
    for (int c = 0; c < 4; ++c) boundary += w[c] * columns[c]->boundary;

    float rho = distance / (kPi * x * (1 - x) * boundary);
    const float reach = std::min(1 - std::sqrt(1 - std::min(rho, 1.0f)), soft_grid::kReach);
    rho = 1 - (1 - reach) * (1 - reach);
    const Cell depth(reach / soft_grid::kReach, soft_grid::kReaches);
    float sharpness = 0, lean = 0, offset = 0;
    for (int c = 0; c < 4; ++c) {
        const soft_grid::Node& a = columns[c]->nodes[depth.index];
        const soft_grid::Node& b = columns[c]->nodes[depth.index + 1];
        sharpness += w[c] * (a.sharpness + depth.t * (b.sharpness - a.sharpness));
        lean += w[c] * (a.lean + depth.t * (b.lean - a.lean));
        offset += w[c] * (a.offset + depth.t * (b.offset - a.offset));
    }
    const float variance = x * (1 - x);
    const float slope = sharpness * rho / std::sqrt((1 - rho) * variance);
    // softStepInverse(x)^2 + 1, in closed form
    const float haze = 1 / (4 * variance);
    // The direction (above, t), rotated by the lean.
    const float scale = slope / (std::max(distance, 1e-20f) * (1 + lean * lean));
    const float c = 1 - lean * lean, s = 2 * lean;
    const float alongNormal = scale * (c * above - s * t), sideways = t > 0 ? scale * (c * t + s * above) / t : 0.0f;
    return {alongNormal * normal + sideways * across, offset * std::sqrt(haze + slope * slope)};
}

}  // namespace apertura
