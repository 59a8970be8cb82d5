// Height maps through the program: assets that are swept, and what `horizon` writes.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/geotiff.h"
#include "tests/program.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

constexpr double kDegree = pi / 180;
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

// UTM zone 33 north, texels of 20 x 30 m.
const Georeference kUtm{{20, 30, 0}, {0, 0, 0, 5e5, 5e6, 0}, {}, {}, {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32633}, {}};

template <typename F>
std::string writeMap(const Folder& folder, const std::string& name, int width, int height, const F& heightAt,
                     const Georeference& georeference = kUtm) {
    std::vector<float> band;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) band.push_back(float(heightAt(x, y)));
    writeGeoTiff(folder / name, width, height, georeference, {"heights"}, [&](const auto& put) { put(0, 0, band); });
    return folder / name;
}

double hills(int x, int y) {
    return 150 * std::sin(x * 0.11) * std::cos(y * 0.08) + 40 * std::sin(x * 0.37 + y * 0.29) + 4 * hashUnit(1, uint64_t(x), uint64_t(y));
}

struct Bands {
    int width = 0, height = 0, count = 0;
    std::vector<float> values;
    float at(int x, int y, int band = 0) const { return values[(size_t(y) * size_t(width) + size_t(x)) * size_t(count) + size_t(band)]; }
};
Bands readBands(const std::string& path) {
    Bands out;
    const auto in = OIIO::ImageInput::open(path);
    EXPECT_TRUE(in) << path;
    if (!in) return out;
    out.width = in->spec().width, out.height = in->spec().height, out.count = in->spec().nchannels;
    out.values.resize(size_t(out.width) * size_t(out.height) * size_t(out.count));
    EXPECT_TRUE(in->read_image(0, 0, 0, out.count, OIIO::TypeDesc::FLOAT, out.values.data()));
    return out;
}

TEST(Terrain, IsSweptIntoAnAssetThatOpensAndCompares) {
    const Folder folder;
    const std::string map = writeMap(folder, "map.tif", 150, 120,
                                     [](int x, int y) { return x == 20 && y < 40 ? double(kHole) : hills(x, y); });
    const std::string glb = folder / "map.glb";
    Result r = run("bake " + map + " -o " + glb);
    ASSERT_EQ(r.code, 0) << r.error;
    EXPECT_NE(r.out.find("150 x 120 texels, swept along"), std::string::npos) << r.out;
    const auto info = nlohmann::json::parse(run("info " + glb + " --json").out);
    EXPECT_EQ(info["at"], "texels");
    EXPECT_EQ(info["rays"], 0);
    EXPECT_GE(info["azimuths"], 8);
    EXPECT_EQ(info["mesh_error"], 2);  // a tenth of 20 m
    EXPECT_EQ(info["images"], nlohmann::json::parse("[[150, 120]]"));
    EXPECT_GT(info["image_bytes"], 10000);
    EXPECT_LT(info["vertices"], 150 * 120);
    r = run("compare " + glb + " --models soft --light-radii 5 --receivers 300 --json " + (folder / "c.json"));
    ASSERT_EQ(r.code, 0) << r.error;
    const auto row = nlohmann::json::parse(slurp(folder / "c.json"))["rows"][0];
    EXPECT_LT(row["rmse"], 1.2 * row["own"].get<double>());
    EXPECT_LT(row["ambient_rmse"], 0.03);
    EXPECT_EQ(run("render " + glb + " -o " + (folder / "x.png") + " --size 32x20").code, 0);
    // Within its error, at 16 bits, at all vertices.
    EXPECT_EQ(run("bake " + map + " -o " + glb + " --mesh-error 40 --error 0.05 --bits 16").code, 0);
    const auto coarse = nlohmann::json::parse(run("info " + glb + " --json").out);
    EXPECT_LT(coarse["vertices"], info["vertices"].get<int>() / 4);
    EXPECT_EQ(coarse["azimuths"], 8);
    EXPECT_EQ(run("bake " + map + " -o " + glb + " --at vertices").code, 0);
    const auto atVertices = nlohmann::json::parse(run("info " + glb + " --json").out);
    EXPECT_EQ(atVertices["vertices"], 150 * 120 - 40);
    EXPECT_EQ(atVertices["images"].size(), 0u);
}

