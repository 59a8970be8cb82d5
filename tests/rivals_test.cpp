// Each rival against a brute-force version in double that integrates its author's definition. Nothing here comes from shaders/ but the
// function under test.
#include <cmath>
#include <functional>

#include "apertura/bake/fit/fit.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// A hemisphere about a normal, from which a few caps are blocked.
struct Region : OcclusionSource {
    glm::dvec3 normal;
    std::vector<std::pair<glm::dvec3, double>> blockers;  // axis and cosine of the radius
    bool isOpen(const glm::dvec3& w) const {
        if (glm::dot(w, normal) <= 0) return false;
        for (const auto& [axis, cosine] : blockers)
            if (glm::dot(w, axis) >= cosine) return false;
        return true;
    }
    void occluded(const SurfacePoint&, std::span<const vec3> directions, uint8_t* blocked) const override {
        for (size_t i = 0; i < directions.size(); ++i) blocked[i] = !isOpen(glm::dvec3(directions[i]));
    }
};

Region randomRegion(Random& random) {
    Region out;
    out.normal = random.direction();
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 axis = random.direction();
        axis -= glm::dot(axis, out.normal) * out.normal;  // blockers stand on the horizon, where a horizon map can hold them
        out.blockers.emplace_back(glm::normalize(axis), std::cos(random(0.2, 0.9)));
    }
    return out;
}

const std::vector<glm::dvec3>& sphere() {
    static const std::vector<glm::dvec3> directions = sphereLattice(60000);
    return directions;
}
double solidAngle() { return 4 * pi / double(sphere().size()); }

// The integral of f over the open part of a region.
double overOpen(const Region& region, const std::function<double(const glm::dvec3&)>& f) {
    double sum = 0;
    for (const glm::dvec3& w : sphere())
        if (region.isOpen(w)) sum += f(w);
    return sum * solidAngle();
}

struct Disc {
    glm::dvec3 axis;
    double radius;
    std::vector<glm::dvec3> directions;
    Disc(const glm::dvec3& towards, double r) : axis(towards), radius(r) {
        const glm::dvec3 u = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                         v = glm::cross(axis, u);
        for (int i = 0; i < 400; ++i) {
            const double z = 1 - (1 - std::cos(r)) * (i + 0.5) / 400, s = std::sqrt(1 - z * z), turn = i * pi * (3 - std::sqrt(5.0));
            directions.push_back(z * axis + s * std::cos(turn) * u + s * std::sin(turn) * v);
        }
    }
    // E / (L pi sin^2 r) where a fraction `visible` of each direction is seen.
    double lit(const glm::dvec3& normal, const std::function<double(const glm::dvec3&)>& visible) const {
        double sum = 0;
        for (const glm::dvec3& w : directions) sum += std::max(glm::dot(w, normal), 0.0) * visible(w);
        return sum / double(directions.size()) * 2 * (1 - std::cos(radius)) / (std::sin(radius) * std::sin(radius));
    }
    double mean(const std::function<double(const glm::dvec3&)>& f) const {
        double sum = 0;
        for (const glm::dvec3& w : directions) sum += f(w);
        return sum / double(directions.size());
    }
};

double clamped(double x) { return std::clamp(x, 0.0, 1.0); }

// What an author makes of a region: E / (L pi sin^2 r) of a disc.
using Author = std::function<double(const Region&, const Disc&)>;

double openness(const Region& region) {
    return overOpen(region, [&](const glm::dvec3& w) { return glm::dot(w, region.normal); }) / pi;
}
glm::dvec3 meanOpen(const Region& region) {
    glm::dvec3 out;
    for (int i = 0; i < 3; ++i) out[i] = overOpen(region, [i](const glm::dvec3& w) { return w[i]; });
    return out;
}
double open(const Region& region, const Disc& disc) {
    return disc.lit(region.normal, [](const glm::dvec3&) { return 1.0; });
}

double xegtao(const Region& region, const Disc& disc, double margin) {
    const double along = glm::dot(glm::normalize(meanOpen(region)), disc.axis) + margin;
    return open(region, disc) * clamped(along / std::sqrt(1 - openness(region)));
}

double cones(const Region& region, const Disc& disc) {
    const double cosine = std::sqrt(1 - openness(region));
    const glm::dvec3 axis = glm::normalize(meanOpen(region));
    // The author knows no plane that cuts the light; what is above it counts.
    const auto above = [&](const glm::dvec3& w) { return glm::dot(w, region.normal) > 0 ? 1.0 : 0.0; };
    return open(region, disc) * disc.mean([&](const glm::dvec3& w) { return glm::dot(w, axis) >= cosine ? above(w) : 0.0; })
         / disc.mean(above);
}

