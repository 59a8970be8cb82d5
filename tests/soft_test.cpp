#include "apertura/sh/soft.h"
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/truth.h"

#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/scene/load.h"
#include "apertura/sh/models.h"
#include "apertura/sh/soft_solve.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

struct Integrals {
    double area = 0;
    dvec3 direction{0};
};

Integrals overHemisphere(const dvec3& normal, const dvec3& slope, double offset) {
    Integrals out;
    const auto lattice = sphereLattice(400000);
    for (const dvec3& w : lattice) {
        if (dot(w, normal) < 0) continue;
        const double f = offset + dot(slope, w), v = 0.5 + 0.5 * f / std::sqrt(1 + f * f);
        out.area += v;
        out.direction += v * w;
    }
    out.area *= 4 * pi / double(lattice.size());
    out.direction *= 4 * pi / double(lattice.size());
    return out;
}

TEST(SoftSolve, HasTheIntegralsItWasAskedFor) {
    Random random(21);
    for (int trial = 0; trial < 12; ++trial) {
        const double area = 2 * pi * random(0.02, 0.98), psi = random(0, pi), rho = random(0, 0.95);
        const double reach = rho * area / 2 * (1 - area / (2 * pi));  // inside HardBoundary, which is at least 1
        const SoftSolution s = solveSoft({area, area / 2 + reach * std::cos(psi), reach * std::sin(psi)});
        const Integrals i = overHemisphere({0, 0, 1}, {s.t, 0, s.n}, s.offset);
        EXPECT_NEAR(i.area, area, 2e-4);
        EXPECT_NEAR(i.direction.z, area / 2 + reach * std::cos(psi), 2e-4);
        EXPECT_NEAR(i.direction.x, reach * std::sin(psi), 2e-4);
    }
}

TEST(SoftSolve, BoundaryIsWhereHardHalfSpacesLie) {
    // Straight up and straight down it is 1, its unit. For half of the hemisphere on one side D = pi/2 (n + t).
    EXPECT_NEAR(HardBoundary(1.0)(0), 1, 1e-6);
    EXPECT_NEAR(HardBoundary(1.0)(pi), 1, 1e-6);
    EXPECT_NEAR(HardBoundary(pi)(pi / 2), 2, 1e-3);
}

TEST(Soft, TableIsWithinThreeThousandthsOfTheFullSolve) {
    // Visibility at receivers of the built-in scenes, lights of all sizes.
    Random random(23);
    double sum = 0;
    int count = 0;
    for (const char* name : {"terrain", "statue", "canyon", "forest", "colonnade"}) {
        const Scene scene = makeBuiltin(name);
        const Tracer tracer(scene);
        std::vector<SurfacePoint> points;
        for (const SurfaceSample& p : sampleReceivers(scene, 150, 4)) points.push_back(p.at);
        BakeOptions options;
        options.rays = 1024;
        const std::vector<BakedPoint> visibility = bakePoints(RayOcclusion(tracer), points, options);
        for (size_t i = 0; i < points.size(); ++i) {
            const vec3 n = points[i].normal;
            const Visibility& v = visibility[i].visibility;
            const double open = v.area / (2 * pi);
            if (open < 1e-3 || open > 0.999) continue;
            const double dn = dot(v.direction, n);
            const vec3 across = v.direction - float(dn) * n;
            const SoftSolution s = solveSoft({v.area, dn, length(across)});
            if (!(std::hypot(s.n, s.t) < 1e3)) continue;  // a hard edge has no soft solution
            const vec3 side = length(across) > 0 ? normalize(across) : vec3(0);
            const AperturaSoftAperture full{float(s.n) * n + float(s.t) * side, float(s.offset)}, table = toSoft(v, n);
            for (int k = 0; k < 40; ++k) {
                dvec3 l = random.direction();
                if (dot(l, dvec3(n)) < 0) l = -l;
                const double r = 0.27 * std::pow(45 / 0.27, random()) * pi / 180;
                const AperturaCapLight light = aperturaCapLight(l, r);
                const double e = normalised(aperturaIrradianceThroughSoft(n, table, light, APERTURA_LIGHTS_ANY)
                                                - aperturaIrradianceThroughSoft(n, full, light, APERTURA_LIGHTS_ANY),
                                            r);
                sum += e * e;
                ++count;
            }
        }
    }
    ASSERT_GT(count, 10000);
    const double rms = std::sqrt(sum / count);
    std::printf("table against full solve: rms %.5f over %d lights\n", rms, count);
    EXPECT_LE(rms, 0.003);
}

