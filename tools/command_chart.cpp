#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <tuple>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/appearance.h"
#include "apertura/bake/measure/measure.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/ground.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "tools/chart_places.h"
#include "tools/commands.h"
#include "tools/costs.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

struct Arguments {
    std::vector<std::string> scenes;
    std::string out;
    std::vector<std::string> models, whole;
    double headline = 0;  // degrees; 0: 5 or the middle
    SceneOptions reading;
    MeasureOptions measure;
};

constexpr double kHeadline = 5;  // degrees, light radius of the charts, the error maps and the frames

// Cost of a recipe, with 256 rays per vertex and one thread: baking time per vertex as a multiple of that of `sh`, and
// points per second of the fit alone.
struct BakeCost {
    double ratio, pointsPerSecond;
};
std::map<std::string, BakeCost> measureBaking(const Scene& scene, const MeasureOptions& measure) {
    using Clock = std::chrono::steady_clock;
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, 100, measure.seed)) points.push_back(p.at);
    BakeOptions options;
    options.threads = 1;
    const FitTools tools(options.rays);
    FitOptions fitOptions{.terrain = scene.isTerrain};
    fitOptions.lambda = 1 / (fitOptions.tolerance * fitOptions.tolerance);
    std::vector<std::pair<Samples, mat3>> samples;
    const RayOcclusion source(tracer);
    const auto start = Clock::now();
    samplePoints(source, points, tools.lattice, options.seed, 1, {},
                 [&](size_t, const Samples& s, const mat3& frame) { samples.emplace_back(s, frame); });
    const double tracing = std::chrono::duration<double>(Clock::now() - start).count();
    std::map<std::string, BakeCost> out;
    double plain = 0;
    for (const Recipe& recipe : recipes()) {
        const bool asked = recipe.model < 0 || !measure.only
                        || std::find(measure.models.begin(), measure.models.end(), &models()[size_t(recipe.model)]) != measure.models.end();
        if (!asked) continue;
        const auto from = Clock::now();
        for (const auto& [s, frame] : samples) makePoint(recipe, tools, s, frame, fitOptions);
        const double fitting = std::chrono::duration<double>(Clock::now() - from).count();
        if (recipe.name == "sh") plain = tracing + fitting;
        out[std::string(recipe.name)] = {(tracing + fitting) / plain, double(points.size()) / fitting};
    }
    return out;
}

// The name of the recipe of a row's model.
std::string recipeOf(const MeasureRow& row) {
    const Recipe* own = findRecipe(row.model);
    if (own && own->source == row.source) return row.model;
    return row.source;
}

// What a model errs between the samples that an asset stores, and how that looks: by scene, model, source and light radius.
struct WholeError {
    double rmse, ambient, mottle, edge;  // as MeasureRow's
};
using WholeErrors = std::map<std::tuple<std::string, std::string, std::string, double>, WholeError>;

// Bakes the scene with what these models are made from, each time to a file beside `path` that is removed again, and measures the asset.
void addWholeErrors(const Scene& scene, const std::vector<const Model*>& models, MeasureOptions measure, const std::string& path,
                    const Progress& progress, WholeErrors& out) {
    measure.bounces = 0;
    std::map<std::string_view, std::vector<const Model*>> byRecipe;
    for (const Model* model : models) byRecipe[recipeFor(*model).name].push_back(model);
    measure.only = true;
    measure.shadowMap = false;
    double done = 0;
    for (const auto& [recipe, made] : byRecipe) {
        const double next = done + 1 / double(byRecipe.size()), middle = 0.5 * (done + next);
        BakeOptions bake;
        bake.recipe = recipe;
        bake.rays = defaultRays(recipeNamed(recipe));
        bake.threads = measure.threads;
        bake.tolerance = measure.tolerance;
        BakeInfo info;
        info.version = APERTURA_VERSION;
        info.scene = scene.name;
        info.model = recipe;
        info.rays = bake.rays;
        info.at = "faces";
        const PendingFile file(path);
        writeAsset(file.name(), scene, bakeScene(scene, Tracer(scene), bake, part(progress, done, middle)), info);
        measure.models = made;
        for (const MeasureRow& row : measureAsset(loadAsset(file.name()), measure, part(progress, middle, next)).rows)
            out[{scene.name, row.model, row.source, row.lightRadius}] = {row.rmse, row.ambient, row.mottle, row.edge};
        done = next;
    }
}