TEST(Terrain, HasTheSameBytesForAnyNumberOfThreads) {
    const Folder folder;
    const std::string map = writeMap(folder, "map.tif", 100, 90, hills);
    for (const std::string what : {"", " --model firm-2 --rays 64"}) {
        for (const std::string threads : {"1", "4"})
            ASSERT_EQ(run("bake " + map + " -o " + (folder / threads) + ".glb --threads " + threads + what).code, 0);
        EXPECT_EQ(slurp(folder / "1.glb"), slurp(folder / "4.glb")) << what;
    }
    for (const std::string exact : {"", " --exact"}) {
        for (const std::string threads : {"1", "4"})
            ASSERT_EQ(run("horizon " + map + " -o " + (folder / threads) + ".tif --azimuths 6 --threads " + threads + exact).code, 0);
        EXPECT_EQ(slurp(folder / "1.tif"), slurp(folder / "4.tif")) << exact;
    }
}

TEST(HorizonCommand, WritesTheSameInBandsThatFitIntoMemory) {
    const Folder folder;
    const std::string map = writeMap(folder, "map.tif", 1500, 300, hills);
    for (const std::string what : {"--azimuths 3", "--quantity openness --azimuths 5"}) {
        ASSERT_EQ(run("horizon " + map + " --exact -o " + (folder / "whole.tif") + " " + what).code, 0);
        // A field of 1600 x 400 places at 9 bytes, and bands of some 60 rows.
        const Result r = run("horizon " + map + " --exact -o " + (folder / "bands.tif") + " --memory 0.007 " + what);
        ASSERT_EQ(r.code, 0) << r.error;
        const Bands whole = readBands(folder / "whole.tif"), bands = readBands(folder / "bands.tif");
        EXPECT_EQ(whole.values, bands.values) << what;
    }
    expectRefusal("horizon " + map + " --exact -o " + (folder / "x.tif") + " --memory 0.005", 1, "--memory");
    expectRefusal("horizon " + map + " -o " + (folder / "x.tif") + " --memory 0.007", 1, "--exact");
}

TEST(Terrain, IsTracedWhereAnOptionAsksForRays) {
    const Folder folder;
    const std::string map = writeMap(folder, "map.tif", 24, 20, hills), glb = folder / "map.glb";
    for (const std::string option : {"--engine rays", "--rays 32", "--max-distance 100", "--at faces", "--at texels --as bent-normal"}) {
        ASSERT_EQ(run("bake " + map + " -o " + glb + " " + option).code, 0) << option;
        EXPECT_GT(nlohmann::json::parse(run("info " + glb + " --json").out)["rays"], 0) << option;
    }
    for (const std::string option : {"--rays 32", "--max-distance 100", "--at faces", "--max-bytes 1000"})
        expectRefusal("bake " + map + " -o " + glb + " --engine sweep " + option, 2, "--engine rays");
    expectRefusal("bake builtin:statue -o " + glb + " --engine sweep", 2, "--engine");
    expectRefusal("bake builtin:statue -o " + glb + " --error 0.1", 2, "--error");
    expectRefusal("bake " + map + " -o " + glb + " --engine rays --mesh-error 1", 2, "--mesh-error");
    expectRefusal("bake " + map + " -o " + glb + " --at vertices --mesh-error 1", 2, "--mesh-error");
    expectRefusal("bake " + map + " -o " + glb + " --at texels --model firm-2", 2, "four numbers");
    expectRefusal("bake " + map + " -o " + glb + " --error nan", 2, "--error");
    expectRefusal("bake " + map + " -o " + glb + " --model firm-2 --error 0.1", 2, "--error");
    expectRefusal("bake " + map + " -o " + glb + " --spacing 1e45", 1, "apart");
    expectRefusal("bake " + (folder / "none.tif") + " -o " + glb, 1, "No such file");
}

TEST(HorizonCommand, WritesTheHorizonsOfAWallInDegrees) {
    const Folder folder;
    // 30 m high, in the north; in the south-east corner there is no data.
    const std::string map = writeMap(folder, "map.tif", 40, 60, [](int x, int y) {
        return x > 30 && y > 50 ? double(kHole) : y <= 10 ? 30 : 0;
    });
    for (const std::string exact : {"", " --exact"}) {
        const std::string out = folder / "out.tif";
        const Result r = run("horizon " + map + " -o " + out + " --azimuths 8" + exact);
        ASSERT_EQ(r.code, 0) << r.error;
        EXPECT_EQ(withoutProgress(r.error), "");
        const Bands bands = readBands(out);
        ASSERT_EQ(bands.count, 8);
        ASSERT_EQ(bands.width, 40);
        for (const int y : {20, 40}) {
            EXPECT_NEAR(bands.at(20, y, 0), std::atan(30.0 / (30 * (y - 10))) / kDegree, 1e-3);
            EXPECT_NEAR(bands.at(20, y, 4), 0, 1e-3);  // to the south
        }
        // At 45 degrees the wall is as far as its distance over the cosine, as the ground is measured in metres.
        EXPECT_NEAR(bands.at(10, 18, 1), std::atan(30 * std::cos(45 * kDegree) / (30 * 8)) / kDegree, exact.empty() ? 0.3 : 1e-3);
        EXPECT_EQ(bands.at(20, 0, 0), -90);  // the map ends there
        EXPECT_EQ(bands.at(39, 59, 3), kNoData);
    }
}

