#include "apertura/bake/scene/geotiff.h"

#include <geo_normalize.h>
#include <geotiff.h>
#include <geovalues.h>
#include <xtiffio.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

constexpr ttag_t kNoDataTag = 42113, kMetadataTag = 42112;  // GDAL's own: a number as text, and XML
constexpr double kSameTilt = 1e-9;                          // of a cell, that its sides may lean
constexpr double kMostStretch = 1.2;                        // of the widths of cells of degrees, at the top and the bottom of a map
constexpr double kNoticedStretch = 1.02;                    // and from where it is said
constexpr double kFewMetres = 0.005;  // a cell of fewer, of which nothing says that it is in metres, is one of degrees
constexpr double kLargeFile = 3.9e9;  // bytes from which a TIFF needs 64-bit offsets
constexpr size_t kStripBytes = 1 << 18;
// Of WGS 84, where the file has no ellipsoid.
constexpr double kSemiMajor = 6378137, kSemiMinor = 6356752.314245;

struct CloseTiff {
    void operator()(TIFF* tiff) const { XTIFFClose(tiff); }
};
struct FreeKeys {
    void operator()(GTIF* keys) const { GTIFFree(keys); }
};

template <typename T>
std::vector<T> tagOf(TIFF* tiff, ttag_t tag) {
    uint16_t count = 0;
    const T* values = nullptr;
    if (!TIFFGetField(tiff, tag, &count, &values) || !values) return {};
    return {values, values + count};
}

// Metres that a degree of longitude and one of latitude are long on an ellipsoid. Snyder, "Map Projections: A Working Manual", 1987, 4-18
// and 4-20.
struct DegreeLengths {
    double longitude, latitude;
    DegreeLengths(double at, double semiMajor, double semiMinor) {
        const double degree = std::numbers::pi / 180, squared = 1 - semiMinor * semiMinor / (semiMajor * semiMajor);
        const double root = 1 - squared * std::pow(std::sin(at * degree), 2);
        longitude = degree * semiMajor * std::cos(at * degree) / std::sqrt(root);
        latitude = degree * semiMajor * (1 - squared) / std::pow(root, 1.5);
    }
};

