// Vulkan: the device computes what the same text computes in C++, the validation layer is silent, pictures are right.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/reference.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/runtime/render/cost.h"
#include "apertura/runtime/render/draw.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/baseline.h"
#include "tests/open_plane.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

class GpuTest : public testing::Test {
protected:
    void SetUp() override { gpu = std::make_unique<Gpu>(GpuOptions{.validate = true}); }
    void TearDown() override {
        if (!gpu) return;  // there is no device, as the failure says
        for (const std::string& message : gpu->messages()) ADD_FAILURE() << message;
    }
    std::unique_ptr<Gpu> gpu;
};

Asset bakedScene(const char* name, int rays) {
    Asset asset;
    asset.scene = makeBuiltin(name);
    BakeOptions options;
    options.rays = rays;
    asset.seen = bakeVertices(asset.scene, Tracer(asset.scene), options);
    return asset;
}

double meanOf(const Picture& p) {
    double sum = 0;
    for (const glm::vec3& c : p.pixels) sum += (c.r + c.g + c.b) / 3;
    return sum / double(p.pixels.size());
}

double differenceOf(const Picture& a, const Picture& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += glm::dot(a.pixels[i] - b.pixels[i], a.pixels[i] - b.pixels[i]) / 3;
    return std::sqrt(sum / double(a.pixels.size()));
}

// Random parameters that a model's bytes can hold.
ModelParams randomForm(const Model& model, const Visibility& v, const vec3& normal, Random& random) {
    const Model* stored = &model;
    if (model.kind == ModelKind::Choice) stored = autoModels()[size_t(random(0, double(autoModels().size())))];
    std::vector<float> numbers(size_t(storedNumbers(*stored)) + 1);
    for (float& n : numbers) n = float(random(-1, 1));
    // Real coefficients are small in the high bands.
    if (stored->id == APERTURA_MODEL_SH_L4)
        for (float& n : numbers) n *= 0.3f;
    ModelParams params = unpackParams(*stored, numbers);
    if (model.kind == ModelKind::Choice) setChoice(params, *stored, false);
    return toParams(model, v, model.isStored() ? &params : nullptr, normal);
}

TEST_F(GpuTest, ComputesWhatTheProcessorComputes) {
    // The driver's compiler takes most of the time: of the cheaper classes each model has one, in turn; all of them in tools/test --all.
    const auto classesOf = [](const Model& model) -> std::vector<int> {
        if (kSanitized && model.id % 4 > 0) return {};
        if (std::getenv("APERTURA_EXHAUSTIVE"))
            return {APERTURA_LIGHTS_ANY, APERTURA_LIGHTS_MEDIUM, APERTURA_LIGHTS_SMALL, APERTURA_LIGHTS_SUN};
        const int cheaper[] = {APERTURA_LIGHTS_MEDIUM, APERTURA_LIGHTS_SMALL, APERTURA_LIGHTS_SUN};
        return {APERTURA_LIGHTS_ANY, cheaper[model.id % 3]};
    };
    for (const Model& model : models())
        for (const int lightClass : classesOf(model)) {
            Random random(41);
            std::vector<AperturaEvaluation> inputs;
            std::vector<AperturaReceiver> receivers;
            const double largest = lightClass == APERTURA_LIGHTS_ANY    ? 45
                                 : lightClass == APERTURA_LIGHTS_MEDIUM ? 10
                                 : lightClass == APERTURA_LIGHTS_SMALL  ? 3
                                                                        : 0.6;
            for (int i = 0; i < (lightClass == APERTURA_LIGHTS_ANY && model.fromVisibility ? 100000 : 10000); ++i) {
                const vec3 normal(random.direction());
                const double area = 2 * pi * random();
                dvec3 d = random.direction();
                if (dot(d, dvec3(normal)) < 0) d = -d;
                const Visibility v{vec3(d * area * (1 - area / (4 * pi)) * random()), float(area)};
                receivers.push_back(toReceiver(v, randomForm(model, v, normal, random), normal));
                const double r = 0.27 * std::pow(largest / 0.27, random()) * pi / 180;
                AperturaEvaluation e{vec4(normal, 0), vec4(vec3(random.direction()), float(std::sin(r))), receivers.back().visibility, {}};
                std::copy_n(receivers.back().params, APERTURA_MAX_SLOTS, e.params);
                inputs.push_back(e);
            }
            const std::vector<vec2> device = evaluateOnDevice(*gpu, model.id, lightClass, inputs);
            double worst = 0;
            for (size_t i = 0; i < inputs.size(); ++i) {
                const AperturaCapLight light = apertura::aperturaCapLight(vec3(inputs[i].light), inputs[i].light.w);
                const float here = aperturaIrradianceThrough(model.id, receivers[i], light, lightClass),
                            sky = aperturaSkyIrradiance(model.id, receivers[i]);
                ASSERT_TRUE(std::isfinite(device[i].x) && std::isfinite(device[i].y)) << model.name;
                worst = std::max({worst, std::abs(double(here) - device[i].x), std::abs(double(sky) - device[i].y)});
            }
            EXPECT_LE(worst, 1e-4) << model.name << ", lights of class " << lightClass;
        }
}