// Bands 0 and 1 of the visibility, and a band 2 that is zonal about the linear band's axis.
double zonal(const Region& region, const Disc& disc, bool guess) {
    const glm::dvec3 d = meanOpen(region), axis = glm::normalize(d);
    const double area = overOpen(region, [](const glm::dvec3&) { return 1.0; });
    const auto legendre2 = [&](const glm::dvec3& w) {
        const double z = glm::dot(axis, w);
        return std::sqrt(5 / (16 * pi)) * (3 * z * z - 1);
    };
    const double dc = std::sqrt(1 / (4 * pi)) * area, ratio = std::sqrt(3 / (4 * pi)) * glm::length(d) / dc;
    const double coefficient = guess ? dc * ratio * (0.08 + 0.6 * ratio) : overOpen(region, legendre2);
    return open(region, disc) * clamped(disc.mean([&](const glm::dvec3& w) {
               return area / (4 * pi) + 3 / (4 * pi) * glm::dot(d, w) + coefficient * legendre2(w);
           }));
}

// A frame about the normal; azimuths must start where those of the recipe do, which is its choice and not the author's.
glm::dmat3 frameAbout(const glm::dvec3& normal) {
    const glm::dvec3 u = glm::normalize(glm::cross(glm::dvec3(0.36, 0.48, 0.8), normal));
    return {u, glm::cross(normal, u), normal};
}

double horizons(const Region& region, const Disc& disc, int azimuths) {
    const glm::dmat3 frame = frameAbout(region.normal);
    std::vector<double> sines;
    for (int i = 0; i < azimuths; ++i) {
        const double turn = 2 * pi * i / azimuths;
        double elevation = pi / 2;
        while (elevation > 0
               && region.isOpen(
                   frame * glm::dvec3(std::cos(elevation) * std::cos(turn), std::cos(elevation) * std::sin(turn), std::sin(elevation))))
            elevation -= 1e-3;
        sines.push_back(std::sin(std::max(elevation, 0.0)));
    }
    return disc.lit(region.normal, [&](const glm::dvec3& w) {
        const glm::dvec3 local = glm::transpose(frame) * w;
        const double turn = std::atan2(local.y, local.x) / (2 * pi) * azimuths, at = turn < 0 ? turn + azimuths : turn;
        const auto i = size_t(at) % size_t(azimuths);
        return local.z > glm::mix(sines[i], sines[(i + 1) % size_t(azimuths)], at - std::floor(at)) ? 1.0 : 0.0;
    });
}

double bits(const Region& region, const Disc& disc, int rings) {
    const glm::dmat3 frame = frameAbout(region.normal);
    const auto sector = [&](const glm::dvec3& w) {
        const glm::dvec3 local = glm::transpose(frame) * w;
        const int ring = std::clamp(int((1 - local.z) * rings), 0, rings - 1);
        const double turn = std::atan2(local.y, local.x) / pi * rings;
        return size_t(ring * 2 * rings + int(turn < 0 ? turn + 2 * rings : turn) % (2 * rings));
    };
    std::vector<int> seen(size_t(2 * rings * rings)), all(seen.size());
    for (const glm::dvec3& w : sphere())
        if (glm::dot(w, region.normal) > 0) ++all[sector(w)], seen[sector(w)] += region.isOpen(w);
    return disc.lit(region.normal, [&](const glm::dvec3& w) { return 2 * seen[sector(w)] >= all[sector(w)] ? 1.0 : 0.0; });
}

// RMS of the model less the author, over regions and lights of one radius.
double differenceTo(const char* name, const Author& author, double degrees) {
    static const FitTools tools(16384, FitTools::Use::Samples);
    const Model& model = *findModel(name);
    Random random(7);
    double sum = 0, count = 0;
    for (int r = 0; r < 6; ++r) {
        const Region region = randomRegion(random);
        const SurfacePoint point{glm::dvec3(0), vec3(region.normal), 1};
        BakedPoint baked;
        samplePoints(region, {&point, 1}, tools.lattice, 1, 1, {},
                     [&](size_t, const Samples& s, const mat3& frame) { baked = makePoint(recipeFor(model), tools, s, frame, {}); });
        const ModelParams* stored = model.isStored() ? &baked.params : nullptr;
        const AperturaReceiver receiver = toReceiver(baked.visibility, toParams(model, baked.visibility, stored, point.normal),
                                                     point.normal);
        for (int k = 0; k < 30; ++k) {
            glm::dvec3 towards = random.direction();
            if (glm::dot(towards, region.normal) < 0.1) continue;
            const double radius = degrees * pi / 180;
            const AperturaCapLight light = aperturaCapLight(towards, radius);
            const double e = aperturaIrradianceThrough(model.id, receiver, light, lightClassOf(light.sinRadius));
            const double off = normalised(float(e), radius) - author(region, Disc(towards, radius));
            sum += off * off, ++count;
        }
    }
    return std::sqrt(sum / count);
}

