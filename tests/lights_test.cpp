// Several lights: what stands in front hides what stands behind, against rays and closed forms; and lights from files.
#include "apertura/runtime/asset/lights.h"

#include "apertura/bake/fit/fit.h"
#include "apertura/bake/measure/reference.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/open_plane.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// Lights that overlap the first one, or nearly so, of radii between half of `radius` and all of it.
std::vector<AperturaLight> near(const glm::vec3& direction, double radius, int count, Random& random) {
    std::vector<AperturaLight> out;
    for (int j = 0; j < count; ++j) {
        const double away = j == 0 ? 0 : 1.6 * radius * std::sqrt(random());
        const glm::vec3 towards = frameFromZ(direction, random(0, 2 * pi)) * glm::vec3(std::sin(away), 0, std::cos(away));
        out.push_back(directionalLight(towards, radius * random(0.5, 1), vec3(1)));
    }
    return out;
}

// E of lights of unit radiance, by rays: of each alone, summed, and of their union.
struct Traced {
    double alone = 0, together = 0;
};
Traced traced(const Tracer& tracer, const SurfacePoint& at, const std::vector<AperturaLight>& lights, Random& random) {
    constexpr int kRays = 256;
    Traced sum;
    for (size_t j = 0; j < lights.size(); ++j) {
        const AperturaCapLight& cap = lights[j].cap;
        const glm::mat3 frame = frameFromZ(cap.axis, random(0, 2 * pi));
        std::vector<glm::vec3> rays;
        for (const glm::vec3& w : fibonacciCap(kRays, cap.height)) rays.push_back(frame * w);
        std::vector<uint8_t> blocked(rays.size());
        tracer.occluded(rayOrigin(tracer, at), rays, kNoLimit, blocked.data());
        for (size_t k = 0; k < rays.size(); ++k) {
            if (blocked[k]) continue;
            bool counts = true;
            for (size_t l = 0; l < j; ++l) counts = counts && glm::dot(rays[k], lights[l].cap.axis) < 1 - lights[l].cap.height;
            const double e = std::max(glm::dot(rays[k], at.normal), 0.0f) * 2 * pi * cap.height / kRays;
            sum.alone += e;
            if (counts) sum.together += e;
        }
    }
    return sum;
}

// The mean excess over truth, in units of the largest light's E overhead: by adding the lights, by taking from each what others cover, and
// of the model itself, for each light alone.
struct Excess {
    double plain = 0, ours = 0, own = 0;
};

Excess excessOf(const std::string& scene, const Model& model, int count, double degrees) {
    const double radius = degrees * pi / 180;
    const FitTools tools(256, FitTools::Use::Fits);
    const Recipe& recipe = recipeFor(model);
    const Scene built = makeBuiltin(scene);
    const Tracer tracer(built);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(built, kSanitized ? 20 : 300, 1)) points.push_back(p.at);
    const MeasuredRegion region = measuredRegion("builtin:" + scene, built);
    const int lightClass = lightClassOf(float(std::sin(radius)));
    std::vector<Excess> sums(points.size());
    samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        const BakedPoint point = makePoint(recipe, tools, samples, frame, {});
        const ModelParams params = toParams(model, point.visibility, recipe.model >= 0 ? &point.params : nullptr, points[i].normal);
        const AperturaReceiver receiver = toReceiver(point.visibility, params, points[i].normal);
        Random random(i + 1);
        const std::vector<glm::vec3> directions = lightDirections(region, points[i], 1, i);
        for (size_t k = 0; k < directions.size(); k += 2) {
            View view;
            view.lights = near(directions[k], radius, count, random);
            const std::vector<AperturaLight> lights = arrangedLights(view);
            const Traced truth = traced(tracer, points[i], lights, random);
            const double scale = 1 / (pi * std::sin(radius) * std::sin(radius));
            double plain = 0, ours = 0;
            for (int j = 0; j < count; ++j) {
                plain += double(aperturaIrradianceThrough(model.id, receiver, lights[size_t(j)].cap, lightClass));
                ours += double(aperturaIrradianceBeside(model.id, receiver, vec3(0), lights.data(), j, lightClass));
            }
            sums[i].plain += (plain - truth.together) * scale / 48;
            sums[i].ours += (ours - truth.together) * scale / 48;
            sums[i].own += (plain - truth.alone) * scale / 48;
        }
    });
    Excess out;
    for (const Excess& e : sums) {
        out.plain += e.plain / double(sums.size());
        out.ours += e.ours / double(sums.size());
        out.own += e.own / double(sums.size());
    }
    return out;
}

