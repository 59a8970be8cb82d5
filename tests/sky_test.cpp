// Skies that differ with direction: against closed forms, and through the four numbers against rays.
#include "apertura/runtime/asset/sky.h"

#include <mutex>

#include "apertura/bake/measure/reference.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/open_plane.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

using Radiance = std::function<glm::dvec3(const glm::dvec3&)>;

// Equirectangular: the middle is -Z, to the right lies +X, the top row is +Y.
Picture pictureOf(const Radiance& radiance, int height = 128) {
    Picture out{2 * height, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < 2 * height; ++x) {
            const double elevation = pi * (0.5 - (y + 0.5) / height), azimuth = pi * ((x + 0.5) / height - 1);
            out.pixels.emplace_back(
                radiance({std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)}));
        }
    return out;
}

glm::dvec3 clear(const glm::dvec3& w) {
    if (w.y < 0) return {0.15, 0.13, 0.1};
    const double low = std::exp(-7 * w.y);
    return glm::dvec3(0.1, 0.2, 0.5) * (1 - low) + glm::dvec3(1.2, 1.1, 0.9) * low;
}
// Moon and Spencer, "Illumination from a non-uniform sky", 1942.
glm::dvec3 overcast(const glm::dvec3& w) { return glm::dvec3(0.9, 0.95, 1) * (w.y < 0 ? 0.2 / 3 : (1 + 2 * w.y) / 3); }
glm::dvec3 halfDark(const glm::dvec3& w) {
    return mix(glm::dvec3(0.02, 0.03, 0.06), glm::dvec3(0.9, 0.8, 0.7), std::clamp(0.5 + 4 * (0.8 * w.x + 0.6 * w.z), 0.0, 1.0));
}

TEST(Sky, LooksWhereItsPictureDoes) {
    const Sky sky(pictureOf([](const glm::dvec3& w) { return glm::max(w, 0.0); }), "sky");
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 w = random.direction();
        EXPECT_LT(glm::length(glm::dvec3(sky.towards(w)) - glm::max(w, 0.0)), 0.02) << w.x << ' ' << w.y << ' ' << w.z;
    }
    for (const glm::vec3 w : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(0, 0, 1), glm::vec3(-1e-9f, 0, 1)})
        EXPECT_LT(glm::length(sky.towards(w) - glm::max(w, 0.0f)), 0.02f);
}

TEST(Sky, OfALinearRadianceIsExactThroughAHemisphere) {
    const glm::dvec3 slope(0.3, -0.2, 0.4);
    const Sky sky(pictureOf([&](const glm::dvec3& w) { return glm::dvec3(1 + glm::dot(slope, w), 1, 2); }), "sky");
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 n = random.direction();
        const vec3 middle = aperturaOpeningCentroid(vec3(n), float(pi) * vec3(n), float(2 * pi));
        EXPECT_LT(glm::length(glm::dvec3(middle) - 2.0 / 3 * n), 1e-5);
        // The cosine-weighted mean of w over the hemisphere about n is 2/3 n.
        EXPECT_NEAR(aperturaSkyMean(sky.bands(), middle).x, 1 + 2.0 / 3 * glm::dot(slope, n), 2e-3);
        EXPECT_NEAR(aperturaSkyMean(sky.bands(), vec3(n)).x, 1 + glm::dot(slope, n), 2e-3);
        EXPECT_NEAR(aperturaSkyMean(sky.bands(), middle).y, 1, 2e-3);
    }
}

// Band 2, which is not linear: P2 about an axis, whose mean through a hemisphere about it, weighted by cosines, is 1/4, and whose value
// at the axis is 1.
TEST(Sky, OfASecondBandIsExactThroughAHemisphereAndAPoint) {
    Random random(3);
    for (int i = 0; i < 20; ++i) {
        const glm::dvec3 a = random.direction();
        const Sky sky(pictureOf([&](const glm::dvec3& w) { return glm::dvec3(1 + 0.5 * (3 * std::pow(glm::dot(a, w), 2) - 1)); }), "sky");
        EXPECT_NEAR(aperturaSkyMean(sky.bands(), 2.0f / 3.0f * vec3(a)).x, 1.25, 3e-3);
        EXPECT_NEAR(aperturaSkyMean(sky.bands(), vec3(a)).x, 2, 3e-3);
    }
}

