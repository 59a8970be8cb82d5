#include "apertura/bake/sampling/directions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "apertura/sh/shading.h"

namespace apertura {
namespace {

using std::numbers::pi;

// Halves a list of directions at the median of their longest axis, recursively. Every aligned run of a power of two of
// them is then a patch of the sphere: 16 for a packet of rays, other sizes for fitting.
void orderInPatches(std::span<glm::vec3> directions) {
    if (directions.size() <= 2) return;
    glm::vec3 low(2), high(-2);
    for (const glm::vec3& d : directions) low = glm::min(low, d), high = glm::max(high, d);
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = std::bit_ceil(directions.size()) / 2;
    std::nth_element(directions.begin(), directions.begin() + ptrdiff_t(half), directions.end(),
                     [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
    orderInPatches(directions.first(half));
    orderInPatches(directions.subspan(half));
}

}  // namespace

double hashUnit(uint32_t seed, uint64_t a, uint64_t b) {
    // SplitMix64's finaliser (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
    uint64_t x = (uint64_t(seed) + 1) * 0x9E3779B97F4A7C15ull + a * 0xD1B54A32D192ED03ull + b * 0x8CB92BA72F3D8DD7ull;
    for (int round = 0; round < 2; ++round) {
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
        x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
        x ^= x >> 31;
    }
    return double(x >> 11) * 0x1p-53;
}

glm::mat3 frameFromZ(const glm::vec3& normal, double angle) {
    const glm::vec3 u = aperturaTangentTo(normal), v = glm::cross(normal, u);
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    return {c * u + s * v, c * v - s * u, normal};
}

std::vector<glm::vec3> fibonacciCap(int n, double h) {
    // Fibonacci lattice: equal steps of height, each rotated by the golden angle.
    const double golden = pi * (3 - std::sqrt(5.0));
    std::vector<glm::vec3> out;
    for (int i = 0; i < n; ++i) {
        const double down = h * (i + 0.5) / n, s = std::sqrt(down * (2 - down)), turn = std::fmod(golden * i, 2 * pi);
        out.emplace_back(float(s * std::cos(turn)), float(s * std::sin(turn)), float(1 - down));
    }
    return out;
}

std::vector<glm::vec3> fibonacciCosine(int n) {
    // A lattice over the disc, and up to the hemisphere from there: Malley's method.
    const double golden = pi * (3 - std::sqrt(5.0));
    std::vector<glm::vec3> out;
    for (int i = 0; i < n; ++i) {
        const double squared = (i + 0.5) / n, r = std::sqrt(squared), turn = std::fmod(golden * i, 2 * pi);
        out.emplace_back(float(r * std::cos(turn)), float(r * std::sin(turn)), float(std::sqrt(1 - squared)));
    }
    return out;
}

std::vector<glm::vec3> fibonacciHemisphere(int n) {
    std::vector<glm::vec3> out = fibonacciCap(n, 1);
    orderInPatches(out);
    return out;
}

}  // namespace apertura