// The lobe that is drawn is softened to keep its numbers in bounds. Openings and blockers that the horizon does not cut
// still keep their area, down to a radius of 2 degrees. Scaling slope and offset alike would turn 2 degrees into 5.
TEST(Soft, CapsAsSoftAsTheyAreDrawnKeepTheirArea) {
    const Model& soft = *findModel("soft");
    const vec3 n(0, 0, 1);
    for (const double tilt : {0.0, 0.2, 0.9})
        for (const double open : {0.0006, 0.002, 0.01, 0.1, 0.9, 0.99, 0.998, 0.9994}) {
            const double area = 2 * pi * std::min(open, 1 - open);
            const vec3 direction = vec3(dvec3(std::sin(tilt), 0, std::cos(tilt)) * area * (1 - area / (4 * pi)));
            // A cap; if more than half is open, the hemisphere without a cap.
            const Visibility v = open <= 0.5 ? Visibility{direction, float(area)}
                                             : Visibility{float(pi) * n - direction, float(2 * pi - area)};
            const vec4 lobe = toParams(soft, v, nullptr, n)[0];
            EXPECT_LE(length(vec3(lobe)) + std::abs(lobe.w), 250.01f) << open;
            const AperturaSoftAperture solved = toSoft(v, n);
            const double before = overHemisphere(n, dvec3(solved.slope), solved.offset).area,
                         after = overHemisphere(n, dvec3(vec3(lobe)), lobe.w).area;
            const double smaller = std::min(before, 2 * pi - before);
            EXPECT_NEAR(after, before, 0.08 * smaller) << open << ", tilt " << tilt;
        }
}

TEST(Soft, LightIsTheIntegralOfTheModelOverIt) {
    // Compares the formula with brute force over the light's disc, for soft apertures of all kinds.
    Random random(27);
    double sum = 0, worst = 0, classSum[4]{};  // by the light class that a renderer uses
    int classCount[4]{};
    const int trials = 3000, rings = 24, turns = 48;
    const dvec3 n(0, 0, 1);
    for (int i = 0; i < trials; ++i) {
        const double area = 2 * pi * random(0.05, 0.95);
        dvec3 d = random.direction();
        d.z = std::abs(d.z);
        const Visibility v{vec3(d * area * (1 - area / (4 * pi)) * std::sqrt(random())), float(area)};
        const AperturaSoftAperture soft = toSoft(v, vec3(n));
        dvec3 axis = random.direction();
        axis.z = std::abs(axis.z) - 0.1;
        axis = normalize(axis);
        const double r = 0.27 * std::pow(45 / 0.27, random()) * pi / 180, height = 1 - std::cos(r);
        const dvec3 u = normalize(cross(axis, dvec3(0.3, 0.5, 0.81))), w = cross(axis, u);
        double e = 0;
        for (int a = 0; a < rings; ++a)
            for (int b = 0; b < turns; ++b) {
                const double h = height * (a + 0.5) / rings, s = std::sqrt(h * (2 - h)), turn = 2 * pi * (b + 0.5 * (a % 2)) / turns;
                const dvec3 l = (1 - h) * axis + s * (std::cos(turn) * u + std::sin(turn) * w);
                const double f = soft.offset + dot(dvec3(soft.slope), l);
                e += std::max(l.z, 0.0) * softStepExact(f);
            }
        e *= 2 * pi * height / (rings * turns) / (pi * std::sin(r) * std::sin(r));
        const double error = normalised(aperturaIrradianceThroughSoft(vec3(n), soft, aperturaCapLight(axis, r), APERTURA_LIGHTS_ANY), r)
                           - e;
        sum += error * error;
        worst = std::max(worst, std::abs(error));
        const int lightClass = lightClassOf(float(std::sin(r)));
        classSum[lightClass] += std::pow(
            normalised(aperturaIrradianceThroughSoft(vec3(n), soft, aperturaCapLight(axis, r), lightClass), r) - e, 2);
        ++classCount[lightClass];
    }
    std::printf("soft light against brute force: rms %.4f max %.4f\n", std::sqrt(sum / trials), worst);
    EXPECT_LE(std::sqrt(sum / trials), 0.0092);
    for (const auto& [lightClass, most] :
         {std::pair(APERTURA_LIGHTS_SUN, 0.002), std::pair(APERTURA_LIGHTS_SMALL, 0.005), std::pair(APERTURA_LIGHTS_MEDIUM, 0.015)}) {
        std::printf("  lights of class %d: rms %.4f\n", lightClass, std::sqrt(classSum[lightClass] / classCount[lightClass]));
        EXPECT_LE(std::sqrt(classSum[lightClass] / classCount[lightClass]), most);
    }
    EXPECT_LE(worst, 0.09);
}

