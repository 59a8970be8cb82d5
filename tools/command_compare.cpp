#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apertura/bake/measure/appearance.h"
#include "apertura/bake/measure/measure.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/materials.h"
#include "apertura/runtime/asset/view.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

struct Arguments {
    std::string scene, json, albedo;
    std::vector<std::string> models;
    SceneOptions reading;
    MeasureOptions measure;
};

// Writes whole numbers without decimals: 4, not 4.0.
nlohmann::ordered_json wholeOrReal(double x) {
    if (x == std::floor(x)) return int(x);
    return x;
}

nlohmann::ordered_json toJson(const Measurement& m) {
    nlohmann::ordered_json rows = nlohmann::json::array(), paths = nlohmann::json::array();
    for (const MeasureRow& r : m.rows) {
        rows.push_back({{"model", r.model},
                        {"source", r.source},
                        {"numbers", wholeOrReal(r.numbers)},
                        {"bytes", wholeOrReal(r.bytes)},
                        {"light_radius_deg", r.lightRadius},
                        {"rmse", r.rmse},
                        {"bias", r.bias},
                        {"max", r.max},
                        {"rms_truth", r.rmsTruth},
                        {"noise", r.noise},
                        {"ambient_rmse", r.ambient},
                        {"leak_max", r.leakMax},
                        {"leak_99", r.leak99}});
        if (m.paths.empty() && r.own > 0) {
            rows.back()["own"] = r.own;
            rows.back()["ratio"] = r.rmse / r.own;
            rows.back()["ambient_own"] = r.ambientOwn;
            if (r.lightRadius <= Appearance::kLargest) {
                rows.back()["mottle"] = r.mottle;
                rows.back()["edge"] = r.edge > 0 ? nlohmann::ordered_json(r.edge) : nlohmann::ordered_json();
            }
        }
        if (!m.bounces.empty()) rows.back()["ambient_unbounced_rmse"] = r.unbounced, rows.back()["ambient_bounced_rmse"] = r.bounced;
        if (r.texelsPerMetre > 0) rows.back()["texels_per_metre"] = r.texelsPerMetre;
    }
    for (const PathRow& p : m.paths)
        paths.push_back({{"stage", p.stage},
                         {"source", p.source},
                         {"direction_deg_rms", p.directionRms},
                         {"direction_deg_max", p.directionMax},
                         {"radius_deg_rms", p.radiusRms},
                         {"radius_deg_max", p.radiusMax},
                         {"irradiance_rms", p.irradianceRms}});
    nlohmann::ordered_json out{{"scene", m.scene}, {"receivers", m.receivers}, {"buried", m.buried}, {"rows", rows}};
    if (!m.paths.empty()) out["sh_and_rays"] = paths;
    for (const BounceRow& b : m.bounces)
        out["bounces"].push_back(
            {{"by", b.by}, {"sky_rmse", b.sky}, {"sky_bias", b.skyBias}, {"light_rmse", b.light}, {"light_bias", b.lightBias}});
    return out;
}

