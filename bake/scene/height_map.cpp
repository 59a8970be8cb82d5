#include "apertura/bake/scene/height_map.h"

#include <Imath/half.h>
#include <OpenImageIO/imageio.h>

#include <tiffio.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();
constexpr float kHighest = 100e3f;                 // metres; Olympus Mons rises 22 km
constexpr double kMostTexelsAByte = 4096;          // four times what deflate reaches on zeros
constexpr double kBytesAVertex = 450;              // of a mesh with two triangles per vertex; measured while baking
constexpr int64_t kMostTexels = int64_t(1) << 26;  // 8192 squared; more would not fit into a .glb

std::string oneLine(std::string cause) {
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    while (!cause.empty() && cause.back() == ' ') cause.pop_back();
    return cause.empty() ? "damaged" : cause;
}

// The height that stands for "no data"; NaN if there is none. GDAL writes it into TIFF as text in a tag of its own, 42113,
// which OpenImageIO does not read.
float noDataValue(const std::string& path) {
    TIFFSetWarningHandler(nullptr);
    TIFF* tiff = TIFFOpen(path.c_str(), "r");
    if (!tiff) return kVoid;
    uint32_t count = 0;
    const char* bytes = nullptr;
    std::string text;
    if (TIFFGetField(tiff, 42113, &count, &bytes) && bytes) text.assign(bytes, strnlen(bytes, count));
    TIFFClose(tiff);
    float value = kVoid;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
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

// Throws Error if a height is over 100 km: Terrarium tiles, which pack heights differently, come out as mountains of
// 800 km when they are unpacked as Terrain-RGB.
void requirePlausible(const std::vector<float>& heights) {
    for (const float h : heights)
        if (std::abs(h) > kHighest) {
            char text[160];
            std::snprintf(text, sizeof text,
                          "a height of %.0f km: its colours are not packed as Terrain-RGB (-10000 + 0.1 (65536 R + 256 G + B) m)",
                          h / 1000);
            throw Error(text);
        }
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
    if (texels > kMostTexels) throw Error(size + "too many");
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
    HeightMap map{spec.width, spec.height, {}};
    const float nothing = in->format_name() == std::string("tiff") ? noDataValue(path) : kVoid;
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
            map.values.push_back(height);
        }
    }
    if (options.terrainRgb) requirePlausible(map.values);
    return map;
}

Scene loadHeightMap(const std::string& path, const HeightMapOptions& options, Coordinates coordinates) {
    HeightMap map;
    const auto send = [&](PipeWriter& out) {
        const HeightMap read = readHeights(path, options);
        out.put(std::vector{read.width, read.height});
        out.put(read.values);
    };
    const auto receive = [&](PipeReader& in) {
        const std::vector<int> size = in.take<int>();
        requireMemory(path, std::to_string(size.at(0)) + " x " + std::to_string(size.at(1)) + " texels",
                      double(size.at(0)) * size.at(1) * kBytesAVertex);
        map = {size.at(0), size.at(1), in.take<float>()};
    };
    runIsolated(path, limitsFor(path, 10), send, receive);
    Scene scene;
    scene.name = path;
    scene.isTerrain = true;
    Surface surface;
    const double x0 = -0.5 * (map.width - 1) * options.spacingX, z0 = -0.5 * (map.height - 1) * options.spacingZ;
    std::vector<uint32_t> vertex(map.values.size(), UINT32_MAX);
    auto at = [&](int x, int y) { return size_t(y) * map.width + x; };
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            if (const float h = map.values[at(x, y)]; !std::isnan(h)) {
                vertex[at(x, y)] = uint32_t(surface.positions.size());
                surface.positions.emplace_back(float(x0 + x * options.spacingX), float(h * options.verticalScale),
                                               float(z0 + y * options.spacingZ));
                if (coordinates == Coordinates::Read)
                    surface.coordinates.emplace_back((float(x) + 0.5f) / float(map.width), (float(y) + 0.5f) / float(map.height));
            }
    for (int y = 0; y + 1 < map.height; ++y)
        for (int x = 0; x + 1 < map.width; ++x) {
            const uint32_t a = vertex[at(x, y)], b = vertex[at(x + 1, y)], c = vertex[at(x, y + 1)], d = vertex[at(x + 1, y + 1)];
            if (a != UINT32_MAX && b != UINT32_MAX && c != UINT32_MAX) surface.triangles.push_back({a, c, b});
            if (b != UINT32_MAX && c != UINT32_MAX && d != UINT32_MAX) surface.triangles.push_back({b, c, d});
        }
    makeNormals(surface);
    if (coordinates == Coordinates::Read) surface.grid = {map.width, map.height};
    scene.surfaces.push_back(std::move(surface));
    scene.instances.push_back({0});
    validate(scene);
    return scene;
}

}  // namespace apertura
