// What GeoTIFF says of a map: how far apart its texels are, and what a result keeps of it.
#include "apertura/bake/scene/geotiff.h"

#include <cmath>
#include <limits>

#include "apertura/bake/scene/height_map.h"
#include "apertura/runtime/asset/error.h"
#include "tests/program.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// Keys of the GeoTIFF standard: a header, then the number of a key, where its value is (0: here), how many, and the value.
std::vector<uint16_t> keys(const std::vector<std::pair<int, int>>& values) {
    std::vector<uint16_t> out{1, 1, 0, uint16_t(values.size())};
    for (const auto& [key, value] : values)
        for (const int v : {key, 0, 1, value}) out.push_back(uint16_t(v));
    return out;
}
const std::vector<uint16_t> kDegrees = keys({{1024, 2}, {1025, 1}, {2048, 4326}});     // WGS 84
const std::vector<uint16_t> kUtm = keys({{1024, 1}, {1025, 1}, {3072, 32633}});        // UTM zone 33 north, metres
const std::vector<uint16_t> kCalifornia = keys({{1024, 1}, {1025, 1}, {3072, 2227}});  // state plane, US survey feet

const std::vector<uint16_t> kWebMercator = keys({{1024, 1}, {1025, 1}, {3072, 3857}});
const std::vector<uint16_t> kGeocentric = keys({{1024, 3}, {1025, 1}, {2048, 4978}});
const std::vector<uint16_t> kUnknown = keys({{1024, 1}, {1025, 1}, {3072, 29999}});

// A slope of 8 x 6 texels.
std::string writeMap(const Folder& folder, const Georeference& georeference, int height = 6) {
    const std::string path = folder / "map.tif";
    writeGeoTiff(path, 8, height, georeference, {"heights"}, [&](const auto& put) {
        std::vector<float> band;
        for (int i = 0; i < 8 * height; ++i) band.push_back(i == 10 ? std::numeric_limits<float>::quiet_NaN() : float(i));
        put(0, 0, band);
    });
    return path;
}
Georeference placed(const std::vector<uint16_t>& keys, double cellX, double cellY, double left, double top) {
    return {{cellX, cellY, 0}, {0, 0, 0, left, top, 0}, {}, {}, keys, {}};
}

TEST(GeoTiff, StatesHowFarApartTexelsAre) {
    const Folder folder;
    const auto fieldOf = [&](const Georeference& g) { return loadHeights(writeMap(folder, g), {}).field; };
    HeightField field = fieldOf(placed(kUtm, 30, 25, 500000, 5000000));
    EXPECT_EQ(field.spacingX, 30);
    EXPECT_EQ(field.spacingZ, 25);
    EXPECT_EQ(field.heights[9], 9);
    EXPECT_TRUE(std::isnan(field.heights[10]));  // -9999, which the tag calls no data
    field = fieldOf(placed(kCalifornia, 10, 10, 6000000, 2000000));
    EXPECT_NEAR(field.spacingX, 10 * 1200 / 3937.0, 1e-9);
    // A degree at 45 degrees north is 78.847 km wide and 111.132 km long (NIMA TR8350.2, 2000).
    const HeightMap map = loadHeights(writeMap(folder, placed(kDegrees, 0.001, 0.001, 10, 45.003)), {});
    EXPECT_NEAR(map.field.spacingX, 78.847, 0.001);
    EXPECT_NEAR(map.field.spacingZ, 111.132, 0.001);
    EXPECT_NEAR(map.grid.latitude, 45, 1e-9);
    ASSERT_EQ(map.notes.size(), 1u);
    EXPECT_NE(map.notes[0].find("45 degrees north"), std::string::npos) << map.notes[0];
    // A file that no code of ours wrote.
    const HeightField small = loadHeights(smallScene("heights_geotiff.tif"), {}).field;
    EXPECT_NEAR(small.spacingX, 78.847, 0.001);
    EXPECT_NEAR(small.spacingZ, 111.132, 0.001);
    EXPECT_EQ(small.heights[0], 100);
    // Numbers of another unit and zero than metres.
    const HeightMap scaled = loadHeights(smallScene("heights_scaled.tif"), {});
    EXPECT_NEAR(scaled.field.heights[0], (100 * 0.1 + 500) * 0.3048, 1e-4);
    EXPECT_NEAR(scaled.field.heights[1], (110 * 0.1 + 500) * 0.3048, 1e-4);
    EXPECT_TRUE(std::isnan(scaled.field.heights[3]));
    // Mercator's metres grow with the latitude: at 60 degrees a degree is as wide as half of one at the equator.
    const double north = 6378137 * std::asinh(std::tan(pi / 3));
    field = fieldOf(placed(kWebMercator, 40, 40, 1e6, north + 3 * 40));
    EXPECT_NEAR(field.spacingX, 20, 1e-3);
    EXPECT_NEAR(field.spacingZ, 20, 1e-3);
    // Feet of heights, by the key of vertical units.
    Georeference feet = placed(kUtm, 30, 30, 5e5, 5e6);
    feet.keys = keys({{1024, 1}, {1025, 1}, {3072, 32633}, {4099, 9003}});
    EXPECT_NEAR(fieldOf(feet).heights[9], 9 * 1200 / 3937.0, 1e-5);
    // The same by a matrix.
    Georeference matrix{{}, {}, {0.001, 0, 0, 10, 0, -0.001, 0, 45.003, 0, 0, 0, 0, 0, 0, 0, 1}, {}, kDegrees, {}};
    EXPECT_NEAR(fieldOf(matrix).spacingX, 78.847, 0.001);
    // What the user says counts.
    HeightMapOptions own;
    own.spacingX = 3, own.spacingZ = 4;
    EXPECT_EQ(loadHeights(writeMap(folder, matrix), own).field.spacingZ, 4);
    // Nothing is said: a metre, and a line.
    const HeightMap plain = loadHeights(writeMap(folder, {}), {});
    EXPECT_EQ(plain.field.spacingX, 1);
    ASSERT_EQ(plain.notes.size(), 1u);
    EXPECT_NE(plain.notes[0].find("1 m apart"), std::string::npos);
}

