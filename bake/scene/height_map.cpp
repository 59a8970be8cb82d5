#include "apertura/bake/scene/height_map.h"

#include <Imath/half.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "apertura/bake/scene/height_mesh.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();
constexpr float kHighest = 100e3f;                          // metres; Olympus Mons rises 22 km
constexpr float kDeepest = -11000;                          // metres; no sea is deeper
constexpr double kLeastSpacing = 1e-4, kMostSpacing = 1e7;  // metres
constexpr int kLongestSide = 1 << 20;                       // texels
constexpr float kFarthest = 1e7f;                           // metres, beyond which no height is believed
constexpr double kMostTexelsAByte = 4096;                   // four times what deflate reaches on zeros
constexpr double kBytesAVertex = 450;                       // of a mesh with two triangles per vertex; measured while baking
constexpr double kBytesATexel = 16;                         // of a field, while it is read
constexpr int64_t kMostTexels = int64_t(1) << 32;
constexpr size_t kMostVertices = size_t(1) << 26;  // 8192 squared; more would not fit into a .glb

std::string oneLine(std::string cause) {
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    while (!cause.empty() && cause.back() == ' ') cause.pop_back();
    return cause.empty() ? "damaged" : cause;
}

// One component as the file stores it: integers keep their value and are not scaled to 0..1.
double component(const unsigned char* bytes, const OIIO::TypeDesc& type) {
    auto load = [bytes](auto value) {
        std::memcpy(&value, bytes, sizeof value);
        return double(value);
    };
    switch (type.basetype) {
        case OIIO::TypeDesc::UINT8: return load(uint8_t{});
        case OIIO::TypeDesc::INT8: return load(int8_t{});
        case OIIO::TypeDesc::UINT16: return load(uint16_t{});
        case OIIO::TypeDesc::INT16: return load(int16_t{});
        case OIIO::TypeDesc::UINT32: return load(uint32_t{});
        case OIIO::TypeDesc::INT32: return load(int32_t{});
        case OIIO::TypeDesc::HALF: {
            half h;
            std::memcpy(&h, bytes, sizeof h);
            return float(h);
        }
        case OIIO::TypeDesc::FLOAT: return load(float{});
        case OIIO::TypeDesc::DOUBLE: return load(double{});
        default: throw Error("has an unknown pixel type");
    }
}

// OpenImageIO's name for the format, from the first bytes of the file. Without it OpenImageIO tries every format it knows.
std::string formatOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::string head(4, '\0');
    in.read(head.data(), 4);
    if (head == "\x89PNG") return "png";
    if (head == "\x76\x2F\x31\x01") return "openexr";
    const bool tiff = head.starts_with("II") || head.starts_with("MM");
    if (!tiff) throw Error("cannot be read as an image: it is no PNG, TIFF or EXR");
    return "tiff";
}

std::string inWords(const char* format, auto... values) {
    char text[200];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

// Throws Error if a height cannot be: Terrarium tiles, which pack heights differently, come out as mountains of 800 km when they are
// unpacked as Terrain-RGB.
void requirePlausible(const std::vector<float>& heights, const HeightMapOptions& options) {
    bool hasData = false;
    for (const float h : heights) {
        hasData = hasData || !std::isnan(h);
        char text[200];
        if (options.terrainRgb && std::abs(h) > kHighest * options.verticalScale) {
            std::snprintf(text, sizeof text,
                          "a height of %.0f km: its colours are not packed as Terrain-RGB (-10000 + 0.1 (65536 R + 256 G + B) m)",
                          h / options.verticalScale / 1000);
            throw Error(text);
        }
        if (std::abs(h) > kFarthest) {
            std::snprintf(text, sizeof text, "a height of %.3g m: if that means that there is no data, it does not say so", double(h));
            throw Error(text);
        }
    }
    if (!hasData) throw Error("has no data at any texel");
}

void send(const std::string& text, PipeWriter& out) { out.put(std::vector<char>(text.begin(), text.end())); }
std::string receiveText(PipeReader& in) {
    const std::vector<char> text = in.take<char>();
    return {text.begin(), text.end()};
}

}  // namespace