TEST(Lights, ThatOverlapGiveAtMostATenthOfWhatAddingThemGivesTooMuch) {
    for (const char* const scene : {"canyon", "arcade", "statue"})
        for (const char* const name : {"soft", "firm-2"})
            for (const int count : {2, 3})
                for (const double degrees : {5.0, 20.0}) {
                    if (kSanitized && (count == 2 || std::string(scene) != "statue")) continue;
                    const Excess e = excessOf(scene, *findModel(name), count, degrees);
                    std::printf("%-7s %-7s %d lights of %4.1f degrees: excess %+.4f, added plainly %+.4f, of the model itself %+.4f\n",
                                scene, name, count, degrees, e.ours, e.plain, e.own);
                    EXPECT_GT(e.plain, 0.01) << scene << ' ' << name << ' ' << count << ' ' << degrees;
                    if (kSanitized) continue;
                    EXPECT_LE(e.ours, 0.1 * e.plain) << scene << ' ' << name << ' ' << count << ' ' << degrees;
                    EXPECT_LE(std::abs(e.ours - e.own), 0.1 * e.plain) << scene << ' ' << name << ' ' << count << ' ' << degrees;
                }
}

// An open receiver that looks up.
AperturaReceiver openReceiver(const Model& model) {
    const Visibility open{{0, float(pi), 0}, float(2 * pi)};
    return toReceiver(open, toParams(model, open, nullptr, {0, 1, 0}), {0, 1, 0});
}

double sumOf(const View& view, const Model& model, const glm::vec3& position = glm::vec3(0)) {
    const std::vector<AperturaLight> lights = arrangedLights(view);
    const AperturaReceiver receiver = openReceiver(model);
    double sum = 0;
    for (size_t i = 0; i < lights.size(); ++i)
        sum += double(aperturaIrradianceBeside(model.id, receiver, position, lights.data(), int(i), APERTURA_LIGHTS_ANY));
    return sum;
}

TEST(Lights, TheSameLightTwiceIsOneAndDistinctOnesAdd) {
    const Model& soft = *findModel("soft");
    const AperturaLight a = directionalLight({0, 1, 0}, 0.2, vec3(1)), b = directionalLight({1, 1, 0}, 0.2, vec3(1)),
                        within = directionalLight({0.05f, 1, 0}, 0.05, vec3(1));
    const auto sum = [&](std::vector<AperturaLight> lights) {
        View view;
        view.lights = std::move(lights);
        return sumOf(view, soft);
    };
    EXPECT_NEAR(sum({a, a}), sum({a}), 1e-3 * sum({a}));
    EXPECT_NEAR(sum({a, a, a}), sum({a}), 1e-3 * sum({a}));
    EXPECT_EQ(sum({a, b}), sum({a}) + sum({b}));
    EXPECT_NEAR(sum({a, within}), sum({a}), 1e-3 * sum({a}));
    EXPECT_NEAR(sum({within, a}), sum({a}), 2e-2 * sum({a})) << "the small one in front";
}