TEST_F(GpuTest, DrawsAnOpenPlaneAsTheClosedFormSays) {
    const Asset asset = openPlane();
    View view;
    view.width = view.height = 16;
    view.camera = {{0, 5, 0.01f}, {0, 0, 0}, 0.5f};
    const glm::vec3 sky(0.1f, 0.2f, 0.3f);
    view.sky = sky;
    view.albedo = vec3(0.5f);
    Renderer renderer(*gpu, asset);
    // Eight lights at 60 degrees from the normal add pi sin^2 r cos 60 each; the sky fills the rest of pi.
    const double r = 0.02, e = pi * std::sin(r) * std::sin(r) * 0.5;
    for (int i = 0; i < 8; ++i) {
        const double turn = 2 * pi * i / 8, s = std::sin(pi / 3);
        view.lights.push_back(directionalLight({s * std::cos(turn), 0.5, s * std::sin(turn)}, r, vec3(100)));
    }
    for (const Model& model : models()) {
        // Models of a kind let all of the light through where nothing blocks; of the others, only that of no visibility does.
        if (!model.fromVisibility || (model.kind == ModelKind::Formula && model.id != APERTURA_MODEL_UNSHADOWED)) continue;
        const Picture picture = renderer.draw(view, model);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(picture.pixels[8 * 16 + 8][c], 0.5 / pi * (8 * e * 100 + (pi - 8 * e) * sky[c]), 2e-3) << model.name;
    }
    // A sphere overhead, sin r = 1/4.
    view.lights = {sphereLight({0, 4, 0}, 1, vec3(2))};
    view.camera = {{6, 2, 0.01f}, {0, 0, 0}, 0.1f};  // past it
    const double own = pi / 16;
    const Picture lamp = renderer.draw(view, *findModel("aperture"));
    EXPECT_NEAR(lamp.pixels[8 * 16 + 8].r, 0.5 / pi * (own * 2 + (pi - own) * 0.1), 2e-3);
}

TEST_F(GpuTest, ShowsWhatTheReferenceShows) {
    const Asset asset = bakedScene("terrain", 256);
    View view;
    view.width = 120;
    view.height = 80;
    view.camera = viewOf(asset.scene);
    view.lights = {directionalLight({0.6f, 0.7f, 0.3f}, 0.087, vec3(100))};
    const Picture truth = traceReference(Tracer(asset.scene), view, {});
    Renderer renderer(*gpu, asset);
    const Picture soft = renderer.draw(view, *findModel("soft")), oat = renderer.draw(view, *findModel("oat"));
    std::printf("terrain: soft %.4f and oat %.4f from the reference, whose mean is %.3f\n", differenceOf(soft, truth),
                differenceOf(oat, truth), meanOf(truth));
    EXPECT_LT(differenceOf(soft, truth), atMost(baseline::kTerrainOfSoft) * meanOf(truth));
    EXPECT_GT(differenceOf(oat, truth), 1.3 * differenceOf(soft, truth));
    // Silhouettes fall on the same pixels: those with exactly the sky's colour.
    int both = 0, either = 0;
    for (size_t i = 0; i < truth.pixels.size(); ++i) {
        const bool a = truth.pixels[i] == view.sky.towards({0, 1, 0}), b = soft.pixels[i] == view.sky.towards({0, 1, 0});
        both += a && b;
        either += a || b;
    }
    EXPECT_GT(both, 0.98 * either);
    EXPECT_GT(either, 100);
}

