// The mean over a light of a product of visibilities, compared with brute force and with exact overlaps.
#include "apertura/sh/models.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// `n` unit directions, uniform over a light.
std::vector<dvec3> directionsIn(const dvec3& axis, double radius, int n) {
    const dvec3 u = normalize(cross(axis, dvec3(0.3, 0.5, 0.81))), v = cross(axis, u);
    std::vector<dvec3> out;
    for (int i = 0; i < n; ++i) {
        const double z = 1 - (1 - std::cos(radius)) * (i + 0.5) / n, s = std::sqrt(1 - z * z), turn = i * pi * (3 - std::sqrt(5.0));
        out.push_back(z * axis + s * (std::cos(turn) * u + std::sin(turn) * v));
    }
    return out;
}

TEST(Edges, CovarianceIsThatOfTwoPlanesOverTheLight) {
    Random random(71);
    double alongOnly = 0;
    for (int i = 0; i < 300; ++i) {
        const double radius = random(0.02, pi / 4);
        dvec3 axis = random.direction(), a = random.direction(), b = random.direction();
        if (i % 3 == 0) a = axis, b = normalize(axis + 0.1 * b);  // edges then run along the light's rim
        double sumA = 0, sumB = 0, squareA = 0, squareB = 0, product = 0;
        const std::vector<dvec3> inside = directionsIn(axis, radius, 4000);
        for (const dvec3& w : inside) {
            const double x = dot(a, w), y = dot(b, w);
            sumA += x, sumB += y, squareA += x * x, squareB += y * y, product += x * y;
        }
        const double n = double(inside.size());
        const double exact = product / n - sumA * sumB / n / n,
                     deviations = std::sqrt((squareA / n - sumA * sumA / n / n) * (squareB / n - sumB * sumB / n / n));
        const AperturaCapLight light = aperturaCapLight(axis, radius);
        const double s2 = std::pow(std::sin(radius), 2) / 4;
        const double ours = s2 * aperturaCovariance(float(dot(a, b)), float(dot(a, axis)), float(dot(b, axis)), light);
        EXPECT_NEAR(ours, exact, 0.07 * deviations + 1e-7) << i << ", radius " << radius;
        if (i % 3 == 0) alongOnly = std::max(alongOnly, std::abs(exact) / deviations);
    }
    EXPECT_GT(alongOnly, 0.9);
}

// Half planes, discs and their complements over a unit disc; the edges have random directions, or nearly parallel ones.
TEST(Edges, MeansOfThreeAndFourFollowFromTheirPairs) {
    Random random(72);
    double three = 0, four = 0, plainThree = 0, plainFour = 0, worst = 0;
    const int trials = 4000, samples = 500;
    for (int i = 0; i < trials; ++i) {
        double slope[4][2], offset[4], bend[4];
        const double first = random(0, 2 * pi);
        for (int k = 0; k < 4; ++k) {
            const double turn = i % 2 ? random(0, 2 * pi) : first + 0.5 * random(-1, 1) + (random() < 0.3 ? pi : 0);
            slope[k][0] = std::cos(turn), slope[k][1] = std::sin(turn), offset[k] = random(-1, 1), bend[k] = random(-0.5, 0.5);
        }
        double p[4]{}, pair[4][4]{}, all3 = 0, all4 = 0;
        for (int s = 0; s < samples; ++s) {
            const double r = std::sqrt((s + 0.5) / samples), turn = s * pi * (3 - std::sqrt(5.0)), x = r * std::cos(turn),
                         y = r * std::sin(turn);
            bool in[4];
            for (int k = 0; k < 4; ++k) in[k] = slope[k][0] * x + slope[k][1] * y + bend[k] * r * r >= offset[k];
            for (int k = 0; k < 4; ++k) {
                p[k] += in[k];
                for (int l = 0; l < 4; ++l) pair[k][l] += in[k] && in[l];
            }
            all3 += in[0] && in[1] && in[2], all4 += in[0] && in[1] && in[2] && in[3];
        }
        const auto mean = [&](double sum) { return float(sum / samples); };
        const float ours3 = aperturaMeanOfThree(vec3(mean(p[0]), mean(p[1]), mean(p[2])),
                                                vec3(mean(pair[0][1]), mean(pair[0][2]), mean(pair[1][2])));
        const float ours4 = aperturaMeanOfFour(vec4(mean(p[0]), mean(p[1]), mean(p[2]), mean(p[3])),
                                               vec2(mean(pair[0][1]), mean(pair[2][3])),
                                               vec4(mean(pair[0][2]), mean(pair[1][2]), mean(pair[0][3]), mean(pair[1][3])));
        three += std::pow(ours3 - mean(all3), 2), four += std::pow(ours4 - mean(all4), 2);
        plainThree += std::pow(mean(p[0]) * mean(p[1]) * mean(p[2]) - mean(all3), 2);
        plainFour += std::pow(mean(p[0]) * mean(p[1]) * mean(p[2]) * mean(p[3]) - mean(all4), 2);
        worst = std::max({worst, std::abs(double(ours3 - mean(all3))), std::abs(double(ours4 - mean(all4)))});
    }
    std::printf("of three rms %.4f (product of means %.4f), of four %.4f (%.4f), max %.3f\n", std::sqrt(three / trials),
                std::sqrt(plainThree / trials), std::sqrt(four / trials), std::sqrt(plainFour / trials), worst);
    EXPECT_LE(std::sqrt(three / trials), 0.002);
    EXPECT_LE(std::sqrt(four / trials), 0.004);
    EXPECT_LE(worst, 0.055);
    EXPECT_GE(std::sqrt(plainThree / trials), 0.06);
    EXPECT_GE(std::sqrt(plainFour / trials), 0.06);
}