TEST(GeoTiff, IsRefusedWhereItsGridCannotBeUsed) {
    const Folder folder;
    const auto expectFault = [&](const Georeference& g, const std::string& words, int height = 6) {
        const std::string path = writeMap(folder, g, height);
        try {
            loadHeights(path, {});
            ADD_FAILURE() << words;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            EXPECT_EQ(std::string(error.what()).find(path), 0u) << error.what();
        }
        HeightMapOptions own;
        own.spacingX = own.spacingZ = 5;
        EXPECT_EQ(loadHeights(path, own).field.spacingX, 5);
    };
    Georeference turned{{}, {}, {7, 7, 0, 10, 7, -7, 0, 45, 0, 0, 0, 0, 0, 0, 0, 1}, {}, kUtm, {}};
    expectFault(turned, "turned");
    turned.transformation = {10, 0, 0, 10, 0, 10, 0, 45, 0, 0, 0, 0, 0, 0, 0, 1};
    expectFault(turned, "mirrored");
    expectFault(placed(kUtm, 0, 0, 0, 0), "size of its cells");
    expectFault(placed(kUtm, std::nan(""), 30, 0, 0), "size of its cells");
    expectFault(placed({}, 0.0008, 0.0008, 10, 45), "--spacing");
    expectFault(placed(kDegrees, 5, 5, 0, 90), "times as wide");
    expectFault(placed({}, 0.0083333, 0.0083333, 10, 45), "--spacing");
    expectFault(placed(kWebMercator, 1e6, 1e6, 0, 8e6), "Mercator");
    expectFault(placed(kGeocentric, 30, 30, 0, 0), "neither of a map nor degrees");
    expectFault(placed(kUnknown, 30, 30, 0, 0), "EPSG:29999");
    expectFault(placed(kUtm, 1e300, 1e300, 0, 0), "apart");
    expectFault(placed(kUtm, 1e-30, 1, 0, 0), "apart");
    expectFault(placed(kDegrees, 50, 50, 0, 90), "reach from");
    expectFault({{}, {0, 0, 0, 1, 2, 0, 5, 5, 0, 7, 8, 0}, {}, {}, kUtm, {}}, "tie points");
}

TEST(GeoTiff, KeepsItsPlaceInWhatIsMadeOfIt) {
    const Folder folder;
    Georeference g = placed(kDegrees, 0.001, 0.002, 10, 45);
    g.keys = {1, 1, 0, 3, 1024, 0, 1, 2, 1026, 34737, 7, 0, 2048, 0, 1, 4326};
    const std::string text = "a place|";
    g.text.assign(text.begin(), text.end());
    g.text.push_back(0);
    const std::string map = writeMap(folder, g), out = folder / "out.tif";
    const Result r = run("horizon " + map + " -o " + out + " --azimuths 4");
    ASSERT_EQ(r.code, 0) << r.error;
    const GeoTiff kept = readGeoTiff(out, 8, 6);
    EXPECT_EQ(kept.georeference.pixelScale, g.pixelScale);
    EXPECT_EQ(kept.georeference.tiePoints, g.tiePoints);
    EXPECT_EQ(kept.georeference.keys, g.keys);
    EXPECT_EQ(kept.georeference.text, g.text);
    EXPECT_EQ(kept.noData, kNoData);
    EXPECT_EQ(kept.grid.spacingX, readGeoTiff(map, 8, 6).grid.spacingX);
}

}  // namespace
}  // namespace apertura::test