TEST_F(GpuTest, SwitchesModelsWithoutAReload) {
    const Asset asset = bakedScene("statue", 16);
    View view;
    view.width = view.height = 64;
    view.camera = viewOf(asset.scene);
    view.lights = {directionalLight({1, 1, 1}, 0.02, vec3(500))};
    Renderer renderer(*gpu, asset);
    const Model& ao = *findModel("ao");
    const Picture first = renderer.draw(view, ao);
    for (const Model& model : models())
        if (model.fromVisibility && model.id != ao.id && (!kSanitized || model.id % 4 == 0)) {
            EXPECT_GT(differenceOf(first, renderer.draw(view, model)), 1e-3) << model.name;
        }
    EXPECT_EQ(differenceOf(first, renderer.draw(view, ao)), 0);
}

TEST_F(GpuTest, TheShadowMapShowsTheShadowsOfTheReference) {
    // The sky is black, since nothing blocks it in the baseline.
    const Asset asset = bakedScene("canyon", 1);
    View view;
    view.width = 120;
    view.height = 80;
    view.camera = viewOf(asset.scene);
    view.sky = glm::vec3(0);
    Renderer renderer(*gpu, asset);
    for (double radius : {0.01, 0.087}) {
        view.lights = {directionalLight({0.5f, 0.7f, 0.4f}, radius, vec3(float(1 / (radius * radius))))};
        const Picture truth = traceReference(Tracer(asset.scene), view, {});
        const double off = differenceOf(renderer.drawShadowMapped(view), truth);
        std::printf("shadow map, light of %.3f rad: %.4f from the reference, whose mean is %.3f\n", radius, off, meanOf(truth));
        EXPECT_LT(off, atMost(baseline::kShadowMap) * meanOf(truth));
    }
    view.lights = {sphereLight({0, 4, 0}, 1, vec3(2))};
    EXPECT_THROW(renderer.drawShadowMapped(view), Error);
}

TEST_F(GpuTest, FramesInFlightAreThoseDrawnOneByOne) {
    const Asset asset = bakedScene("statue", 16);
    const Model& soft = *findModel("soft");
    View views[2];
    for (View& view : views) view.width = view.height = 48;
    views[0].camera = views[1].camera = viewOf(asset.scene);
    views[1].camera.eye *= 1.3f;
    views[0].lights = {directionalLight({1, 1, 1}, 0.02, vec3(500))};
    views[1].lights = {directionalLight({-1, 1, 0}, 0.02, vec3(200, 300, 400))};
    Renderer alone(*gpu, asset), renderer(*gpu, asset, 4);
    constexpr VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
    const vk::Extent2D size{96, 96};
    renderer.prepare(soft, lightClassOf(views[0]), format);
    renderer.prepareShadowMapped(format);
    std::vector<Offscreen> targets;
    for (int i = 0; i < 4; ++i) targets.emplace_back(*gpu, size, vk::Format(format));
    // All frames are in one submission: none runs before the last is recorded.
    gpu->run([&](VkCommandBuffer commands) {
        for (int i = 0; i < 4; ++i) {
            targets[size_t(i)].begin(commands);
            if (i < 2)
                renderer.record(commands, targets[size_t(i)].target(), views[i], soft, i);
            else
                renderer.recordShadowMapped(commands, targets[size_t(i)].target(), views[i - 2], i);
            targets[size_t(i)].end(commands);
        }
    });
    for (int i = 0; i < 4; ++i) {
        Picture picture{96, 96, {}};
        const auto* pixels = static_cast<const vec4*>(targets[size_t(i)].pixels());
        picture.pixels.assign(pixels, pixels + 96 * 96);
        const Picture expected = i < 2 ? alone.draw(views[i], soft) : alone.drawShadowMapped(views[i - 2]);
        EXPECT_LT(differenceOf(halved(picture), expected), 1e-5) << i;  // a pipeline for one light may round otherwise
    }
    EXPECT_GT(differenceOf(alone.draw(views[0], soft), alone.draw(views[1], soft)), 1e-2);
}

