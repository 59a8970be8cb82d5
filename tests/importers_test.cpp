// Every importer, on the small scenes of tests/data, which tests/data/make.py writes by their formats' specifications alone.
#include <cmath>
#include <string>

#include "apertura/bake/scene/load.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// 5 x 4 texels, whose heights begin at `lowest`.
void expectHeights(const std::string& name, float lowest, bool hasHole, float within = 0, const HeightMapOptions& options = {}) {
    const Scene scene = loadScene(smallScene(name), options);
    ASSERT_EQ(scene.surfaces.size(), 1u) << name;
    const Surface& surface = scene.surfaces[0];
    // The triangles that touch texel (2, 1) are six of 24.
    EXPECT_EQ(surface.positions.size(), hasHole ? 19u : 20u) << name;
    EXPECT_EQ(surface.triangles.size(), hasHole ? 18u : 24u) << name;
    size_t v = 0;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
            if (hasHole && x == 2 && y == 1) continue;
            const glm::vec3& p = surface.positions[v++];
            EXPECT_EQ(p.x, float(x) - 2.0f) << name;
            EXPECT_EQ(p.z, float(y) - 1.5f) << name;
            EXPECT_NEAR(p.y, lowest + float(10 * x + 3 * y), within) << name << " at " << x << ", " << y;
        }
    EXPECT_TRUE(scene.isTerrain);
    // A plane: its normal is (-10, 1, -3).
    if (hasHole) return;
    for (const glm::vec3& n : surface.normals)
        EXPECT_LT(glm::length(n - glm::normalize(glm::vec3(-10, 1, -3))), 1e-5f + 0.02f * within) << name;
}

TEST(HeightMap, PngsAreReadAsIntegersOfEightAndSixteenBits) {
    expectHeights("heights_u8.png", 100, false);
    expectHeights("heights_u16.png", 100, false);
    expectHeights("heights_u16_alpha.png", 100, true);
}

TEST(HeightMap, TerrainRgbIsUnpackedToATenthOfAMetre) { expectHeights("heights_terrain_rgb.png", -100, false, 0.001f, {0, 0, 1, true}); }

TEST(HeightMap, TiffsOfIntegersLeaveOutWhatGdalCallsNoData) {
    expectHeights("heights_u16.tif", 100, false);
    expectHeights("heights_i16_nodata.tif", -100, true);
    expectHeights("heights_i32_nodata.tif", -100, true);
}

TEST(HeightMap, TiffsOfFloatsLeaveOutNoDataAndWhatIsNotANumber) {
    expectHeights("heights_f32_nodata.tif", -100, true);
    expectHeights("heights_f32_nan.tif", -100, true);
    expectHeights("heights_f64.tif", -100, false);
}

TEST(HeightMap, ExrsOfFloatsAndHalvesLeaveOutWhatIsNotANumber) {
    expectHeights("heights_f32.exr", -100, true);
    expectHeights("heights_f16.exr", -100, true);
}

TEST(SmallScenes, AreWhatTheirScriptWrites) {
    const Folder folder;
    ASSERT_EQ(std::system(("/usr/bin/python3 -B \"" APERTURA_SOURCE "/tests/data/make.py\" " + folder.path.string()).c_str()), 0);
    const auto bytes = [](const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    for (const auto& entry : std::filesystem::directory_iterator(folder.path)) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".png")) continue;  // zlib's versions compress differently
        EXPECT_EQ(bytes(entry.path()), bytes(smallScene(name))) << name;
    }
    EXPECT_GE(folder.files(), 24u);
}

// The volume that a closed surface's triangles enclose, seen counter-clockwise from outside, and its area.
struct Enclosed {
    double volume = 0, area = 0;
};
Enclosed enclosedBy(const Scene& scene) {
    Enclosed out;
    for (size_t i = 0; i < scene.instances.size(); ++i)
        for (size_t t = 0; t < scene.surfaces[size_t(scene.instances[i].surface)].triangles.size(); ++t) {
            const auto [a, b, c] = cornersOf(scene, int(i), int(t));
            out.volume += glm::dot(a, glm::cross(b, c)) / 6;
            out.area += glm::length(glm::cross(b - a, c - a)) / 2;
        }
    return out;
}

void expectCube(const std::string& name, const glm::vec3& low = glm::vec3(0)) {
    const Scene scene = loadScene(smallScene(name));
    EXPECT_EQ(triangleCount(scene), 12u) << name;
    const Enclosed e = enclosedBy(scene);
    EXPECT_NEAR(e.volume, 1, 1e-4) << name;
    EXPECT_NEAR(e.area, 6, 1e-4) << name;
    const Box box = worldBounds(scene);
    EXPECT_LT(glm::length(box.low - low), 1e-4f) << name;
    EXPECT_LT(glm::length(box.high - low - glm::vec3(1)), 1e-4f) << name;
    for (const Surface& surface : scene.surfaces)
        for (const glm::vec3& n : surface.normals) EXPECT_NEAR(glm::length(n), 1, 1e-5) << name;
}

TEST(Gltf, ACubeIsOneInEitherContainer) {
    expectCube("cube.gltf");
    expectCube("cube.glb");
}

TEST(Gltf, InterleavedPositionsKeepTheNormalsBesideThem) {
    expectCube("cube_interleaved.glb");
    const Scene scene = loadScene(smallScene("cube_interleaved.glb"));
    const Surface& surface = scene.surfaces[0];
    EXPECT_FALSE(surface.normalsMade);
    ASSERT_EQ(surface.positions.size(), 8u);
    for (size_t v = 0; v < 8; ++v)
        EXPECT_LT(glm::length(surface.normals[v] - glm::normalize(2.0f * surface.positions[v] - glm::vec3(1))), 1e-5f);
}

TEST(Gltf, StripsAndFansOfThirtyTwoBitIndicesEncloseTheCube) { expectCube("cube_strips_fans.gltf"); }

TEST(Gltf, ASparseAccessorWithoutAViewBeginsAtZero) { expectCube("cube_sparse.gltf"); }

// The node turns x to y and y to -x, and moves by one.
TEST(Gltf, QuantisedPositionsStandWhereTheirNodePutsThem) { expectCube("cube_quantized.glb"); }

TEST(Gltf, CompressedViewsAreDecoded) { expectCube("cube_compressed.gltf"); }

TEST(MeshFile, ObjPlyAndStlGiveTheSameCube) {
    for (const char* name : {"cube.obj", "cube_ascii.ply", "cube_binary.ply", "cube_ascii.stl", "cube_binary.stl"}) expectCube(name);
}

}  // namespace
}  // namespace apertura::test