TEST(Edges, TwoMeansAreWithinWhatTwoCanHave) {
    Random random(73);
    for (int i = 0; i < 10000; ++i) {
        const float p = float(random()), q = float(random()), w = aperturaEdgeAlignment(float(random(-1.2, 1.2)));
        const float both = aperturaMeanOfTwo(p, q, w);
        EXPECT_LE(both, std::min(p, q) + 1e-6f);
        EXPECT_GE(both, std::max(p + q - 1, 0.0f) - 1e-6f);
    }
    EXPECT_EQ(aperturaMeanOfTwo(0.4f, 0.7f, aperturaEdgeAlignment(0)), 0.4f * 0.7f);
    EXPECT_FLOAT_EQ(aperturaMeanOfTwo(0.4f, 0.7f, aperturaEdgeAlignment(1)), 0.4f);
    EXPECT_NEAR(aperturaMeanOfTwo(0.4f, 0.7f, aperturaEdgeAlignment(-1)), 0.1f, 1e-6);
}

// The same cap several times counts once, where it crosses the light's edge and where it lies within the light, so that
// its edge has no direction.
TEST(Edges, CapsOneUponTheOtherCountOnce) {
    Random random(74);
    const dvec3 n(0, 0, 1);
    for (int i = 0; i < 300; ++i) {
        const double light = random(3, 30) * pi / 180, radius = light * random(0.5, 1), away = radius * random(0, 1.5);
        const dvec3 l = normalize(dvec3(random(-0.3, 0.3), random(-0.3, 0.3), 1)), side = normalize(cross(l, random.direction()));
        const dvec3 axis = std::cos(away) * l + std::sin(away) * side;
        const double exact = exactFraction(n, {{axis, radius}, {l, light}}, light);
        const AperturaCapLight cap = aperturaCapLight(l, light);
        ModelParams stored{};
        for (int k = 0; k < 4; ++k) stored[size_t(k)] = vec4(vec3(axis), float(1 - std::cos(radius)));
        for (const char* name : {"multi-2", "multi-3", "multi-4"}) {
            const Model& model = *findModel(name);
            const AperturaReceiver receiver = toReceiver({float(pi) * vec3(n), float(2 * pi)}, toParams(model, {}, &stored, vec3(n)),
                                                         vec3(n));
            EXPECT_NEAR(normalised(aperturaIrradianceThrough(model.id, receiver, cap, lightClassOf(cap.sinRadius)), light), exact, 0.05)
                << name << ", light " << light << ", cap " << radius << ", away " << away;
        }
    }
}

// The mean of the product of two visibilities over one light, against its quadrature; a blocker whose edge is the baked one takes
// hardly more away than the softness of that edge does.
TEST(Edges, VisibilitiesOfOneLightAreCorrelated) {
    Random random(75);
    double both = 0, plain = 0, twice = 0, plainTwice = 0;
    const int trials = 2000;
    for (int i = 0; i < trials; ++i) {
        const double radius = random(1, 9) * pi / 180;
        const dvec3 axis = normalize(dvec3(random(-0.2, 0.2), random(-0.2, 0.2), 1));
        const AperturaCapLight light = aperturaCapLight(axis, radius);
        vec4 lobe[2];
        AperturaLightVisibility seen[2];
        for (int k = 0; k < 2; ++k) {
            const vec3 slope = kHardSharpness * vec3(random.direction());
            lobe[k] = vec4(slope, kHardSharpness * light.sinRadius * float(random(-1, 1)) - dot(slope, light.axis));
            AperturaReceiver receiver{vec3(0, 0, 1), vec4(0, 0, 3, 6), {}};
            receiver.params[0] = lobe[k];
            seen[k] = aperturaVisibilityOfLight(APERTURA_MODEL_SOFT, receiver, light, APERTURA_LIGHTS_MEDIUM);
        }
        double product = 0, square = 0;
        const int samples = 500;
        for (const dvec3& direction : directionsIn(axis, radius, samples)) {
            const vec3 w(direction);
            const double first = aperturaSoftStep(lobe[0].w + dot(vec3(lobe[0]), w)),
                         second = aperturaSoftStep(lobe[1].w + dot(vec3(lobe[1]), w));
            product += first * second / samples, square += first * first / samples;
        }
        both += std::pow(aperturaMeanOfBoth(seen[0], seen[1], light) - product, 2),
            plain += std::pow(seen[0].mean * seen[1].mean - product, 2);
        twice += std::pow(aperturaMeanOfBoth(seen[0], seen[0], light) - square, 2),
            plainTwice += std::pow(seen[0].mean * seen[0].mean - square, 2);
    }
    std::printf("two edges: rms %.4f, product of means %.4f; one edge twice: %.4f, %.4f\n", std::sqrt(both / trials),
                std::sqrt(plain / trials), std::sqrt(twice / trials), std::sqrt(plainTwice / trials));
    EXPECT_LE(std::sqrt(both / trials), 0.042);
    EXPECT_GE(std::sqrt(plain / trials), 0.05);
    EXPECT_LE(std::sqrt(twice / trials), 0.052);
    EXPECT_GE(std::sqrt(plainTwice / trials), 0.1);
}

