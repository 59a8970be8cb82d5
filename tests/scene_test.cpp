// Scenes from files: what the readers accept and what they refuse.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "tests/gltf_text.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

double areaOf(const Scene& scene) {
    double sum = 0;
    for (const Instance& instance : scene.instances)
        for (const auto& t : scene.surfaces[instance.surface].triangles) {
            const auto& p = scene.surfaces[instance.surface].positions;
            const glm::mat3 m(instance.toWorld);
            sum += 0.5 * glm::length(glm::cross(m * (p[t[1]] - p[t[0]]), m * (p[t[2]] - p[t[0]])));
        }
    return sum;
}

// A rotation or reflection after a stretch along three orthogonal axes: rotationPart removes the stretch.
TEST(RotationPart, IsWhatStretchingLeaves) {
    Random random(1);
    const auto axes = [&] {
        const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
        return glm::dmat3(x, y, glm::cross(x, y));
    };
    for (int i = 0; i < 1000; ++i) {
        const glm::dmat3 rotation = i % 2 ? axes() : -axes(), along = axes();
        const double size = std::pow(10, random(-12, 12));
        glm::dmat3 stretch(0);
        for (int c = 0; c < 3; ++c) stretch[c][c] = size * std::pow(10, random(-1, 1));
        const glm::mat3 back = rotationPart(glm::mat4(glm::mat3(rotation * along * stretch * glm::transpose(along))));
        for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length(glm::dvec3(back[c]) - rotation[c]), 1e-5) << i;
    }
}

TEST(RotationPart, IsWhatStretchingLeavesHoweverFlat) {
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
        const glm::dmat3 rotation = glm::dmat3(x, y, glm::cross(x, y)) * (i % 2 ? 1.0 : -1.0);
        const double thin = std::pow(10, -random(0, 16));
        // Columns in float32 keep their directions, whatever their lengths.
        const glm::mat3 back = rotationPart(glm::mat4(glm::mat3(rotation[0], rotation[1] * thin, rotation[2] * 0.7 * thin)));
        for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length(glm::dvec3(back[c]) - rotation[c]), 1e-5) << thin;
    }
}

TEST(RotationPart, OfAFlatTransformIsNone) {
    glm::mat4 flat(1);
    flat[0] = {0, 3, 0, 0};
    flat[1] = {2, 0, 0, 0};
    flat[2] = {0, 0, 0, 0};
    EXPECT_EQ(rotationPart(flat), glm::mat3(1));
    EXPECT_EQ(rotationPart(glm::mat4(0)), glm::mat3(1));
}

TEST(Gltf, StripsAndFansKeepTheirWinding) {
    const Folder folder;
    for (int mode : {5, 6}) {
        // A square as the fan 0 1 2 3, and as a strip in Z order.
        std::vector<float> data = kSquare;
        if (mode == 5) data = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        const Scene scene = readGltf(
            folder.write("a.gltf", gltf(data, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":)" + std::to_string(mode) + "}")));
        EXPECT_EQ(triangleCount(scene), 2u);
        EXPECT_NEAR(areaOf(scene), 1, 1e-6);
        for (const glm::vec3& n : scene.surfaces[0].normals) EXPECT_NEAR(n.z, 1, 1e-6);
        EXPECT_TRUE(scene.surfaces[0].normalsMade);
    }
}

TEST(Gltf, InterleavedSparseAndTransformed) {
    const Folder folder;
    // Positions and normals are interleaved (stride 24); a sparse accessor moves vertex 2 to (3, 3, 0).
    std::vector<float> data;
    for (int i = 0; i < 4; ++i) {
        data.insert(data.end(), kSquare.begin() + 3 * i, kSquare.begin() + 3 * i + 3);
        data.insert(data.end(), {0, 0, 2});
    }
    const uint32_t index = 2;
    float asFloat;
    std::memcpy(&asFloat, &index, 4);
    data.insert(data.end(), {asFloat, 3, 3, 0});
    const std::string views =
        R"({"buffer":0,"byteLength":96,"byteStride":24},{"buffer":0,"byteOffset":96,"byteLength":4},{"buffer":0,"byteOffset":100,"byteLength":12})";
    const std::string accessors =
        R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4,"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5125},"values":{"bufferView":2}}},)"
        R"({"bufferView":0,"byteOffset":12,"componentType":5126,"type":"VEC3","count":4})";
    const std::string nodes = R"({"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]})";
    const Scene scene = readGltf(
        folder.write("a.gltf", gltf(data, views, accessors, R"({"attributes":{"POSITION":0,"NORMAL":1},"mode":6})", nodes)));
    EXPECT_EQ(scene.surfaces[0].positions[2], glm::vec3(3, 3, 0));
    EXPECT_NEAR(scene.surfaces[0].normals[1].z, 1, 1e-6);  // normalised
    const Box box = worldBounds(scene);
    EXPECT_NEAR(box.low.x, 10, 1e-5);
    EXPECT_NEAR(box.high.x, 16, 1e-5);
}

