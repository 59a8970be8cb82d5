#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>

#include "apertura/bake/sampling/horizons.h"
#include "apertura/bake/scene/height_map.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "tools/commands.h"
#include "tools/sun.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr double kEarth = 6371000;   // metres, the mean radius
constexpr double kMinutesAStep = 5;  // of the sun's way
constexpr double kSweepBytes = 36;   // a texel, of both ways through a field and results
constexpr double kAround = 100;      // texels
constexpr double kExactBytes = 9;    // of a field alone
constexpr double kRowBytes = 12;     // a texel of a band
constexpr double kMostBytes = 4e9;   // that bands take, where nothing else is said
constexpr float kNothing = -std::numeric_limits<float>::infinity();

struct Arguments {
    std::string map, out, quantity = "horizons";
    HeightMapOptions options;
    HorizonOptions horizons;
    int azimuths = 16;
    bool isCurved = false;
    double refraction = 0.13, latitude = 1000, day = 0, memory = 0;
};

enum class Quantity { Horizons, SkyView, Openness, SunHours };

// What is written of a map: bands, and the azimuths that they are made from.
struct Product {
    Quantity quantity;
    std::vector<std::string> descriptions;
    std::vector<double> azimuths;  // radians
    std::vector<float> tangents;   // of the sun's elevation at each of them; empty: none
    float share = 0;               // of the result that one azimuth may add
};

Product productOf(const Arguments& a) {
    Product out{a.quantity == "sun-hours"  ? Quantity::SunHours
                : a.quantity == "sky-view" ? Quantity::SkyView
                : a.quantity == "openness" ? Quantity::Openness
                                           : Quantity::Horizons,
                {},
                {},
                {},
                0};
    if (out.quantity == Quantity::SunHours) {
        const double latitude = a.latitude * pi / 180, declination = sunDeclination(a.day), step = kMinutesAStep / 60;
        for (double hour = step / 2; hour < 24; hour += step)
            if (const SunPosition sun = sunAt(latitude, declination, hour); sun.elevation > 0)
                out.azimuths.push_back(sun.azimuth), out.tangents.push_back(float(std::tan(sun.elevation)));
        out.share = float(step);
        out.descriptions = {"hours of sun on day " + std::to_string(int(a.day))};
        return out;
    }
    out.share = 1 / float(a.azimuths);
    for (int k = 0; k < a.azimuths; ++k) {
        out.azimuths.push_back(2 * pi * k / a.azimuths);
        char text[80];
        std::snprintf(text, sizeof text, "horizon towards %.10g degrees from north by east, degrees", 360.0 * k / a.azimuths);
        if (out.quantity == Quantity::Horizons) out.descriptions.emplace_back(text);
    }
    if (out.quantity == Quantity::SkyView) out.descriptions = {"sky-view factor, 0..1"};
    if (out.quantity == Quantity::Openness) out.descriptions = {"positive openness, degrees"};
    return out;
}

// What one azimuth adds to a band that is made of all of them. Directions without terrain count as a horizon of 0: Zaksek, Ostir & Kokalj,
// "Sky-View Factor as a Relief Visualization Technique", 2011.
float shareOf(const Product& product, size_t azimuth, float tangent) {
    const float t = tangent == kNothing ? 0 : tangent, up = std::max(t, 0.0f);
    switch (product.quantity) {
        case Quantity::SkyView: return product.share * (1 - up / std::sqrt(1 + up * up));
        case Quantity::Openness: return product.share * (90 - std::atan(t) * float(180 / pi));
        default: return product.tangents[azimuth] > tangent ? product.share : 0;
    }
}