TEST(HorizonCommand, WritesSkyViewAndOpennessOfACrater) {
    const Folder folder;
    const Georeference square{{1, 1, 0}, {0, 0, 0, 5e5, 5e6, 0}, {}, {}, kUtm.keys, {}};
    const auto crater = [](int x, int y) { return std::hypot(x - 60, y - 60) >= 40 ? 20.0 : 0.0; };
    const std::string map = writeMap(folder, "map.tif", 121, 121, crater, square), out = folder / "out.tif";
    ASSERT_EQ(run("horizon " + map + " -o " + out + " --quantity sky-view --azimuths 32 --exact").code, 0);
    const double rim = std::atan(20 / 40.0);
    // The rim is a polygon of texels, up to a texel farther out.
    EXPECT_NEAR(readBands(out).at(60, 60), 1 - std::sin(rim), 0.009);
    ASSERT_EQ(run("horizon " + map + " -o " + out + " --quantity openness --azimuths 32 --exact").code, 0);
    EXPECT_NEAR(readBands(out).at(60, 60), 90 - rim / kDegree, 0.4);
    // A plain sees all of the sky, its border too.
    const std::string plain = writeMap(folder, "plain.tif", 30, 20, [](int, int) { return 7; });
    ASSERT_EQ(run("horizon " + plain + " -o " + out + " --quantity sky-view").code, 0);
    for (const float x : readBands(out).values) EXPECT_NEAR(x, 1, 1e-6);
    ASSERT_EQ(run("horizon " + plain + " -o " + out + " --quantity openness").code, 0);
    for (const float x : readBands(out).values) EXPECT_NEAR(x, 90, 1e-4);
}

TEST(HorizonCommand, WritesHoursOfSun) {
    const Folder folder;
    const std::string out = folder / "out.tif";
    // How long the sun is up over a plain: cos(half the day) = -tan(latitude) tan(declination), which is 23.45 degrees in June.
    const std::string plain = writeMap(folder, "plain.tif", 20, 20, [](int, int) { return 0; });
    const auto hoursAt = [&](double latitude, int day) {
        EXPECT_EQ(run("horizon " + plain + " -o " + out + " --quantity sun-hours --latitude=" + std::to_string(latitude) + " --day "
                      + std::to_string(day))
                      .code,
                  0);
        return double(readBands(out).at(10, 10));
    };
    const auto expected = [](double latitude, double declination) {
        return 2 / 15.0 * std::acos(-std::tan(latitude * kDegree) * std::tan(declination * kDegree)) / kDegree;
    };
    EXPECT_NEAR(hoursAt(46, 172), expected(46, 23.45), 0.1);
    EXPECT_NEAR(hoursAt(-33, 172), expected(-33, 23.45), 0.1);
    EXPECT_NEAR(hoursAt(60, 355), expected(60, -23.45), 0.1);
    EXPECT_NEAR(hoursAt(0, 80), 12, 0.1);
    EXPECT_NEAR(hoursAt(80, 172), 24, 1e-3);
    EXPECT_NEAR(hoursAt(80, 355), 0, 1e-3);
    // North of a wall that hides the sun up to 60 degrees, at 46 degrees north, there is none in December; south of it a whole day.
    const Georeference square{{1, 1, 0}, {0, 0, 0, 5e5, 5e6, 0}, {}, {}, kUtm.keys, {}};
    const std::string wall = writeMap(
        folder, "wall.tif", 300, 40, [](int, int y) { return y == 20 ? 10 * std::tan(60 * kDegree) : 0; }, square);
    ASSERT_EQ(run("horizon " + wall + " -o " + out + " --quantity sun-hours --latitude 46 --day 355").code, 0);
    EXPECT_NEAR(readBands(out).at(150, 12), 0, 0.2);
    EXPECT_NEAR(readBands(out).at(150, 28), expected(46, -23.45), 0.2);
    // Degrees say where the map lies.
    const Georeference degrees{{0.001, 0.001, 0}, {0, 0, 0, 10, 46.01, 0}, {}, {}, {1, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326}, {}};
    const std::string placed = writeMap(
        folder, "placed.tif", 20, 20, [](int, int) { return 0; }, degrees);
    ASSERT_EQ(run("horizon " + placed + " -o " + out + " --quantity sun-hours --day 172").code, 0);
    EXPECT_NEAR(readBands(out).at(10, 10), expected(46, 23.45), 0.1);
}

