#include "tools/costs.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <thread>

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

// Work for child processes, which are begun in turn, as many at a time as there are cores: compilers use one.
class Jobs {
public:
    // `work` runs in the child; `receive`, here, on what it sends.
    void add(std::function<void(PipeWriter&)> work, std::function<void(PipeReader&)> receive) {
        jobs_.push_back({std::move(work), std::move(receive)});
    }

    // Throws Error as the work does, and Cancelled.
    void run(const char* name, const Progress& progress) {
        std::deque<std::pair<size_t, std::unique_ptr<IsolatedWork>>> running;
        const size_t most = std::max(1u, std::thread::hardware_concurrency());
        for (size_t next = 0, done = 0; done < jobs_.size(); ++done) {
            for (; next < jobs_.size() && running.size() < most; ++next)
                running.emplace_back(next, std::make_unique<IsolatedWork>(name, ResourceLimits{1800, 0x1p32}, jobs_[next].work));
            running.front().second->finish(jobs_[running.front().first].receive);
            running.pop_front();
            if (progress && !progress(double(done + 1) / double(jobs_.size()))) throw Cancelled{};
        }
    }

private:
    struct Job {
        std::function<void(PipeWriter&)> work;
        std::function<void(PipeReader&)> receive;
    };
    std::vector<Job> jobs_;
};

constexpr size_t kTogether = 12;  // cases that a child compiles

// Calls use(cases, where) on groups of the cases: `where` is the index of the first.
template <typename Case>
void inGroups(const std::vector<Case>& cases, const std::function<void(std::vector<Case>, size_t)>& use) {
    for (size_t from = 0; from < cases.size(); from += kTogether) {
        const size_t to = std::min(from + kTogether, cases.size());
        use({cases.begin() + ptrdiff_t(from), cases.begin() + ptrdiff_t(to)}, from);
    }
}

// Cycles on one family of Radeons, compiled in child processes: Mesa takes the GPU to compile for, which need not exist, from the
// environment.
class FamilyCosts {
public:
    FamilyCosts(std::span<const Model* const> asked, std::span<const int> lightClasses)
        : keys_(keysOf(asked, lightClasses, false)), drawn_(keysOf(asked, lightClasses, true)), classes_(lightClasses.size()) {}

    // Adds what is to be compiled; this must outlive the run.
    void addTo(Jobs& jobs, const std::string& family, const std::string& driver) {
        std::vector<CostCase> lightCases;
        std::vector<PixelCase> pixelCases, litCases;
        for (const CostKey& key : keys_) lightCases.push_back({key.first, key.second});
        for (const CostKey& key : drawn_) pixelCases.push_back({modelOf(key), key.second});
        for (const CostKey& key : keys_)
            litCases.push_back({modelOf(key), key.second, key.first == APERTURA_MODEL_UNSHADOWED ? LightAt::Pixels : LightAt::Vertices});
        add<CostCase>(jobs, family, driver, lightCases, compiledCosts, light_);
        add<PixelCase>(jobs, family, driver, pixelCases, compiledPixelCosts, pixel_);
        add<PixelCase>(jobs, family, driver, litCases, compiledPixelCosts, lit_);
    }

    // After the run.
    Cycles cycles() const {
        return {aboveFirst(keys_, light_, classes_), aboveFirst(drawn_, pixel_, classes_), aboveFirst(keys_, lit_, classes_)};
    }

private:
    template <typename Case>
    static void add(Jobs& jobs, const std::string& family, const std::string& driver, const std::vector<Case>& cases,
                    std::vector<CompiledCost> (*compile)(const Gpu&, std::span<const Case>), std::vector<CompiledCost>& out) {
        out.resize(cases.size());
        inGroups<Case>(cases, [&](std::vector<Case> group, size_t where) {
            jobs.add(
                [=](PipeWriter& to) {
                    setenv("VK_ICD_FILENAMES", driver.c_str(), 1);
                    setenv("VK_DRIVER_FILES", driver.c_str(), 1);
                    setenv("RADV_FORCE_FAMILY", family.c_str(), 1);
                    to.put(compile(Gpu({.statistics = true}), group));
                },
                [&out, where](PipeReader& from) {
                    const std::vector<CompiledCost> own = from.take<CompiledCost>();
                    std::copy(own.begin(), own.end(), out.begin() + ptrdiff_t(where));
                });
        });
    }

    std::vector<CostKey> keys_, drawn_;
    size_t classes_;
    std::vector<CompiledCost> light_, pixel_, lit_;
};

std::string requireRadeonDriver() {
    const std::string driver = radeonDriver();
    if (driver.empty()) throw Error("Mesa's driver for Radeons (RADV) is not installed");
    return driver;
}

}  // namespace

Cycles cyclesOn(const char* family, std::span<const Model* const> asked, std::span<const int> lightClasses) {
    FamilyCosts costs(asked, lightClasses);
    Jobs jobs;
    costs.addTo(jobs, family, requireRadeonDriver());
    jobs.run("RADV", {});
    return costs.cycles();
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

Costs measureCosts(std::span<const Model* const> asked, std::span<const int> lightClasses, int frameClass, const Progress& progress) {
    Costs out;
    const std::vector<CostKey> keys = keysOf(asked, lightClasses, false);
    std::vector<CostCase> cases;
    for (const CostKey& key : keys) cases.push_back({key.first, key.second});
    try {
        const std::string driver = requireRadeonDriver();
        std::map<std::string, FamilyCosts> families;
        Jobs jobs;
        for (const char* family : kFamilies) families.try_emplace(family, asked, lightClasses).first->second.addTo(jobs, family, driver);
        jobs.run("RADV", part(progress, 0, 0.6));
        for (const auto& [family, costs] : families) out.cycles[family] = costs.cycles();
    } catch (const Error& e) {
        out.cycles.clear();
        std::fprintf(stderr, "apertura: no GPU cycles, their columns stay empty: %s\n", e.what());
    }
    try {
        // This machine's device compiles what it first runs, one case after another. In children it does so side by side, and Mesa keeps
        // what they made on disk, where this process finds it.
        Jobs jobs;
        inGroups<CostCase>(cases, [&](std::vector<CostCase> group, size_t) {
            jobs.add([=](PipeWriter& to) { to.put(measuredCosts(Gpu(), group, 64, 1)); }, [](PipeReader& from) { from.take<double>(); });
        });
        jobs.run("Vulkan", part(progress, 0.6, 0.9));
        const Gpu gpu;
        const std::vector<double> seconds = measuredCosts(gpu, cases, 1 << 16, 5);
        for (size_t i = 0; i < keys.size(); ++i) out.time[keys[i]] = seconds[i] / seconds[i % lightClasses.size()];
        out.frame = frameTimes(gpu, asked, frameClass);
        out.device = gpu.name();
    } catch (const Error& e) {
        std::fprintf(stderr, "apertura: no times of a device, their columns stay empty: %s\n", e.what());
    }
    if (progress) progress(1);
    return out;
}

}  // namespace apertura