// Prints one line per model and source, one column per light radius.
void print(const Measurement& m, const std::vector<double>& radii) {
    std::printf("%s: %s\n", m.scene.c_str(),
                m.paths.empty() ? "the whole error, interpolated from the asset's bytes" : "each model's own error, at the receivers");
    std::printf("rmse of E / (L pi sin^2 r) at %d receivers, by light radius in degrees", m.receivers);
    if (m.buried > 0) std::printf("; %d more lie inside solids, where nobody sees them", m.buried);
    std::printf("\n");
    const bool bounces = !m.bounces.empty();
    std::printf("%-12s %-6s %7s %6s %7s", "model", "from", "numbers", "bytes", "ambient");
    if (bounces) std::printf(" %7s", "bounced");
    for (double radius : radii) std::printf(" %8g", radius);
    std::printf("\n");
    for (size_t i = 0; i < m.rows.size(); i += radii.size()) {
        const MeasureRow& first = m.rows[i];
        std::printf("%-12s %-6s %7.4g %6.3g %7.4f", first.model.c_str(), first.source.c_str(), first.numbers, first.bytes,
                    bounces ? first.unbounced : first.ambient);
        if (bounces) std::printf(" %7.4f", first.bounced);
        for (size_t k = 0; k < radii.size(); ++k) std::printf(" %8.4f", m.rows[i + k].rmse);
        std::printf("\n");
        if (!m.paths.empty() || !(first.own > 0)) continue;
        const int indent = bounces ? 50 : 42;
        std::printf("%-34s %7.4f%s", "  at the receivers themselves", first.ambientOwn, bounces ? "        " : "");
        for (size_t k = 0; k < radii.size(); ++k) std::printf(" %8.4f", m.rows[i + k].own);
        std::printf("\n%-*s", indent, "  mottle");
        for (size_t k = 0; k < radii.size(); ++k)
            radii[k] <= Appearance::kLargest ? std::printf(" %8.4f", m.rows[i + k].mottle) : std::printf(" %8s", "");
        std::printf("\n%-*s", indent, "  width of edges, over truth's own");
        for (size_t k = 0; k < radii.size(); ++k)
            m.rows[i + k].edge > 0 ? std::printf(" %8.1f", m.rows[i + k].edge) : std::printf(" %8s", "");
        std::printf("\n");
    }
    const auto footer = [&](const char* name, double MeasureRow::*field) {
        std::printf("%-*s", bounces ? 50 : 42, name);
        for (size_t k = 0; k < radii.size(); ++k) std::printf(" %8.4f", m.rows[k].*field);
        std::printf("\n");
    };
    footer("rms of the truth", &MeasureRow::rmsTruth);
    footer("the truth's own noise", &MeasureRow::noise);
    std::printf(
        "from: sh, the coefficients of what the rays see; rays, straight from them; fit, fitted to them; sh-fit, the coefficients of the "
        "soft aperture that is fitted to them. numbers: of auto, the mean over the receivers. bytes: of a sample in the asset; at vertices "
        "padded to a multiple of four\n");
    for (const MeasureRow& r : m.rows)
        if (r.texelsPerMetre > 0 && &r == &m.rows[m.rows.size() - radii.size()])
            std::printf("shadow-map: %d texels a side over the whole scene, %.3g a metre on average\n", kShadowTexels, r.texelsPerMetre);
    if (bounces) {
        std::printf(
            "ambient, bounced: of a sky of one radiance whose light bounces, without what surfaces reflect and with it\n\n"
            "what surfaces reflect: E of that sky over pi with it, and E by way of them of any light at infinity, over what it gives to a\n"
            "surface that faces it. none: all that is missing without them; given: by the mean albedo; baked: as the asset stores it. "
            "What\n"
            "comes straight is the truth here\n"
            "%-8s %10s %10s %12s %12s\n",
            "from", "sky rmse", "sky bias", "light rmse", "light bias");
        for (const BounceRow& b : m.bounces)
            std::printf("%-8s %10.4f %+10.4f %12.4f %+12.4f\n", b.by.c_str(), b.sky, b.skyBias, b.light, b.lightBias);
    }
    if (m.paths.empty()) return;
    std::printf(
        "\nwhere apertures of coefficients (sh) and of rays part: what each step does to the receiver's own aperture,\n"
        "rms and largest, and to its E / (L pi sin^2 r) of a light of 5 degrees\n");
    std::printf("%-56s %-5s %17s %17s %8s\n", "", "from", "axis deg rms/max", "radius deg", "E rms");
    for (const PathRow& p : m.paths)
        std::printf("%-56s %-5s %8.3f %8.2f %8.3f %8.2f %8.4f\n", p.stage.c_str(), p.source.c_str(), p.directionRms, p.directionMax,
                    p.radiusRms, p.radiusMax, p.irradianceRms);
}