HeightMap readHeights(const std::string& path, const HeightMapOptions& options) {
    OIIO::ImageSpec hints, opened;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    auto in = OIIO::ImageInput::create(formatOf(path));
    if (in && !in->open(path, opened, hints)) {
        const std::string cause = in->geterror();
        throw Error("cannot be read as an image: " + oneLine(cause));
    }
    if (!in) throw Error("cannot be read as an image: " + oneLine(OIIO::geterror()));
    in->threads(1);  // a forked process has none of the pool that its parent may have started
    const OIIO::ImageSpec spec = in->spec();
    if (spec.width < 2 || spec.height < 2)
        throw Error("a height map needs at least 2 x 2 texels, this has " + std::to_string(spec.width) + " x "
                    + std::to_string(spec.height));
    const int64_t texels = int64_t(spec.width) * spec.height;
    const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height) + " texels are ";
    if (texels > kMostTexels || std::max(spec.width, spec.height) > kLongestSide) throw Error(size + "too many");
    // A file of a few bytes can claim any size.
    if (double(texels) > kMostTexelsAByte * double(std::filesystem::file_size(path)))
        throw Error(size + "more than a file of its size can hold");
    const int channels = spec.nchannels;
    if (options.terrainRgb && (channels < 3 || spec.format != OIIO::TypeDesc::UINT8)) throw Error("Terrain-RGB needs three 8-bit channels");
    if (!options.terrainRgb && channels > 2)
        throw Error("has " + std::to_string(channels)
                    + " channels where a height map has one; where colours pack heights as Terrain-RGB does, give --terrain-rgb");
    if (channels > 16) throw Error("has too many channels");

    // Reads one row of texels or of tiles at a time. Of 64-bit floats OpenImageIO 2.4 reads a single row as zeros, and says that all is
    // well: these are read whole.
    const bool whole = spec.tile_width <= 0 && spec.format == OIIO::TypeDesc::DOUBLE;
    const int rows = spec.tile_width > 0 ? std::clamp(spec.tile_height, 1, spec.height) : whole ? spec.height : 1;
    std::vector<unsigned char> raw(size_t(spec.width) * channels * spec.format.size() * rows);
    HeightMap map;
    map.field.width = spec.width, map.field.height = spec.height;
    std::vector<float>& heights = map.field.heights;
    float nothing = kVoid;
    double scale = 1, offset = 0;  // metres a number, and of 0
    if (in->format_name() == std::string("tiff")) {
        GeoTiff tags = readGeoTiff(path, spec.width, spec.height);
        nothing = tags.noData;
        scale = tags.scale, offset = tags.offset;
        map.georeference = std::move(tags.georeference);
        map.grid = std::move(tags.grid);
    }
    if (options.spacingX > 0) {
        map.field.spacingX = options.spacingX, map.field.spacingZ = options.spacingZ;
        const auto differs = [](double own, double given) { return own > 0 && std::abs(own / given - 1) > 0.01; };
        if (differs(map.grid.spacingX, options.spacingX) || differs(map.grid.spacingZ, options.spacingZ))
            map.notes.push_back(inWords("--spacing is taken, though the file says %.4g x %.4g m", map.grid.spacingX, map.grid.spacingZ));
        if (map.grid.isTurned) map.notes.push_back(map.grid.fault + ": the world lies as its rows and columns do");
    } else if (map.grid.spacingX > 0) {
        map.field.spacingX = map.grid.spacingX, map.field.spacingZ = map.grid.spacingZ;
        if (!map.grid.note.empty()) map.notes.push_back(map.grid.note);
    } else if (!map.grid.fault.empty()) {
        const bool saysHow = map.grid.isTurned || map.grid.fault.find("--spacing") != std::string::npos;
        throw Error(map.grid.fault + (saysHow ? "" : "; --spacing says how far apart its texels are"));
    } else {
        map.notes.push_back("texels are taken for 1 m apart and heights for metres: --spacing and --vertical-scale say otherwise");
    }
    for (int y = 0; y < spec.height; ++y) {
        if (y % rows == 0) {
            const int first = spec.y + y, end = spec.y + std::min(y + rows, spec.height);
            const bool read = spec.tile_width > 0
                                ? in->read_tiles(0, 0, spec.x, spec.x + spec.width, first, end, 0, 1, 0, channels, spec.format, raw.data())
                            : whole ? in->read_image(0, 0, 0, channels, spec.format, raw.data())
                                    : in->read_scanline(first, 0, spec.format, raw.data());
            if (!read) throw Error("cannot be read: " + oneLine(in->geterror()));
        }
        for (int x = 0; x < spec.width; ++x) {
            const size_t texel = size_t(y % rows) * spec.width + x;
            auto value = [&](int c) { return component(&raw[(texel * channels + c) * spec.format.size()], spec.format); };
            float height = float(options.terrainRgb ? -10000 + 0.1 * (65536 * value(0) + 256 * value(1) + value(2)) : value(0));
            const bool transparent = !options.terrainRgb && channels == 2 && value(1) == 0;
            if (height == nothing || !std::isfinite(height) || transparent) height = kVoid;
            heights.push_back(float((height * scale + offset) * options.verticalScale));
        }
    }
    for (const double spacing : {map.field.spacingX, map.field.spacingZ})
        if (!(spacing >= kLeastSpacing && spacing <= kMostSpacing))
            throw Error(inWords("texels %.4g m apart: %g to %g can be", spacing, kLeastSpacing, kMostSpacing));
    if (scale != 1 || offset != 0) map.notes.push_back(inWords("a height is %.6g times the file's number, and %.6g m more", scale, offset));
    requirePlausible(heights, options);
    const float lowest = *std::min_element(heights.begin(), heights.end(),
                                           [](float a, float b) { return a < b || (std::isnan(b) && !std::isnan(a)); });
    if (std::isnan(nothing) && lowest < kDeepest)
        map.notes.push_back(inWords("its lowest height is %g m: if that means that there is no data, it does not say so", double(lowest)));
    return map;
}