TEST(Gltf, RefusesWhatIsBrokenWithOneLine) {
    const Folder folder;
    const std::string all = R"({"attributes":{"POSITION":0},"mode":4})";
    const struct {
        const char* what;
        std::string text;
    } cases[] = {
        {"outside its buffer",
         gltf(kSquare, R"({"buffer":0,"byteLength":480})", R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":40})", all)},
        {"out of range",
         gltf(
             {0, 0, 0, 1, 0, 0, 1, 1, 0, 7e-45f, 7e-45f, 7e-45f}, std::string(kView) + R"(,{"buffer":0,"byteOffset":36,"byteLength":12})",
             R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":3})",
             R"({"attributes":{"POSITION":0},"indices":1})")},
        {"not a finite number", gltf({0, 0, 0, NAN, 0, 0, 1, 1, 0, 0, 1, 0}, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":6})")},
        {"no triangles", gltf(kSquare, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":0})")},
        {"its own ancestor", gltf(kSquare, kView, kVec3, all, R"({"mesh":0,"children":[0]})")},
        {"two parents", gltf(kSquare, kView, kVec3, all, R"({"children":[1,1]},{"mesh":0})")},
        {"nested too deep", std::string(100000, '[')},
        {"KHR_draco_mesh_compression",
         gltf(kSquare, kView, kVec3, all, R"({"mesh":0})", R"(,"extensionsRequired":["KHR_draco_mesh_compression"])")},
        {"not a valid glTF", "{\"asset\": 3"},
        {"the file is empty", ""},
    };
    for (const auto& c : cases) {
        const std::string path = folder.write("bad.gltf", c.text);
        try {
            readGltf(path);
            ADD_FAILURE() << "accepted: " << c.what;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(c.what), std::string::npos) << e.what();
            EXPECT_EQ(std::string(e.what()).find(path), 0u) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        }
    }
}

TEST(Asset, KeepsContentAndGivesEachInstanceItsOwn) {
    const Folder folder;
    const std::string nodes =
        R"({"name":"root","children":[1,2],"extras":{"keep":[12345678901,"two",null,{}]}},{"mesh":0},{"mesh":0,"translation":[0,0,0.5],"rotation":[0,1,0,0]})";
    const std::string path = folder.write("a.gltf",
                                          gltf(kSquare, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":6,"material":0})", nodes,
                                               R"(,"materials":[{"name":"clay","pbrMetallicRoughness":{"roughnessFactor":0.25}}])"));
    const Scene scene = readGltf(path);
    ASSERT_EQ(scene.instances.size(), 2u);
    BakedVisibility given;
    Random random(31);
    for (int i = 0; i < 2; ++i) {
        given.emplace_back();
        for (int v = 0; v < 4; ++v) {
            const double area = random(0.5, 6);
            given.back().visibility.push_back({vec3(random.direction() * area * 0.4), float(area)});
        }
    }
    for (int bits : {8, 16}) {
        BakeInfo info;
        info.version = "1.2.3";
        info.bits = bits;
        info.seed = 4000000000u;
        const std::string out = folder / "out.glb";
        writeAsset(out, scene, given, info);
        const Asset back = loadAsset(out);
        EXPECT_EQ(back.info.seed, 4000000000u);
        EXPECT_EQ(back.info.bits, bits);
        ASSERT_EQ(back.seen.size(), 2u);
        for (int i = 0; i < 2; ++i)
            for (int v = 0; v < 4; ++v) {
                EXPECT_NEAR(back.seen[i].visibility[v].area, given[i].visibility[v].area, bits == 8 ? 0.03 : 1e-4);
                EXPECT_LT(glm::length(back.seen[i].visibility[v].direction - given[i].visibility[v].direction), bits == 8 ? 0.06 : 3e-4);
            }
        const Json& json = back.scene.document->json;
        EXPECT_EQ(json["nodes"][0]["name"], "root");
        EXPECT_EQ(json["nodes"][0]["extras"]["keep"].dump(), R"([12345678901,"two",null,{}])");
        EXPECT_EQ(json["materials"][0]["name"], "clay");
        EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"], 0.25);
        ASSERT_EQ(json["meshes"].size(), 2u);  // one mesh, two skies
        const Json &one = json["meshes"][0]["primitives"][0], &two = json["meshes"][1]["primitives"][0];
        EXPECT_EQ(one["attributes"]["POSITION"], two["attributes"]["POSITION"]);
        EXPECT_NE(one["attributes"]["_VISIBILITY"], two["attributes"]["_VISIBILITY"]);
        EXPECT_EQ(two["material"], 0);
    }
}

