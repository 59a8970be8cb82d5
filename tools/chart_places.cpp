#include "tools/chart_places.h"

#include <sstream>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/fit/texels.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/texels.h"
#include "tools/commands.h"

namespace apertura {
namespace {

constexpr int kSides[] = {128, 256, 512};  // texels

// The sizes of images that a scene can have; none where its coordinates hold no image.
std::vector<int> sidesFor(const Scene& scene) {
    try {
        requireCharts(scene, kSides[0]);
    } catch (const Error&) {
        return {};
    }
    if (scene.surfaces[0].grid.x > 0) return {0};
    return {std::begin(kSides), std::end(kSides)};
}

double bytesOf(const Asset& asset) {
    if (!hasTexels(asset)) return double(visibilityBytes(asset));
    double sum = 0;
    for (size_t i = 0; i < asset.seen.size(); ++i) {
        sum += double(asset.seen[i].visibility.size()) * asset.info.bits / 2;
        const glm::mat3 toLocal = glm::transpose(rotationPart(asset.scene.instances[i].toWorld));
        sum += double(encodePng(visibilityImage(asset.seen[i].texels, toLocal, asset.info.bits)).size());
    }
    return sum;
}

}  // namespace

std::vector<PlaceRow> measurePlaces(const Scene& scene, MeasureOptions measure, const std::string& path, const Progress& progress) {
    std::vector<std::pair<const char*, int>> places{{"vertices", 0}, {"faces", 0}};
    for (const int side : sidesFor(scene)) places.emplace_back("texels", side);
    measure.models = {findModel("soft")};
    measure.only = true;
    measure.shadowMap = false;
    measure.lightRadii = {5};
    std::vector<PlaceRow> out;
    for (const auto& [at, side] : places) {
        const double done = double(out.size()), count = double(places.size());
        BakeOptions bake;
        bake.at = std::string_view(at) == "vertices" ? At::Vertices : std::string_view(at) == "faces" ? At::Faces : At::Texels;
        bake.texels = side > 0 ? side : bake.texels;
        bake.threads = measure.threads;
        BakeInfo info;
        info.version = APERTURA_VERSION;
        info.scene = scene.name;
        info.at = at;
        const PendingFile file(path);
        writeAsset(file.name(), scene, bakeScene(scene, Tracer(scene), bake, part(progress, done / count, (done + 0.7) / count)), info);
        const Asset asset = loadAsset(file.name());
        const MeasureRow row = measureAsset(asset, measure, part(progress, (done + 0.7) / count, (done + 1) / count)).rows.at(0);
        out.push_back({scene.name, at, side, bytesOf(asset), row.rmse, row.ambient, row.own});
    }
    return out;
}

std::string toCsv(const std::vector<PlaceRow>& rows) {
    std::ostringstream out;
    out.precision(6);
    out << "scene,at,texels,bytes,rmse,ambient_rmse,own_rmse\n";
    for (const PlaceRow& r : rows)
        out << inQuotes(r.scene) << ',' << r.at << ',' << r.texels << ',' << r.bytes << ',' << r.rmse << ',' << r.ambient << ',' << r.own
            << '\n';
    return out.str();
}

}  // namespace apertura
