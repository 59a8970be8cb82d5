// Which bytes stand for lobes and caps.
#include "apertura/bake/fit/rounding.h"

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/rows.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/sh/models.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

std::vector<float> numbersOf(const Model& model, const ModelParams& params) {
    std::vector<float> out(size_t(storedNumbers(model)));
    packParams(model, params, out);
    return out;
}

ModelParams throughBytes(const Model& model, const ModelParams& params, const mat3& toLocal = mat3(1)) {
    const auto bytes = packAllParams(model, {&params, 1}, toLocal, 8);
    return unpackAllParams(model, {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, 1, transpose(toLocal), 8)[0];
}

// The RMS of what bytes change of E / (L pi sin^2 r) under lights of 5 degrees.
struct Change {
    double plain = 0, together = 0;
};
Change changeOf(const char* scene, const Model& model) {
    const Scene loaded = loadScene(scene);
    const Tracer tracer(loaded);
    const int count = kSanitized ? 40 : 200;
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(loaded, count, 3)) points.push_back(p.at);
    BakeOptions options;
    options.recipe = recipeFor(model).name;
    options.rays = 1024;
    const std::vector<BakedPoint> baked = bakePoints(RayOcclusion(tracer), points, options);
    const std::vector<vec3> lights = fibonacciHemisphere(96);
    Change sum;
    for (size_t i = 0; i < points.size(); ++i) {
        const vec3 n = points[i].normal;
        const mat3 frame = frameFromZ(n, 0), toLocal = frameFromZ(vec3(0.6f, 0, 0.8f), float(i));
        const ModelParams plain = throughBytes(model, baked[i].params, toLocal),
                          together = throughBytes(model, roundedParams(model, baked[i].params, n, toLocal, 8), toLocal);
        for (const vec3& l : lights) {
            const AperturaCapLight light = aperturaCapLight(glm::dvec3(frame * l), 5 * pi / 180);
            const auto value = [&](const ModelParams& params) {
                return modelValue(model.id, toReceiver(baked[i].visibility, toParams(model, baked[i].visibility, &params, n), n), light);
            };
            const double own = value(baked[i].params);
            sum.plain += (value(plain) - own) * (value(plain) - own);
            sum.together += (value(together) - own) * (value(together) - own);
        }
    }
    const double all = double(points.size() * lights.size());
    std::printf("%s, %s: each by itself %.5f, together %.5f\n", scene, std::string(model.name).c_str(), std::sqrt(sum.plain / all),
                std::sqrt(sum.together / all));
    return {std::sqrt(sum.plain / all), std::sqrt(sum.together / all)};
}

TEST(Rounding, OfALobesNumbersTogetherMovesItsEdgeLess) {
    for (const char* scene : {"builtin:arcade", "builtin:statue"})
        for (const char* name : {"firm-2", "firm-4", "multi-2", "cap-anti"}) {
            const Model& model = *findModel(name);
            const Change change = changeOf(scene, model);
            EXPECT_LT(change.together, (model.stored[0] == Field::HardLobe ? 0.7 : 0.85) * change.plain) << scene << ", " << name;
            EXPECT_LT(change.together, 0.006) << scene << ", " << name;
        }
}

TEST(Rounding, KeepsFlagsAndStaysWhereItIs) {
    Random random(4);
    for (const char* name : {"firm-2", "firm-3", "firm-4", "multi-3", "cap-anti", "anti", "soft-2", "soft-l2"}) {
        const Model& model = *findModel(name);
        for (int i = 0; i < 100; ++i) {
            std::vector<float> numbers(size_t(storedNumbers(model)));
            for (float& n : numbers) n = float(random(-1, 1));
            const ModelParams params = unpackParams(model, numbers);
            const vec3 normal(random.direction());
            const mat3 toLocal = frameFromZ(vec3(random.direction()), 1);
            EXPECT_EQ(roundedParams(model, params, normal, toLocal, 16), params) << name;
            const ModelParams once = roundedParams(model, params, normal, toLocal, 8);
            const std::vector<float> before = numbersOf(model, rotateParams(model, params, toLocal)),
                                     after = numbersOf(model, rotateParams(model, once, toLocal));
            const bool isMoved = model.stored[0] == Field::HardLobe || model.stored[0] == Field::Cap;
            for (size_t k = 0; k < before.size(); ++k) {
                if (!isMoved) {
                    EXPECT_EQ(after[k], before[k]) << name;
                    continue;
                }
                if (k % 3 == 2) {  // axes at the rim of their mapping have two places there
                    EXPECT_EQ(after[k] < 0, before[k] < 0) << name << " " << k;
                    EXPECT_NEAR(after[k], before[k], 1.51 / 127) << name << " " << k;
                }
                EXPECT_NEAR(after[k] * 127, std::round(after[k] * 127), 0.02) << name << " " << k;
            }
        }
    }
}

// An opening 10 degrees wide is the complement of a lobe that is open nearly everywhere.
TEST(Rounding, SmallOpeningsKeepTheirSize) {
    const Model& model = *findModel("firm-2");
    for (double degrees = 5; degrees <= 175; degrees += 0.25) {
        ModelParams params{};
        const float x = float(-std::cos(degrees * pi / 180));  // of the part that the lobe does not let through
        params[0] = params[1] = kHardSharpness * vec4(0, 0, 1, -x);
        const ModelParams back = throughBytes(model, params);
        const double radius = std::acos(std::clamp(double(back[0].w) / length(vec3(back[0])), -1.0, 1.0)) * 180 / pi;
        EXPECT_NEAR(radius, degrees, degrees < 12 || degrees > 168 ? 1.6 : 1.1);
    }
}

// The edge of a hard lobe was packed as o / sqrt(1 + s^2 + o^2), as that of other lobes is.
TEST(Rounding, AssetsOf01AreRead) {
    Random random(8);
    for (const char* name : {"firm-2", "firm-3", "firm-4"}) {
        const Model& model = *findModel(name);
        for (int i = 0; i < 200; ++i) {
            std::vector<float> numbers(size_t(storedNumbers(model)));
            for (float& n : numbers) n = float(random(-1, 1));
            std::vector<unsigned char> bytes;
            for (float& n : numbers) {
                const auto byte = int8_t(std::lround(n * 127));
                n = float(byte) / 127;
                bytes.push_back(static_cast<unsigned char>(byte));
            }
            const double s = numbers.back() < 0 ? kSofterSharpness : kHardSharpness;
            const ModelParams old = unpackAllParams(model, bytes, 1, mat3(1), 8, 1)[0];
            for (size_t k = 0; k < size_t(model.parts); ++k) {
                const double e = std::clamp(2 * std::abs(double(numbers[3 * k + 2])) - 1, -.999, .999);
                const double offset = e * std::sqrt((1 + s * s) / (1 - e * e));
                EXPECT_NEAR(length(vec3(old[k])), s, 1e-3);
                // Beyond the slope the lobe is open, or closed, however far.
                EXPECT_NEAR(old[k].w, std::clamp(offset, -2 * s, 2 * s), 1e-3 * s) << name;
            }
            const auto before = aperturaCombinationIn(old[size_t(model.flagSlot())]);
            EXPECT_EQ(before.complement > 0.5f, numbers[2] < 0);
        }
    }
}

}  // namespace
}  // namespace apertura::test