TEST(Lights, OfTwoLampsTheFartherIsHiddenFromEachSide) {
    const Model& soft = *findModel("soft");
    View view;
    view.lights = {sphereLight({0, 4, 0}, 1, vec3(1)), sphereLight({0, 8, 0}, 1, vec3(3))};
    const std::vector<AperturaLight> lights = arrangedLights(view);
    const AperturaReceiver below = openReceiver(soft);
    const auto e = [&](const AperturaReceiver& receiver, const glm::vec3& at, int light) {
        return double(aperturaIrradianceBeside(soft.id, receiver, at, lights.data(), light, APERTURA_LIGHTS_ANY));
    };
    EXPECT_NEAR(e(below, {0, 0, 0}, 0), pi / 16, 1e-3);
    EXPECT_NEAR(e(below, {0, 0, 0}, 1), 0, 1e-3);
    // From above the order is the other way round, and from aside both are seen.
    const Visibility open{{0, float(-pi), 0}, float(2 * pi)};
    const AperturaReceiver above = toReceiver(open, toParams(soft, open, nullptr, {0, -1, 0}), {0, -1, 0});
    EXPECT_NEAR(e(above, {0, 12, 0}, 1), pi / 16, 1e-3);
    EXPECT_NEAR(e(above, {0, 12, 0}, 0), 0, 1e-3);
    const double aside = glm::length(glm::dvec2(4, 4));
    EXPECT_NEAR(e(below, {4, 0, 0}, 0), pi / (aside * aside) * 4 / aside, 2e-3);
    // A lamp at the receiver, and one about it, give numbers.
    view.lights = {sphereLight({0, 0, 0}, 1, vec3(1)), sphereLight({0, 0.5f, 0}, 0.1, vec3(1)), directionalLight({0, 1, 0}, 0.1, vec3(1))};
    EXPECT_TRUE(std::isfinite(sumOf(view, soft)));
    EXPECT_LE(sumOf(view, soft), pi * 1.01);
}

TEST(Lights, TogetherGiveNoMoreThanTheWholeOpeningWithTheBrightest) {
    const AperturaIrradiance sum{vec3(10, 1, 0), vec3(0), 2};
    EXPECT_EQ(aperturaSumOf(sum, vec3(0), vec3(3)), vec3(6, 1, 0));
    EXPECT_EQ(aperturaSumOf({vec3(1), vec3(5), 2}, vec3(2), vec3(3)), vec3(1)) << "lights that hide more than all of the sky";
}

// The mean radiance that leaves a floor, by the device: under the lights of a view.
TEST(Lights, ThatHideEachOtherAreDrawnSo) {
    const Gpu gpu({.validate = true});
    const Asset asset = openPlane();
    View view;
    view.width = view.height = 16;
    view.camera = {{0, 5, 0.01f}, {0, 0, 0}, 0.5f};
    view.sky = glm::vec3(0.5f, 0.25f, 0);
    view.albedo = vec3(1);
    // Two lights of one size whose union is two circles on the sphere: a third has the area of the lens twice, so that a sum would not do.
    const double r = 0.15;
    view.lights = {directionalLight({0, 1, 0}, r, vec3(4)), directionalLight({float(r), 1, 0}, r, vec3(8)),
                   directionalLight({0, 1, 0}, 0.5 * r, vec3(100))};
    const double area = pi * r * r, lens = (2 * std::acos(0.5) - std::sin(2 * std::acos(0.5))) * r * r;
    const Model& soft = *findModel("soft");
    Renderer renderer(gpu, asset);
    for (const LightAt at : {LightAt::Pixels, LightAt::Vertices}) {
        const Picture picture = renderer.draw(view, soft, at);
        for (int c = 0; c < 3; ++c) {
            const double sky = std::array{0.5, 0.25, 0.0}[size_t(c)],
                         expected = 4 * area + 8 * (area - lens) + (pi - 2 * area + lens) * sky;
            EXPECT_NEAR(picture.pixels[8 * 16 + 8][c] * pi, expected, 0.02 * expected) << c;
        }
    }
    // Lamps and the sun are seen as what they are, by both.
    view.camera = {{0, 1, 8}, {0, 1.2f, 0}, 0.9f};
    view.width = 64, view.height = 48;
    view.lights = {directionalLight({0.1f, 0.3f, -1}, 0.05, vec3(9, 0, 0)), sphereLight({0.5f, 1, 0}, 0.6, vec3(0, 9, 0)),
                   sphereLight({0, -0.1f, 2}, 0.5, vec3(0, 0, 9))};
    const Picture drawn = renderer.draw(view, soft), traced = traceReference(Tracer(asset.scene), view, {});
    int same = 0, lights = 0;
    for (size_t i = 0; i < drawn.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const bool a = drawn.pixels[i][c] > 8, b = traced.pixels[i][c] > 8;
            same += a && b, lights += a || b;
        }
    EXPECT_GT(lights, 50);
    EXPECT_GT(same, 0.97 * lights);
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
}

