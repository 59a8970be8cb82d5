#pragma once
// Helpers of several tests: random directions, brute force, folders.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "apertura/sh/cap_reference.h"
#include "apertura/sh/shading.h"

namespace apertura::test {

using std::numbers::pi;

// Where everything takes several times as long, tests whose code others run too do less of it.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

struct Random {
    std::mt19937_64 engine;
    explicit Random(uint64_t seed) : engine(seed) {}
    double operator()() { return std::uniform_real_distribution<double>(0, 1)(engine); }
    double operator()(double low, double high) { return low + (high - low) * (*this)(); }
    glm::dvec3 direction() {
        const double z = (*this)(-1, 1), turn = (*this)(0, 2 * pi), s = std::sqrt(1 - z * z);
        return {s * std::cos(turn), s * std::sin(turn), z};
    }
};

// Fibonacci lattice: `n` unit directions over the sphere, 4 pi / n sr each.
inline std::vector<glm::dvec3> sphereLattice(int n) {
    std::vector<glm::dvec3> out;
    for (int i = 0; i < n; ++i) {
        const double z = 1 - 2 * (i + 0.5) / n, s = std::sqrt(1 - z * z), turn = i * pi * (3 - std::sqrt(5.0));
        out.emplace_back(s * std::cos(turn), s * std::sin(turn), z);
    }
    return out;
}

inline AperturaCapLight aperturaCapLight(const glm::dvec3& axis, double radius) {
    return apertura::aperturaCapLight(vec3(axis), float(std::sin(radius)));
}

inline AperturaAperture capAperture(const glm::dvec3& axis, double radius) {
    const double half = std::sin(radius / 2);
    return aperturaMakeAperture(vec3(axis), float(2 * half * half));
}

// E / (L pi sin^2 r) of a cap light of unit radiance: from a float32 result, and exactly, through caps above the horizon.
inline double normalised(float e, double radius) { return e / (pi * std::sin(radius) * std::sin(radius)); }
inline double exactFraction(const glm::dvec3& normal, std::vector<ExactCap> caps, double lightRadius) {
    caps.push_back({normal, pi / 2});
    return glm::dot(normal, vectorIrradiance(caps)) / (pi * std::sin(lightRadius) * std::sin(lightRadius));
}

// A small scene of our own: tests/data.
inline std::string smallScene(const std::string& name) { return std::string(APERTURA_SOURCE "/tests/data/") + name; }

// The folder of real scenes that are not in this repository, which $APERTURA_SCENES names. Tests that need it are the suite RealScenes;
// tools/test leaves them out, with a line, where it is not set.
inline std::filesystem::path realScenes() {
    const char* const folder = std::getenv("APERTURA_SCENES");
    return folder ? folder : "";
}
#define NEEDS_REAL_SCENES() \
    if (!std::filesystem::exists(apertura::test::realScenes())) GTEST_SKIP() << "$APERTURA_SCENES names no folder of real scenes"

// A temporary folder, removed by the destructor.
struct Folder {
    std::filesystem::path path;
    Folder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "aperturaXXXXXX").string();
        path = mkdtemp(pattern.data());
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string operator/(const std::string& name) const { return (path / name).string(); }
    size_t files() const { return size_t(std::distance(std::filesystem::directory_iterator(path), std::filesystem::directory_iterator())); }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path / name, std::ios::binary) << text;
        return *this / name;
    }
};

}  // namespace apertura::test