TEST(Asset, HoldsDirectionsInTheFrameOfThePrimitive) {
    const Folder folder;
    // The node turns x to y: a direction along y in the world is stored along x.
    const std::string nodes = R"({"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[3,3,3]})";
    const Scene scene = readGltf(folder.write("a.gltf", gltf(kSquare, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":6})", nodes)));
    const float area = 2, length = area * (1 - area / float(4 * pi));
    const BakedVisibility given{{{{vec3(0, length, 0), area}, {}, {}, {}}, {}}};
    writeAsset(folder / "out.glb", scene, given, {});
    const Scene back = readGltf(folder / "out.glb");
    const Json& primitive = back.document->json["meshes"][0]["primitives"][0];
    const auto stored = readAccessor(*back.document, primitive["attributes"]["_VISIBILITY"].get<size_t>(), 4);
    EXPECT_NEAR(stored[0], length / area, 0.005);
    EXPECT_NEAR(stored[1], 0, 0.005);
    EXPECT_NEAR(stored[3], 2 * std::sqrt(area / (2 * pi)) - 1, 0.005);
    EXPECT_EQ(stored[7], -1);  // a closed point
}

TEST(Asset, TruncatedOrWithoutVisibilityIsRefused) {
    const Folder folder;
    const Scene scene = readGltf(folder.write("a.gltf", gltf(kSquare, kView, kVec3, R"({"attributes":{"POSITION":0},"mode":6})")));
    writeAsset(folder / "out.glb", scene, {{std::vector<Visibility>(4), {}}}, {});
    std::string bytes;
    {
        std::ifstream in(folder / "out.glb", std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    for (size_t size : {size_t(0), size_t(3), size_t(12), size_t(19), bytes.size() / 2, bytes.size() - 1})
        EXPECT_THROW(loadAsset(folder.write("cut.glb", bytes.substr(0, size))), Error) << size;
    EXPECT_THROW(loadAsset(folder / "a.gltf"), Error);
    EXPECT_THROW(writeAsset(folder / "no/where.glb", scene, {{std::vector<Visibility>(4), {}}}, {}), Error);
}

TEST(Asset, RefusesWhatIsNoVisibilityOrNoBuffer) {
    const Folder folder;
    // _VISIBILITY as floats is refused: an asset has normalised bytes or shorts.
    std::vector<float> data = kSquare;
    data.resize(28);
    const std::string views = std::string(kView) + R"(,{"buffer":0,"byteOffset":48,"byteLength":64})";
    const std::string accessors = std::string(kVec3) + R"(,{"bufferView":1,"componentType":5126,"type":"VEC4","count":4})";
    EXPECT_THROW(
        loadAsset(folder.write("f.gltf", gltf(data, views, accessors, R"({"attributes":{"POSITION":0,"_VISIBILITY":1},"mode":6})"))),
        Error);
    // An unused view of a buffer that does not exist.
    EXPECT_THROW(readGltf(folder.write("b.gltf", gltf(kSquare, std::string(kView) + R"(,{"buffer":100000000,"byteLength":4})", kVec3,
                                                      R"({"attributes":{"POSITION":0},"mode":6})"))),
                 Error);
}

TEST(RealScenes, HeightMapsHaveTheirSizesAndHeights) {
    NEEDS_REAL_SCENES();
    const auto dem = realScenes() / "dem";
    const Scene andes = loadScene((dem / "andes_S33W071_srtm3_1201.tif").string(), {90, 90});
    EXPECT_EQ(andes.surfaces[0].positions.size(), 1201u * 1201);
    Box box = worldBounds(andes);
    EXPECT_EQ(box.low.y, 250);
    EXPECT_EQ(box.high.y, 6929);
    EXPECT_NEAR(box.high.x - box.low.x, 1200 * 90, 0.1);
    const Scene png = loadScene((dem / "andes_S33W071_srtm3_1201_u16.png").string(), {90, 90});
    EXPECT_EQ(png.surfaces[0].positions, andes.surfaces[0].positions);
    const Scene helens = loadScene((dem / "st_helens_usgs_327x468_i16_nodata.tif").string());
    EXPECT_EQ(helens.surfaces[0].positions.size(), 327u * 468 - 4151);
    box = worldBounds(helens);
    EXPECT_EQ(box.low.y, 682);
    EXPECT_EQ(box.high.y, 2543);
    const Scene fuji = loadScene((dem / "fuji_terrainrgb_512.png").string(), {1, 1, 1, true});
    box = worldBounds(fuji);
    EXPECT_NEAR(box.low.y, 13.7, 0.05);
    EXPECT_NEAR(box.high.y, 3751, 0.5);
    for (const glm::vec3& n : andes.surfaces[0].normals) ASSERT_GT(n.y, 0);
}

TEST(RealScenes, MeshesHaveTheirCountsAndBounds) {
    NEEDS_REAL_SCENES();
    const struct {
        const char* file;
        size_t triangles;
        glm::vec3 low, high;
    } cases[] = {
        {"statues/stanford_bunny.obj", 69451, {-0.09469f, 0.03299f, -0.06187f}, {0.06101f, 0.1873f, 0.0588f}},
        {"statues/stanford_dragon_res2.ply", 202520, {-0.1082f, 0.05274f, -0.05035f}, {0.09641f, 0.1971f, 0.04114f}},
        {"arch/cornell_box.obj", 36, {0, 0, 0}, {556, 548.8f, 559.2f}},
        {"gltf/BoxInterleaved.glb", 12, {-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}},
        {"gltf/CesiumMilkTruck.glb", 3624, {-2.431f, 0.001452f, -1.396f}, {2.438f, 2.584f, 1.396f}},
        {"gltf/CesiumMilkTruck_quantized.glb", 3624, {-2.431f, 0.001445f, -1.396f}, {2.438f, 2.584f, 1.396f}},
        {"gltf/Duck_meshopt_quantized_vp12.glb", 4212, {-0.693f, 0.09929f, -0.6133f}, {0.9618f, 1.64f, 0.5392f}},
        {"gltf/MultiUVTest/MultiUVTest.gltf", 12, {-1, -1, -1}, {1, 1, 1}},
        {"gltf/PrimitiveMode/Mesh_PrimitiveMode_04.gltf", 2, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
        {"gltf/PrimitiveMode/Mesh_PrimitiveMode_12.gltf", 2, {-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}},
        {"gltf/SimpleMeshes_embedded.gltf", 2, {0, 0, 0}, {2, 1, 0}},
        {"gltf/SimpleSparseAccessor_embedded.gltf", 12, {0, 0, 0}, {6, 4, 0}},
        {"gltf/VirtualCity_geom.glb", 8327, {-82.95f, -0.9539f, -82.45f}, {83.09f, 13.2f, 85.99f}},
        {"gltf/teapots_galore/teapots_galore.gltf", 7656770, {-339.4f, 0, -339.4f}, {339.4f, 13.3f, 339.4f}},
    };
    for (const auto& c : cases) {
        const Scene scene = loadScene((realScenes() / c.file).string());
        EXPECT_EQ(triangleCount(scene), c.triangles) << c.file;
        const Box box = worldBounds(scene);
        const float size = glm::length(c.high - c.low);
        EXPECT_LT(glm::length(box.low - c.low), 1e-3f * size) << c.file;
        EXPECT_LT(glm::length(box.high - c.high), 1e-3f * size) << c.file;
    }
}

TEST(MeshFile, NormalsAreMadeAndSplitAtEdges) {
    const Folder folder;
    // A cube of 8 shared vertices: its edges of 90 degrees are split, so that each face gets its own normals.
    const std::string obj =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    const Scene scene = loadScene(folder.write("cube.obj", obj));
    EXPECT_EQ(scene.surfaces[0].positions.size(), 24u);
    for (const glm::vec3& n : scene.surfaces[0].normals) EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-5);
}

}  // namespace
}  // namespace apertura::test
