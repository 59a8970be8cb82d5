#include "apertura/sh/sh4.h"

#include <cstring>

#include "apertura/sh/packing.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

TEST(Sh4, BasisIsOrthonormal) {
    double gram[4][4]{};
    const auto lattice = sphereLattice(200000);
    for (const dvec3& w : lattice) {
        const Sh4 y = shBasis(vec3(w));
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) gram[i][j] += double(y.c[i]) * y.c[j] * 4 * pi / double(lattice.size());
    }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) EXPECT_NEAR(gram[i][j], i == j, 1e-5);
}

TEST(Sh4, SignsAndOrderAreAsStated) {
    // Index l (l + 1) + m, no Condon-Shortley sign: band 1 is (y, z, x), each growing along its axis.
    EXPECT_NEAR(shBasis({0, 1, 0}).c[1], std::sqrt(3 / (4 * pi)), 1e-7);
    EXPECT_NEAR(shBasis({0, 0, 1}).c[2], std::sqrt(3 / (4 * pi)), 1e-7);
    EXPECT_NEAR(shBasis({1, 0, 0}).c[3], std::sqrt(3 / (4 * pi)), 1e-7);
    EXPECT_NEAR(shBasis({1, 0, 0}).c[0], 1 / std::sqrt(4 * pi), 1e-7);
}

TEST(Sh4, ProjectionOfACapMatchesTheClosedForm) {
    Random random(5);
    const int n = 200000;
    const auto lattice = sphereLattice(n);
    for (int trial = 0; trial < 20; ++trial) {
        const dvec3 axis = random.direction();
        const double r = random(0.1, 3);
        std::vector<vec3> open;
        for (const dvec3& w : lattice)
            if (dot(w, axis) >= std::cos(r)) open.emplace_back(w);
        const Visibility v = toVisibility(project(open, 4 * pi / n));
        EXPECT_NEAR(v.area, 4 * pi * std::pow(std::sin(r / 2), 2), 2e-3);
        EXPECT_LT(length(dvec3(v.direction) - pi * std::pow(std::sin(r), 2) * axis), 2e-3);
    }
}

TEST(Sh4, HoldsTheSameAsAreaAndDirection) {
    const Visibility v{{0.3f, -0.2f, 0.9f}, 2.5f}, back = toVisibility(toSh4(v));
    EXPECT_NEAR(back.area, v.area, 1e-6);
    EXPECT_LT(length(back.direction - v.direction), 1e-6);
}

Visibility randomVisibility(Random& random) {
    const double area = 2 * pi * std::pow(random(), 2), share = std::sqrt(random());
    return {vec3(random.direction() * area * (1 - area / (4 * pi)) * share), float(area)};
}

template <typename Packed>
void holdsItsBounds(Packed (*pack)(const Visibility&), int bits) {
    Random random(7);
    const PackingError bound = packingError(bits);
    double area = 0, direction = 0;
    for (int i = 0; i < 500000; ++i) {
        const Visibility v = randomVisibility(random), back = unpack(pack(v));
        area = std::max(area, std::abs(back.area - v.area) / (2 * pi));
        if (back.area == 0) {
            EXPECT_LE(v.area / (2 * pi), bound.closed * 1.0001);
            continue;
        }
        direction = std::max(direction, double(length(back.direction / back.area - v.direction / v.area)));
    }
    EXPECT_LE(area, bound.area + 1e-7);
    EXPECT_GE(area, 0.9 * bound.area);  // the bound is tight
    EXPECT_LE(direction, bound.direction);
    EXPECT_GE(direction, 0.7 * bound.direction);
}

TEST(Packing, EightBitsHoldTheirBounds) { holdsItsBounds<Packed8>(pack8, 8); }
TEST(Packing, SixteenBitsHoldTheirBounds) { holdsItsBounds<Packed16>(pack16, 16); }

TEST(Packing, IsWhatTheAssetSays) {
    // x, y, z = D / A, w = 2 sqrt(A / 2 pi) - 1.
    EXPECT_EQ(pack8({}), (Packed8{0, 0, 0, -127}));
    EXPECT_EQ(pack8({vec3(0, 0, float(pi)), float(2 * pi)}), (Packed8{0, 0, 64, 127}));
    EXPECT_EQ(pack16({vec3(0), float(pi / 2)}), (Packed16{0, 0, 0, 0}));
}

TEST(Packing, EveryPatternIsAPossibleVisibility) {
    Random random(9);
    auto possible = [](const Visibility& v) {
        return v.area >= 0 && v.area <= float(2 * pi) && length(v.direction) <= v.area * (1 - v.area / (4 * pi)) * 1.00001;
    };
    for (int i = 0; i < 1 << 22; ++i) {
        const uint64_t bits = random.engine();
        Packed8 p;
        Packed16 q;
        std::memcpy(&p, &bits, 4);
        std::memcpy(&q, &bits, 8);
        ASSERT_TRUE(possible(unpack(p)) && possible(unpack(q)));
    }
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(possible(unpack(vec4(nan, 1, 2, 1e30f))));
}

}  // namespace
}  // namespace apertura::test
