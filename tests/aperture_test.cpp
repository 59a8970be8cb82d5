#include "apertura/sh/aperture.h"

#include "tests/support.h"

namespace apertura::test {
namespace {

struct Errors {
    double rms = 0, max = 0;
};

// Errors of E / (L pi sin^2 r) through random apertures of the upper hemisphere; half of the lights are near the rim.
// least, largest: light radii, degrees.
template <typename Formula>
Errors againstExact(uint64_t seed, Formula&& formula, double least = 0.27, double largest = 45) {
    Random random(seed);
    const dvec3 normal(0, 0, 1);
    Errors out;
    const int n = 100000;
    for (int i = 0; i < n;) {
        dvec3 axis = random.direction(), light = random.direction();
        axis.z = std::abs(axis.z);
        const double r0 = std::acos(1 - random()), r1 = least * std::pow(largest / least, random()) * pi / 180;
        if (i % 2) {
            const double d = r0 + r1 * random(-2, 2);
            light = std::cos(d) * axis + std::sin(d) * normalize(cross(axis, random.direction()));
        }
        if (light.z < -std::sin(r1)) continue;
        const double error = normalised(formula(vec3(normal), capAperture(axis, r0), aperturaCapLight(light, r1)), r1)
                           - exactFraction(normal, {{axis, r0}, {light, r1}}, r1);
        out.rms += error * error;
        out.max = std::max(out.max, std::abs(error));
        ++i;
    }
    out.rms = std::sqrt(out.rms / n);
    return out;
}

TEST(Aperture, LightThroughItIsAsNearToExactAsItsHeadSays) {
    for (uint64_t seed : {11, 12, 13, 14}) {
        const Errors e = againstExact(seed, [](auto... a) { return aperturaIrradianceThroughAperture(a..., APERTURA_LIGHTS_ANY); });
        EXPECT_LE(e.rms, 0.0023) << "seed " << seed;
        EXPECT_LE(e.max, 0.036) << "seed " << seed;
        std::printf("seed %d: rms %.4f max %.4f\n", int(seed), e.rms, e.max);
    }
}

TEST(Aperture, AndSoAreTheFormulasForLightsOfASize) {
    const Errors medium = againstExact(
        15, [](auto... a) { return aperturaIrradianceThroughAperture(a..., APERTURA_LIGHTS_MEDIUM); }, 3, 10);
    const Errors small = againstExact(
        16, [](auto... a) { return aperturaIrradianceThroughAperture(a..., APERTURA_LIGHTS_SMALL); }, 0.27, 3);
    std::printf("medium: rms %.4f max %.4f, small: rms %.4f max %.4f\n", medium.rms, medium.max, small.rms, small.max);
    EXPECT_LE(medium.rms, 0.003);
    EXPECT_LE(medium.max, 0.035);
    EXPECT_LE(small.rms, 0.005);
    EXPECT_LE(small.max, 0.035);
}

TEST(Aperture, ErrsMoreUnderLargerLightsWhereHalfOfThemLieOnItsEdge) {
    for (const auto& [radius, most] : {std::pair(1.0, 0.0017), {5.0, 0.0019}, {15.0, 0.0023}, {30.0, 0.0033}, {45.0, 0.0049}}) {
        const Errors e = againstExact(
            17, [](auto... a) { return aperturaIrradianceThroughAperture(a..., APERTURA_LIGHTS_ANY); }, radius, radius);
        std::printf("%g degrees: rms %.4f max %.4f\n", radius, e.rms, e.max);
        EXPECT_LE(e.rms, most) << radius;
    }
}

TEST(Aperture, AChordLeavesOfADiscWhatItShould) {
    double before = 0;
    for (int i = 1; i <= 1000; ++i) {
        const double x = i / 1000.0, turn = std::acos(1 - 2 * x), share = aperturaDiscFraction(float(x));
        EXPECT_NEAR(share, (turn - std::sin(turn) * std::cos(turn)) / pi, 0.0012) << x;
        EXPECT_LE((share - before) * 1000, 4 / pi + 1e-3) << x;  // slope of a chord through the centre
        before = share;
    }
}

TEST(Aperture, ThePublishedFormulaIsTheBaselineThatItIsSaidToBe) {
    // 0.19 RMS over lights of the sizes in the header's claim, 0.69 at most; this mix is wider and has the same maximum.
    const Errors e = againstExact(11, [](auto... a) { return aperturaOatIrradianceThroughAperture(a...); });
    EXPECT_GT(e.rms, 0.1);
    EXPECT_NEAR(e.max, 0.69, 0.02);
}

TEST(Aperture, SurvivesWhereThePublishedFormulaFails) {
    const vec3 n(0, 0, 1);
    for (double r0 : {0.0, 1e-5, 0.00465, 0.5, pi / 2})
        for (double r1 : {1e-5, 0.00465, 0.26, pi / 2})
            for (const dvec3& axis : {dvec3(0, 0, 1), dvec3(0, 0, -1), dvec3(1, 0, 0)})
                for (const dvec3& light : {axis, -axis, dvec3(0, 1, 0)}) {
                    const float e = aperturaIrradianceThroughAperture(n, capAperture(axis, r0), aperturaCapLight(light, r1),
                                                                      APERTURA_LIGHTS_ANY);
                    EXPECT_TRUE(std::isfinite(e) && e >= 0 && e <= 1.006 * pi * std::pow(std::sin(r1), 2) + 1e-12)
                        << r0 << " " << r1 << " gives " << e;
                }
}

TEST(Aperture, ComesBackFromItsOwnCoefficients) {
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const dvec3 axis = random.direction();
        const double r = random(0.001, pi / 2), area = 2 * pi * (1 - std::cos(r));
        const Visibility cap{vec3(axis * area * (1 - area / (4 * pi))), float(area)};
        EXPECT_NEAR(capness(cap), 1, 1e-5);
        const AperturaAperture a = toAperture(toVisibility(toSh4(cap)), vec3(0, 0, 1));
        EXPECT_LT(length(dvec3(a.axis) - axis), 1e-5);
        EXPECT_NEAR(aperturaCapRadius(a.height), r, 2e-4);
    }
}

TEST(Aperture, AxisFallsBackToTheNormal) {
    const vec3 n = normalize(vec3(1, 2, 3));
    EXPECT_EQ(toAperture({}, n).axis, n);
    EXPECT_EQ(toAperture({}, n).height, 0);
    EXPECT_EQ(toAperture({vec3(0), 3}, n).axis, n);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(toAperture({vec3(nan), nan}, n).axis, n);
}

TEST(Aperture, FullyOpenIsTheHemisphere) {
    const vec3 n(0, 1, 0);
    const AperturaAperture a = toAperture({float(pi) * n, float(2 * pi)}, n);
    EXPECT_NEAR(a.height, 1, 1e-6);
    const AperturaCapLight sun = aperturaCapLight(normalize(dvec3(1, 2, 0)), 0.00465);
    EXPECT_NEAR(aperturaIrradianceThroughAperture(n, a, sun, APERTURA_LIGHTS_ANY) / aperturaIrradianceAboveHorizon(n, sun), 1, 1e-3);
}

}  // namespace
}  // namespace apertura::test