// Two lobes whose edges have random directions; in half of the trials they are nearly parallel or antiparallel.
TEST(Lobes, LightThroughTwoIsTheIntegralOfTheirProduct) {
    Random random(61);
    const dvec3 n(0, 0, 1);
    double sum = 0, plain = 0;
    const int trials = 1500, rings = 24, turns = 48;
    for (int i = 0; i < trials; ++i) {
        const double r = 1 * std::pow(45.0, random()) * pi / 180, z = random(std::sin(r), 1), height = 1 - std::cos(r);
        const dvec3 axis(std::sqrt(1 - z * z), 0, z), u = normalize(cross(axis, dvec3(0.3, 0.5, 0.81))), w = cross(axis, u);
        dvec3 slopes[2]{random.direction(), random.direction()};
        if (i % 2) slopes[1] = normalize((random() < 0.5 ? 1.0 : -1.0) * slopes[0] + 0.3 * slopes[1]);
        AperturaReceiver receiver{vec3(n), vec4(float(pi) * vec3(n), float(2 * pi)), {}};
        double offsets[2];
        for (int k = 0; k < 2; ++k) {
            slopes[k] *= 3 * std::pow(80, random());
            const double along = dot(slopes[k], axis), across = std::sqrt(std::max(dot(slopes[k], slopes[k]) - along * along, 0.0));
            offsets[k] = -along + random(-1, 1) * (1.5 + 1.2 * across * std::sin(r));
            receiver.params[k] = vec4(vec3(slopes[k]), float(offsets[k]));
        }
        double both = 0, each[2]{}, all = 0;
        for (int a = 0; a < rings; ++a)
            for (int b = 0; b < turns; ++b) {
                const double h = height * (a + 0.5) / rings, s = std::sqrt(h * (2 - h)), turn = 2 * pi * (b + 0.5 * (a % 2)) / turns;
                const dvec3 l = (1 - h) * axis + s * (std::cos(turn) * u + std::sin(turn) * w);
                const double first = softStepExact(offsets[0] + dot(slopes[0], l)), second = softStepExact(offsets[1] + dot(slopes[1], l));
                all += l.z, both += l.z * first * second, each[0] += l.z * first, each[1] += l.z * second;
            }
        const AperturaCapLight light = aperturaCapLight(axis, r);
        const double e = aperturaIrradianceThrough(APERTURA_MODEL_FIRM_2, receiver, light, lightClassOf(light.sinRadius))
                       / aperturaUnoccludedIrradiance(vec3(n), light, APERTURA_LIGHTS_ANY);
        sum += std::pow(e - both / all, 2);
        plain += std::pow((each[0] * each[1] / all - both) / all, 2);
    }
    std::printf("two lobes against brute force: rms %.4f; the product of their exact means: %.4f\n", std::sqrt(sum / trials),
                std::sqrt(plain / trials));
    EXPECT_LE(std::sqrt(sum / trials), 0.016);
    EXPECT_GE(std::sqrt(plain / trials), 0.025);
}

