// A bake keeps the content of a glTF file, value by value, except what it has to change.
#include <algorithm>
#include <cctype>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/measure.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/view.h"
#include "tests/gltf_text.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

namespace fs = std::filesystem;

Json jsonOf(const std::string& path) {
    const Bytes bytes = readFile(path);
    const GltfContainer container = splitContainer(bytes, path);
    return Json::parse(container.json.begin(), container.json.end());
}

// Visibility with every vertex closed, for tests of everything else in the file.
BakedVisibility closedEverywhere(const Scene& scene) {
    BakedVisibility out;
    for (const Instance& instance : scene.instances)
        out.push_back({std::vector<Visibility>(scene.surfaces[size_t(instance.surface)].positions.size()), {}});
    return out;
}

// True for places in the JSON that baking changes. Other tests check these, or their bytes.
bool isOurs(const std::string& at) {
    std::string place;  // `at` with # for indices
    for (size_t i = 0; i < at.size(); ++i) {
        const bool digit = std::isdigit(uint8_t(at[i])) != 0;
        if (!digit) place += at[i];
        if (digit && !place.ends_with('#')) place += '#';
    }
    for (const char* whole : {"/asset/generator", "/bufferViews/#/buffer", "/bufferViews/#/byteOffset", "/images/#/uri", "/nodes/#/mesh"})
        if (place == whole) return true;
    for (const char* from : {"/buffers", "/bufferViews/#/extensions/EXT_meshopt_compression", "/extensionsUsed", "/extensionsRequired"})
        if (place.starts_with(from)) return true;
    return false;
}

// Adds the places where `in` has what `out` has not to `missing`.
void compare(const Json& in, const Json& out, const std::string& at, std::vector<std::string>& missing) {
    if (isOurs(at)) return;
    if (in.is_object() && out.is_object()) {
        for (const auto& [key, value] : in.items()) {
            const std::string below = at + "/" + key;
            if (isOurs(below)) continue;
            if (out.contains(key))
                compare(value, out[key], below, missing);
            else if (!(key == "extensions" && value.contains("EXT_meshopt_compression")))
                missing.push_back(below);
        }
    } else if (in.is_array() && out.is_array() && out.size() >= in.size()) {
        for (size_t i = 0; i < in.size(); ++i) compare(in[i], out[i], at + "/" + std::to_string(i), missing);
    } else if (in != out || in.dump() != out.dump()) {
        missing.push_back(at + ": " + in.dump() + " became " + out.dump());
    }
}

// True if vertices are split or instances become nodes: the indices of accessors then change.
bool isRebuilt(const Scene& scene, const Json& in) {
    const bool flat = std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [](const Surface& s) { return s.normalsMade; });
    return flat || in.dump().find("EXT_mesh_gpu_instancing") != std::string::npos;
}

// Writes a copy with every vertex closed and compares. Returns whether accessors could be compared too.
bool expectKept(const std::string& path) {
    const Folder folder;
    const std::string written = folder / "o.glb";
    const Scene scene = readGltf(path);
    writeAsset(written, scene, closedEverywhere(scene), {});
    Json in = jsonOf(path), out = jsonOf(written);
    const bool rebuilt = isRebuilt(scene, in);
    if (rebuilt)
        for (const char* key : {"accessors", "bufferViews", "meshes", "nodes"}) in.erase(key);
    std::vector<std::string> missing;
    compare(in, out, "", missing);
    EXPECT_TRUE(missing.empty()) << path << ": " << missing.size() << ", first " << missing.front();
    const Scene back = readGltf(written);
    EXPECT_EQ(back.instances.size(), scene.instances.size()) << path;
    for (size_t i = 0; i < std::min(back.instances.size(), scene.instances.size()); ++i) {
        const Surface &a = scene.surfaces[size_t(scene.instances[i].surface)], &b = back.surfaces[size_t(back.instances[i].surface)];
        EXPECT_EQ(a.positions, b.positions) << path;
        EXPECT_EQ(a.triangles, b.triangles) << path;
        EXPECT_EQ(a.twoSided, b.twoSided) << path;
        EXPECT_EQ(scene.instances[i].toWorld, back.instances[i].toWorld) << path;
    }
    if (!rebuilt)
        for (size_t i = 0; i < listOf(in, "accessors").size(); ++i) {
            const std::vector<uint32_t> first{0};
            if (accessorCount(*scene.document, i) == 0) continue;
            EXPECT_EQ(gatherAccessor(*scene.document, i, first).bytes, gatherAccessor(*back.document, i, first).bytes)
                << path << " accessor " << i;
        }
    for (size_t i = 0; i < scene.document->images.size(); ++i)
        if (!scene.document->images[i]->empty()) {
            const auto bytes = viewBytes(*back.document, back.document->json["images"][i]["bufferView"].get<size_t>());
            EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), scene.document->images[i]->begin(), scene.document->images[i]->end()))
                << path;
        }
    return !rebuilt;
}