std::string inWords(const char* format, auto... values) {
    char text[240];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

// The sides of a cell and the north-western corner in the units of the map, from either of the two ways to say so.
struct Affine {
    double cellX = 0, cellY = 0, left = 0, top = 0;  // cellY > 0 southwards
};
bool findAffine(const Georeference& g, MapGrid& grid, Affine& out) {
    if (g.transformation.size() >= 16) {
        const std::vector<double>& t = g.transformation;
        out = {t[0], -t[5], t[3], t[7]};
        const double size = std::max(std::abs(t[0]), std::abs(t[5]));
        if (!(std::abs(t[1]) <= kSameTilt * size && std::abs(t[4]) <= kSameTilt * size)) {
            grid.fault = "its grid is turned or sheared against the map's north";
            grid.isTurned = true;
            return false;
        }
    } else if (g.pixelScale.size() >= 2) {
        out = {g.pixelScale[0], g.pixelScale[1], 0, 0};
        if (g.tiePoints.size() >= 6)
            out.left = g.tiePoints[3] - g.tiePoints[0] * out.cellX, out.top = g.tiePoints[4] + g.tiePoints[1] * out.cellY;
    } else {
        if (!g.tiePoints.empty()) grid.fault = "it is placed by tie points alone, without a size of its cells";
        return false;
    }
    if (out.cellX < 0 || out.cellY < 0) {
        grid.fault = "its grid is mirrored: rows go north, or columns west";
        grid.isTurned = true;
    } else if (!(out.cellX > 0 && out.cellY > 0 && std::isfinite(out.cellX + out.cellY + out.left + out.top))) {
        grid.fault = "the size of its cells is 0 or no number";
    }
    return grid.fault.empty();
}

// A code of the EPSG's register that could not be looked up: libgeotiff then takes degrees and metres for granted.
bool isUnknown(const GTIFDefn& definition, const Georeference& georeference) {
    const auto has = [&](int key) {
        for (size_t i = 4; i + 3 < georeference.keys.size(); i += 4)
            if (georeference.keys[i] == key) return true;
        return false;
    };
    if (definition.Model == ModelTypeProjected)
        return definition.PCS != KvUserDefined && definition.CTProjection == KvUserDefined && !has(ProjLinearUnitsGeoKey);
    return definition.GCS != KvUserDefined && definition.Ellipsoid == KvUserDefined && !has(GeogAngularUnitsGeoKey);
}

MapGrid gridOf(const Georeference& georeference, GTIF* keys, int width, int height) {
    MapGrid out;
    Affine cell;
    if (!findAffine(georeference, out, cell)) return out;
    GTIFDefn definition;
    std::memset(&definition, 0, sizeof definition);
    const bool isDefined = keys && !georeference.keys.empty() && GTIFGetDefn(keys, &definition);
    if (isDefined && definition.Model == ModelTypeGeographic) {
        if (isUnknown(definition, georeference)) {
            out.fault = inWords("its coordinate system, EPSG:%d, cannot be looked up in PROJ's database", int(definition.GCS));
            return out;
        }
        const double angle = definition.UOMAngleInDegrees > 0 ? definition.UOMAngleInDegrees : 1;
        const double top = cell.top * angle, bottom = top - height * cell.cellY * angle;
        const bool hasEllipsoid = definition.SemiMajor > 0 && definition.SemiMinor > 0;
        const double major = hasEllipsoid ? definition.SemiMajor : kSemiMajor, minor = hasEllipsoid ? definition.SemiMinor : kSemiMinor;
        if (!(top <= 90 + 1e-6 && bottom >= -90 - 1e-6)) {
            out.fault = inWords("its cells are of degrees, and reach from %.4g to %.4g degrees north", bottom, top);
            return out;
        }
        const auto widthAt = [&](double latitude) { return DegreeLengths(latitude, major, minor).longitude; };
        const double widest = top * bottom < 0 ? widthAt(0) : std::max(widthAt(top), widthAt(bottom));
        const double stretch = widest / std::max(std::min(widthAt(top), widthAt(bottom)), 1e-9);
        if (stretch > kMostStretch) {
            out.fault = inWords(
                "its cells are of degrees, and %.3g times as wide at one end of the map as at the other: project it to metres first",
                stretch);
            return out;
        }
        out.isGeographic = true;
        out.latitude = (top + bottom) / 2;
        const DegreeLengths degree(out.latitude, major, minor);
        out.spacingX = cell.cellX * angle * degree.longitude, out.spacingZ = cell.cellY * angle * degree.latitude;
        out.note = inWords("cells of %.4g x %.4g degrees are taken for %.4g x %.4g m, as they are at %.4g degrees %s", cell.cellX * angle,
                           cell.cellY * angle, out.spacingX, out.spacingZ, std::abs(out.latitude), out.latitude < 0 ? "south" : "north");
        if (stretch > kNoticedStretch) out.note += inWords("; from top to bottom their width changes by %.2g %%", 100 * (stretch - 1));
        return out;
    }
    const bool isProjected = isDefined && definition.Model == ModelTypeProjected;
    if (isDefined && !isProjected && definition.Model != KvUserDefined) {
        out.fault = "its coordinates are neither of a map nor degrees";
        return out;
    }
    if (isProjected && isUnknown(definition, georeference)) {
        out.fault = inWords("its coordinate system, EPSG:%d, cannot be looked up in PROJ's database", int(definition.PCS));
        return out;
    }
    if (isProjected && definition.CTProjection == CT_Mercator) {
        // The latitude of a northing, on a sphere: within .2 degrees of it on the ellipsoid.
        const double radius = definition.SemiMajor > 0 ? definition.SemiMajor : kSemiMajor, degree = std::numbers::pi / 180;
        const auto latitudeAt = [&](double northing) { return std::atan(std::sinh(northing / radius)) / degree; };
        const double top = latitudeAt(cell.top), bottom = latitudeAt(cell.top - height * cell.cellY);
        const double ratio = std::cos(top * degree) / std::cos(bottom * degree), stretch = std::max(ratio, 1 / ratio);
        if (!(stretch <= kMostStretch)) {
            out.fault = inWords(
                "it is in Mercator's projection, and its cells are %.3g times as wide at one end of the map as at the other: project it to "
                "metres first",
                stretch);
            return out;
        }
        const double latitude = (top + bottom) / 2, shrink = std::cos(latitude * degree);
        out.spacingX = cell.cellX * shrink, out.spacingZ = cell.cellY * shrink;
        out.note = inWords("cells of %.4g x %.4g m in Mercator's projection are %.4g x %.4g m of ground, as they are at %.4g degrees %s",
                           cell.cellX, cell.cellY, out.spacingX, out.spacingZ, std::abs(latitude), latitude < 0 ? "south" : "north");
        return out;
    }
    const bool seemsDegrees = std::abs(cell.left) <= 360 && std::abs(cell.top) <= 90 && width * cell.cellX <= 360
                           && height * cell.cellY <= 180
                           && (cell.left != 0 || cell.top != 0 || std::max(cell.cellX, cell.cellY) < kFewMetres);
    if (!isProjected && seemsDegrees) {
        out.fault = "its cells seem to be of degrees, and it does not say so: give --spacing";
        return out;
    }
    const double unit = isProjected ? definition.UOMLengthInMeters : 1;
    if (!(unit > 0 && std::isfinite(unit))) {
        out.fault = "the unit of its coordinates is 0 or no number";
        return out;
    }
    out.spacingX = cell.cellX * unit, out.spacingZ = cell.cellY * unit;
    if (unit != 1)
        out.note = inWords("its cells of %.4g x %.4g units are %.4g x %.4g m", cell.cellX, cell.cellY, out.spacingX, out.spacingZ);
    return out;
}

// The text of an item of the first band that has a role in GDAL's metadata; empty where there is none.
std::string itemOf(const std::string& metadata, const std::string& role) {
    const size_t at = metadata.find("role=\"" + role + "\"");
    const size_t begin = at == std::string::npos ? at : metadata.find('>', at);
    const size_t end = begin == std::string::npos ? begin : metadata.find('<', begin);
    return end == std::string::npos ? "" : metadata.substr(begin + 1, end - begin - 1);
}

// The number at the beginning of a text, blanks and a plus left out.
template <typename T>
T numberIn(std::string text, T otherwise) {
    text.erase(0, std::min(text.find_first_not_of(" \t\r\n+"), text.size()));
    T value = otherwise;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

// Metres a unit of heights, as GDAL calls it, or by its code in the EPSG's register; 0: another one.
double metresIn(const std::string& unit, int code) {
    if (unit == "ft" || unit == "foot" || (unit.empty() && code == 9002)) return 0.3048;
    if (unit == "us-ft" || unit == "ftUS" || unit == "US survey foot" || (unit.empty() && code == 9003)) return 1200 / 3937.0;
    return 1;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

}  // namespace

void Georeference::send(PipeWriter& out) const {
    for (const std::vector<double>* of : {&pixelScale, &tiePoints, &transformation, &numbers}) out.put(*of);
    out.put(keys);
    out.put(text);
}

Georeference Georeference::receive(PipeReader& in) {
    Georeference out;
    for (std::vector<double>* of : {&out.pixelScale, &out.tiePoints, &out.transformation, &out.numbers}) *of = in.take<double>();
    out.keys = in.take<uint16_t>();
    out.text = in.take<char>();
    return out;
}

GeoTiff readGeoTiff(const std::string& path, int width, int height) {
    GeoTiff out;
    TIFFSetWarningHandler(nullptr);
    TIFFSetErrorHandler(nullptr);
    const std::unique_ptr<TIFF, CloseTiff> tiff(XTIFFOpen(path.c_str(), "r"));
    if (!tiff) return out;
    uint32_t count = 0;
    const char* bytes = nullptr;
    if (TIFFGetField(tiff.get(), kNoDataTag, &count, &bytes) && bytes) {
        out.noData = numberIn(std::string(bytes, strnlen(bytes, count)), out.noData);
    }
    Georeference& g = out.georeference;
    g.pixelScale = tagOf<double>(tiff.get(), TIFFTAG_GEOPIXELSCALE);
    g.tiePoints = tagOf<double>(tiff.get(), TIFFTAG_GEOTIEPOINTS);
    g.transformation = tagOf<double>(tiff.get(), TIFFTAG_GEOTRANSMATRIX);
    g.numbers = tagOf<double>(tiff.get(), TIFFTAG_GEODOUBLEPARAMS);
    g.keys = tagOf<uint16_t>(tiff.get(), TIFFTAG_GEOKEYDIRECTORY);
    const char* text = nullptr;
    if (TIFFGetField(tiff.get(), TIFFTAG_GEOASCIIPARAMS, &text) && text) g.text.assign(text, text + std::strlen(text) + 1);
    const std::unique_ptr<GTIF, FreeKeys> keys(g.keys.empty() ? nullptr : GTIFNew(tiff.get()));
    out.grid = gridOf(g, keys.get(), width, height);
    std::string metadata;
    if (TIFFGetField(tiff.get(), kMetadataTag, &count, &bytes) && bytes) metadata.assign(bytes, strnlen(bytes, count));
    unsigned short code = 0;
    if (keys) GTIFKeyGetSHORT(keys.get(), VerticalUnitsGeoKey, &code, 0, 1);
    const double unit = metresIn(itemOf(metadata, "unittype"), code);
    out.scale = unit * numberIn(itemOf(metadata, "scale"), 1.0), out.offset = unit * numberIn(itemOf(metadata, "offset"), 0.0);
    return out;
}

int rowsAStrip(int width) { return std::max(1, int(kStripBytes / (size_t(width) * sizeof(float)))); }

void writeGeoTiff(const std::string& path, int width, int height, const Georeference& georeference,
                  const std::vector<std::string>& descriptions,
                  const std::function<void(const std::function<void(int, int, std::span<const float>)>&)>& writeBands) {
    PendingFile pending(path);
    struct Restored {
        TIFFErrorHandler warnings, errors;
        ~Restored() { TIFFSetWarningHandler(warnings), TIFFSetErrorHandler(errors); }
    };
    static std::string cause;  // what libtiff said; it knows no other way
    cause.clear();
    const auto warnings = TIFFSetWarningHandler(nullptr);
    const auto errors = TIFFSetErrorHandler([](const char*, const char* format, va_list values) {
        char text[200];
        std::vsnprintf(text, sizeof text, format, values);
        cause = text;
    });
    const Restored restored{warnings, errors};
    const auto fail = [&] { throw Error(path + ": cannot be written" + (cause.empty() ? "" : ": " + cause)); };
    const double bytes = double(width) * height * double(descriptions.size()) * sizeof(float);
    std::unique_ptr<TIFF, CloseTiff> tiff(XTIFFOpen(pending.name().c_str(), bytes > kLargeFile ? "w8" : "w"));
    if (!tiff) fail();
    static const TIFFFieldInfo extra[] = {{kNoDataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, true, false, const_cast<char*>("GDALNoDataValue")},
                                          {kMetadataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, true, false, const_cast<char*>("GDALMetadata")}};
    TIFFMergeFieldInfo(tiff.get(), extra, 2);
    TIFF* const t = tiff.get();
    const int rows = rowsAStrip(width);
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 32);
    TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, int(descriptions.size()));
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_SEPARATE);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    if (descriptions.size() > 1) {
        const std::vector<uint16_t> kinds(descriptions.size() - 1, EXTRASAMPLE_UNSPECIFIED);
        TIFFSetField(t, TIFFTAG_EXTRASAMPLES, int(kinds.size()), kinds.data());
    }
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, rows);
    TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    TIFFSetField(t, TIFFTAG_PREDICTOR, PREDICTOR_FLOATINGPOINT);
    TIFFSetField(t, TIFFTAG_ZIPQUALITY, 1);
    TIFFSetField(t, TIFFTAG_SOFTWARE, "Apertura " APERTURA_VERSION);
    TIFFSetField(t, kNoDataTag, std::to_string(int(kNoData)).c_str());
    std::string metadata = "<GDALMetadata>\n";
    for (size_t i = 0; i < descriptions.size(); ++i)
        metadata += "  <Item name=\"DESCRIPTION\" sample=\"" + std::to_string(i) + "\" role=\"description\">" + escaped(descriptions[i])
                  + "</Item>\n";
    TIFFSetField(t, kMetadataTag, (metadata + "</GDALMetadata>\n").c_str());
    const Georeference& g = georeference;
    const auto put = [&](ttag_t tag, const auto& values) {
        if (!values.empty()) TIFFSetField(t, tag, int(values.size()), values.data());
    };
    put(TIFFTAG_GEOPIXELSCALE, g.pixelScale);
    put(TIFFTAG_GEOTIEPOINTS, g.tiePoints);
    put(TIFFTAG_GEOTRANSMATRIX, g.transformation);
    put(TIFFTAG_GEOKEYDIRECTORY, g.keys);
    put(TIFFTAG_GEODOUBLEPARAMS, g.numbers);
    if (!g.text.empty()) TIFFSetField(t, TIFFTAG_GEOASCIIPARAMS, g.text.data());

    std::vector<float> strip(size_t(width) * size_t(rows));
    const int strips = (height + rows - 1) / rows;
    writeBands([&](int band, int row, std::span<const float> values) {
        for (size_t done = 0; done < values.size(); done += strip.size()) {
            const size_t count = std::min(strip.size(), values.size() - done);
            std::transform(values.begin() + std::ptrdiff_t(done), values.begin() + std::ptrdiff_t(done + count), strip.begin(),
                           [](float x) { return std::isnan(x) ? kNoData : x; });
            // libtiff compresses in this memory.
            const auto number = uint32_t(band * strips + row / rows + int(done / strip.size()));
            if (TIFFWriteEncodedStrip(t, number, strip.data(), tmsize_t(count * sizeof(float))) < 0) fail();
        }
    });
    if (!TIFFFlush(t) || !cause.empty()) fail();
    tiff.reset();
    if (!cause.empty()) fail();
    pending.commit();
}

}  // namespace apertura
