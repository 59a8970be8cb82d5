#include "tests/support.h"

namespace apertura::test {
namespace {

TEST(CapReference, MatchesQuadratureOnRandomTriples) {
    Random random(1);
    const auto lattice = sphereLattice(400000);
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<ExactCap> caps;
        for (int i = 0; i < 3; ++i) caps.push_back({random.direction(), random(0.05, 2.6)});
        dvec3 sum(0);
        for (const dvec3& w : lattice) {
            bool in = true;
            for (const ExactCap& cap : caps) in = in && dot(w, cap.axis) >= std::cos(cap.radius);
            if (in) sum += w;
        }
        sum *= 4 * pi / double(lattice.size());
        EXPECT_LT(length(sum - vectorIrradiance(caps)), 2e-3) << "trial " << trial;
    }
}

TEST(CapReference, KnownDegenerateCases) {
    const dvec3 up(0, 0, 1), side(1, 0, 0);
    auto along = [](std::vector<ExactCap> caps) { return vectorIrradiance(caps); };
    const double r = 0.4, disc = pi * std::sin(r) * std::sin(r);
    EXPECT_NEAR(along({{up, r}}).z, disc, 1e-14);
    EXPECT_NEAR(along({{up, pi}}).z, 0, 1e-14);                      // everything
    EXPECT_NEAR(along({{up, pi / 2}}).z, pi, 1e-14);                 // a hemisphere
    EXPECT_NEAR(along({{up, r}, {up, r}}).z, disc, 1e-14);           // equal: counted once
    EXPECT_NEAR(along({{up, r}, {up, 0.9}}).z, disc, 1e-14);         // nested
    EXPECT_NEAR(length(along({{up, r}, {-up, 0.9}})), 0, 1e-14);     // disjoint
    EXPECT_NEAR(length(along({{up, r}, {-up, pi - r}})), 0, 1e-14);  // complements
    EXPECT_NEAR(along({{up, 0}}).z, 0, 1e-14);
    // Two hemispheres at a right angle: a lune of pi/2, F = pi/2 (side + up).
    EXPECT_LT(length(along({{up, pi / 2}, {side, pi / 2}}) - pi / 2 * (up + side)), 1e-12);
    // Caps that touch from outside and from inside.
    const dvec3 tilted(std::sin(0.7), 0, std::cos(0.7));
    EXPECT_NEAR(length(along({{up, 0.3}, {tilted, 0.4}})), 0, 1e-8);
    EXPECT_NEAR(along({{up, 1.1}, {tilted, 0.4}}).x, pi * std::pow(std::sin(0.4), 2) * std::sin(0.7), 1e-8);
    // Two caps over 90 degrees that cover the sphere: their intersection is the sphere without their two complements.
    const double a = 2.8;
    const dvec3 both = along({{up, a}, {side, a}});
    EXPECT_LT(length(both - pi * std::pow(std::sin(a), 2) * (up + side)), 1e-12);
}

TEST(CapReference, HalfACapOnTheHorizon) {
    // A light centred on the horizon, by quadrature over its rings, of which one half is above the horizon.
    const double r = 0.5;
    double expected = 0;
    const int steps = 200000;
    for (int i = 0; i < steps; ++i) {
        const double theta = (i + 0.5) / steps * r;
        expected += 2 * std::sin(theta) * std::sin(theta) * r / steps;
    }
    EXPECT_NEAR(dot(dvec3(0, 0, 1), vectorIrradiance(std::vector<ExactCap>{{{1, 0, 0}, r}, {{0, 0, 1}, pi / 2}})), expected, 1e-9);
}

TEST(Light, CutByTheHorizonWithinAThousandth) {
    const dvec3 normal(0, 0, 1);
    double worst = 0;
    for (double degrees = 0.27; degrees <= 45; degrees *= 1.05)
        for (double elevation = -60; elevation <= 90; elevation += 0.125) {
            const double r = degrees * pi / 180, e = elevation * pi / 180;
            const dvec3 axis(std::cos(e), 0, std::sin(e));
            const double error = normalised(aperturaIrradianceAboveHorizon(vec3(normal), aperturaCapLight(axis, r)), r)
                               - exactFraction(normal, {{axis, r}}, r);
            worst = std::max(worst, std::abs(error));
        }
    EXPECT_LE(worst, 0.001);
    RecordProperty("worst", std::to_string(worst));
}

TEST(Light, OfASphereHasTheSizeItIsSeenAt) {
    const AperturaCapLight light = aperturaCapOfSphere(vec3(0, 4, 0), 1);
    EXPECT_FLOAT_EQ(light.sinRadius, 0.25f);
    EXPECT_NEAR(light.height, 1 - std::sqrt(1 - 0.0625), 1e-7);
    EXPECT_FLOAT_EQ(light.axis.y, 1);
    EXPECT_FLOAT_EQ(aperturaCapOfSphere(vec3(0, 0.5f, 0), 1).sinRadius, 1);  // from inside: a half-space
    const AperturaCapLight centre = aperturaCapOfSphere(vec3(0), 1);
    EXPECT_TRUE(std::isfinite(aperturaIrradianceAboveHorizon(vec3(0, 1, 0), centre)));
}

}  // namespace
}  // namespace apertura::test