TEST(Reference, ALampBehindAnotherIsHidden) {
    Scene scene;
    scene.name = "lamps";
    Surface plane;
    plane.positions = {{-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, {-20, 0, -20}};
    plane.triangles = {{0, 1, 2}, {0, 2, 3}};
    makeNormals(plane);
    scene.surfaces = {plane};
    scene.instances = {{0}};
    View view;
    view.camera = {{0.02f, 0.5f, 0.01f}, {0, 0, 0}, 0.01f};
    view.width = view.height = 2;
    view.sky = glm::vec3(0);
    view.albedo = glm::vec3(1);
    ReferenceOptions options;
    options.lightRays = 4096;
    const auto e = [&] { return pi * double(traceReference(Tracer(scene), view, options).pixels[0].x); };
    view.lights = {sphereLight({0, 8, 0}, 1, vec3(5)), sphereLight({0, 4, 0}, 1, vec3(1))};
    EXPECT_NEAR(e(), pi / 16, 2e-3);
    view.lights = {directionalLight({0, 1, 0}, 0.5, vec3(1)), directionalLight({0, 1, 0}, 0.6, vec3(1))};
    EXPECT_NEAR(e(), pi * std::pow(std::sin(0.6), 2), 5e-3);
}

TEST(Lights, OfAFileAreReadOrRefusedWithItsName) {
    const Folder folder;
    const std::string good = folder.write("good.json", R"([{"towards": [0, 2, 0], "radius": 5, "radiance": [1, 2, 3]},
        {"at": [1, 2, 3], "radius": 0.5, "radiance": [4, 5, 6]}])");
    const std::vector<AperturaLight> lights = readLights(good);
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[0].cap.axis, vec3(0, 1, 0));
    EXPECT_NEAR(lights[0].cap.sinRadius, std::sin(5 * pi / 180), 1e-6);
    EXPECT_EQ(vec3(lights[0].radiance), vec3(1, 2, 3));
    EXPECT_EQ(lights[1].sphere, vec4(1, 2, 3, 0.5f));
    std::string many = "[";
    for (int i = 0; i < 17; ++i) many += std::string(i ? "," : "") + R"({"at":[0,0,0],"radius":1,"radiance":[1,1,1]})";
    const std::pair<std::string, const char*> bad[] = {
        {many + "]", "17 lights"},
        {R"({"at": [0,0,0]})", "not a list"},
        {"[1]", "light 1 is not an object"},
        {R"([{"at": [0,0,0], "radius": 1, "radiance": [1,1]}])", "\"radiance\" is not three numbers"},
        {R"([{"at": [0,0,"0"], "radius": 1, "radiance": [1,1,1]}])", "\"at\" is not three numbers"},
        {R"([{"at": [0,0,0], "radius": 0, "radiance": [1,1,1]}])", "1e-6 to 1e9 metres"},
        {R"([{"at": [0,0,0], "radius": 1e-46, "radiance": [1,1,1]}])", "1e-6 to 1e9 metres"},
        {R"([{"at": [0,0,0], "radius": 1, "radiance": [1,-1,1]}])", "negative"},
        {R"([{"at": [0,0,0], "radius": 1, "radiance": [1,NaN,1]}])", "not JSON"},
        {R"([{"at": [0,0,1e300], "radius": 1, "radiance": [1,1,1]}])", "too large"},
        {R"([{"at": [0,0,0], "towards": [0,1,0], "radius": 1, "radiance": [1,1,1]}])", "neither"},
        {R"([{"towards": [0,0,0], "radius": 1, "radiance": [1,1,1]}])", "no direction"},
        {R"([{"towards": [0,1,0], "radius": 46, "radiance": [1,1,1]}])", "degrees"},
        {R"([{"towards": [0,1,0], "radius": 1}])", "no \"radiance\""},
        {R"([{"towards": [0,1,0], "radius": 1, "radiance": [1,1,1], "color": 1}])", "no \"color\""},
        {"", "not JSON"}};
    for (const auto& [text, cause] : bad) {
        const std::string path = folder.write("bad.json", text);
        try {
            readLights(path);
            ADD_FAILURE() << text;
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).rfind(path + ": ", 0), 0u) << e.what();
            EXPECT_NE(std::string(e.what()).find(cause), std::string::npos) << e.what();
        }
    }
}

