#include <cstdio>
#include <filesystem>

#include "apertura/bake/fit/bounce.h"
#include "apertura/bake/fit/faces.h"
#include "apertura/bake/fit/terrain.h"
#include "apertura/bake/fit/texels.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/image_files.h"
#include "apertura/runtime/asset/materials.h"
#include "tools/commands.h"
#include "tools/terminal.h"
#include "tools/terrain.h"

namespace apertura {
namespace {

constexpr double kManyShared = 0.01;  // fraction of texels that two charts share, from which a warning is printed
constexpr double kNearlyAll = 0.95;   // fraction of vertices without sky from which a warning is printed

struct Arguments {
    std::string scene, out, model = "sh", drawnAs, whyRays;
    SceneOptions reading;
    BakeOptions bake;
    int bits = 8;
    bool isSwept = false;   // a height map, without rays
    double meshError = -1;  // metres; negative: meshToSweep's own
    std::string price, at, as = "visibility", images, engine, albedo;
    bool bounce = false;
};

// Refuses, before anything is traced, names of images that cannot be written, or that are the scene's own.
void requireImageFiles(const Arguments& a, const Scene& scene, ImageFormat format) {
    const std::vector<std::string> names = imageFiles(a.out, scene.instances.size(), a.bake.as == As::BentNormals, format);
    if (names.size() > kMostImageFiles)
        throw Error(a.scene + ": --images would write " + std::to_string(names.size()) + " files, more than "
                    + std::to_string(kMostImageFiles));
    std::vector<std::string> own{a.scene};
    if (scene.document)
        for (const std::filesystem::path& file : filesOf(*scene.document, std::filesystem::path(a.scene).parent_path()))
            own.push_back(file);
    for (const std::string& name : names) {
        for (const std::string& file : own) refuseToReplaceInput(file, name);
        requireWritable(name);
    }
}

void printSwept(const Arguments& a, const HeightField& field, const Scene& scene, const BakeInfo& info, const TerrainReport& report,
                size_t vertices, double bytes) {
    std::printf("%s: %d x %d texels, swept along %d azimuths; %zu vertices, %zu triangles", a.out.c_str(), field.width, field.height,
                report.azimuths, vertices, triangleCount(scene));
    if (info.at == "texels")
        std::printf(", from which the texels lie at most %.3g m away\n", info.meshError);
    else
        std::printf(", %.3g bytes a vertex\n", bytes);
    printNotes(scene.notes);
    if (info.model != "sh") return;
    std::printf(
        "  the sweep errs by %.3g of the hemisphere in area and %.3g degrees in direction (RMS at some texels, by exact horizons)\n",
        report.areaError, report.directionError);
    if (report.areaError > a.bake.error)
        std::printf("  more azimuths would not bring it to the %.3g of --error: lines beside a texel see what it does not\n", a.bake.error);
}

void run(const Arguments& a) {
    if (std::filesystem::path(a.out).extension() != ".glb") throw CLI::ValidationError("-o " + a.out + " does not end in .glb");
    refuseToReplaceInput(a.scene, a.out);
    // Fail now, and not after the rays are traced, if the output cannot be written.
    requireWritable(a.out);
    BakeInfo info;
    info.scene = a.scene.starts_with("builtin:") ? a.scene : std::filesystem::path(a.scene).filename().string();
    requireStorable(info, a.scene);
    const ImageFormat format = a.images == "exr" ? ImageFormat::Exr : ImageFormat::Png;
    HeightMap map;
    Scene scene;
    if (a.isSwept) {
        a.reading.check(a.scene);
        map = loadHeights(a.scene, a.reading.heights);
        scene = meshToSweep(a.scene, map, a.bake.at == At::Texels, a.meshError, info.meshError);
    } else {
        scene = a.reading.load(a.scene, a.bake.at == At::Texels ? Coordinates::Read : Coordinates::Ignore);
    }
    if (!a.images.empty()) requireImageFiles(a, scene, format);
    info.version = APERTURA_VERSION;
    info.model = a.model;
    info.rays = a.bake.rays;
    info.bits = a.bits;
    info.seed = a.bake.seed;
    info.maxDistance = a.bake.maxDistance;
    BakedVisibility visibility;
    MeshIssues issues;
    AutoPlan plan{};
    FaceReport report;
    TexelReport texels;
    TerrainReport swept;
    BounceReport bounced;
    if (a.bounce) {
        loadTextures(scene, TexturesFor::Pictures);
        info.bounce = !a.albedo.empty() ? a.albedo : scene.materials.empty() ? "0.8" : "materials";
    }
    {
        ProgressBar bar("baking");
        const Progress progress = bar.callback();
        if (a.isSwept) {
            visibility = bakeTerrain(scene, map.field, a.bake, {0, a.bake.threads}, progress, &plan, &swept);
            info.azimuths = swept.azimuths;
            if (a.model == "sh") info.rays = 0;
        } else {
            const Tracer tracer(scene, progress);
            info.rayOffset = tracer.offset();
            visibility = bakeScene(scene, tracer, a.bake, part(progress, 0, a.bounce ? 0.5 : 1), &issues, &plan, &report, &texels);
            if (a.bounce) {
                BounceOptions options{.rays = a.bake.rays, .seed = a.bake.seed, .threads = a.bake.threads};
                if (!a.albedo.empty()) options.albedo = {*albedoIn(a.albedo), true};
                bounced = bakeBounces(scene, tracer, visibility, options, part(progress, 0.5, 1));
            }
        }
    }
    info.at = a.bake.at == At::Faces ? "faces" : a.bake.at == At::Texels && a.bake.as == As::Visibility ? "texels" : "vertices";
    info.unmetArea = report.unmet;
    if (a.model == "auto") {
        info.tolerance = a.bake.tolerance;
        info.price = a.price.empty() ? "numbers" : a.price;
        info.alone = plan.alone ? plan.alone->name : "none";
    }
    std::vector<std::unique_ptr<PendingFile>> images;
    if (!a.images.empty()) images = pendingImages(a.out, scene, visibility, a.bits, format);
    writeAsset(a.out, scene, visibility, info);
    for (const auto& image : images) image->commit();
    size_t vertices = 0, closed = 0;
    for (const SeenByInstance& seen : visibility) {
        vertices += seen.visibility.size();
        for (const Visibility& v : seen.visibility) closed += v.area <= 0;
    }
    const double bytes = bytesAPoint({{}, std::move(visibility), info});
    if (a.isSwept)
        printSwept(a, map.field, scene, info, swept, vertices, bytes);
    else
        std::printf("%s: %zu vertices, %zu triangles, %d rays a vertex, %.3g bytes a vertex\n", a.out.c_str(), vertices,
                    triangleCount(scene), a.bake.rays, bytes);
    const auto little = [](double error) {
        char text[32];
        std::snprintf(text, sizeof text, "%.3g", error);
        return error > 0 ? std::string(text) : "too little to tell";
    };
    if (report.samples > 0)
        std::printf(
            "  %zu samples on faces. Between what is stored a light of 5 degrees errs by %s beside the model's own error, and the sky by "
            "%s "
            "(wanted: %.3g and %.3g)\n  %.3g times the rays of all vertices and samples were traced, to decide where those are\n",
            report.samples, little(report.error).c_str(), little(report.skyError).c_str(), report.tolerance, report.skyTolerance,
            double(report.rays + vertices * size_t(a.bake.rays)) / (double(vertices + report.samples) * a.bake.rays));
    if (bounced.passes > 0)
        std::printf(
            "  surfaces reflect %.3g of a sky of one radiance on average; %d bounces followed; all further ones, estimated, add %.2g "
            "(RMS)\n",
            bounced.mean, bounced.passes, bounced.left);
    if (texels.images > 0) {
        std::printf("  %zu %s%s of %zu texels, of which %.3g %% are drawn\n", texels.images, texels.images == 1 ? "image" : "images",
                    a.bake.as == As::BentNormals ? " of bent normals, and as many of occlusion," : "", texels.texels,
                    100 * double(texels.drawn) / double(texels.texels));
        if (texels.shared > kManyShared)
            std::printf(
                "  %.3g %% of those are read on two charts, which see what the other one does: more texels, or more room between charts, "
                "would part "
                "them\n",
                100 * texels.shared);
    }
    if (report.overfull)
        std::printf("  the vertices alone take more than --max-bytes %.10g\n", a.bake.maxBytes);
    else if (report.full)
        std::printf("  finer samples would take more than --max-bytes %.10g\n", a.bake.maxBytes);
    if (report.unmet > 0)
        std::printf("  %.3g %% of the surface errs more than is wanted%s\n", 100 * report.unmet,
                    report.full || report.overfull ? "" : "; finer samples would gain it too little for the bytes they take");
    if (report.buried > 0) std::printf("  %.3g %% of the surface lies inside solids and gets no samples\n", 100 * report.buried);
    if (double(closed) > kNearlyAll * double(vertices))
        std::printf("  %zu of %zu vertices see nothing of the sky: a closed room, or faces that are wound inside out\n", closed, vertices);
    if (!a.whyRays.empty())
        std::printf("  %s asks for rays; without it a height map is swept, which is faster by far\n", a.whyRays.c_str());
    if (!a.drawnAs.empty())
        std::printf("  %s is made from the four numbers when it is drawn: they are what was stored, as by --model %s\n", a.drawnAs.c_str(),
                    a.model.c_str());
    if (!a.isSwept) printNotes(scene.notes);
    for (const std::string& line : describe(issues)) std::printf("  %s\n", line.c_str());
}

// What to store for a model: of those that are made from the four numbers when they are drawn, these.
const Recipe* recipeNamed(const std::string& name) {
    const Model* const model = findModel(name);
    return model && model->fromVisibility ? &recipeFor(*model) : findRecipe(name);
}

std::string whyNoRecipe(const std::string& name) {
    std::string names;
    for (const Recipe& recipe : recipes()) names += (names.empty() ? "" : ", ") + std::string(recipe.name);
    return "there is no model '" + name + "' (there are " + names + ")";
}

}  // namespace

void addBakeCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("bake", "ray trace what a scene sees of the sky, into a glTF asset");
    std::string names, fromFour;
    for (const Model& model : models())
        if (model.fromVisibility && !model.baseline && !findRecipe(model.name))
            fromFour += (fromFour.empty() ? "" : ", ") + std::string(model.name);
    for (const Recipe& recipe : recipes()) {
        names += "  ";
        names += recipe.name;
        names += std::string(recipe.name.size() < 12 ? 12 - recipe.name.size() : 1, ' ');
        names += recipe.what;
        names += '\n';
    }
    command.footer(
        "Models:\n" + names + "  " + fromFour
        + " are made from the four numbers of sh when they are drawn\nExample: apertura bake statue.obj -o statue.glb --rays 1024");
    command.add_option("SCENE", a->scene, ".glb .gltf .obj .ply .stl, a height map .png .tif .exr, or builtin:NAME")->required();
    command.add_option("-o", a->out, "the asset, .glb")->required()->type_name("OUT.glb");
    command
        .add_option("--rays", a->bake.rays,
                    "rays a vertex and a sample [256; 1024 of models with hard edges, which fewer rays misplace: firm-N, soft-2, multi-N, "
                    "cap-anti, anti]")
        ->check(CLI::Range(1, 1 << 20))
        ->type_name("N");
    command.add_option("--bits", a->bits, "bits a component: 8 for 4 bytes a vertex, 16 for 8 [8]")
        ->check(CLI::IsMember({8, 16}))
        ->type_name("8|16");
    command.add_option("--max-distance", a->bake.maxDistance, "metres beyond which nothing blocks [no limit]")
        ->check(finiteRange(1e-30, 1e30))
        ->type_name("M");
    command.add_option("--seed", a->bake.seed, "of the rays' patterns [1]")->type_name("S");
    command.add_option("--threads", a->bake.threads, "[all cores]; the result is the same for any number")
        ->check(CLI::Range(1, 1024))
        ->type_name("T");
    command.add_option("--model", a->model, "what to store, of the models below [sh]")
        ->check(CLI::Validator([](std::string& name) { return recipeNamed(name) ? "" : whyNoRecipe(name); }, ""))
        ->type_name("NAME");
    command
        .add_option("--tolerance", a->bake.tolerance,
                    "of the model auto: RMSE of E / (L pi sin^2 r) at light radii 5 and 15 degrees [0.05]")
        ->check(finiteRange(1e-6, 1e6))
        ->type_name("RMSE");
    command
        .add_option(
            "--price", a->price,
            "of the model auto, what to spend least of: numbers that the formula reads, bytes stored, or a shader's cycles [numbers]")
        ->check(CLI::IsMember({"numbers", "bytes", "cycles"}))
        ->type_name("numbers|bytes|cycles");
    command
        .add_option("--at", a->at,
                    "where to store it: vertices; faces: samples on the faces too that these do not suffice for; or texels: "
                    "images over the second set of texture coordinates, else the first [faces]")
        ->check(CLI::IsMember({"vertices", "faces", "texels"}))
        ->type_name("vertices|faces|texels");
    command.add_option("--texels", a->bake.texels, "of each image, across and down, with --at texels [256]")
        ->check(CLI::Range(2, 8192))
        ->type_name("N");
    command
        .add_option("--as", a->as,
                    "what images hold: visibility; or bent-normal: what engines read today, a bent normal in tangent space and occlusion, "
                    "the latter as the materials' occlusionTexture [visibility]")
        ->check(CLI::IsMember({"visibility", "bent-normal"}))
        ->type_name("visibility|bent-normal");
    command
        .add_option("--images", a->images,
                    "images beside the asset too: OUT.visibility.png, or .bent-normal.png and .occlusion.png; as .exr, the numbers "
                    "themselves in half floats, -1..1 [none]")
        ->check(CLI::IsMember({"png", "exr"}))
        ->type_name("png|exr");
    command
        .add_option(
            "--storage-tolerance", a->bake.storageTolerance,
            "RMSE of E / (L pi sin^2 r), at a light radius of 5 degrees, and of the sky's E / pi, that storing may add [half of what "
            "the model errs; of the sky .012]")
        ->check(finiteRange(1e-6, 1e6))
        ->type_name("RMSE");
    command
        .add_option("--max-bytes", a->bake.maxBytes, "that visibility may take in the file; what --bounce stores comes on top [no limit]")
        ->check(finiteRange(1, 1e12))
        ->type_name("N");
    command.add_flag("--bounce", a->bounce,
                     "store what surfaces reflect, too: 8 bytes a vertex and 6 a sample on faces, for render and view --bounces");
    command
        .add_option("--albedo", a->albedo,
                    "with --bounce: what all surfaces reflect, in place of their materials' base colours, 0..1 [theirs; 0.8 of files "
                    "without materials]")
        ->check(isAlbedo())
        ->type_name("A|R,G,B");
    a->reading.addTo(command);
    const char* const group = "Height maps";
    command
        .add_option("--engine", a->engine,
                    "sweep: by horizons, into an image with a texel for each of the map's; models that are fitted, at its vertices, in "
                    "the directions of --rays. rays: as any mesh [sweep; rays where --rays of sh, --max-distance, --at faces or --as "
                    "bent-normal is given]")
        ->check(CLI::IsMember({"sweep", "rays"}))
        ->type_name("sweep|rays")
        ->group(group);
    command
        .add_option("--error", a->bake.error,
                    "the RMS error of the open area over 2 pi that the sweep aims at: azimuths are added until it is met [0.005]")
        ->check(finiteRange(1e-6, 1))
        ->type_name("E")
        ->group(group);
    command
        .add_option("--mesh-error", a->meshError, "metres that texels may lie above or below the mesh [a tenth of a texel's shorter side]")
        ->check(finiteRange(0, 1e9))
        ->type_name("M")
        ->group(group);
    command.callback([a, &command] {
        if (const Recipe* const recipe = recipeNamed(a->model); recipe->name != a->model && !findRecipe(a->model)) {
            a->drawnAs = a->model;
            a->model = recipe->name;
        }
        if (!a->price.empty() && a->model != "auto") throw CLI::ValidationError("--price is for --model auto");
        if (command.count("--tolerance") > 0 && a->model != "auto") throw CLI::ValidationError("--tolerance is for --model auto");
        if (!a->albedo.empty() && !a->bounce) throw CLI::ValidationError("--albedo is for --bounce");
        if (a->bounce && a->bake.maxDistance > 0) throw CLI::ValidationError("--bounce: light comes from beyond --max-distance, too");
        if (a->bounce && a->at == "texels")
            throw CLI::ValidationError("--bounce is for --at vertices and faces: images hold visibility alone");
        if (command.count("--texels") > 0 && a->at != "texels") throw CLI::ValidationError("--texels is for --at texels");
        if (command.count("--images") > 0 && a->at != "texels") throw CLI::ValidationError("--images is for --at texels");
        if (command.count("--as") > 0 && a->at != "texels") throw CLI::ValidationError("--as is for --at texels");
        if (command.count("--texels") > 0 && isHeightMap(a->scene))
            throw CLI::ValidationError("--texels is not for height maps, whose images have a texel for each of theirs");
        const std::string wantsRays = command.count("--rays") > 0 && a->model == "sh" ? "--rays"
                                    : command.count("--max-distance") > 0             ? "--max-distance"
                                    : a->at == "faces"                                ? "--at faces"
                                    : a->as == "bent-normal"                          ? "--as bent-normal"
                                    : a->bake.storageTolerance > 0                    ? "--storage-tolerance"
                                    : a->bake.maxBytes > 0                            ? "--max-bytes"
                                                                                      : "";
        if (!a->engine.empty() && !isHeightMap(a->scene)) throw CLI::ValidationError("--engine is for height maps");
        if (a->engine == "sweep" && !wantsRays.empty()) throw CLI::ValidationError(wantsRays + " is for --engine rays");
        a->isSwept = isHeightMap(a->scene) && (a->engine.empty() ? wantsRays.empty() : a->engine == "sweep");
        if (isHeightMap(a->scene) && a->engine.empty()) a->whyRays = wantsRays;
        if (command.count("--rays") == 0 && !a->isSwept) a->bake.rays = defaultRays(*findRecipe(a->model));
        if (a->bounce && a->isSwept) throw CLI::ValidationError("--bounce wants rays: --engine rays");
        for (const char* const own : {"--error", "--mesh-error"})
            if (command.count(own) > 0 && !a->isSwept)
                throw CLI::ValidationError(std::string(own) + " is for height maps that are swept"
                                           + (isHeightMap(a->scene) && !wantsRays.empty() ? ", and " + wantsRays + " asks for rays" : ""));
        if (command.count("--error") > 0 && findRecipe(a->model)->name != "sh")
            throw CLI::ValidationError("--error is for the model sh: others are fitted to 64 azimuths");
        if (a->isSwept && a->at.empty()) a->at = findRecipe(a->model)->name == "sh" ? "texels" : "vertices";
        if (a->isSwept && a->at == "texels" && findRecipe(a->model)->name != "sh")
            throw CLI::ValidationError("images hold the four numbers alone: --at vertices, or --model sh");
        if (command.count("--mesh-error") > 0 && a->at != "texels") throw CLI::ValidationError("--mesh-error is for --at texels");
        if (!a->at.empty() && a->at != "faces" && (a->bake.storageTolerance > 0 || a->bake.maxBytes > 0))
            throw CLI::ValidationError("--storage-tolerance and --max-bytes are for --at faces");
        a->bake.at = a->at == "vertices" ? At::Vertices : a->at == "texels" ? At::Texels : At::Faces;
        a->bake.as = a->as == "bent-normal" ? As::BentNormals : As::Visibility;
        a->bake.bits = a->bits;
        a->bake.price = a->price == "bytes" ? Price::Bytes : a->price == "cycles" ? Price::Cycles : Price::Numbers;
        a->model = findRecipe(a->model)->name;
        a->bake.recipe = findRecipe(a->model)->name;
        run(*a);
    });
}

}  // namespace apertura