// The class of formulas for a light of so many degrees.
int classOf(double degrees) { return lightClassOf(float(std::sin(degrees * std::numbers::pi / 180))); }

// What other receivers would change of a row's RMSE: its standard deviation over seeds, from that of the squares of this seed's receivers.
double spreadOf(const MeasureRow& row) {
    const double n = double(row.receiverRmse.size());
    if (n < 2 || row.rmse <= 0) return 0;
    double mean = 0, squares = 0;
    for (const float e : row.receiverRmse) mean += double(e) * e / n, squares += std::pow(double(e), 4) / n;
    return std::sqrt(std::max(squares - mean * mean, 0.0) / (n - 1)) / (2 * row.rmse);
}

// The same model's row made from rays, beside that from the coefficients: they are equal.
bool isRepeated(const MeasureRow& row) {
    const Model* model = findModel(row.model);
    return row.source == "rays" && model && model->fromVisibility;
}

std::string toCsv(const std::vector<Measurement>& all, const WholeErrors& whole, const Costs& costs,
                  const std::map<std::string, BakeCost>& baking) {
    std::ostringstream out;
    out.precision(6);
    out << "scene,model,source,baseline,numbers,bytes,light_radius_deg,rmse,rmse_spread,bias,max,rms_truth,noise,ambient_rmse,ambient_"
           "unbounced,"
           "ambient_bounced,leak_max,leak_99,"
           "whole_rmse,whole_ambient,whole_mottle,whole_edge";
    for (const char* family : kFamilies) out << ",cycles_" << family << ",cycles_pixel_" << family << ",cycles_lit_" << family;
    out << ",time_ratio,frame_ratio,texels_per_metre,bake_ratio,fits_per_second\n";
    // An empty cell, where a figure is not there.
    const auto cell = [&](const auto& figures, const CostKey& key) {
        out << ',';
        if (const auto found = figures.find(key); found != figures.end()) out << found->second;
    };
    for (const Measurement& m : all)
        for (const MeasureRow& r : m.rows) {
            if (isRepeated(r)) continue;
            const Model* model = findModel(r.model);
            out << inQuotes(m.scene) << ',' << r.model << ',' << r.source << ',' << (!model || model->baseline) << ',' << r.numbers << ','
                << r.bytes << ',' << r.lightRadius << ',' << r.rmse << ',' << spreadOf(r) << ',' << r.bias << ',' << r.max << ','
                << r.rmsTruth << ',' << r.noise << ',' << r.ambient << ',' << r.unbounced << ',' << r.bounced << ',' << r.leakMax << ','
                << r.leak99 << ',';
            if (const auto found = whole.find({m.scene, r.model, r.source, r.lightRadius}); found != whole.end()) {
                const WholeError& error = found->second;
                out << error.rmse << ',' << error.ambient << ',';
                if (r.lightRadius <= Appearance::kLargest) out << error.mottle;
                out << ',';
                if (error.edge > 0) out << error.edge;
            } else {
                out << ",,,";
            }
            const CostKey key(model ? model->id : kShadowMapId, classOf(r.lightRadius));
            for (const char* family : kFamilies) {
                const auto found = costs.cycles.find(family);
                const Cycles none, &cycles = found != costs.cycles.end() ? found->second : none;
                cell(cycles.light, key);
                cell(cycles.pixel, key);
                cell(cycles.lit, key);
            }
            cell(costs.time, key);
            cell(costs.frame, key);
            out << ',';
            if (r.texelsPerMetre > 0) out << r.texelsPerMetre;
            const auto cost = baking.find(recipeOf(r));
            if (cost != baking.end())
                out << ',' << cost->second.ratio << ',' << cost->second.pointsPerSecond << '\n';
            else
                out << ",,\n";
        }
    return out.str();
}

