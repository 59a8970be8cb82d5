#include "tools/costs.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

// Path of the JSON manifest of Mesa's driver for Radeons; empty if there is none.
std::string radeonDriver() {
    for (const char* folder : {"/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"}) {
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
            if (entry.path().filename().string().starts_with("radeon_icd")) return entry.path().string();
    }
    return {};
}

// Every model in every class, N.L first and, for pixels, a shadow map last.
std::vector<CostKey> keysOf(std::span<const Model* const> asked, std::span<const int> lightClasses, bool shadowMap) {
    std::vector<CostKey> out;
    const auto add = [&](int id) {
        for (const int lightClass : lightClasses) out.emplace_back(id, lightClass);
    };
    add(APERTURA_MODEL_UNSHADOWED);
    for (const Model* model : asked)
        if (model->id != APERTURA_MODEL_UNSHADOWED) add(model->id);
    if (shadowMap) add(kShadowMapId);
    return out;
}

const Model* modelOf(const CostKey& key) { return key.first == kShadowMapId ? nullptr : &models()[size_t(key.first)]; }

// By key, what each case costs above the first model's in the same class.
std::map<CostKey, int> aboveFirst(std::span<const CostKey> keys, const std::vector<CompiledCost>& costs, size_t classes) {
    std::map<CostKey, int> out;
    for (size_t i = 0; i < keys.size(); ++i) out[keys[i]] = costs[i].cycles - costs[i % classes].cycles;
    return out;
}

}  // namespace

namespace {

// Cycles on one family of Radeons, compiled in a child process: Mesa takes the GPU to compile for, which need not exist, from the
// environment.
class FamilyCosts {
public:
    FamilyCosts(const char* family, const std::string& driver, std::span<const Model* const> asked, std::span<const int> lightClasses)
        : keys_(keysOf(asked, lightClasses, false)),
          drawn_(keysOf(asked, lightClasses, true)),
          classes_(lightClasses.size()),
          work_("RADV", {1800, 0x1p32}, [&](PipeWriter& out) {
              setenv("VK_ICD_FILENAMES", driver.c_str(), 1);
              setenv("VK_DRIVER_FILES", driver.c_str(), 1);
              setenv("RADV_FORCE_FAMILY", family, 1);
              const Gpu gpu({.statistics = true});
              std::vector<CostCase> lightCases;
              std::vector<PixelCase> pixelCases, litCases;
              for (const CostKey& key : keys_) lightCases.push_back({key.first, key.second});
              for (const CostKey& key : drawn_) pixelCases.push_back({modelOf(key), key.second});
              for (const CostKey& key : keys_)
                  litCases.push_back(
                      {modelOf(key), key.second, key.first == APERTURA_MODEL_UNSHADOWED ? LightAt::Pixels : LightAt::Vertices});
              out.put(compiledCosts(gpu, lightCases));
              out.put(compiledPixelCosts(gpu, pixelCases));
              out.put(compiledPixelCosts(gpu, litCases));
          }) {}

    Cycles finish() {
        std::vector<CompiledCost> light, pixel, lit;
        work_.finish([&](PipeReader& in) {
            light = in.take<CompiledCost>();
            pixel = in.take<CompiledCost>();
            lit = in.take<CompiledCost>();
        });
        return {aboveFirst(keys_, light, classes_), aboveFirst(drawn_, pixel, classes_), aboveFirst(keys_, lit, classes_)};
    }

private:
    std::vector<CostKey> keys_, drawn_;
    size_t classes_;
    IsolatedWork work_;
};

std::string requireRadeonDriver() {
    const std::string driver = radeonDriver();
    if (driver.empty()) throw Error("Mesa's driver for Radeons (RADV) is not installed");
    return driver;
}

}  // namespace

Cycles cyclesOn(const char* family, std::span<const Model* const> asked, std::span<const int> lightClasses) {
    return FamilyCosts(family, requireRadeonDriver(), asked, lightClasses).finish();
}