TEST(Lobes, TheSameTwiceIsOne) {
    Random random(62);
    for (int i = 0; i < 1000; ++i) {
        AperturaReceiver receiver{vec3(0, 0, 1), vec4(0, 0, float(pi), float(2 * pi)), {}};
        const float sharp = float(random(150, 240));  // for soft steps the square of one is not the step itself
        for (int k = 0; k < 4; ++k) receiver.params[k] = vec4(sharp * vec3(0, 1, 0), 0.0f);
        receiver.params[4] = vec4(0);
        const double r = random(5, 10) * pi / 180;
        const AperturaCapLight light = aperturaCapLight(normalize(dvec3(0.2, random(-0.15, 0.15), 1)), r);
        const int lightClass = lightClassOf(light.sinRadius);
        AperturaReceiver two = receiver, three = receiver, one = receiver;
        two.params[2] = three.params[3] = vec4(0);
        one.params[1] = vec4(0, 0, 0, 1000);  // the other lobe is fully open
        one.params[2] = vec4(0);
        const double single = aperturaIrradianceThrough(APERTURA_MODEL_FIRM_2, one, light, lightClass) / light.area;
        EXPECT_NEAR(aperturaIrradianceThrough(APERTURA_MODEL_FIRM_2, two, light, lightClass) / light.area, single, 0.02);
        EXPECT_NEAR(aperturaIrradianceThrough(APERTURA_MODEL_FIRM_3, three, light, lightClass) / light.area, single, 0.04);
        EXPECT_NEAR(aperturaIrradianceThrough(APERTURA_MODEL_FIRM_4, receiver, light, lightClass) / light.area, single, 0.06);
    }
}

TEST(Soft, IsFiniteAndInRangeForAnything) {
    Random random(25);
    for (int i = 0; i < 200000; ++i) {
        const double area = std::pow(10, random(-8, 1)) * (random() < 0.05 ? 0 : 1);
        const vec3 n(normalize(random.direction()));
        const Visibility v{vec3(random.direction() * area * random(0, 1.5)), float(area)};
        const AperturaSoftAperture soft = toSoft(v, n);
        const AperturaCapLight light = aperturaCapLight(random.direction(), random(1e-4, pi / 2));
        const float e = aperturaIrradianceThroughSoft(n, soft, light, APERTURA_LIGHTS_ANY);
        ASSERT_TRUE(std::isfinite(soft.offset) && std::isfinite(length(soft.slope)));
        ASSERT_TRUE(e >= 0 && e <= 1.001f * aperturaIrradianceAboveHorizon(n, light) + 1e-12f);
    }
}

TEST(Soft, OfAnEvenHazeIsTheHaze) {
    const vec3 n(0, 1, 0);
    const AperturaSoftAperture soft = toSoft({float(pi) * 0.3f * n, float(2 * pi) * 0.3f}, n);
    EXPECT_LT(length(soft.slope), 0.02f);
    const AperturaCapLight light = aperturaCapLight(normalize(dvec3(1, 1, 0)), 0.1);
    EXPECT_NEAR(aperturaIrradianceThroughSoft(n, soft, light, APERTURA_LIGHTS_ANY) / aperturaIrradianceAboveHorizon(n, light), 0.3, 0.003);
}

}  // namespace
}  // namespace apertura::test