TEST_F(GpuTest, RecordsOnlyWhatIsPrepared) {
    const Asset asset = bakedScene("statue", 16);
    const Model &soft = *findModel("soft"), &ao = *findModel("ao");
    View view;
    view.camera = viewOf(asset.scene);
    view.lights = {directionalLight({1, 1, 1}, 0.02, vec3(500))};
    Renderer renderer(*gpu, asset);
    const Offscreen shown(*gpu, {64, 64}, vk::Format::eB8G8R8A8Srgb), other(*gpu, {64, 64}, vk::Format::eR16G16B16A16Sfloat);
    renderer.prepare(soft, lightClassOf(view), VK_FORMAT_B8G8R8A8_SRGB);
    const auto recorded = [&](const Offscreen& to, const View& from, const Model* model) {
        gpu->run([&](VkCommandBuffer commands) {
            to.begin(commands);
            if (model)
                renderer.record(commands, to.target(), from, *model, 0);
            else
                renderer.recordShadowMapped(commands, to.target(), from, 0);
            to.end(commands);
        });
    };
    recorded(shown, view, &soft);
    EXPECT_THROW(recorded(shown, view, &ao), Error);
    EXPECT_THROW(recorded(other, view, &soft), Error);
    EXPECT_THROW(recorded(shown, view, nullptr), Error);
    renderer.prepareShadowMapped(VK_FORMAT_R16G16B16A16_SFLOAT);
    EXPECT_THROW(recorded(shown, view, nullptr), Error);
    recorded(other, view, nullptr);
    View wider = view;
    wider.lights = {directionalLight({1, 1, 1}, 0.5, vec3(1))};
    EXPECT_THROW(recorded(shown, wider, &soft), Error);
    View many = view;
    many.lights.assign(APERTURA_MAX_LIGHTS + 1, view.lights[0]);
    EXPECT_THROW(recorded(shown, many, &soft), Error);
    for (const int frame : {-1, 3, 100000})
        EXPECT_THROW(gpu->run([&](VkCommandBuffer commands) { renderer.record(commands, shown.target(), view, soft, frame); }), Error)
            << frame;
    // The sky, in the top left corner, is encoded as sRGB.
    recorded(shown, view, &soft);
    const auto* bytes = static_cast<const uint8_t*>(shown.pixels());
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(bytes[2 - c] / 255.0, 1.055 * std::pow(double(view.sky.towards({0, 1, 0})[c]), 1 / 2.4) - 0.055, 0.004) << c;
}

TEST_F(GpuTest, CostsAreStatedAndTimed) {
    const CostCase cases[] = {{APERTURA_MODEL_UNSHADOWED, APERTURA_LIGHTS_SUN}, {APERTURA_MODEL_FIRM_4, APERTURA_LIGHTS_ANY}};
    const std::vector<double> seconds = measuredCosts(*gpu, cases, 1 << 14, 3);
    for (double s : seconds) EXPECT_TRUE(s > 0 && std::isfinite(s)) << s;
}

TEST(Renderer, RefusesAPictureThatIsTooLarge) {
    const Gpu gpu;
    Asset asset;
    Surface triangle;
    triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    triangle.triangles = {{0, 1, 2}};
    makeNormals(triangle);
    asset.scene.surfaces = {triangle};
    asset.scene.instances = {{0}};
    asset.seen = {{std::vector<Visibility>(3), {}}};
    View view;
    view.width = int(gpu.largestImage());
    EXPECT_THROW(Renderer(gpu, asset).draw(view, models()[0]), Error);
}

}  // namespace
}  // namespace apertura::test