struct Rival {
    const char* name;
    Author author;
    double sun, five, fifteen;  // RMS allowed
};

TEST(Rivals, AreWhatTheirAuthorsDefine) {
    const Rival rivals[] = {
        {"ao-area", [](auto& r, auto& d) { return open(r, d) * overOpen(r, [](auto&) { return 1.0; }) / (2 * pi); }, 0.002, 0.002, 0.002},
        {"ao-cosine", [](auto& r, auto& d) { return open(r, d) * openness(r); }, 0.002, 0.002, 0.002},
        {"xegtao", [](auto& r, auto& d) { return xegtao(r, d, 0.1); }, 0.004, 0.004, 0.004},
        {"xegtao-0", [](auto& r, auto& d) { return xegtao(r, d, 0); }, 0.004, 0.004, 0.004},
        {"micro-shadow",
         [](auto& r, auto& d) { return open(r, d) * std::pow(clamped(glm::dot(r.normal, d.axis) / std::sqrt(1 - openness(r))), 2); }, 0.004,
         0.004, 0.004},
        {"bent-cones", cones, 0.08, 0.05, 0.04},  // smoothstep for the overlap of two caps
        {"sh-l1",
         [](auto& r, auto& d) {
             const glm::dvec3 D = meanOpen(r);
             const double area = overOpen(r, [](auto&) { return 1.0; });
             return open(r, d) * clamped(d.mean([&](auto& w) { return area / (4 * pi) + 3 / (4 * pi) * glm::dot(D, w); }));
         },
         0.002, 0.002, 0.002},
        {"zh3", [](auto& r, auto& d) { return zonal(r, d, false); }, 0.002, 0.002, 0.002},
        {"zh3-guess", [](auto& r, auto& d) { return zonal(r, d, true); }, 0.002, 0.002, 0.002},
        {"horizon-8", [](auto& r, auto& d) { return horizons(r, d, 8); }, 0.01, 0.03, 0.06},  // a line for the horizon across the disc
        {"horizon-16", [](auto& r, auto& d) { return horizons(r, d, 16); }, 0.02, 0.02, 0.05},
        {"horizon-32", [](auto& r, auto& d) { return horizons(r, d, 32); }, 0.02, 0.02, 0.05},
        {"bits-32", [](auto& r, auto& d) { return bits(r, d, 4); }, 0.05, 0.05, 0.05},  // eight points for the disc
        {"bits-128", [](auto& r, auto& d) { return bits(r, d, 8); }, 0.05, 0.06, 0.06},
    };
    for (const Rival& rival : rivals) {
        const double sun = differenceTo(rival.name, rival.author, 0.27), five = differenceTo(rival.name, rival.author, 5),
                     fifteen = differenceTo(rival.name, rival.author, 15);
        std::printf("%-12s differs from its author's by %.4f %.4f %.4f\n", rival.name, sun, five, fifteen);
        EXPECT_LT(sun, rival.sun) << rival.name;
        EXPECT_LT(five, rival.five) << rival.name;
        EXPECT_LT(fifteen, rival.fifteen) << rival.name;
    }
}

// The squared error of an ambient cube over the hemisphere, weighted by the cosine.
double cubeError(const Region& region, const float* faces) {
    double sum = 0;
    for (const glm::dvec3& w : sphere()) {
        const double weight = glm::dot(w, region.normal);
        if (weight <= 0) continue;
        double v = -double(region.isOpen(w));
        for (int i = 0; i < 3; ++i) v += w[i] * w[i] * double(faces[w[i] < 0 ? 3 + i : i]);
        sum += weight * v * v * solidAngle();
    }
    return sum;
}