const char* const kNormals = R"({"bufferView":0,"byteOffset":48,"componentType":5126,"type":"VEC3","count":4})";
std::vector<float> squareWithNormals() {
    std::vector<float> data = kSquare;
    for (int i = 0; i < 4; ++i) data.insert(data.end(), {0, 0, 1});
    return data;
}
const char* const kView96 = R"({"buffer":0,"byteLength":96})";
const char* const kBoth = R"({"attributes":{"POSITION":0,"NORMAL":1},"mode":6})";

TEST(RoundTrip, OddValuesComeOutAsTheyWere) {
    const Folder folder;
    const std::string odd =
        R"({"large":9007199254740993,"larger":18446744073709551615,"least":-9223372036854775808,"list":[null,{},[],[null],""],"none":null,"empty":{},"nothing":[],"real":0.1,"tiny":1e-300,"text":"\u0000\u001b[31m\ud83d\ude00"})";
    const std::string extras = R"("extras":)" + odd;
    const std::string node =
        R"({"mesh":0,"extensions":{"VENDOR_thing":)" + odd + "}," + extras
        + R"(,"unheard":[null]},{"camera":0,"matrix":[-0.9993908270190958,-0.03489949670250097,0,0,0.03489949670250097,-0.9993908270190958,0,0,0,0,1,0,0,0,5,1]})";
    const std::string extra =
        R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],"extensionsUsed":["VENDOR_thing"],"extensions":{"VENDOR_thing":)"
        + odd + "}," + extras + R"(,"skins":[],"materials":[{"pbrMetallicRoughness":{"roughnessFactor":1.0},)" + extras + "}]";
    std::string text = gltf(squareWithNormals(), R"({"buffer":0,"byteLength":96,)" + extras + "}", std::string(kVec3) + "," + kNormals,
                            kBoth, node, extra);
    text.replace(text.find("\"nodes\":[0]"), 11, "\"nodes\":[0,1]");
    text.replace(text.find("\"uri\":\"data"), 5, extras + ",\"uri\"");
    const std::string path = folder.write("odd.gltf", text);
    EXPECT_TRUE(expectKept(path));
    const Scene scene = readGltf(path);
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    const Json out = jsonOf(folder / "o.glb");
    EXPECT_EQ(out["buffers"][0]["extras"].dump(), Json::parse(odd).dump());
    // The camera is rolled by 178 degrees.
    const Scene back = readGltf(folder / "o.glb");
    ASSERT_EQ(back.cameras.size(), 1u);
    EXPECT_NEAR(back.cameras[0].up.y, std::cos(178 * pi / 180), 1e-5);
    EXPECT_NEAR(back.cameras[0].up.x, std::sin(178 * pi / 180), 1e-5);
    const glm::vec3 top = rayThrough(back.cameras[0], 1, 0.5, 0), middle = rayThrough(back.cameras[0], 1, 0.5, 0.5);
    EXPECT_LT(top.y, middle.y) << "drawn upside down, as the file has it";
}

TEST(RoundTrip, WhatSeveralBuffersHeldIsKept) {
    const Folder folder;
    folder.write("b.bin", std::string(16, 'b'));
    std::string text = gltf(squareWithNormals(), std::string(kView96) + R"(,{"buffer":1,"byteOffset":4,"byteLength":8,"name":"rest"})",
                            std::string(kVec3) + "," + kNormals, kBoth);
    text.replace(text.find("}],\"bufferViews\""), 1, R"(},{"byteLength":16,"uri":"b.bin","name":"second","extras":{"x":[null]}})");
    const std::string path = folder.write("two.gltf", text);
    EXPECT_TRUE(expectKept(path));
    for (int bakes = 0; bakes < 2; ++bakes) {
        const Scene scene = readGltf(bakes ? folder / "o.glb" : path);
        writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
        const Json out = jsonOf(folder / "o.glb");
        EXPECT_EQ(out["asset"]["extras"]["apertura"]["mergedBuffers"].dump(),
                  R"([{"buffer":1,"content":{"extras":{"x":[null]},"name":"second"}}])");
        const GltfDocument back = readGltfDocument(folder / "o.glb");
        const auto rest = viewBytes(back, 1);
        EXPECT_EQ(std::string(rest.begin(), rest.end()), "bbbbbbbb");
    }
}

