#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/bounces.h"
#include "apertura/bake/measure/fuzz.h"
#include "apertura/bake/measure/scene_steps.h"
#include "apertura/bake/measure/seams.h"
#include "apertura/bake/measure/storage_errors.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/render/renderer.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

struct Arguments {
    std::string out;
    std::vector<std::string> models;
    uint64_t inputs = 1000000, deviceInputs = 20000;
    int receivers = 12;
    uint32_t seed = 1;
};

const std::vector<double> kRadii{0.27, 1, 5, 15, 30};  // degrees, lights that cross the scenes
const std::vector<double> kHalfRadii{0.27, 1, 5, 15};  // one per light class: compiling takes the most time
const char* const kHalfScenes[] = {"terrain", "room-1", "statue", "canyon"};

struct ModelReport {
    const Model* model;
    FuzzCount here, onDevice;
    double error = 0, step = 0, sceneStep = 0, half = -1;
    std::string errorIn, stepIn, sceneStepIn;
};

std::string sweepsCsv(const std::vector<StabilityRow>& rows) {
    std::ostringstream out;
    out.precision(5);
    out << "model,baseline,sweep,frames,not_finite,outside,error,error_at,model_error,step,exact_step,device_difference\n";
    for (const StabilityRow& r : rows)
        out << r.model << ',' << r.baseline << ",\"" << r.sweep << "\"," << r.frames << ',' << r.notFinite << ',' << r.outside << ','
            << r.error << ',' << r.worst << ',' << r.modelError << ',' << r.step << ',' << r.exactStep << ','
            << (r.onDevice < 0 ? "" : std::to_string(r.onDevice)) << '\n';
    return out.str();
}

std::string scenesCsv(const std::vector<SceneSteps>& rows) {
    std::ostringstream out;
    out << "scene,model,baseline,light_radius_deg,step\n";
    for (const SceneSteps& r : rows) out << r.scene << ',' << r.model << ',' << r.baseline << ',' << r.radius << ',' << r.step << '\n';
    return out.str();
}

std::string mapCsv(const std::vector<FailurePoint>& rows) {
    std::ostringstream out;
    out.precision(5);
    out << "model,light_radius_deg,aperture_radius_deg,distance,error\n";
    for (const FailurePoint& r : rows)
        out << r.model << ',' << r.lightRadius << ',' << r.apertureRadius << ',' << r.distance << ',' << r.error << '\n';
    return out.str();
}

std::string decodeCsv() {
    std::ostringstream out;
    out.precision(5);
    out << "bits,open,capness,axis_deg,axis_bound_deg,radius_deg,radius_bound_deg\n";
    for (const int bits : {8, 16})
        for (const DecodeError& r : decodeErrors(bits))
            out << r.bits << ',' << r.open << ',' << r.capness << ',' << r.axis << ',' << r.axisBound << ',' << r.radius << ','
                << r.radiusBound << '\n';
    return out.str();
}

std::string mixingCsv(const std::vector<MixingError>& rows) {
    std::ostringstream out;
    out.precision(5);
    out << "model,baseline,between,light_radius_deg,below,above,path\n";
    for (const MixingError& r : rows)
        out << r.model << ',' << findModel(r.model)->baseline << ",\"" << r.between << "\"," << r.lightRadius << ',' << r.below << ','
            << r.above << ',' << r.path << '\n';
    return out.str();
}

// Where the faces of builtin:arcade meet, by all models that its samples give.
std::vector<Seam> arcadeSeams(const std::vector<const Model*>& asked, uint32_t seed, const Progress& progress) {
    Asset asset{makeBuiltin("arcade"), {}, {}};
    BakeOptions options;
    options.seed = seed;
    asset.seen = bakeScene(asset.scene, Tracer(asset.scene), options, progress);
    std::vector<const Model*> drawn;
    for (const Model* model : asked)
        if (model->fromVisibility && !model->baseline) drawn.push_back(model);
    return measureSeams(asset, drawn, {0.27, 5}, 2000, seed);
}

std::string seamsCsv(const std::vector<Seam>& rows) {
    std::ostringstream out;
    out.precision(5);
    out << "model,light_radius_deg,densities,edges,rms,max\n";
    for (const Seam& r : rows)
        out << r.model << ',' << r.radius << ',' << (r.unequal ? "unequal" : "equal") << ',' << r.edges << ',' << r.rms << ',' << r.max
            << '\n';
    return out.str();
}