// RMSE of the irradiance from a sky, relative to what an open hemisphere gets of its mean, with the four numbers of many rays.
struct SkyErrors {
    double ours = 0, lowestMip = 0;
};

SkyErrors errorsUnder(const Sky& sky, const Radiance& radiance, const std::string& name) {
    constexpr int kRays = 1024;
    const Scene scene = makeBuiltin(name);
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, kSanitized ? 20 : 200, 1)) points.push_back(p.at);
    const SampleLattice lattice(kRays);
    const glm::dvec3 mean(sky.bands().bands[0]);
    std::mutex lock;
    SkyErrors sum;
    samplePoints(RayOcclusion(tracer), points, lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        std::vector<glm::vec3> directions;
        for (const glm::vec3& w : lattice.directions()) directions.push_back(frame * w);
        std::vector<uint8_t> blocked(directions.size());
        samples.source->occluded(points[i], directions, blocked.data());
        const glm::vec3 normal = points[i].normal;
        glm::dvec3 truth(0), direction(0);
        double area = 0;
        for (size_t k = 0; k < directions.size(); ++k) {
            if (blocked[k]) continue;
            const double each = 2 * pi / kRays;
            truth += each * double(glm::dot(directions[k], normal)) * radiance(directions[k]);
            direction += each * glm::dvec3(directions[k]);
            area += each;
        }
        const double open = std::max(glm::dot(glm::dvec3(normal), direction), 0.0);
        const glm::dvec3 ours = open * glm::dvec3(aperturaSkyThrough(APERTURA_MODEL_SOFT, normal, vec4(direction, area), sky.bands()));
        const std::lock_guard hold(lock);
        for (int c = 0; c < 3; ++c) {
            sum.ours += std::pow((ours[c] - truth[c]) / (pi * mean[c]), 2) / 3;
            sum.lowestMip += std::pow((open * mean[c] - truth[c]) / (pi * mean[c]), 2) / 3;
        }
    });
    return {std::sqrt(sum.ours / double(points.size())), std::sqrt(sum.lowestMip / double(points.size()))};
}

TEST(Sky, ThroughFourNumbersErrsLessThanHalfOfItsLowestMip) {
    const std::pair<const char*, Radiance> skies[] = {{"clear", clear}, {"overcast", overcast}, {"half dark", halfDark}};
    for (const auto& [name, radiance] : skies) {
        const Sky sky(pictureOf(radiance), name);
        SkyErrors sum;
        for (const std::string& scene : builtinNames()) {
            if (kSanitized && scene != "statue" && scene != "room-2") continue;
            const SkyErrors e = errorsUnder(sky, radiance, scene);
            std::printf("%-10s %-18s %.4f, lowest mip %.4f\n", name, scene.c_str(), e.ours, e.lowestMip);
            sum.ours += e.ours, sum.lowestMip += e.lowestMip;
        }
        EXPECT_LE(sum.ours, 0.25 * sum.lowestMip) << name;
    }
}

