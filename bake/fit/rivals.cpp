#include "apertura/bake/fit/rivals.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apertura/bake/sampling/occlusion.h"

namespace apertura {
namespace {

float* flat(ModelParams& params) { return &params[0].x; }

// The elevation, radians, of the horizon in each plane through the pole and one of `outwards`: halfway between the first direction from
// the pole down that is blocked and the one before. `lowest`: where the search ends.
std::vector<double> elevations(const Samples& samples, const vec3& pole, std::span<const vec3> outwards, double lowest) {
    if (!samples.source) throw std::logic_error("a horizon needs samples that can ask for more directions");
    constexpr int kSteps = 64, kHalvings = 10;
    const double highest = APERTURA_PI / 2, step = (highest - lowest) / kSteps;
    const auto at = [&](size_t i, double elevation) {
        return float(std::sin(elevation)) * pole + float(std::cos(elevation)) * outwards[i];
    };
    std::vector<vec3> directions;
    for (size_t i = 0; i < outwards.size(); ++i)
        for (int k = 0; k < kSteps; ++k) directions.push_back(at(i, highest - (k + 0.5) * step));
    std::vector<uint8_t> blocked(directions.size());
    samples.source->occluded(*samples.point, directions, blocked.data());
    std::vector<double> open(outwards.size()), closed(outwards.size());
    for (size_t i = 0; i < outwards.size(); ++i) {
        const auto first = blocked.begin() + ptrdiff_t(i * kSteps);
        const auto k = double(std::find(first, first + kSteps, 1) - first);
        open[i] = std::min(highest - (k - 0.5) * step, highest);
        closed[i] = std::max(highest - (k + 0.5) * step, lowest);
    }
    directions.resize(outwards.size());
    for (int halving = 0; halving < kHalvings; ++halving) {
        for (size_t i = 0; i < outwards.size(); ++i) directions[i] = at(i, (open[i] + closed[i]) / 2);
        samples.source->occluded(*samples.point, directions, blocked.data());
        for (size_t i = 0; i < outwards.size(); ++i) (blocked[i] ? closed : open)[i] = (open[i] + closed[i]) / 2;
    }
    for (size_t i = 0; i < outwards.size(); ++i) open[i] = (open[i] + closed[i]) / 2;
    return open;
}

// A sine of elevation as a byte of Stellarium's texture: its square root with the sign, over -1..1.
double throughByte(double h) {
    const double root = std::copysign(std::sqrt(std::abs(h)), h);
    const double kept = std::round((root / 2 + 0.5) * 255) / 255 * 2 - 1;
    return std::copysign(kept * kept, kept);
}

double rounded(double x, int bits) {
    const double top = (1 << bits) - 1;
    return std::round(std::clamp(x, 0.0, 1.0) * top) / top;
}

}  // namespace

template <int Count>
BakedPoint horizon(const FitTools&, const Samples& samples, const mat3& frame, const FitOptions& options) {
    const vec3 pole = options.terrain ? vec3(0, 1, 0) : frame[2], tangent = aperturaAzimuthZero(pole), side = cross(pole, tangent);
    std::vector<vec3> outwards;
    for (int i = 0; i < Count; ++i) {
        const double turn = 2 * double(APERTURA_PI) * i / Count;
        outwards.push_back(float(std::cos(turn)) * tangent + float(std::sin(turn)) * side);
    }
    BakedPoint out{project(samples), {}};
    const std::vector<double> found = elevations(samples, pole, outwards, options.terrain ? -APERTURA_PI / 2 : 0);
    for (size_t i = 0; i < Count; ++i) {
        const double h = Count == 4 ? throughByte(std::sin(found[i])) : std::sin(found[i]);
        flat(out.params)[i] = options.terrain ? float(h) + APERTURA_ABOUT_VERTICAL : float(std::max(h, 0.0));
    }
    return out;
}
template BakedPoint horizon<4>(const FitTools&, const Samples&, const mat3&, const FitOptions&);
template BakedPoint horizon<8>(const FitTools&, const Samples&, const mat3&, const FitOptions&);
template BakedPoint horizon<16>(const FitTools&, const Samples&, const mat3&, const FitOptions&);
template BakedPoint horizon<32>(const FitTools&, const Samples&, const mat3&, const FitOptions&);

BakedPoint ambientCube(const FitTools&, const Samples& samples, const mat3& frame, const FitOptions&) {
    const SampleLattice& lattice = *samples.lattice;
    // Faces that nothing above the surface sees are held at nothing by a weight too small to matter elsewhere.
    Eigen::Matrix<double, 6, 6> squares = 1e-6 * lattice.rays() * Eigen::Matrix<double, 6, 6>::Identity();
    Eigen::Matrix<double, 6, 1> products = Eigen::Matrix<double, 6, 1>::Zero();
    for (size_t i = 0; i < lattice.directions().size(); ++i) {
        const vec3 w = frame * lattice.directions()[i];
        const double weight = lattice.directions()[i].z;
        Eigen::Matrix<double, 6, 1> face = Eigen::Matrix<double, 6, 1>::Zero();
        for (int axis = 0; axis < 3; ++axis) face[axis + (w[axis] < 0 ? 3 : 0)] = double(w[axis]) * w[axis];
        squares += weight * face * face.transpose();
        if (samples.isOpen(i)) products += weight * face;
    }
    // Least squares within 0..1: one face after the other (Gauss-Seidel, projected), which converges for a convex problem.
    Eigen::Matrix<double, 6, 1> faces = squares.ldlt().solve(products).cwiseMax(0.0).cwiseMin(1.0);
    for (int sweep = 0; sweep < 100; ++sweep)
        for (int i = 0; i < 6; ++i) {
            const double others = squares.row(i) * faces - squares(i, i) * faces[i];
            faces[i] = std::clamp((products[i] - others) / squares(i, i), 0.0, 1.0);
        }
    BakedPoint out{project(samples), {}};
    for (int i = 0; i < 6; ++i) flat(out.params)[i] = float(rounded(faces[i], i % 3 == 1 ? 6 : 5));
    return out;
}

BakedPoint zonalBand(const FitTools&, const Samples& samples, const mat3&, const FitOptions&) {
    const SampleLattice& lattice = *samples.lattice;
    BakedPoint out{project(samples), {}};
    const float length = glm::length(out.visibility.direction);
    const vec3 axis = length > 1e-4f ? out.visibility.direction / length : vec3(0, 0, 1);
    double sum = 0;
    for (size_t i = 0; i < lattice.directions().size(); ++i) {
        const double z = dot(axis, lattice.directions()[i]);
        if (samples.isOpen(i)) sum += std::sqrt(5 / (16 * double(APERTURA_PI))) * (3 * z * z - 1);
    }
    out.params[0].x = float(sum * lattice.solidAngle());
    return out;
}

template <int Rings>
BakedPoint sectors(const FitTools&, const Samples& samples, const mat3& frame, const FitOptions&) {
    constexpr int count = 2 * Rings * Rings;
    const SampleLattice& lattice = *samples.lattice;
    const vec3 normal = frame[2], tangent = aperturaAzimuthZero(normal), side = cross(normal, tangent);
    int open[count]{}, all[count]{};
    for (size_t i = 0; i < lattice.directions().size(); ++i) {
        const vec3 w = frame * lattice.directions()[i];
        const int sector = aperturaSectorAt(Rings, dot(tangent, w), dot(side, w), lattice.directions()[i].z);
        ++all[sector];
        open[sector] += samples.isOpen(i);
    }
    BakedPoint out{project(samples), {}};
    for (int sector = 0; sector < count; ++sector) {
        if (all[sector] == 0) {  // fewer rays than sectors: what the nearest ray saw
            const float z = 1 - (float(sector / (2 * Rings)) + 0.5f) / Rings,
                        turn = APERTURA_PI * (float(sector % (2 * Rings)) + 0.5f) / Rings;
            const vec3 middle = z * normal + std::sqrt(1 - z * z) * (std::cos(turn) * tangent + std::sin(turn) * side);
            size_t nearest = 0;
            for (size_t i = 0; i < lattice.directions().size(); ++i)
                if (dot(frame * lattice.directions()[i], middle) > dot(frame * lattice.directions()[nearest], middle)) nearest = i;
            all[sector] = 1;
            open[sector] = samples.isOpen(nearest);
        }
        if (2 * open[sector] >= all[sector]) flat(out.params)[sector / APERTURA_SECTOR_BITS] += float(1 << sector % APERTURA_SECTOR_BITS);
    }
    return out;
}
template BakedPoint sectors<4>(const FitTools&, const Samples&, const mat3&, const FitOptions&);
template BakedPoint sectors<8>(const FitTools&, const Samples&, const mat3&, const FitOptions&);

}  // namespace apertura