void run(Arguments a) {
    a.measure.models = parseModels(a.models, a.measure.shadowMap);
    a.measure.only = !a.models.empty();
    dropRepeats(a.measure.lightRadii);
    refuseToReplaceInput(a.scene, a.json);
    if (!a.json.empty()) requireWritable(a.json);
    Measurement result;
    std::vector<std::string> notes;
    {
        ProgressBar bar("comparing");
        Scene scene = a.reading.load(a.scene);
        if (a.measure.bounces > 0 && a.albedo.empty()) loadTextures(scene, TexturesFor::Pictures);
        if (hasVisibility(scene)) {
            const Asset asset = toAsset(scene);
            for (const Model* model : a.measure.models)
                if (!model->fromVisibility && model != storedModel(asset.info))
                    throw Error(a.scene + ": does not hold the model " + std::string(model->name) + "; bake it with --model "
                                + std::string(model->name));
            notes = asset.scene.notes;
            if (const auto baked = bakedAlbedo(asset.info); baked && a.albedo.empty()) a.measure.albedo = {*baked, true};
            result = measureAsset(asset, a.measure, bar.callback());
        } else {
            notes = scene.notes;
            if (lostVisibility(scene)) notes.push_back("it was baked, but its visibility is gone: the models are made anew");
            result = measureScene(scene, a.measure, bar.callback());
        }
    }
    nlohmann::ordered_json json = toJson(result);
    if (!notes.empty()) json["notes"] = notes;
    if (!a.json.empty()) writeTextFile(a.json, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    print(result, a.measure.lightRadii);
    printNotes(notes);
}

}  // namespace

void addCompareCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("compare", "the error of each model against ray-traced truth");
    command.footer(
        "Of a scene, the models are made at the receivers themselves: the model's own error. Of a baked asset they are\n"
        "interpolated from what it stores, as the renderer does: the whole error.\n"
        "Example: apertura compare builtin:statue --models aperture,soft --light-radii 1,5");
    command.add_option("SCENE", a->scene, "a scene as for bake, or a baked asset")->required();
    command.add_option("--models", a->models, modelNames() + ", and the baseline shadow-map [all]")->delimiter(',')->type_name("A,B,...");
    command.add_option("--light-radii", a->measure.lightRadii, "degrees [0.27,1,5,15,30]")
        ->delimiter(',')
        ->check(finiteRange(0.01, 45.0))
        ->type_name("D,D,...");
    command.add_option("--receivers", a->measure.receivers, "points on the surface [600]")->check(CLI::Range(1, 1000000))->type_name("N");
    command.add_option("--tolerance", a->measure.tolerance, "of the model auto: RMSE [0.05]")
        ->check(finiteRange(1e-6, 1e6))
        ->type_name("RMSE");
    command
        .add_option("--bounces", a->measure.bounces,
                    "let light bounce so often, from surface to surface, in the truth of the sky: the ambient errors are then those "
                    "against that, without and with what surfaces reflect [0]")
        ->check(CLI::Range(0, 1000))
        ->type_name("N");
    command
        .add_option("--albedo", a->albedo,
                    "with --bounces: what all surfaces reflect, in place of their materials' base colours, 0..1 [theirs; 0.8 of files "
                    "without materials]")
        ->check(isAlbedo())
        ->type_name("A|R,G,B");
    command.add_option("--seed", a->measure.seed, "of the receivers and the rays [1]")->type_name("S");
    command.add_option("--threads", a->measure.threads, "[all cores]")->check(CLI::Range(1, 1024))->type_name("T");
    command.add_option("--json", a->json, "write the table here too")->type_name("OUT");
    a->reading.addTo(command);
    command.callback([a, &command] {
        if (command.count("--tolerance") > 0) requireAuto(a->models);
        if (!a->albedo.empty() && a->measure.bounces == 0) throw CLI::ValidationError("--albedo is for --bounces");
        if (!a->albedo.empty()) a->measure.albedo = {*albedoIn(a->albedo), true};
        run(*a);
    });
}

}  // namespace apertura