TEST(RoundTrip, ListsOfBuffersGrowWithWhatToolsAdd) {
    const Folder folder;
    folder.write("b.bin", std::string(16, 'b'));
    std::string text = gltf(squareWithNormals(), std::string(kView96) + R"(,{"buffer":1,"byteLength":8})",
                            std::string(kVec3) + "," + kNormals, kBoth);
    text.replace(text.find("}],\"bufferViews\""), 1, R"(},{"byteLength":16,"uri":"b.bin","name":"second"})");
    text.replace(text.find(R"("version":"2.0")"), 15,
                 R"("version":"2.0","generator":"a tool","extras":{"apertura":{"mergedBuffers":[{"content":{"name":"first"}}]}})");
    const Scene scene = readGltf(folder.write("a.gltf", text));
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    const Json ours = jsonOf(folder / "o.glb")["asset"]["extras"]["apertura"];
    ASSERT_EQ(ours["mergedBuffers"].size(), 2u);
    EXPECT_EQ(ours["mergedBuffers"][0]["content"]["name"], "first");
    EXPECT_EQ(ours["inputGenerator"], "a tool");
    text.replace(text.find(R"([{"content)"), std::string(R"([{"content":{"name":"first"}}])").size(), "5");  // a list of another's
    const Scene other = readGltf(folder.write("c.gltf", text));
    writeAsset(folder / "o.glb", other, closedEverywhere(other), {});
    EXPECT_EQ(jsonOf(folder / "o.glb")["asset"]["extras"]["apertura"]["mergedBuffers"].size(), 1u);
}

TEST(RoundTrip, ImagesKeepTheirKind) {
    const Folder folder;
    const std::string text = gltf(squareWithNormals(), kView96, std::string(kVec3) + "," + kNormals, kBoth, R"({"mesh":0})",
                                  R"(,"images":[{"uri":"data:image/avif;base64,AAAA"},{"uri":"a.dds"},{"uri":"a.what"},{"uri":"a.jpg"}])");
    folder.write("a.dds", "DDS " + std::string(20, 'x'));
    folder.write("a.what", "what is it");
    folder.write("a.jpg", "\xFF\xD8\xFF" + std::string(20, 'x'));
    const Scene scene = readGltf(folder.write("a.gltf", text));
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    const Json out = jsonOf(folder / "o.glb"), images = out["images"];
    EXPECT_EQ(images[0]["mimeType"], "image/avif");
    EXPECT_EQ(images[1]["mimeType"], "image/vnd-ms.dds");
    EXPECT_EQ(images[2].dump(), R"({"uri":"a.what"})");
    EXPECT_EQ(images[3]["mimeType"], "image/jpeg");
}

TEST(RoundTrip, ASecondSetOfTheSameIsLeftOut) {
    const Folder folder;
    // An optional Draco copy, and tangents, which mean nothing without normals.
    const std::string primitive =
        R"({"attributes":{"POSITION":0,"TANGENT":1},"mode":6,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}})";
    const std::string tangents = std::string(kVec3) + R"(,{"bufferView":1,"componentType":5126,"type":"VEC4","count":4})";
    std::vector<float> data = kSquare;
    data.resize(28, 1.0f);
    const std::string views = std::string(kView) + R"(,{"buffer":0,"byteOffset":48,"byteLength":64})";
    const Scene scene = readGltf(folder.write(
        "a.gltf", gltf(data, views, tangents, primitive, R"({"mesh":0})", R"(,"extensionsUsed":["KHR_draco_mesh_compression"])")));
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    const std::string out = jsonOf(folder / "o.glb").dump();
    EXPECT_EQ(out.find("draco"), std::string::npos) << out;
    EXPECT_EQ(out.find("TANGENT"), std::string::npos) << out;
}

TEST(RoundTrip, SmallScenesOfEveryKindComeOutAsTheyWere) {
    int whole = 0;
    for (const char* name : {"cube.gltf", "cube.glb", "cube_interleaved.glb", "cube_strips_fans.gltf", "cube_sparse.gltf",
                             "cube_quantized.glb", "cube_compressed.gltf", "arcade.glb"})
        whole += expectKept(smallScene(name));
    EXPECT_EQ(whole, 2);  // those with normals of their own: the accessors of others change
}

TEST(RealScenes, FilesComeOutAsTheyWere) {
    NEEDS_REAL_SCENES();
    int whole = 0;
    for (const auto& entry : fs::recursive_directory_iterator(realScenes())) {
        const std::string path = entry.path().string(), ending = entry.path().extension().string();
        // Draco is refused; the teapots are large, and tested for their counts elsewhere.
        if (path.find("malformed") != std::string::npos || path.find("Draco") != std::string::npos
            || path.find("teapots") != std::string::npos)
            continue;
        if (ending == ".gltf" || ending == ".glb") whole += expectKept(path);
    }
    EXPECT_GE(whole, 7);
}

TEST(RoundTrip, BakingAgainReplaces) {
    const Folder folder;
    const std::string odd = folder.write("a.gltf", gltf(squareWithNormals(), kView96, std::string(kVec3) + "," + kNormals, kBoth,
                                                        R"({"children":[1,2]},{"mesh":0},{"mesh":0,"translation":[0,0,1]})"));
    auto bake = [&](const std::string& from, const char* model, int bits) {
        const Scene scene = readGltf(from);
        const Tracer tracer(scene);
        BakeOptions options;
        options.recipe = model;
        options.rays = 16;
        BakeInfo info;
        info.model = model;
        info.bits = bits;
        writeAsset(folder / "o.glb", scene, bakeVertices(scene, tracer, options), info);
        return fs::file_size(folder / "o.glb");
    };
    for (const auto& [model, bits] : {std::pair("firm-2", 8), std::pair("sh", 8), std::pair("soft-2", 16)}) {
        const auto once = bake(odd, model, bits);
        const std::string first = jsonOf(folder / "o.glb").dump();
        for (int again = 0; again < 3; ++again) {
            EXPECT_EQ(bake(folder / "o.glb", model, bits), once) << model;
            EXPECT_EQ(jsonOf(folder / "o.glb").dump(), first) << model;
        }
        // Baked over a model that stores more: its stream is removed.
        bake(folder / "o.glb", "firm-4", 16);
        EXPECT_EQ(bake(folder / "o.glb", model, bits), once) << "from firm-4 to " << model;
    }
    // An unknown extension may hold indices: accessors keep theirs.
    std::string unknown = gltf(squareWithNormals(), kView96, std::string(kVec3) + "," + kNormals, kBoth, R"({"mesh":0})",
                               R"(,"extensionsUsed":["VENDOR_thing"],"extensions":{"VENDOR_thing":{"accessor":1}})");
    bake(folder.write("b.gltf", unknown), "firm-4", 16);
    const auto once = bake(folder / "o.glb", "sh", 8);
    const std::string first = jsonOf(folder / "o.glb").dump();
    EXPECT_EQ(bake(folder / "o.glb", "sh", 8), once);
    EXPECT_EQ(jsonOf(folder / "o.glb").dump(), first);
    EXPECT_EQ(loadAsset(folder / "o.glb").seen[0].visibility.size(), 4u);
}

TEST(RealScenes, CompressedBytesGoOnceTheyAreDecoded) {
    NEEDS_REAL_SCENES();
    const Folder folder;
    const std::string path = (realScenes() / "gltf/Duck_meshopt_quantized_vp12.glb").string();
    const Scene scene = readGltf(path);
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    // Bytes per vertex: 8 of position, 4 of texture coordinates, 12 of normals as floats, 4 of visibility; 2 per index.
    size_t views = 0;
    const Json out = jsonOf(folder / "o.glb");
    for (const Json& view : out["bufferViews"]) views += view["byteLength"].get<size_t>();
    EXPECT_LT(fs::file_size(folder / "o.glb"), views + 24000);  // a texture and the JSON
    EXPECT_LT(fs::file_size(folder / "o.glb"), 150000u);
    const Scene back = readGltf(folder / "o.glb");
    for (const glm::vec3& n : back.surfaces[0].normals) EXPECT_NEAR(glm::length(n), 1, 1e-5);
}

TEST(RoundTrip, AMeshOfAnotherSceneKeepsItsOwn) {
    const Folder folder;
    std::string text = gltf(squareWithNormals(), kView96, std::string(kVec3) + "," + kNormals, kBoth,
                            R"({"mesh":0},{"mesh":0,"name":"elsewhere"})");
    text.replace(text.find("\"scenes\":[{\"nodes\":[0]}]"), 24, "\"scenes\":[{\"nodes\":[0]},{\"nodes\":[1]}]");
    for (const char* which : {"0", "1"}) {
        std::string chosen = text;
        chosen.replace(chosen.find("\"scene\":0"), 9, std::string("\"scene\":") + which);
        const Scene scene = readGltf(folder.write("a.gltf", chosen));
        writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
        const Json out = jsonOf(folder / "o.glb");
        const size_t baked = size_t(which[0] - '0');
        const auto attributes = [&](size_t node) {
            return out["meshes"][out["nodes"][node]["mesh"].get<size_t>()]["primitives"][0]["attributes"];
        };
        EXPECT_TRUE(attributes(baked).contains("_VISIBILITY"));
        EXPECT_FALSE(attributes(1 - baked).contains("_VISIBILITY"));
    }
}

TEST(RoundTrip, PrimitivesWithoutNormalsAreFlat) {
    const Folder folder;
    // A cube of 8 vertices with a colour in bytes and a morph target, and one more vertex that no face uses.
    std::vector<float> data;
    for (int i = 0; i < 8; ++i) data.insert(data.end(), {float(i & 1), float(i >> 1 & 1), float(i >> 2)});
    data.insert(data.end(), {9, 9, 9});
    const unsigned char faces[] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                   2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    unsigned char rest[36 + 36] = {};
    std::memcpy(rest, faces, 36);
    for (int i = 0; i < 9; ++i) rest[36 + 4 * i] = static_cast<unsigned char>(10 * i);
    data.resize(27 + 18);
    std::memcpy(&data[27], rest, sizeof rest);
    const std::string views =
        R"({"buffer":0,"byteLength":108,"byteStride":12},{"buffer":0,"byteOffset":108,"byteLength":36},{"buffer":0,"byteOffset":144,"byteLength":36,"byteStride":4})";
    const std::string accessors =
        R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":9,"min":[0,0,0],"max":[9,9,9],"name":"corners"},{"bufferView":1,"componentType":5121,"type":"SCALAR","count":36},)"
        R"({"bufferView":2,"componentType":5121,"type":"VEC4","count":9,"normalized":true})";
    const Scene scene = readGltf(folder.write(
        "cube.gltf",
        gltf(data, views, accessors, R"({"attributes":{"POSITION":0,"COLOR_0":2},"indices":1,"targets":[{"POSITION":0}],"mode":4})")));
    ASSERT_EQ(scene.surfaces[0].positions.size(), 24u);
    for (const auto& t : scene.surfaces[0].triangles) {
        const auto& p = scene.surfaces[0].positions;
        const glm::vec3 n = glm::normalize(glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
        for (const uint32_t v : t) EXPECT_GT(glm::dot(n, scene.surfaces[0].normals[v]), 0.99999f);
    }
    writeAsset(folder / "o.glb", scene, closedEverywhere(scene), {});
    const Scene back = readGltf(folder / "o.glb");
    EXPECT_FALSE(back.surfaces[0].normalsMade);
    EXPECT_EQ(back.surfaces[0].positions, scene.surfaces[0].positions);
    const Json primitive = back.document->json["meshes"][0]["primitives"][0];
    const auto colours = readAccessor(*back.document, primitive["attributes"]["COLOR_0"].get<size_t>(), 4);
    const auto moved = readAccessor(*back.document, primitive["targets"][0]["POSITION"].get<size_t>(), 3);
    for (size_t i = 0; i < 24; ++i) {
        const glm::vec3 p = back.surfaces[0].positions[i];
        EXPECT_NEAR(colours[4 * i] * 255, 10 * (p.x + 2 * p.y + 4 * p.z), 1e-3) << "the colour of another corner";
        EXPECT_EQ(glm::vec3(moved[3 * i], moved[3 * i + 1], moved[3 * i + 2]), p);
    }
    const Json& corners = back.document->json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
    EXPECT_EQ(corners["max"].dump(), "[1.0,1.0,1.0]");
    EXPECT_EQ(corners["name"], "corners");
    EXPECT_EQ(back.document->json["accessors"].size(), 6u) << "the replaced accessors are gone";
    // The same visibility as that of a cube of 24 vertices with normals, which an .obj file gives.
    const Scene obj = loadScene(folder.write("cube.obj",
                                             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\nf 1 3 4 2\nf 5 6 8 "
                                             "7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"));
    MeasureOptions options;
    options.models = {findModel("soft")};
    options.lightRadii = {5};
    options.receivers = 100;
    double errors[2];
    for (const Scene* cube : {&back, &obj}) {
        const Tracer tracer(*cube);
        Asset asset{*cube, bakeVertices(*cube, tracer, {}), {}};
        errors[cube == &obj] = measureAsset(asset, options).rows[0].rmse;
    }
    EXPECT_NEAR(errors[0], errors[1], 0.1 * errors[1]);
}

}  // namespace
}  // namespace apertura::test