TEST(Sky, IsDrawnAsItsPictureAndLightsAsTheClosedFormSays) {
    const Gpu gpu({.validate = true});
    const Asset asset = openPlane();
    View view;
    view.width = 64, view.height = 48;
    view.camera = {{0, 3, 8}, {0, 2, 0}, 1.2f};
    view.albedo = vec3(1);
    Renderer renderer(gpu, asset);
    const Model& soft = *findModel("soft");
    // A picture of one colour is that colour.
    const glm::vec3 colour(0.2f, 0.4f, 0.6f);
    view.lights = {directionalLight({1, 2, 1}, 0.1, vec3(5))};
    view.sky = colour;
    const Picture plain = renderer.draw(view, soft);
    view.sky = Sky(pictureOf([&](const glm::dvec3&) { return glm::dvec3(colour); }), "sky");
    const Picture drawn = renderer.draw(view, soft);
    for (size_t i = 0; i < plain.pixels.size(); ++i) ASSERT_LT(glm::length(plain.pixels[i] - drawn.pixels[i]), 2e-3f) << i;
    // An overcast one: 7/9 of the zenith's irradiance, pi (1 + 2 sin) / 3; and the reference sees the same sky behind it.
    view.lights.clear();
    view.sky = Sky(pictureOf(overcast), "sky");
    for (const LightAt at : {LightAt::Pixels, LightAt::Vertices}) {
        const Picture grey = renderer.draw(view, soft, at);
        EXPECT_NEAR(grey.pixels[47 * 64 + 32].z, 7.0 / 9, 0.03);
        ReferenceOptions options;
        options.skyRays = 256;
        const Picture truth = traceReference(Tracer(asset.scene), view, options);
        double sum = 0;
        for (size_t i = 0; i < truth.pixels.size(); ++i) sum += std::abs(truth.pixels[i].x - grey.pixels[i].x);
        EXPECT_LT(sum / double(truth.pixels.size()), 0.01);
    }
    // A light of the sky's own radiance changes nothing: what is behind it is not counted twice.
    view.sky = Sky(pictureOf(clear), "sky");
    const Picture without = renderer.draw(view, soft);
    view.lights = {
        directionalLight({1, 2, 1}, 0.2, glm::vec3(view.sky.meanOver(aperturaCapLight(glm::normalize(glm::dvec3(1, 2, 1)), 0.2))))};
    const Picture with = renderer.draw(view, soft);
    EXPECT_LT(glm::length(with.pixels[47 * 64 + 32] - without.pixels[47 * 64 + 32]), 1e-3f);
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
    // Frames are drawn under the sky that was prepared, and no other.
    constexpr VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
    renderer.prepare(soft, lightClassOf(view), format);
    view.sky = Sky(pictureOf(halfDark), "sky");
    EXPECT_THROW(gpu.run([&](VkCommandBuffer commands) {
        renderer.record(commands, {VK_NULL_HANDLE, format, VK_NULL_HANDLE, {8, 8}}, view, soft, 0);
    }),
                 Error);
}

TEST(Sky, ThatIsNoSkyIsRefused) {
    const Folder folder;
    const auto refused = [&](const std::string& file, const Picture& picture, const std::string& cause) {
        if (file.ends_with(".png")) {
            writePicture(folder / file, picture);
        } else {
            std::vector<float> values;
            for (const glm::vec3& p : picture.pixels) values.insert(values.end(), {p.r, p.g, p.b});
            const std::vector<unsigned char> bytes = encodeHalves(picture.width, picture.height, 3, values);
            folder.write(file, {bytes.begin(), bytes.end()});
        }
        try {
            readSky(folder / file);
            ADD_FAILURE() << cause;
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).rfind(folder / file + ": ", 0), 0u) << e.what();
            EXPECT_NE(std::string(e.what()).find(cause), std::string::npos) << e.what();
        }
    };
    Picture picture = pictureOf(clear, 8);
    writePicture(folder / "good.exr", picture);
    const Sky sky = readSky(folder / "good.exr");
    ASSERT_TRUE(sky.picture());
    for (size_t i = 0; i < picture.pixels.size(); ++i) ASSERT_LT(glm::length(sky.picture()->pixels[i] - picture.pixels[i]), 2e-3f);
    refused("grey.png", picture, ".exr or .hdr");
    refused("square.exr", {16, 16, std::vector<glm::vec3>(256)}, "twice as wide as high");
    picture.pixels[5].y = std::numeric_limits<float>::infinity();
    refused("infinite.exr", picture, "finite");
    picture.pixels[5].y = std::numeric_limits<float>::quiet_NaN();
    refused("nan.exr", picture, "finite");
    picture.pixels[5].y = -1;
    refused("negative.exr", picture, "0 to 1e12");
    EXPECT_THROW(readSky(folder / "missing.exr"), Error);
    EXPECT_THROW(Sky({2, 1, {glm::vec3(3e38f), glm::vec3(0)}}, "too bright"), Error);
    std::ofstream(folder / "cut.exr", std::ios::binary) << "\x76\x2F\x31\x01 and no more";
    EXPECT_THROW(readSky(folder / "cut.exr"), Error);
    std::ofstream(folder / "cut.hdr", std::ios::binary) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000 +X 8000\n";
    EXPECT_THROW(readSky(folder / "cut.hdr"), Error);
}

}  // namespace
}  // namespace apertura::test