std::string halfCsv(const std::vector<HalfError>& rows) {
    std::ostringstream out;
    out << "model,baseline,light_radius_deg,lights,not_finite,rms,max\n";
    for (const HalfError& r : rows)
        out << r.model << ',' << findModel(r.model)->baseline << ',' << r.radius << ',' << r.lights << ',' << r.notFinite << ',' << r.rms
            << ',' << r.max << '\n';
    return out.str();
}

std::string countsCsv(const std::vector<ModelReport>& reports) {
    std::ostringstream out;
    out << "model,baseline,inputs,not_finite,outside,device_inputs,device_not_finite,device_outside\n";
    for (const ModelReport& r : reports)
        out << r.model->name << ',' << r.model->baseline << ',' << r.here.inputs << ',' << r.here.notFinite << ',' << r.here.outside << ','
            << r.onDevice.inputs << ',' << r.onDevice.notFinite << ',' << r.onDevice.outside << '\n';
    return out.str();
}

std::string bouncesCsv() {
    std::ostringstream out;
    out.precision(6);
    out << "sweep,albedo_or_share,frames,not_finite,outside,steepest\n";
    for (const BounceSweep& s : bounceSweeps())
        out << inQuotes(s.name) << ',' << s.albedo << ',' << s.frames << ',' << s.notFinite << ',' << s.outside << ',' << s.steepest
            << '\n';
    return out.str();
}

void print(const std::vector<ModelReport>& reports) {
    std::printf("%-11s %10s %8s   %6s %-52s %6s   %6s   %6s\n", "model", "not finite", "outside", "error", "in the sweep", "step", "scenes",
                "half");
    for (const ModelReport& r : reports)
        std::printf("%-11s %10" PRIu64 " %8" PRIu64 "   %6.3f %-52s %6.2f   %6.2f   %6s%s\n", std::string(r.model->name).c_str(),
                    r.here.notFinite + r.onDevice.notFinite, r.here.outside + r.onDevice.outside, r.error, r.errorIn.c_str(), r.step,
                    r.sceneStep, r.half < 0 ? "" : std::to_string(r.half).substr(0, 6).c_str(), r.model->baseline ? "   baseline" : "");
    std::printf(
        "error: the largest, in shares of the smaller of light and opening, from the model's own exact integral (of a baseline: from the\n"
        "opening). step: the largest, in a sweep, as a multiple of the exact one. scenes: of a light that crosses the sky of the built-in\n"
        "scenes, as a multiple of what its rim can sweep. half: what 16-bit floats add, the largest RMS of E / (L pi sin^2 r).\n");
}