// CSV for the error maps: for each model the scene with its largest error, with the receivers' positions and errors.
std::string toMaps(const std::vector<Measurement>& all, double headline) {
    std::map<std::pair<std::string, std::string>, std::pair<const Measurement*, const MeasureRow*>> worst;
    for (const Measurement& m : all)
        for (const MeasureRow& r : m.rows) {
            if (r.lightRadius != headline || isRepeated(r)) continue;
            auto& [scene, row] = worst[{r.model, r.source}];
            if (!row || r.rmse > row->rmse) scene = &m, row = &r;
        }
    std::ostringstream out;
    out << "scene,model,source,x,y,z,rmse\n";
    for (const auto& [key, found] : worst) {
        const auto& [m, row] = found;
        for (size_t i = 0; i < m->positions.size(); ++i)
            out << inQuotes(m->scene) << ',' << row->model << ',' << row->source << ',' << m->positions[i].x << ',' << m->positions[i].y
                << ',' << m->positions[i].z << ',' << row->receiverRmse[i] << '\n';
    }
    return out.str();
}

std::vector<double> sorted(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values;
}

void run(Arguments a) {
    const std::string script = findScript("charts.py");
    a.measure.models = parseModels(a.models, a.measure.shadowMap);
    a.measure.only = !a.models.empty();
    if (a.scenes.empty())
        for (const std::string& name : builtinNames()) a.scenes.push_back("builtin:" + name);
    dropRepeats(a.measure.lightRadii);
    std::vector<Scene> scenes;
    scenes.reserve(a.scenes.size());
    const std::vector<double>& radii = a.measure.lightRadii;
    if (a.headline > 0 && std::find(radii.begin(), radii.end(), a.headline) == radii.end())
        throw CLI::ValidationError((std::ostringstream() << "--headline: " << a.headline << " is not one of --light-radii").str());
    const auto heightMaps = std::count_if(a.scenes.begin(), a.scenes.end(), isHeightMap);
    if (heightMaps == 0 || size_t(heightMaps) == a.scenes.size()) a.reading.check(a.scenes.front());
    for (const std::string& name : a.scenes) {
        // Of several kinds, each takes the options that are for it.
        Scene scene = loadScene(name, a.reading.heights, isHeightMap(name) ? Coordinates::Read : Coordinates::Ignore);
        scenes.push_back(a.reading.ground && !isHeightMap(name) ? withGround(std::move(scene)) : std::move(scene));
    }
    const bool hasUsual = std::find(radii.begin(), radii.end(), kHeadline) != radii.end();
    const double headline = a.headline > 0 ? a.headline : hasUsual ? kHeadline : sorted(radii)[radii.size() / 2];
    std::error_code failed;
    std::filesystem::create_directories(a.out, failed);
    if (failed || !std::filesystem::is_directory(a.out)) throw Error(a.out + ": is not a folder, and cannot be made one");
    const std::string csv = a.out + "/models.csv", maps = a.out + "/maps.csv", about = a.out + "/about.json";
    requireWritable(csv);

    std::vector<const Model*> asked = a.measure.models;
    if (!a.measure.only)
        for (const Model& model : models()) asked.push_back(&model);
    std::vector<const Model*> wholes;
    for (const Model* model : asked)
        if (a.whole.empty() && model->fromVisibility) wholes.push_back(model);
    if (bool none = false; !a.whole.empty()) wholes = parseModels(a.whole, none);
    for (const Model* model : wholes)
        if (std::find(asked.begin(), asked.end(), model) == asked.end())
            throw CLI::ValidationError("--whole: " + std::string(model->name) + " is not one of --models");
    std::vector<int> classes;
    for (const double radius : a.measure.lightRadii)
        if (const int c = classOf(radius); std::find(classes.begin(), classes.end(), c) == classes.end()) classes.push_back(c);
    Costs costs;
    {
        ProgressBar bar("compiling for two Radeons and this machine's device");
        costs = measureCosts(asked, classes, classOf(headline), bar.callback());
    }
    std::vector<Measurement> all;
    WholeErrors whole;
    std::vector<PlaceRow> places;
    std::map<std::string, BakeCost> baking;
    {
        ProgressBar bar("charting");
        const Progress progress = bar.callback();
        baking = measureBaking(scenes[0], a.measure);
        for (size_t i = 0; i < scenes.size(); ++i) {
            const Progress own = part(progress, double(i) / double(scenes.size()), double(i + 1) / double(scenes.size()));
            all.push_back(measureScene(scenes[i], a.measure, part(own, 0, 0.5)));
            addWholeErrors(scenes[i], wholes, a.measure, a.out + "/scene.glb", part(own, 0.5, 0.8), whole);
            if (std::find(wholes.begin(), wholes.end(), findModel("soft")) == wholes.end()) continue;
            for (PlaceRow& row : measurePlaces(scenes[i], a.measure, a.out + "/scene.glb", part(own, 0.8, 1))) places.push_back(row);
        }
    }
    if (interrupted()) throw Cancelled{};
    writeTextFile(csv, toCsv(all, whole, costs, baking));
    writeTextFile(maps, toMaps(all, headline));
    writeTextFile(a.out + "/places.csv", toCsv(places));
    writeTextFile(about,
                  nlohmann::ordered_json{
                      {"version", APERTURA_VERSION}, {"receivers", all[0].receivers}, {"device", costs.device}, {"headline", headline}}
                          .dump()
                      + "\n");
    drawCharts(script, a.out, "the table models.csv is there, the charts are not");
    std::printf("%s/index.html: %zu scenes, %d receivers each\n", a.out.c_str(), all.size(), all[0].receivers);
}

}  // namespace

void addChartCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    a->measure.receivers = 200;
    a->measure.bounces = 8;
    a->measure.albedo = {glm::vec3(0.5f), true};
    CLI::App& command = *program.add_subcommand("chart", "every model's error against its cost, as a table, charts and one page");
    command.footer(
        "Leaves models.csv, places.csv (soft at vertices, on faces and in images), the charts as .png and .svg, and index.html, which "
        "holds them all and needs no network.\n"
        "ambient_unbounced and ambient_bounced in models.csv: the sky's error where light bounces 8 times from surfaces of albedo .5, "
        "without "
        "and with what they reflect.\n"
        "GPU cycles are what Mesa's compilers for an RDNA2 and a GCN4 Radeon state, above N.L alone; no such GPU is needed.\n"
        "The charts are drawn by matplotlib under /usr/bin/python3, or under $APERTURA_PYTHON.\n"
        "Example: apertura chart builtin:statue builtin:canyon -o charts");
    command.add_option("SCENE", a->scenes, "scenes as for bake [the ten built-in ones]")->type_name("SCENE ...");
    command.add_option("-o", a->out, "the folder for all of it; made where it is not there")->required()->type_name("DIR");
    command.add_option("--models", a->models, "of " + modelNames() + ", shadow-map [all]")->delimiter(',')->type_name("A,B,...");
    command
        .add_option("--whole", a->whole,
                    "models that are measured between the samples of an asset too, for which each scene is baked [those of --models that "
                    "are made from the four numbers]")
        ->delimiter(',')
        ->type_name("A,B,...");
    command.add_option("--light-radii", a->measure.lightRadii, "degrees [0.27,1,5,15,30]")
        ->delimiter(',')
        ->check(finiteRange(0.01, 45.0))
        ->type_name("D,D,...");
    command.add_option("--headline", a->headline, "degrees, one of --light-radii, that the charts are drawn for [5, else the middle one]")
        ->check(finiteRange(0.01, 45.0))
        ->type_name("D");
    command.add_option("--receivers", a->measure.receivers, "points on each scene's surface [200]")
        ->check(CLI::Range(1, 1000000))
        ->type_name("N");
    command.add_option("--tolerance", a->measure.tolerance, "of the model auto: RMSE [0.05]")
        ->check(finiteRange(1e-6, 1e6))
        ->type_name("RMSE");
    command.add_option("--seed", a->measure.seed, "of the receivers and the rays [1]")->type_name("S");
    command.add_option("--threads", a->measure.threads, "[all cores]")->check(CLI::Range(1, 1024))->type_name("T");
    a->reading.addTo(command);
    command.callback([a, &command] {
        if (command.count("--tolerance") > 0) requireAuto(a->models);
        run(*a);
    });
}

}  // namespace apertura
