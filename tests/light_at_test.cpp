// Light at vertices against light at pixels, and what both cost.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/render/draw.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/support.h"
#include "tools/costs.h"

namespace apertura::test {
namespace {

Asset bakedStatue(const char* model) {
    Asset asset;
    asset.scene = makeBuiltin("statue");
    BakeOptions options;
    options.recipe = model;
    options.rays = 64;
    asset.info.model = model;
    asset.seen = bakeVertices(asset.scene, Tracer(asset.scene), options);
    return asset;
}

View lit(const Asset& asset, std::vector<AperturaLight> lights) {
    View view;
    view.width = 320, view.height = 240;
    view.camera = viewOf(asset.scene);
    view.lights = std::move(lights);
    return view;
}

AperturaLight sun(const glm::vec3& direction, double degrees) {
    const double r = degrees * pi / 180;
    return directionalLight(direction, r, vec3(float(2.4 / (pi * std::sin(r) * std::sin(r)))));
}

double largest(const Picture& a, const Picture& b) {
    double out = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) out = std::max(out, double(std::abs(a.pixels[i][c] - b.pixels[i][c])));
    return out;
}

class LightAtTest : public testing::Test {
protected:
    void SetUp() override { gpu = std::make_unique<Gpu>(GpuOptions{.validate = true}); }
    void TearDown() override {
        for (const std::string& message : gpu->messages()) ADD_FAILURE() << message;
    }
    std::unique_ptr<Gpu> gpu;
};

TEST_F(LightAtTest, VerticesDrawWhatPixelsDraw) {
    for (const char* name : {"firm-2", "multi-2"}) {
        if (kSanitized && std::string(name) == "multi-2") continue;
        const Asset asset = bakedStatue(name);
        const Model& model = *findModel(name);
        Renderer renderer(*gpu, asset);
        const AperturaLight lamp = sphereLight({3, 2, 1}, 0.3, vec3(20));
        const std::pair<std::vector<AperturaLight>, double> cases[] = {
            {{sun({1, 1, 0.5f}, 0.27)}, 1e-3},
            {{sun({-1, 0.3f, 0.5f}, 0.27), sun({1, 0.2f, 0}, 0.4)}, 1e-3},
            {{sun({1, 0.6f, 0.5f}, 2.5)}, 0.02},
            {{sun({1, 0.6f, 0.5f}, 5), lamp, sun({0, 1, 0}, 1), sun({0, 1, 1}, 2), sun({-1, 1, 1}, 2), sun({-1, 1, 0}, 1)}, 0.2},
            {{}, 1e-3},  // a quarter of a step of 8 bits
        };
        for (const auto& [lights, allowed] : cases) {
            const View view = lit(asset, lights);
            const Picture pixels = renderer.draw(view, model), vertices = renderer.draw(view, model, LightAt::Vertices);
            EXPECT_LT(largest(pixels, vertices), allowed) << name << ", " << lights.size() << " lights";
        }
    }
}

TEST_F(LightAtTest, ModelsWithASkyOfTheirOwnKeepIt) {
    for (const char* name : {"ao-area", "oat", "soft"}) {
        const Asset asset = bakedStatue("sh");
        Renderer renderer(*gpu, asset);
        const View view = lit(asset, {});
        const Model& model = *findModel(name);
        // Normals bend between vertices, so that the sky there is not quite the mean of theirs.
        EXPECT_LT(largest(renderer.draw(view, model), renderer.draw(view, model, LightAt::Vertices)), 0.05) << name;
    }
}

TEST_F(LightAtTest, FramesInFlightWithFewerLightsThanThereIsRoomForStayApart) {
    const Asset asset = bakedStatue("firm-2");
    const Model& model = *findModel("firm-2");
    Renderer renderer(*gpu, asset, 2);
    constexpr auto format = VK_FORMAT_R32G32B32A32_SFLOAT;
    renderer.prepare(model, APERTURA_LIGHTS_SUN, format, LightAt::Vertices, 3);
    const View views[] = {lit(asset, {sun({1, 1, 0.5f}, 0.27)}), lit(asset, {sun({-1, 0.5f, 0}, 0.27), sun({0, 1, 1}, 0.27)})};
    const Offscreen first(*gpu, {128, 128}, vk::Format(format)), second(*gpu, {128, 128}, vk::Format(format));
    const Offscreen* targets[] = {&first, &second};
    const auto pixelsOf = [&](const Offscreen& target) {
        const auto* p = static_cast<const vec4*>(target.pixels());
        return std::vector<vec4>(p, p + 128 * 128);
    };
    std::vector<std::vector<vec4>> alone;
    for (int i = 0; i < 2; ++i) {
        gpu->run([&](VkCommandBuffer commands) {
            targets[i]->begin(commands);
            renderer.record(commands, targets[i]->target(), views[i], model, i, LightAt::Vertices);
            targets[i]->end(commands);
        });
        alone.push_back(pixelsOf(*targets[i]));
    }
    gpu->run([&](VkCommandBuffer commands) {
        for (int i = 0; i < 2; ++i) {
            targets[i]->begin(commands);
            renderer.record(commands, targets[i]->target(), views[i], model, i, LightAt::Vertices);
            targets[i]->end(commands);
        }
    });
    for (int i = 0; i < 2; ++i) EXPECT_EQ(pixelsOf(*targets[i]), alone[size_t(i)]) << i;
    EXPECT_NE(alone[0], alone[1]);
    View many = views[0];
    many.lights.assign(8, views[0].lights[0]);
    EXPECT_THROW(gpu->run([&](VkCommandBuffer commands) { renderer.record(commands, first.target(), many, model, 0, LightAt::Vertices); }),
                 Error);
    EXPECT_THROW(gpu->run([&](VkCommandBuffer commands) { renderer.record(commands, first.target(), views[0], model, 0); }), Error);
}

TEST_F(LightAtTest, TheBetterWayIsVerticesWhereTheyAreFewer) {
    const Asset asset = bakedStatue("firm-2");
    const Renderer renderer(*gpu, asset);
    const double vertices = double(asset.scene.surfaces[0].positions.size());
    EXPECT_EQ(renderer.betterLightAt(*findModel("firm-2"), vertices), LightAt::Vertices);
    EXPECT_EQ(renderer.betterLightAt(*findModel("firm-2"), vertices / 4), LightAt::Pixels);
    EXPECT_EQ(renderer.betterLightAt(*findModel("soft"), 1e9), LightAt::Pixels);
}

TEST_F(LightAtTest, FramesAreTimed) {
    const Asset asset = bakedStatue("sh");
    Renderer renderer(*gpu, asset);
    const FrameCase cases[] = {
        {&renderer, findModel("unshadowed")}, {&renderer, findModel("soft"), LightAt::Vertices}, {&renderer, nullptr}};
    for (const double seconds : measuredFrames(*gpu, lit(asset, {sun({1, 1, 1}, 5)}), cases, 2)) EXPECT_GT(seconds, 0);
}

TEST(Costs, TheTablesCyclesAreWhatTheCompilerStates) {
    std::vector<const Model*> chosen(autoModels().begin(), autoModels().end());
    const int lights[] = {APERTURA_LIGHTS_MEDIUM};
    Cycles cycles;
    try {
        cycles = cyclesOn("navi21", chosen, lights);
    } catch (const Error& e) {
        GTEST_SKIP() << e.what();
    }
    for (const Model* model : chosen) {
        const int stated = cycles.light.at({model->id, APERTURA_LIGHTS_MEDIUM});
        EXPECT_NEAR(model->cycles, stated, 2 + 0.15 * stated) << model->name;
        // A pixel takes three corners where the model does not mix, and one mix where it does; it fetches besides.
        EXPECT_GT(cycles.pixel.at({model->id, APERTURA_LIGHTS_MEDIUM}), (model->mixes ? 1 : 3) * stated) << model->name;
        EXPECT_LT(cycles.lit.at({model->id, APERTURA_LIGHTS_MEDIUM}), 100) << model->name;
    }
}

}  // namespace
}  // namespace apertura::test