TEST(HorizonCommand, RefusesInALineAndLeavesNothing) {
    const Folder folder;
    const std::string map = writeMap(folder, "map.tif", 20, 20, hills), out = folder / "out.tif";
    expectRefusal("horizon " + map + " -o " + (folder / "out.png"), 2, ".tif");
    expectRefusal("horizon " + map + " -o " + map, 2, "input");
    expectRefusal("horizon builtin:terrain -o " + out, 2, "no height map");
    expectRefusal("horizon " + map + " -o " + out + " --quantity sun-hours", 2, "--day");
    expectRefusal("horizon " + map + " -o " + out + " --quantity sun-hours --day 10", 2, "--latitude");
    expectRefusal("horizon " + map + " -o " + out + " --day 10", 2, "--day");
    expectRefusal("horizon " + map + " -o " + out + " --max-distance 10", 2, "--exact");
    expectRefusal("horizon " + map + " -o " + out + " --refraction 0.1", 2, "--curvature");
    expectRefusal("horizon " + map + " -o " + out + " --azimuths 0", 2, "--azimuths");
    expectRefusal("horizon " + (folder / "none.tif") + " -o " + out, 1, "none.tif");
    expectRefusal("horizon " + map + " -o " + (folder / "no/folder.tif"), 1, "no/folder.tif");
    Georeference turned{{}, {}, {7, 7, 0, 10, 7, -7, 0, 45, 0, 0, 0, 0, 0, 0, 0, 1}, {}, kUtm.keys, {}};
    const std::string askew = writeMap(folder, "askew.tif", 20, 20, hills, turned);
    expectRefusal("horizon " + askew + " -o " + out, 1, "turned");
    expectRefusal("horizon " + askew + " -o " + out + " --spacing 10", 1, "north");
    expectRefusal("horizon " + map + " -o " + out + " --exact --spacing 1e45", 1, "apart");
    expectRefusal("bake " + askew + " -o " + (folder / "x.glb"), 1, "turned");
    expectRefusal("horizon " + writeMap(folder, "holes.tif", 20, 20, [](int, int) { return kHole; }) + " -o " + out, 1, "no data at any");
    expectRefusal("horizon " + writeMap(folder, "line.tif", 20, 1, hills) + " -o " + out, 1, "2 x 2");
    expectRefusal(
        "bake " + writeMap(folder, "high.tif", 20, 20, [](int x, int) { return x == 3 ? 1e38 : 0; }) + " -o " + (folder / "x.glb"), 1,
        "1e+38 m");
    expectRefusal("horizon " + writeMap(folder, "large.tif", 300, 300, hills) + " -o " + out + " --memory 0.002", 1, "--memory");
    expectRefusal("bake " + writeMap(folder, "few.tif", 20, 20, [](int x, int y) { return x == 3 && y == 4 ? 1 : double(kHole); }) + " -o "
                      + (folder / "x.glb"),
                  1, "no three texels");
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_FALSE(std::filesystem::exists(folder / "x.glb"));
    // A disk that is full: a file can have no more than 8 kB.
    const std::string large = folder / "large.tif";
    const Result full = run("horizon " + large + " -o " + out, "ulimit -f 16; trap '' XFSZ;");
    EXPECT_EQ(full.code, 1) << full.error;
    EXPECT_NE(full.error.find("out.tif: cannot be written"), std::string::npos) << full.error;
    EXPECT_EQ(lines(withoutProgress(full.error)), 1) << full.error;
    EXPECT_FALSE(std::filesystem::exists(out));
    size_t hidden = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path)) hidden += entry.path().filename().string().starts_with(".");
    EXPECT_EQ(hidden, 0u);
}

}  // namespace
}  // namespace apertura::test