TEST(Rivals, AnAmbientCubeIsTheBestOfItsKind) {
    static const FitTools tools(4096, FitTools::Use::Samples);
    Random random(11);
    for (int r = 0; r < 6; ++r) {
        const Region region = randomRegion(random);
        const SurfacePoint point{glm::dvec3(0), vec3(region.normal), 1};
        ModelParams params;
        samplePoints(region, {&point, 1}, tools.lattice, 1, 1, {}, [&](size_t, const Samples& s, const mat3& frame) {
            params = makePoint(*findRecipe("cube-6"), tools, s, frame, {}).params;
        });
        float* faces = &params[0].x;
        const double own = cubeError(region, faces);
        for (int i = 0; i < 6; ++i) {
            const int steps = i % 3 == 1 ? 63 : 31;
            EXPECT_NEAR(faces[i] * float(steps), std::round(faces[i] * float(steps)), 1e-4);
            for (const float change : {-1.5f / 31, 1.5f / 31}) {
                const float kept = faces[i];
                faces[i] = kept + change;
                const bool possible = faces[i] >= 0 && faces[i] <= 1;
                EXPECT_TRUE(!possible || cubeError(region, faces) > own - 1e-3) << i;
                faces[i] = kept;
            }
        }
        // What the light and the sky get from these faces.
        const AperturaReceiver receiver = toReceiver({}, params, point.normal);
        const auto face = [&](const glm::dvec3& w) {
            double v = 0;
            for (int i = 0; i < 3; ++i) v += w[i] * w[i] * double(faces[w[i] < 0 ? 3 + i : i]);
            return v;
        };
        double sky = 0;
        for (const glm::dvec3& w : sphere()) sky += std::max(glm::dot(w, region.normal), 0.0) * face(w) * solidAngle();
        EXPECT_NEAR(aperturaSkyIrradiance(APERTURA_MODEL_CUBE_6, receiver), sky, 1e-3);
        for (int k = 0; k < 20; ++k) {
            const glm::dvec3 towards = random.direction();
            if (glm::dot(towards, region.normal) < 0.1) continue;
            for (const double radius : {0.005, 0.09, 0.26}) {
                const Disc disc(towards, radius);
                const AperturaCapLight light = aperturaCapLight(towards, radius);
                const float e = aperturaIrradianceThrough(APERTURA_MODEL_CUBE_6, receiver, light, lightClassOf(light.sinRadius));
                EXPECT_NEAR(normalised(e, radius), open(region, disc) * clamped(disc.mean(face)), 0.03);
            }
        }
    }
}

TEST(Rivals, OverAnOpenPlaneAllGiveAllOfTheLight) {
    static const FitTools tools(4096, FitTools::Use::Samples);
    Region plane;
    plane.normal = glm::normalize(glm::dvec3(0.3, 1, -0.2));
    const SurfacePoint point{glm::dvec3(0), vec3(plane.normal), 1};
    for (const char* name : {"ao-cosine", "xegtao", "bent-cones", "horizon-4", "horizon-32", "bits-128"}) {
        const Model& model = *findModel(name);
        BakedPoint baked;
        samplePoints(plane, {&point, 1}, tools.lattice, 1, 1, {},
                     [&](size_t, const Samples& s, const mat3& frame) { baked = makePoint(recipeFor(model), tools, s, frame, {}); });
        const ModelParams* stored = model.isStored() ? &baked.params : nullptr;
        const AperturaReceiver receiver = toReceiver(baked.visibility, toParams(model, baked.visibility, stored, point.normal),
                                                     point.normal);
        for (const double elevation : {0.02, 0.1, 0.5, 1.5})
            for (const double radius : {0.005, 0.09, 0.5}) {
                const glm::dmat3 frame = frameAbout(plane.normal);
                const glm::dvec3 towards = frame * glm::dvec3(std::cos(elevation), 0, std::sin(elevation));
                const AperturaCapLight light = aperturaCapLight(towards, radius);
                const float e = aperturaIrradianceThrough(model.id, receiver, light, lightClassOf(light.sinRadius));
                EXPECT_NEAR(normalised(e, radius), exactFraction(plane.normal, {{towards, radius}}, radius), 0.02)
                    << name << ", " << elevation << ", " << radius;
            }
    }
}

TEST(Rivals, AHorizonIsFoundWhereItIs) {
    // A wall of known height on one side, about the vertical: the sine of its elevation at each azimuth in closed form.
    struct Wall : OcclusionSource {
        void occluded(const SurfacePoint&, std::span<const vec3> directions, uint8_t* blocked) const override {
            // Three metres high, two metres to the east, endless; and the ground.
            for (size_t i = 0; i < directions.size(); ++i) {
                const vec3 w = directions[i];
                blocked[i] = w.y < 0 || (w.x > 0 && 2 * w.y < 3 * w.x);
            }
        }
    } wall;
    const FitTools tools(64, FitTools::Use::Samples);
    const SurfacePoint point{glm::dvec3(0), glm::normalize(vec3(0.2f, 1, 0.1f)), 1};
    FitOptions options;
    options.terrain = true;
    BakedPoint baked;
    samplePoints(wall, {&point, 1}, tools.lattice, 1, 1, {}, [&](size_t, const Samples& s, const mat3& frame) {
        baked = makePoint(*findRecipe("horizon-32"), tools, s, frame, options);
    });
    const glm::dmat3 frame = frameAbout({0, 1, 0});
    for (int i = 0; i < 32; ++i) {
        const double turn = 2 * pi * i / 32;
        const glm::dvec3 out = std::cos(turn) * frame[0] + std::sin(turn) * frame[1];
        const double rise = std::max(1.5 * out.x, 0.0);
        EXPECT_NEAR(aperturaHorizonHeight(toReceiver({}, baked.params, point.normal), 32, i), rise / std::sqrt(1 + rise * rise), 1e-3) << i;
    }
}

}  // namespace
}  // namespace apertura::test