// Exact horizons are found in bands of as many rows as there is memory for; a sweep has the whole map in memory. Throws Error where that
// is not enough.
void setBand(Arguments& a, const HeightField& field) {
    // With what surrounds a field on all sides.
    const double places = (double(field.width) + kAround) * (double(field.height) + kAround);
    const double bytes = places * (a.horizons.isExact ? kExactBytes : kSweepBytes), row = kRowBytes * (double(field.width) + kAround);
    const int rows = rowsAStrip(field.width);
    const double least = bytes + (a.horizons.isExact ? rows * row : 0), most = a.memory > 0 ? 1e9 * a.memory : kMostBytes;
    if (a.memory <= 0) requireMemory(a.map, std::to_string(field.width) + " x " + std::to_string(field.height) + " texels", least);
    if (a.memory > 0 && least > most) {
        char text[200];
        std::snprintf(text, sizeof text, ": %d x %d texels take %.3g GB, more than --memory%s", field.width, field.height, least / 1e9,
                      a.horizons.isExact ? "" : "; --exact takes a quarter of that");
        throw Error(a.map + text);
    }
    if (a.horizons.isExact) a.horizons.band = rows * int(std::clamp((most - bytes) / row / rows, 1.0, 1e6));
}

void run(Arguments a) {
    const std::string ending = std::filesystem::path(a.out).extension().string();
    if (ending != ".tif" && ending != ".tiff") throw CLI::ValidationError("-o " + a.out + " ends neither in .tif nor in .tiff");
    if (!isHeightMap(a.map)) throw CLI::ValidationError(a.map + " is no height map that is read: .png .tif .tiff .exr");
    refuseToReplaceInput(a.map, a.out);
    requireWritable(a.out);
    const HeightMap map = loadHeights(a.map, a.options);
    const HeightField& field = map.field;
    if (map.grid.isTurned) throw Error(a.map + ": " + map.grid.fault + ", so that its rows do not tell where north is");
    if (a.quantity == "sun-hours" && a.latitude > 90) {
        if (!map.grid.isGeographic) throw CLI::ValidationError("--latitude is needed: the coordinates of " + a.map + " are not degrees");
        a.latitude = map.grid.latitude;
    }
    setBand(a, field);
    if (a.isCurved) a.horizons.curvature = (1 - a.refraction) / (2 * kEarth);
    const Product product = productOf(a);
    {
        ProgressBar bar(a.horizons.isExact ? "looking" : "sweeping");
        const bool isSum = product.quantity != Quantity::Horizons;
        const auto writeBands = [&](const auto& put) {
            std::vector<float> sums;  // of the rows from `first` on
            int first = 0;
            const auto finish = [&](int band, int row, std::vector<float>& values) {
                const float* const heights = &field.heights[size_t(row) * size_t(field.width)];
                for (size_t i = 0; i < values.size(); ++i)
                    if (std::isnan(heights[i])) values[i] = std::numeric_limits<float>::quiet_NaN();
                put(band, row, values);
            };
            const auto use = [&](size_t k, int row, std::span<const float> tangents) {
                if (!isSum || row != first || sums.empty()) {
                    if (isSum && !sums.empty()) finish(0, first, sums);
                    sums.assign(tangents.size(), 0);
                    first = row;
                }
                tbb::parallel_for(tbb::blocked_range<size_t>(0, sums.size(), 1 << 14), [&](const tbb::blocked_range<size_t>& range) {
                    for (size_t i = range.begin(); i < range.end(); ++i)
                        sums[i] = isSum ? sums[i] + shareOf(product, k, tangents[i]) : float(std::atan(double(tangents[i])) * 180 / pi);
                });
                if (!isSum) finish(int(k), row, sums);
            };
            findHorizons(field, product.azimuths, a.horizons, use, bar.callback());
            if (!isSum) return;
            // In the polar night nothing was looked at.
            if (sums.empty()) sums.assign(field.texels(), 0);
            finish(0, first, sums);
        };
        writeGeoTiff(a.out, field.width, field.height, map.georeference, product.descriptions, writeBands);
    }
    std::printf("%s: %d x %d texels, %s%s", a.out.c_str(), field.width, field.height, a.horizons.isExact ? "exact " : "",
                a.quantity.c_str());
    if (product.quantity == Quantity::SunHours)
        std::printf(" by %zu places of the sun at %.4g degrees north\n", product.azimuths.size(), a.latitude);
    else
        std::printf(" of %zu azimuths\n", product.azimuths.size());
    printNotes(map.notes);
}

}  // namespace

void addHorizonCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("horizon", "horizons, sky view and hours of sun of a height map, as a GeoTIFF");
    command.footer(
        "horizons   band k: the angle h of the horizon above the horizontal, degrees, towards 360 k / N degrees from the map's north (up)\n"
        "           by east. It may be negative, and is -90 where the map, or its data, ends at the texel.\n"
        "sky-view   1 - the mean of sin h, h at least 0: the part of the sky that is open over level ground, without a cosine, 0..1\n"
        "openness   the mean of 90 - h, degrees\n"
        "sun-hours  how long the sun's middle stands above the horizontal and the terrain, in steps of 5 minutes, without refraction, on\n"
        "           one latitude\n"
        "Where the map ends, the last three take h for 0: beside its border they see more than there is. Texels without data are -9999.\n"
        "Between texels the surface is two triangles a cell, whose diagonal runs from the north-east to the south-west. Swept horizons\n"
        "err by .15 to .4 degrees (RMS) on mountains, a few in ten thousand by more than 5; --exact by less than .001, in a few times the\n"
        "time.\n"
        "Example: apertura horizon alps.tif -o sky.tif --quantity sky-view --azimuths 32");
    command.add_option("MAP", a->map, "a height map, .png .tif .exr")->required();
    command.add_option("-o", a->out, "32-bit floats, where MAP lies")->required()->type_name("OUT.tif");
    command.add_option("--azimuths", a->azimuths, "how many [16]")->check(CLI::Range(1, 3600))->type_name("N");
    command.add_flag("--exact", a->horizons.isExact,
                     "along a line through each texel itself; without it horizons are swept between parallel lines");
    command.add_option("--quantity", a->quantity, "[horizons]")
        ->check(CLI::IsMember({"horizons", "sky-view", "openness", "sun-hours"}))
        ->type_name("horizons|sky-view|openness|sun-hours");
    command.add_option("--latitude", a->latitude, "degrees north, for sun-hours [of the map's middle, where it is in degrees]")
        ->check(finiteRange(-90, 90))
        ->type_name("D");
    command.add_option("--day", a->day, "of the year, for sun-hours: 172 is the 21st of June")->check(CLI::Range(1, 366))->type_name("N");
    command.add_flag("--curvature", a->isCurved, "the ground falls away as the earth is round, with a radius of 6371 km");
    command.add_option("--refraction", a->refraction, "with --curvature, how much of it the air takes back [0.13]")
        ->check(finiteRange(0, 1))
        ->type_name("K");
    command.add_option("--max-distance", a->horizons.farthest, "with --exact, metres beyond which nothing hides anything [no limit]")
        ->check(finiteRange(1e-3, 1e9))
        ->type_name("M");
    command.add_option("--memory", a->memory, "gigabytes that it may take: --exact then goes in bands of rows [half of this machine's]")
        ->check(finiteRange(1e-3, 1e6))
        ->type_name("G");
    command.add_option("--threads", a->horizons.threads, "[all cores]; the result is the same for any number")
        ->check(CLI::Range(1, 1024))
        ->type_name("T");
    addHeightMapOptions(command, a->options);
    command.callback([a, &command] {
        const auto given = [&](const char* option) { return command.count(option) > 0; };
        if (given("--max-distance") && !a->horizons.isExact) throw CLI::ValidationError("--max-distance is for --exact");
        if (given("--refraction") && !a->isCurved) throw CLI::ValidationError("--refraction is for --curvature");
        const bool isSun = a->quantity == "sun-hours";
        if (isSun && !given("--day")) throw CLI::ValidationError("--quantity sun-hours needs --day");
        for (const char* const own : {"--day", "--latitude"})
            if (given(own) && !isSun) throw CLI::ValidationError(std::string(own) + " is for --quantity sun-hours");
        if (isSun && given("--azimuths")) throw CLI::ValidationError("--azimuths is not for sun-hours, which follow the sun");
        run(*a);
    });
}

}  // namespace apertura