namespace {

// The statue with the four numbers and, for a model that is stored, with parameters of all kinds: what they are hardly changes what a
// frame costs. Of `auto` every vertex takes another model than its neighbours, the worst case.
Asset frameAsset(const Scene& scene, const BakedVisibility& seen, const Model& model) {
    Asset out{scene, seen, {}};
    if (!model.isStored()) return out;
    out.info.model = model.name;
    uint64_t draw = 0;
    for (SeenByInstance& instance : out.seen)
        for (size_t v = 0; v < instance.visibility.size(); ++v) {
            const bool chooses = model.kind == ModelKind::Choice;
            const Model& own = chooses ? *autoModels()[v % autoModels().size()] : model;
            std::vector<float> numbers(size_t(storedNumbers(own)));
            for (float& number : numbers) number = float(hashUnit(1, draw++, 0));
            ModelParams params = own.isStored() ? unpackParams(own, numbers) : ModelParams{};
            if (chooses) setChoice(params, own, false);
            instance.allParams.push_back(params);
        }
    return out;
}

// The time of a frame of each model over that of N.L, 960 x 540 pixels of the statue.
std::map<CostKey, double> frameTimes(const Gpu& gpu, std::span<const Model* const> asked, int lightClass) {
    const Scene scene = makeBuiltin("statue");
    BakeOptions options;
    options.rays = 16;
    const BakedVisibility seen = bakeVertices(scene, Tracer(scene), options);
    View view;
    view.camera = viewOf(scene);
    const double degrees = lightClass == APERTURA_LIGHTS_SUN    ? 0.27
                         : lightClass == APERTURA_LIGHTS_SMALL  ? 1
                         : lightClass == APERTURA_LIGHTS_MEDIUM ? 5
                                                                : 15;
    view.lights = {directionalLight({0.5f, 0.6f, 0.5f}, degrees * std::numbers::pi / 180, glm::vec3(1))};
    const int one[] = {lightClass};
    const std::vector<CostKey> keys = keysOf(asked, one, true);
    std::vector<std::unique_ptr<Asset>> assets;
    std::vector<std::unique_ptr<Renderer>> renderers;
    std::vector<FrameCase> cases;
    for (const CostKey& key : keys) {
        const Model* model = modelOf(key);
        assets.push_back(std::make_unique<Asset>(frameAsset(scene, seen, model ? *model : models()[APERTURA_MODEL_UNSHADOWED])));
        renderers.push_back(std::make_unique<Renderer>(gpu, *assets.back()));
        const LightAt at = model ? renderers.back()->betterLightAt(*model, double(view.width) * view.height) : LightAt::Pixels;
        cases.push_back({renderers.back().get(), model, at});
    }
    const std::vector<double> seconds = measuredFrames(gpu, view, cases, 5);
    std::map<CostKey, double> out;
    for (size_t i = 0; i < keys.size(); ++i) out[keys[i]] = seconds[i] / seconds[0];
    return out;
}

}  // namespace

Costs measureCosts(std::span<const Model* const> asked, std::span<const int> lightClasses, int frameClass) {
    Costs out;
    try {
        // Side by side.
        const std::string driver = requireRadeonDriver();
        std::map<std::string, std::unique_ptr<FamilyCosts>> running;
        for (const char* family : kFamilies) running[family] = std::make_unique<FamilyCosts>(family, driver, asked, lightClasses);
        for (auto& [family, costs] : running) out.cycles[family] = costs->finish();
    } catch (const Error& e) {
        out.cycles.clear();
        std::fprintf(stderr, "apertura: no GPU cycles, their columns stay empty: %s\n", e.what());
    }
    try {
        const Gpu gpu;
        const std::vector<CostKey> keys = keysOf(asked, lightClasses, false);
        std::vector<CostCase> cases;
        for (const CostKey& key : keys) cases.push_back({key.first, key.second});
        const std::vector<double> seconds = measuredCosts(gpu, cases, 1 << 16, 5);
        for (size_t i = 0; i < keys.size(); ++i) out.time[keys[i]] = seconds[i] / seconds[i % lightClasses.size()];
        out.frame = frameTimes(gpu, asked, frameClass);
        out.device = gpu.name();
    } catch (const Error& e) {
        std::fprintf(stderr, "apertura: no times of a device, their columns stay empty: %s\n", e.what());
    }
    return out;
}

}  // namespace apertura