void run(const Arguments& a) {
    const std::string script = findScript("stability_charts.py");
    std::vector<const Model*> asked;
    for (const Model& model : models())
        if (model.id != APERTURA_MODEL_UNSHADOWED
            && (a.models.empty() || std::find(a.models.begin(), a.models.end(), model.name) != a.models.end()))
            asked.push_back(&model);
    for (const std::string& name : a.models)
        if (!findModel(name)) throw CLI::ValidationError("--models: there is no model '" + name + "' (there are " + modelNames() + ")");
    std::error_code failed;
    std::filesystem::create_directories(a.out, failed);
    if (failed || !std::filesystem::is_directory(a.out)) throw Error(a.out + ": is not a folder, and cannot be made one");
    const std::string sweeps = a.out + "/sweeps.csv";
    requireWritable(sweeps);

    std::optional<Gpu> gpu;
    FrameEvaluator device, half;
    try {
        gpu.emplace();
        device = [&](int model, int lightClass, const std::vector<AperturaEvaluation>& inputs) {
            std::vector<float> out;
            for (const vec2& e : evaluateOnDevice(*gpu, model, lightClass, inputs)) out.push_back(e.x);
            return out;
        };
        if (gpu->hasHalf())
            half = [&](int model, int lightClass, const std::vector<AperturaEvaluation>& inputs) {
                std::vector<float> out;
                for (const vec2& e : evaluateOnDevice(*gpu, model, lightClass, inputs, true)) out.push_back(e.x);
                return out;
            };
    } catch (const Error& e) {
        std::fprintf(stderr, "apertura: no Vulkan device, its columns stay empty: %s\n", e.what());
    }

    std::vector<StabilityRow> rows;
    std::vector<SceneSteps> steps;
    std::vector<FailurePoint> map;
    std::vector<MixingError> mixing;
    std::vector<HalfError> halves;
    std::vector<Seam> seams;
    std::vector<ModelReport> reports;
    {
        ProgressBar bar("sweeping");
        const Progress progress = bar.callback();
        auto show = [&](double share) {
            if (!progress(share)) throw Cancelled{};
        };
        const FitTools tools(1024);
        const std::vector<Sweep> all = singularSweeps();
        for (size_t m = 0; m < asked.size(); ++m) {
            const Model& model = *asked[m];
            ModelReport report{&model, countFuzz(model, a.seed, a.inputs), {}};
            if (device) report.onDevice = countFuzz(model, a.seed + 1, a.deviceInputs, device);
            for (const Sweep& sweep : all) {
                const StabilityRow row = measureSweep(sweepModel(model, tools, sweep), sweep, nullptr);
                if (row.error > report.error) report.error = row.error, report.errorIn = row.sweep;
                if (row.exactStep > 0.01) report.step = std::max(report.step, row.step / row.exactStep);
                rows.push_back(row);
            }
            for (const FailurePoint& point : failureMap(model, tools)) map.push_back(point);
            for (const MixingError& row : mixingErrors(model)) mixing.push_back(row);
            reports.push_back(report);
            show(0.5 * double(m + 1) / double(asked.size()));
        }
        std::vector<Scene> halfScenes;
        for (const char* name : kHalfScenes) halfScenes.push_back(makeBuiltin(name));
        for (size_t m = 0; half && m < asked.size(); ++m) {
            for (const HalfError& row : measureHalf(halfScenes, {asked[m]}, std::max(a.receivers / 2, 1), 256, a.seed, kHalfRadii, half)) {
                halves.push_back(row);
                reports[m].half = std::max(reports[m].half, row.notFinite ? 9.99 : row.rms);
            }
            show(0.5 + 0.3 * double(m + 1) / double(asked.size()));
        }
        const std::vector<std::string>& scenes = builtinNames();
        for (size_t s = 0; s < scenes.size(); ++s) {
            for (const SceneSteps& step : measureSceneSteps(makeBuiltin(scenes[s]), asked, a.receivers, 256, a.seed, kRadii, {})) {
                steps.push_back(step);
                for (ModelReport& report : reports)
                    if (report.model->name == step.model) report.sceneStep = std::max(report.sceneStep, step.step);
            }
            show(0.8 + 0.15 * double(s + 1) / double(scenes.size()));
        }
        seams = arcadeSeams(asked, a.seed, part(progress, 0.95, 1));
    }
    if (interrupted()) throw Cancelled{};
    writeTextFile(sweeps, sweepsCsv(rows));
    writeTextFile(a.out + "/scenes.csv", scenesCsv(steps));
    writeTextFile(a.out + "/map.csv", mapCsv(map));
    writeTextFile(a.out + "/counts.csv", countsCsv(reports));
    writeTextFile(a.out + "/decode.csv", decodeCsv());
    writeTextFile(a.out + "/mixing.csv", mixingCsv(mixing));
    writeTextFile(a.out + "/half.csv", halfCsv(halves));
    writeTextFile(a.out + "/seams.csv", seamsCsv(seams));
    writeTextFile(a.out + "/bounces.csv", bouncesCsv());
    print(reports);
    drawCharts(script, a.out, "the tables are there, the charts are not");
}

}  // namespace

void addStabilityCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("stability", "where each model breaks: singular configurations, hostile numbers, flashes");
    command.footer(
        "Leaves sweeps.csv, scenes.csv, map.csv, counts.csv, decode.csv, mixing.csv, half.csv, seams.csv, bounces.csv and charts of them. "
        "What was "
        "published, and "
        "the rivals, are marked as\n"
        "baselines: they stay as they are.\n"
        "Example: apertura stability -o stability");
    command.add_option("-o", a->out, "the folder for all of it; made where it is not there")->required()->type_name("DIR");
    command.add_option("--models", a->models, "of " + modelNames() + " [all]")->delimiter(',')->type_name("A,B,...");
    command.add_option("--inputs", a->inputs, "hostile inputs a model on this processor [1000000]")
        ->check(CLI::Range(1.0, 1e12))
        ->type_name("N");
    command.add_option("--device-inputs", a->deviceInputs, "and on the device [20000]")->check(CLI::Range(1.0, 1e10))->type_name("N");
    command.add_option("--receivers", a->receivers, "points of each scene whose sky a light crosses [12]")
        ->check(CLI::Range(1, 100000))
        ->type_name("N");
    command.add_option("--seed", a->seed, "[1]")->type_name("S");
    command.callback([a] { run(*a); });
}

}  // namespace apertura