TEST(Lights, OfAGltfFileStandWhereItsNodesDo) {
    // A quarter turn about X takes -Z, along which lights shine, to +Y: light comes from below.
    const std::string text = R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":683,"color":[1,0.5,0]},{"type":"directional","intensity":1366},
        {"type":"spot"},{"type":"laser"}]}},
        "nodes":[{"mesh":0},{"translation":[1,2,3],"children":[2]},{"translation":[0,1,0],"extensions":{"KHR_lights_punctual":{"light":0}}},
        {"rotation":[0.70710678,0,0,0.70710678],"extensions":{"KHR_lights_punctual":{"light":1}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"scenes":[{"nodes":[0,1,3]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    const auto parsed = [&](const std::string& json) {
        return parseGltf({reinterpret_cast<const unsigned char*>(json.data()), json.size()}, "lit.gltf", ".");
    };
    const Scene scene = parsed(text);
    std::vector<std::string> notes;
    const std::vector<AperturaLight> lights = punctualLights(scene, 0.25, 0.01, notes);
    ASSERT_EQ(lights.size(), 2u);
    EXPECT_EQ(lights[0].sphere, vec4(1, 3, 3, 0.25f));
    // 683 cd are 1 W/sr: the radiance of the sphere times pi R^2.
    EXPECT_NEAR(lights[0].radiance.r * pi * 0.0625, 1, 1e-5);
    EXPECT_NEAR(lights[0].radiance.g * pi * 0.0625, 0.5, 1e-5);
    EXPECT_LT(glm::length(lights[1].cap.axis - vec3(0, -1, 0)), 1e-6f);
    EXPECT_NEAR(lights[1].radiance.r * pi * std::pow(std::sin(0.01), 2), 2, 1e-5);
    const auto refused = [&](const std::string& from, const std::string& to, const std::string& cause) {
        std::string json = text;
        json.replace(json.find(from), from.size(), to);
        try {
            std::vector<std::string> ignored;
            punctualLights(parsed(json), 0.25, 0.01, ignored);
            ADD_FAILURE() << cause;
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).rfind("lit.gltf: ", 0), 0u) << e.what();
            EXPECT_NE(std::string(e.what()).find(cause), std::string::npos) << e.what();
        }
    };
    refused("\"light\":0", "\"light\":9", "does not exist");
    refused("\"light\":0", "\"light\":3", "unknown type");
    refused("\"intensity\":683", "\"intensity\":-1", "intensity");
    refused("[1,0.5,0]", "[1,0.5]", "color");
    for (const char* const broken : {"[1]", "null", "7", R"({"lights":3})"}) {
        Scene damaged = scene;
        damaged.document = std::make_shared<GltfDocument>(*scene.document);
        damaged.document->json["extensions"]["KHR_lights_punctual"] = nlohmann::json::parse(broken);
        std::vector<std::string> unused;
        EXPECT_THROW(punctualLights(damaged, 0.25, 0.01, unused), Error) << broken;
    }
    std::vector<std::string> ignored;
    EXPECT_THROW(punctualLights(makeBuiltin("statue"), 0.25, 0.01, ignored), Error);
}

}  // namespace
}  // namespace apertura::test
