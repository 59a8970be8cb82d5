#pragma once
// Directions on the sphere, and the numbers that place them: the same everywhere.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace apertura {

// A number in 0..1 from a seed and two indices; the same everywhere.
double hashUnit(uint32_t seed, uint64_t a, uint64_t b);

// Columns x, y, z: a right-handed frame whose z is `normal` (unit), spun about it by `angle` radians.
glm::mat3 frameFromZ(const glm::vec3& normal, double angle);

// `n` directions of the cap about +Z of height h = 1 - cos(radius), each standing for 2 pi h / n sr, from its centre
// outwards: Fibonacci's lattice.
std::vector<glm::vec3> fibonacciCap(int n, double h);

// `n` directions of the hemisphere about +Z, each standing for 2 pi / n sr: fibonacciCap, ordered so that neighbours in
// the list are neighbours on the sphere.
std::vector<glm::vec3> fibonacciHemisphere(int n);

}  // namespace apertura