HeightMap loadHeights(const std::string& path, const HeightMapOptions& options) {
    requireOrdinaryFile(path);
    HeightMap map;
    const auto work = [&](PipeWriter& out) {
        const HeightMap read = readHeights(path, options);
        out.put(std::vector{read.field.width, read.field.height});
        out.put(std::vector{read.field.spacingX, read.field.spacingZ, read.grid.spacingX, read.grid.spacingZ, read.grid.latitude,
                            double(read.grid.isGeographic), double(read.grid.isTurned)});
        for (const std::string& text : {read.grid.fault, read.grid.note}) send(text, out);
        out.put(std::vector{read.notes.size()});
        for (const std::string& note : read.notes) send(note, out);
        read.georeference.send(out);
        out.put(read.field.heights);
    };
    const auto receive = [&](PipeReader& in) {
        const std::vector<int> size = in.take<int>();
        requireMemory(path, std::to_string(size.at(0)) + " x " + std::to_string(size.at(1)) + " texels",
                      double(size.at(0)) * size.at(1) * kBytesATexel);
        const std::vector<double> grid = in.take<double>();
        map.field.width = size.at(0), map.field.height = size.at(1);
        map.field.spacingX = grid.at(0), map.field.spacingZ = grid.at(1);
        map.grid = {grid.at(2), grid.at(3), grid.at(4), grid.at(5) != 0, {}, {}, grid.at(6) != 0};
        map.grid.fault = receiveText(in), map.grid.note = receiveText(in);
        for (size_t i = 0, count = in.take<size_t>().at(0); i < count; ++i) map.notes.push_back(receiveText(in));
        map.georeference = Georeference::receive(in);
        map.field.heights = in.take<float>();
        if (map.field.heights.size() != map.field.texels()) throw Error("its heights were lost");
    };
    runIsolated(path, limitsFor(path, 10), work, receive);
    return map;
}

void requireMeshable(const std::string& name, const HeightField& field) {
    const std::string size = std::to_string(field.width) + " x " + std::to_string(field.height) + " texels";
    if (field.texels() > kMostVertices) throw Error(name + ": " + size + " are more than an asset can hold");
    requireMemory(name, "the mesh of " + size, kBytesAVertex * double(field.texels()));
}

Scene terrainScene(const std::string& name, std::vector<Surface> surfaces) {
    Scene scene;
    scene.name = name;
    scene.isTerrain = true;
    scene.surfaces = std::move(surfaces);
    for (size_t i = 0; i < scene.surfaces.size(); ++i) scene.instances.push_back({int(i)});
    validate(scene);
    return scene;
}

Scene loadHeightMap(const std::string& path, const HeightMapOptions& options, Coordinates coordinates) {
    const HeightMap map = loadHeights(path, options);
    requireMeshable(path, map.field);
    Surface surface = fullMesh(map.field);
    if (coordinates == Coordinates::Ignore) surface.coordinates.clear(), surface.grid = {0, 0};
    Scene scene = terrainScene(path, {std::move(surface)});
    scene.notes = map.notes;
    return scene;
}

}  // namespace apertura