// A cap without an edge within the light is even over it, and its product with anything that of the means.
TEST(Edges, ACapThatHoldsAllOfTheLightIsEven) {
    const AperturaCapLight light = aperturaCapLight(dvec3(0.2, 0, 1), 0.05);
    AperturaReceiver lobe{vec3(0, 0, 1), vec4(0, 0, 3, 6), {}};
    lobe.params[0] = vec4(kHardSharpness * vec3(1, 0, 0), -kHardSharpness * light.axis.x);  // half of the light
    const AperturaLightVisibility half = aperturaVisibilityOfLight(APERTURA_MODEL_SOFT, lobe, light, APERTURA_LIGHTS_MEDIUM);
    for (const float side : {-1.0f, 1.0f}) {
        const AperturaReceiver cap = aperturaWithAperture(lobe, aperturaMakeAperture(normalize(vec3(0.2f * side, 0, 1)), 0.8f), 0.5f);
        const AperturaLightVisibility even = aperturaVisibilityOfLight(APERTURA_MODEL_ALPHA, cap, light, APERTURA_LIGHTS_MEDIUM);
        EXPECT_NEAR(even.mean, 0.5, 0.01);
        EXPECT_NEAR(aperturaMeanOfBoth(even, half, light), even.mean * half.mean, 0.01);
    }
}

// The slope of several lobes is twice the gradient of what they let through, by differences.
TEST(Edges, TheSlopeOfLobesIsTheirGradient) {
    Random random(76);
    for (int i = 0; i < 2000; ++i) {
        const int model = i % 3 == 0 ? APERTURA_MODEL_FIRM_2
                        : i % 3 == 1 ? APERTURA_MODEL_FIRM_3
                                     : APERTURA_MODEL_FIRM_4,
                  count = models()[size_t(model)].parts;
        AperturaReceiver r{vec3(0, 0, 1), vec4(0, 0, 3, 6), {}};
        const dvec3 axis = normalize(dvec3(random(-0.5, 0.5), random(-0.5, 0.5), 1));
        for (int k = 0; k < count; ++k) {
            const vec3 slope = 6.0f * vec3(random.direction());
            r.params[k] = vec4(slope, float(random(-1, 1)) - dot(slope, vec3(axis)));
        }
        r.params[count] = aperturaWithCombination(vec4(0), {float(i % 2), float(i / 7 % (count - 1))});
        auto at = [&](const dvec3& w) { return aperturaVisibilityOfLight(model, r, aperturaCapLight(w, 1e-4), APERTURA_LIGHTS_SUN).mean; };
        const AperturaCapLight light = aperturaCapLight(axis, 1e-4);
        const vec3 slope = aperturaVisibilityOfLight(model, r, light, APERTURA_LIGHTS_SUN).slope;
        const dvec3 side = normalize(cross(axis, random.direction()));
        const double step = 1e-3, grown = (at(normalize(axis + step * side)) - at(normalize(axis - step * side))) / (2 * step);
        const double scale = std::max(1.0, double(length(slope)));
        EXPECT_NEAR(2 * grown, dot(dvec3(slope), side), 0.01 * scale) << model << " " << i;
    }
}

// Through an opening of one degree a light brings no more than a sky of the same radiance, whatever the error of the
// formula for large lights.
TEST(Edges, NoLargeLightBringsMoreThanTheSky) {
    const vec3 n(0, 0, 1);
    const dvec3 axis = normalize(dvec3(0.3, 0, 1));
    const double radius = pi / 180, sky = pi * std::pow(std::sin(radius), 2) * axis.z;  // through the opening, a cap above the horizon
    const double area = 2 * pi * (1 - std::cos(radius));
    const Visibility v{vec3(axis * area * (1 - area / (4 * pi))), float(area)};
    const AperturaReceiver receiver = toReceiver(*findModel("soft"), v, n);
    for (const double light : {12.0, 30.0, 45.0})
        for (double away = 0; away < 90; away += 3) {
            const AperturaCapLight cap = aperturaCapLight(normalize(dvec3(std::sin(away * pi / 180), 0, std::cos(away * pi / 180))),
                                                          light * pi / 180);
            EXPECT_LE(aperturaIrradianceThrough(APERTURA_MODEL_SOFT, receiver, cap, APERTURA_LIGHTS_ANY), 1.001 * sky)
                << light << " degrees, " << away << " away";
        }
}

}  // namespace
}  // namespace apertura::test
