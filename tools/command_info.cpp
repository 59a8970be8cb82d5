#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "apertura/bake/fit/rounding.h"
#include "apertura/bake/sampling/samples.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/runtime/asset/texels.h"
#include "apertura/sh/packing.h"
#include "apertura/sh/shading.h"
#include "tools/commands.h"

namespace apertura {
namespace {

constexpr size_t kImagesShown = 4;  // of whose images the size is printed

// The choices of `auto`: the fraction of vertices and samples with each model, and of those where none came within the tolerance.
nlohmann::ordered_json describeChoices(const Asset& asset) {
    std::vector<size_t> counts(models().size());
    size_t all = 0, unreached = 0;
    for (const SeenByInstance& seen : asset.seen)
        for (const auto* points : {&seen.allParams, &seen.faces.allParams})
            for (const ModelParams& params : *points) {
                ++all;
                ++counts[size_t(chosenModel(models()[APERTURA_MODEL_AUTO], params).id)];
                unreached += aperturaChoiceIn(params[APERTURA_CHOICE_SLOT]).outOfReach;
            }
    nlohmann::ordered_json shares = nlohmann::json::object();
    double numbers = 0;
    // Numbers that the light's formula reads, of vertices and of samples.
    const auto meanOf = [&](const auto& paramsOf) {
        double sum = 0, points = 0;
        for (const SeenByInstance& seen : asset.seen)
            for (const ModelParams& params : paramsOf(seen)) sum += chosenModel(models()[APERTURA_MODEL_AUTO], params).numbers, points += 1;
        return points > 0 ? sum / points : 0.0;
    };
    const double atVertices = meanOf([](const SeenByInstance& seen) -> const auto& { return seen.allParams; });
    const double onFaces = meanOf([](const SeenByInstance& seen) -> const auto& { return seen.faces.allParams; });
    for (const Model* model : autoModels()) {
        const double share = double(counts[size_t(model->id)]) / double(std::max<size_t>(all, 1));
        shares[std::string(model->name)] = share;
        numbers += share * model->numbers;
    }
    return {{"tolerance", asset.info.tolerance},
            {"price", asset.info.price.empty() ? "numbers" : asset.info.price},
            {"alone", asset.info.alone},
            {"numbers_per_vertex", atVertices},
            {"numbers_per_sample", onFaces},
            {"numbers_per_point", numbers},
            {"shares", shares},
            {"unreached", double(unreached) / double(std::max<size_t>(all, 1))}};
}

nlohmann::ordered_json describe(const std::string& file) {
    if (!file.ends_with(".glb") && !file.ends_with(".gltf"))
        throw Error(file + ": is no asset, which is a .glb; make one of it with `apertura bake`");
    const Asset asset = loadAsset(file);
    size_t vertices = 0, closed = 0;
    double area = 0, cap = 0;
    for (const SeenByInstance& seen : asset.seen)
        for (const Visibility& v : seen.visibility) {
            ++vertices;
            closed += v.area <= 0;
            area += v.area / (2 * std::numbers::pi);
            cap += capness(v);
        }
    size_t samples = 0;
    nlohmann::ordered_json bySteps = nlohmann::json::object();
    for (int level = 1; level <= APERTURA_MAX_LATTICE_LEVEL; ++level) {
        size_t count = 0;
        for (const SeenByInstance& seen : asset.seen)
            for (const uint8_t own : seen.faces.levels)
                count += own == level ? size_t(aperturaLatticeSize(aperturaLatticeSteps(level))) : 0;
        if (count > 0) bySteps[std::to_string(aperturaLatticeSteps(level))] = count;
        samples += count;
    }
    nlohmann::ordered_json images = nlohmann::json::array();
    size_t imageBytes = 0;
    for (size_t i = 0; i < asset.seen.size(); ++i) {
        const SeenOnTexels& texels = asset.seen[i].texels;
        if (texels.visibility.empty()) continue;
        images.push_back({texels.width, texels.height});
        imageBytes += texels.bytes;
    }
    const PackingError error = packingError(asset.info.bits);
    const Model* const stored = storedModel(asset.info);
    nlohmann::ordered_json out{{"file", file},
                               {"version", asset.info.version},
                               {"model", asset.info.model},
                               {"rays", asset.info.rays},
                               {"azimuths", asset.info.azimuths},
                               {"mesh_error", asset.info.meshError},
                               {"seed", asset.info.seed},
                               {"max_distance", asset.info.maxDistance},
                               {"hemisphere", asset.info.hemisphere},
                               {"instances", asset.scene.instances.size()},
                               {"vertices", vertices},
                               {"triangles", triangleCount(asset.scene)},
                               {"bits", asset.info.bits},
                               {"bytes_per_vertex", bytesAPoint(asset)},
                               {"visibility_bytes", visibilityBytes(asset)},
                               {"at", asset.info.at},
                               {"samples", samples},
                               {"samples_by_steps", bySteps},
                               {"images", images},
                               {"image_bytes", imageBytes},
                               {"bent_normals", asset.info.bentNormals},
                               {"unmet_area", asset.info.unmetArea},
                               {"mean_open", area / double(vertices)},
                               {"mean_capness", cap / double(vertices)},
                               {"closed_vertices", closed},
                               {"error_bounds",
                                {{"area_of_hemisphere", error.area},
                                 {"direction", error.direction},
                                 {"direction_degrees_of_a_cap", std::asin(error.direction / 0.5) * 180 / std::numbers::pi},
                                 {"radius_degrees", error.radius * 180 / std::numbers::pi}}}};
    if (stored)
        if (const ParamsError own = paramsError(*stored, asset.info.bits); own.axis > 0) {
            const double farther = asset.info.packing == 1 ? 1 : roundedFarther(*stored, asset.info.bits),
                         degrees = farther * 180 / std::numbers::pi;
            out["error_bounds"]["model"] = {
                {"axis_degrees", own.axis * degrees}, {"edge_degrees", own.edge * degrees}, {"chosen_together", farther > 1}};
        }
    if (asset.info.rays > 0 && asset.info.azimuths == 0) {
        const RaysError rays = raysError(asset.info.rays);
        out["rays_add"] = {{"area_of_hemisphere", rays.area}, {"direction_degrees", rays.direction * 180 / std::numbers::pi}};
    }
    out["ray_offset"] = asset.info.rayOffset;
    if (hasBounces(asset)) out["bounce"] = asset.info.bounce, out["bounce_bytes"] = bytesOfBounces(asset);
    if (asset.info.model == "auto") out["auto"] = describeChoices(asset);
    if (!asset.scene.notes.empty()) out["notes"] = asset.scene.notes;
    return out;
}

void print(const nlohmann::ordered_json& d) {
    const auto text = [&](const char* key) { return printable(d[key].get<std::string>()); };
    std::printf("%s: baked by Apertura %s\n", text("file").c_str(), text("version").c_str());
    if (const int azimuths = d["azimuths"].get<int>(); azimuths > 0)
        std::printf("  model         %s, swept along %d azimuths, hemisphere about the %s\n", text("model").c_str(), azimuths,
                    text("hemisphere").c_str());
    else
        std::printf("  model         %s, %d rays a vertex, seed %u, hemisphere about the %s\n", text("model").c_str(), d["rays"].get<int>(),
                    d["seed"].get<unsigned>(), text("hemisphere").c_str());
    if (d["max_distance"].get<double>() > 0) std::printf("  max distance  %g m\n", d["max_distance"].get<double>());
    std::printf("  geometry      %zu vertices, %zu triangles, %zu instances\n", d["vertices"].get<size_t>(), d["triangles"].get<size_t>(),
                d["instances"].get<size_t>());
    if (const double error = d["mesh_error"].get<double>(); error > 0)
        std::printf("                the texels of its map lie at most %.3g m above or below it\n", error);
    std::printf("  stored        %.3g bytes a vertex, %d bits a number; %zu bytes of visibility in all\n",
                d["bytes_per_vertex"].get<double>(), d["bits"].get<int>(), d["visibility_bytes"].get<size_t>());
    if (d["samples"].get<size_t>() > 0) {
        std::printf("  on faces      %zu samples, on lattices of", d["samples"].get<size_t>());
        const char* comma = " ";
        for (const auto& [steps, count] : d["samples_by_steps"].items())
            std::printf("%s%s steps: %zu", std::exchange(comma, ", "), steps.c_str(), count.get<size_t>());
        std::printf("\n");
        if (d["unmet_area"].get<double>() > 0)
            std::printf("                %.3g %% of the surface errs more than was asked for\n", 100 * d["unmet_area"].get<double>());
    }
    if (const auto& images = d["images"]; !images.empty()) {
        std::printf("  in images     of");
        for (size_t i = 0; i < std::min<size_t>(images.size(), kImagesShown); ++i)
            std::printf("%s %d x %d", i > 0 ? "," : "", images[i][0].get<int>(), images[i][1].get<int>());
        if (images.size() > kImagesShown) std::printf(" and %zu more", images.size() - kImagesShown);
        std::printf(" texels; %zu bytes as PNG\n", d["image_bytes"].get<size_t>());
    }
    if (d.contains("bounce"))
        std::printf("  bounces       what surfaces reflect, by %s; %zu bytes more\n",
                    text("bounce") == "materials" ? "their materials" : ("an albedo of " + text("bounce")).c_str(),
                    d["bounce_bytes"].get<size_t>());
    if (d["bent_normals"].get<int>() > 0)
        std::printf("  for engines   bent normals and occlusion of %d instances, an image of each\n", d["bent_normals"].get<int>());
    if (d.contains("notes"))
        for (const auto& note : d["notes"]) std::printf("  note          %s\n", printable(note.get<std::string>()).c_str());
    if (d.contains("auto")) {
        const auto& a = d["auto"];
        std::printf("  needs         least model within %g, by %s:", a["tolerance"].get<double>(),
                    printable(a["price"].get<std::string>()).c_str());
        const char* between = " ";
        for (const auto& [name, share] : a["shares"].items())
            if (share.get<double>() > 0)
                std::printf("%s%s on %.3g %%", std::exchange(between, ", "), name.c_str(), 100 * share.get<double>());
        const std::string alone = printable(a["alone"].get<std::string>());
        std::printf("%s%s\n", alone.empty() ? "" : "; as one model for the whole scene: ", alone.c_str());
        std::printf("  reads         %.3g numbers a vertex", a["numbers_per_vertex"].get<double>());
        if (const double onFaces = a["numbers_per_sample"].get<double>(); onFaces > 0)
            std::printf(", %.3g a sample on faces, %.3g of all of them", onFaces, a["numbers_per_point"].get<double>());
        std::printf("\n");
        if (a["unreached"].get<double>() > 0)
            std::printf(
                "                at %.2g %% of these points no model comes within the tolerance; they have the best. It is of each point: "
                "the RMSE of the whole surface may be within it all the same\n",
                100 * a["unreached"].get<double>());
        else
            std::printf("                the tolerance is within reach at every point\n");
    }
    std::printf("  visibility    %.3f of the hemisphere open on average, capness %.3f (1: it is one cap), %zu vertices closed\n",
                d["mean_open"].get<double>(), d["mean_capness"].get<double>(), d["closed_vertices"].get<size_t>());
    const auto& e = d["error_bounds"];
    std::printf(
        "  error bounds  of the bytes alone: area %.5f of the hemisphere, direction %.5f of D/A (%.3f degrees for a cap), radius %.3f "
        "degrees\n",
        e["area_of_hemisphere"].get<double>(), e["direction"].get<double>(), e["direction_degrees_of_a_cap"].get<double>(),
        e["radius_degrees"].get<double>());
    if (e.contains("model"))
        std::printf(
            "                of the model's: axes %.3f degrees, edges %.3f degrees, more where they are far from the middle of the sky%s\n",
            e["model"]["axis_degrees"].get<double>(), e["model"]["edge_degrees"].get<double>(),
            e["model"]["chosen_together"].get<bool>() ? "; chosen together so that light of 5 degrees errs by some .003 (RMS)" : "");
    if (d.contains("rays_add"))
        std::printf(
            "  rays add      about %.2g of the hemisphere in area and %.2g degrees in direction (RMS; up to six times as much at some "
            "points)\n",
            d["rays_add"]["area_of_hemisphere"].get<double>(), d["rays_add"]["direction_degrees"].get<double>());
    if (d.contains("rays_add") && d["ray_offset"].get<double>() > 0)
        std::printf("                and start up to %.2g m above the surface: what lies nearer does not block them\n",
                    d["ray_offset"].get<double>());
}

}  // namespace

void addInfoCommand(CLI::App& program) {
    struct Arguments {
        std::string file;
        bool json = false;
    };
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("info", "what an asset stores, its size a vertex, its error bounds");
    command.footer("Example: apertura info statue.glb");
    command.add_option("FILE", a->file, "a baked .glb")->required();
    command.add_flag("--json", a->json, "as JSON");
    command.callback([a] {
        const auto description = describe(a->file);
        if (a->json)
            std::printf("%s\n", description.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
        else
            print(description);
    });
}

}  // namespace apertura
