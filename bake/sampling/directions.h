#pragma once
// Directions on the sphere, and the hashed numbers that place them: the same on every machine.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace apertura {

// A number in 0..1, without 1, hashed from a seed and two indices.
double hashUnit(uint32_t seed, uint64_t a, uint64_t b);

// A right-handed frame, as columns x, y, z: z is `normal` (unit), and the others are rotated about it by `angle` radians.
glm::mat3 frameFromZ(const glm::vec3& normal, double angle);

// A Fibonacci lattice of `n` directions over the cap about +Z of height h = 1 - cos(radius), 0..2, from its centre
// outwards. Each stands for 2 pi h / n sr.
std::vector<glm::vec3> fibonacciCap(int n, double h);

// A Fibonacci lattice of `n` directions over the hemisphere about +Z, ordered so that neighbours in the list are
// neighbours on the sphere. Each stands for 2 pi / n sr.
std::vector<glm::vec3> fibonacciHemisphere(int n);

// `n` directions over the hemisphere about +Z, as many to a solid angle as it has cosine to +Z. Each stands for pi / n sr times cosine.
std::vector<glm::vec3> fibonacciCosine(int n);

}  // namespace apertura
