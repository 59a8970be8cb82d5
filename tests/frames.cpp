// What models cost on a device, by its own clock: build/release/tests/frames FILE... prints a table of them, in Markdown. It needs neither
// Embree nor image libraries to run, so that it can be carried to where a GPU is.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <numbers>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/view.h"
#include "apertura/runtime/render/cost.h"
#include "apertura/sh/models.h"

namespace apertura {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;
constexpr int kRounds = 20;
constexpr int kPoints = 1 << 22;

double sunRadius(double degrees) { return degrees * std::numbers::pi / 180; }

// Picoseconds of one evaluation of each formula, of a light of 5 degrees and the sky, and the same over N.L alone.
void printFormulas(const Gpu& gpu) {
    std::vector<CostCase> cases;
    for (const Model& model : models())
        if (hasFormula(model, APERTURA_LIGHTS_MEDIUM)) cases.push_back({model.id, APERTURA_LIGHTS_MEDIUM, true});
    const std::vector<double> seconds = measuredCosts(gpu, cases, kPoints, kRounds);
    const auto bare = std::find_if(cases.begin(), cases.end(), [](const CostCase& c) { return c.model == APERTURA_MODEL_UNSHADOWED; });
    const double least = seconds[size_t(bare - cases.begin())];
    std::printf("\n| formula, a light of 5 degrees and the sky | ps an evaluation | over N.L |\n|---|---|---|\n");
    for (size_t i = 0; i < cases.size(); ++i)
        std::printf("| %s | %.1f | %.2f |\n", models()[size_t(cases[i].model)].name.data(), 1e12 * seconds[i] / kPoints,
                    seconds[i] / least);
}

void printFrames(const Gpu& gpu, const char* file) {
    const Asset asset = loadAsset(file);
    Renderer renderer(gpu, asset);
    View view;
    view.width = kWidth, view.height = kHeight;
    view.camera = viewOf(asset.scene);
    std::vector<std::string_view> names;
    std::vector<FrameCase> cases;
    for (const Model& model : models()) {
        if (model.isStored() && &model != storedModel(asset.info)) continue;
        names.push_back(model.name);
        cases.push_back({&renderer, &model, renderer.betterLightAt(model, double(kWidth) * kHeight)});
    }
    names.push_back("shadow-map");
    cases.push_back({&renderer, nullptr});
    std::printf("\n| %s, %d x %d, ms a frame | sun of .27 degrees | of 5 degrees |\n|---|---|---|\n", file, kWidth, kHeight);
    std::vector<double> seconds[2];
    for (int k = 0; k < 2; ++k) {
        view.lights = {directionalLight({0.5f, 0.6f, 0.5f}, sunRadius(k ? 5 : 0.27), glm::vec3(1))};
        seconds[k] = measuredFrames(gpu, view, cases, kRounds);
    }
    for (size_t i = 0; i < cases.size(); ++i)
        std::printf("| %s%s | %.3f | %.3f |\n", names[i].data(), cases[i].at == LightAt::Vertices ? ", lit at vertices" : "",
                    1e3 * seconds[0][i], 1e3 * seconds[1][i]);
}

}  // namespace
}  // namespace apertura

int main(int count, char** arguments) try {
    using namespace apertura;
    const Gpu gpu;
    std::printf("%s\n", gpu.name().c_str());
    printFormulas(gpu);
    for (int i = 1; i < count; ++i) printFrames(gpu, arguments[i]);
} catch (const std::exception& e) {
    std::fprintf(stderr, "frames: %s\n", e.what());
    return 1;
}
