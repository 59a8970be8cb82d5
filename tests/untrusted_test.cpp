// Damaged and hostile files make the readers do nothing but report it in one line.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/view.h"
#include "tests/gltf_text.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

namespace fs = std::filesystem;

// The error for a .gltf file of this text; empty if it is read.
std::string refusal(const Folder& folder, const std::string& text) {
    const std::string path = folder.write("in.gltf", text);
    try {
        readGltf(path);
        return {};
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find(path), 0u) << e.what();
        return e.what();
    }
}

std::string square(const std::string& extra = "", const std::string& views = "", const std::string& primitive = kFan,
                   const std::string& nodes = R"({"mesh":0})") {
    return gltf(kSquare, kView + views, kVec3, primitive, nodes, extra);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Untrusted, AnImageOutsideItsBufferIsRefused) {
    const Folder folder;
    for (const char* view : {R"({"buffer":0,"byteOffset":40,"byteLength":9})", R"({"buffer":0,"byteOffset":4000000000,"byteLength":100})"})
        EXPECT_NE(refusal(folder, square(R"(,"images":[{"bufferView":1,"mimeType":"image/png"}])", std::string(",") + view))
                      .find("outside its buffer"),
                  std::string::npos);
    EXPECT_EQ(refusal(folder,
                      square(R"(,"images":[{"bufferView":1,"mimeType":"image/png"}])", R"(,{"buffer":0,"byteOffset":40,"byteLength":8})")),
              "");
}

TEST(Untrusted, EmptyDocumentsAndAccessorsAreNoCrash) {
    const Folder folder;
    for (const char* text : {"{}", "[]", "{\"asset\":{}}", "{\"asset\":[]}", R"({"asset":{"version":"2.0"}})", R"({"asset":{"version":2}})",
                             "{\"asset\":null}", "\xEF\xBB\xBF", "{"})
        EXPECT_NE(refusal(folder, text), "") << text;
    const std::string none = R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":0})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, none, kFan)).find("no triangles"), std::string::npos);
    const std::string indices = std::string(kVec3) + R"(,{"bufferView":0,"componentType":5125,"type":"SCALAR","count":0})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, indices, R"({"attributes":{"POSITION":0},"indices":1})")).find("no triangles"),
              std::string::npos);
}

// A folder with a secret beside it; it contains a pipe, links and another folder.
struct Trap {
    Folder outer;
    fs::path home = outer.path / "home";
    Trap() {
        fs::create_directories(home / "sub");
        outer.write("secret.bin", std::string(48, 's'));
        const std::string square(reinterpret_cast<const char*>(kSquare.data()), 48);
        for (const char* name : {"home/a.bin", "home/a..b.bin", "home/sub/a.bin", "home/..c.bin", "home/with space.bin"})
            outer.write(name, square);
        fs::create_symlink("../secret.bin", home / "leads-out.bin");
        fs::create_symlink("..", home / "up");
        fs::create_symlink("a.bin", home / "stays.bin");
        mkfifo((home / "pipe.bin").c_str(), 0600);
    }
    std::string refusal(const std::string& text) const {
        outer.write("home/in.gltf", text);
        try {
            readGltf(outer / "home/in.gltf");
            return {};
        } catch (const Error& e) {
            return e.what();
        }
    }
};

TEST(Untrusted, UrisStayInTheFilesOwnFolder) {
    const Trap trap;
    const std::string data = square();
    const size_t begin = data.find("data:"), end = data.find('"', begin);
    const auto buffer = [&](const std::string& uri) { return data.substr(0, begin) + uri + data.substr(end); };
    const auto image = [&](const std::string& uri) { return square(R"(,"images":[{"uri":")" + uri + "\"}]"); };
    const std::string absolute = (trap.outer.path / "home/a.bin").string();
    for (const std::string& uri :
         {std::string("../secret.bin"), std::string("..%2Fsecret.bin"), std::string("%2e%2e/secret.bin"),
          std::string("sub/../../secret.bin"), std::string("up/secret.bin"), std::string("leads-out.bin"), std::string("/etc/passwd"),
          "file://" + absolute, std::string("file:a.bin"), absolute, std::string("http://localhost/a.bin"), std::string("pipe.bin"),
          std::string("sub"), std::string("."), std::string("a.bin%00"), std::string("%zz"), std::string("data:,plain"),
          std::string("data:;base64,*")}) {
        for (const std::string& text : {buffer(uri), image(uri)}) {
            const auto start = std::chrono::steady_clock::now();
            const std::string said = trap.refusal(text);
            EXPECT_NE(said.find("'" + uri), std::string::npos) << uri << ": " << said;
            EXPECT_EQ(said.find("bad_alloc"), std::string::npos) << said;
            EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60)) << "waits for a pipe: " << uri;
        }
    }
    // A link behind a folder that does not exist is not followed either.
    for (const std::string& text : {buffer("nothing/../leads-out.bin"), image("nothing/../leads-out.bin")}) {
        const std::string said = trap.refusal(text);
        if (!said.empty()) {
            EXPECT_NE(said.find("there is no file"), std::string::npos) << said;
        } else {
            const GltfDocument document = readGltfDocument(trap.outer / "home/in.gltf");
            EXPECT_TRUE(document.images[0]->empty()) << "the secret";
        }
    }
    for (const char* uri : {"a.bin", "./a.bin", "sub/a.bin", "sub/../a.bin", "a..b.bin", "..c.bin", "%61.bin", "with%20space.bin",
                            "with space.bin", "stays.bin"}) {
        EXPECT_EQ(trap.refusal(buffer(uri)), "") << uri;
        EXPECT_EQ(trap.refusal(image(uri)), "") << uri;
    }
}

TEST(Untrusted, BuffersAreOfTheLengthThatTheDocumentStates) {
    const Folder folder;
    for (const size_t size : {0, 47, 49, 480}) {
        folder.write("a.bin", std::string(size, '\0'));
        std::string text = replaced(square(), "data:", "a.bin\",\"was\":\"data:");
        EXPECT_NE(refusal(folder, text).find("'a.bin'"), std::string::npos) << size;
    }
    EXPECT_NE(refusal(folder, replaced(square(), "\"byteLength\":48,\"uri\"", "\"byteLength\":49,\"uri\"")).find("48 bytes"),
              std::string::npos);
}

TEST(Untrusted, AMissingImageIsSaidAndKept) {
    const Folder folder;
    const Scene scene = readGltf(folder.write("a.gltf", square(R"(,"images":[{"uri":"gone.png","name":"wood"}])")));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("gone.png"), std::string::npos);
    writeAsset(folder / "o.glb", scene, {{std::vector<Visibility>(4), {}}}, {});
    EXPECT_EQ(readGltf(folder / "o.glb").document->json["images"][0].dump(), R"({"name":"wood","uri":"gone.png"})");
}

TEST(Untrusted, FallbackBuffersAreNotAllocated) {
    const Folder folder;
    // Four fallback buffers of 256 MiB, as gltfpack writes them for readers without the extension; then a view of one
    // without compression.
    std::string buffers;
    for (int i = 0; i < 4; ++i) buffers += R"(,{"byteLength":268435456,"extensions":{"EXT_meshopt_compression":{"fallback":true}}})";
    const std::string text = replaced(square(), "}],\"bufferViews\"", "}" + buffers + "],\"bufferViews\"");
    const GltfDocument document = readGltfDocument(folder.write("a.gltf", text));
    ASSERT_EQ(document.buffers.size(), 5u);
    for (int i = 1; i < 5; ++i) EXPECT_EQ(document.buffers[size_t(i)]->size(), 0u);
    EXPECT_NE(
        refusal(folder, replaced(text, R"({"buffer":0,"byteLength":48})", R"({"buffer":1,"byteLength":48})")).find("outside its buffer"),
        std::string::npos);
    // Views that claim to decode to 256 MiB, from too few compressed bytes.
    for (const char* mode : {"ATTRIBUTES", "TRIANGLES", "INDICES"}) {
        const std::string packed =
            std::string(
                R"(,{"buffer":1,"byteLength":268435456,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteLength":48,"byteStride":4,"count":67108863,"mode":")")
            + mode + "\"}}}";
        EXPECT_NE(refusal(folder, replaced(text, kView, kView + packed)).find("damaged"), std::string::npos) << mode;
    }
}

TEST(Untrusted, InstancesAreCountedBeforeTheyAreSpelledOut) {
    const Folder folder;
    // 16 000 nodes of 65 536 instances each, from zeros that take no bytes: 10^9 nodes.
    std::string nodes = "{\"children\":[1";
    for (int i = 2; i <= 16000; ++i) nodes += "," + std::to_string(i);
    nodes += "]}";
    for (int i = 1; i <= 16000; ++i) nodes += R"(,{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}})";
    const std::string zeros = R"(,{"componentType":5126,"type":"VEC3","count":65536})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, kVec3 + zeros, kFan, nodes)).find("1048576000 instances would take"), std::string::npos);
    // Positions of zeros, many more than the file has bytes.
    const std::string many =
        R"({"componentType":5126,"type":"VEC3","count":2000000000,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, many, kFan)).find("more than a file of its size can mean"), std::string::npos);
}

TEST(Untrusted, InstancesAreAsManyAsEachOfTheirAttributesHas) {
    const Folder folder;
    const std::string counts = std::string(kVec3) + R"(,{"componentType":5126,"type":"VEC4","count":0})";
    const std::string node = R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"ROTATION":1,"TRANSLATION":0}}}})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, counts, kFan, node)).find("differ in length"), std::string::npos);
    // Each instance keeps the weights and the application's own number.
    const std::string own =
        R"({"mesh":0,"weights":[0.5],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0,"_ID":1}}}})";
    const std::string ids = std::string(kVec3) + R"(,{"bufferView":0,"componentType":5121,"type":"SCALAR","count":4})";
    const Scene scene = readGltf(folder.write("a.gltf", gltf(kSquare, kView, ids, kFan, own)));
    const Json& nodes = scene.document->json["nodes"];
    EXPECT_FALSE(nodes[0].contains("weights"));
    for (size_t i = 1; i < 5; ++i) {
        EXPECT_EQ(nodes[i]["weights"].dump(), "[0.5]");
        EXPECT_TRUE(nodes[i]["extras"].contains("_ID"));
    }
}

TEST(Untrusted, OneFileOfManyNamesIsReadOnce) {
    const Folder folder;
    folder.write("a.png", "\x89PNG" + std::string(100, 'x'));
    const GltfDocument document = readGltfDocument(
        folder.write("a.gltf", square(R"(,"images":[{"uri":"a.png"},{"uri":"./a.png"},{"uri":"%61.png"}])")));
    EXPECT_EQ(document.images[0], document.images[1]);
    EXPECT_EQ(document.images[0], document.images[2]);
}

TEST(Untrusted, WhatIsRepeatedIsBounded) {
    const Folder folder;
    // Many primitives of one accessor of zeros; many instances of a mesh with much JSON.
    std::string primitives = kFan;
    const std::string zeros = R"({"componentType":5126,"type":"VEC3","count":65536})";
    for (int i = 0; i < 1000; ++i) primitives += std::string(",") + kFan;
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, zeros, primitives)).find("more than a file of its size can mean"), std::string::npos);
    const std::string places = std::string(kVec3) + R"(,{"componentType":5126,"type":"VEC3","count":60000})";
    const std::string extras = R"({"attributes":{"POSITION":0},"mode":6,"extras":")" + std::string(40000, 'x') + "\"}";
    const Scene scene = readGltf(folder.write(
        "b.gltf",
        gltf(kSquare, kView, places, extras, R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}})")));
    BakedVisibility seen(scene.instances.size(), {std::vector<Visibility>(4), {}});
    EXPECT_THROW(writeAsset(folder / "o.glb", scene, seen, {}), Error);
}

TEST(Untrusted, ACameraFarOffOrOfNoUseIsNoCrash) {
    const Folder folder;
    for (const char* translation : {"1e8", "1e14", "1e20", "1e300"})
        for (const char* fov : {"0.7", "3.2", "1e300"}) {
            const std::string nodes = std::string(R"({"mesh":0,"children":[1]},{"camera":0,"translation":[)") + translation + ",0,0]}";
            const std::string text = square(
                std::string(R"(,"cameras":[{"type":"perspective","perspective":{"yfov":)") + fov + R"(,"znear":0.1}}])", "", kFan, nodes);
            const Scene scene = readGltf(folder.write("a.gltf", text));
            const glm::vec3 ray = rayThrough(viewOf(scene), 1.5, 0.3, 0.3);
            EXPECT_TRUE(std::isfinite(glm::length(ray)) && glm::length(ray) > 0) << translation << " " << fov;
        }
}

TEST(Untrusted, AMorphTargetHasAnElementAVertex) {
    const Folder folder;
    const std::string two = std::string(kVec3) + R"(,{"bufferView":0,"componentType":5126,"type":"VEC3","count":2})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, two, R"({"attributes":{"POSITION":0},"targets":[{"POSITION":1}],"mode":6})"))
                  .find("one element a vertex"),
              std::string::npos);
}

TEST(Untrusted, FlatAndTinyInstancesAreTraced) {
    const Folder folder;
    // Two instances of one mesh: unchanged, and turned with a singular or extreme scale.
    for (const char* scale : {"[1,1,0]", "[1,1e-9,1]", "[1e-20,1e-20,1e-20]", "[0,0,0]", "[1e-12,1e12,1]"}) {
        const std::string nodes = std::string(R"({"children":[1,2]},{"mesh":0},{"mesh":0,"rotation":[0.5,0.5,0.1,0.7],"scale":)") + scale
                                + "}";
        const Scene scene = readGltf(folder.write("a.gltf", square("", "", kFan, nodes)));
        const Tracer tracer(scene);
        for (const SeenByInstance& seen : bakeVertices(scene, tracer, {}))
            for (const Visibility& v : seen.visibility) EXPECT_TRUE(std::isfinite(v.area)) << scale;
    }
}

TEST(Untrusted, WhatIsNotGltfTwoIsSaid) {
    const Folder folder;
    const struct {
        const char *from, *to, *said;
    } cases[] = {
        {R"("version":"2.0")", R"("version":"3.0")", "version '3.0'"},
        {R"("version":"2.0")", R"("version":"2.1","minVersion":"2.1")", "needs a reader of glTF 2.1"},
        {R"("version":"2.0")", R"("version":"1.1")", "is glTF 1.1"},
        {R"("scene":0)", R"("scene":1)", "but there are 1 scenes"},
        {R"("mode":6)", R"("mode":7)", "mode 7"},
        {R"("mode":6)", R"("mode":-1)", "whole number"},
        {R"({"buffer":0,"byteLength":48})", R"({"buffer":0,"byteOffset":-4,"byteLength":48})", "byteOffset"},
        {R"({"buffer":0,"byteLength":48})", R"({"buffer":0,"byteStride":-12,"byteLength":48})", "byteStride"},
        {R"({"buffer":0,"byteLength":48})", R"({"buffer":0.5,"byteLength":48})", "buffer"},
        {R"({"buffer":0,"byteLength":48})", R"({"buffer":0,"byteStride":2,"byteLength":48})", "outside"},
        {R"("count":4)", R"("count":"4")", "count"},
        {R"("count":4)", R"("count":1e30)", "count"},
        {R"({"mesh":0})", R"({"mesh":0,"matrix":["1",0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})", "16 numbers"},
        {R"({"mesh":0})", R"({"mesh":0,"scale":[1,1]})", "3 numbers"},
        {R"({"mesh":0})", R"({"mesh":0,"children":[1]})", "nodes"},
        {R"({"POSITION":0})", R"({"POSITION":"0"})", "POSITION"},
        {R"({"attributes":{"POSITION":0},"mode":6})", R"({"attributes":{"POSITION":0},"indices":0})", "holds no indices"},
        {R"("componentType":5126)", R"("componentType":5130)", "component type"},
        {R"("type":"VEC3")", R"("type":"VEC5")", "type"},
    };
    for (const auto& c : cases)
        EXPECT_NE(refusal(folder, replaced(square(), c.from, c.to)).find(c.said), std::string::npos)
            << c.to << ": " << refusal(folder, replaced(square(), c.from, c.to));
    // Indices of the right shape, but floats.
    const std::string floats = std::string(kVec3) + R"(,{"bufferView":0,"componentType":5126,"type":"SCALAR","count":3})";
    EXPECT_NE(refusal(folder, gltf(kSquare, kView, floats, R"({"attributes":{"POSITION":0},"indices":1})")).find("holds no indices"),
              std::string::npos);
    EXPECT_EQ(refusal(folder, replaced(square(), R"("version":"2.0")", R"("version":"2.1","minVersion":"2.0")")), "");
    EXPECT_EQ(refusal(folder, replaced(square(), R"("count":4)", R"("count":4.0)")), "");
}

// An uncompressed TIFF of 2 x 2 texels of three bytes.
std::string tinyTiff(const std::string& texels) {
    std::string out("II*\0\x08\0\0\0", 8);
    auto put = [&](uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) out += char(value >> (8 * i) & 255);
    };
    const uint32_t fields[][4] = {{256, 3, 1, 2},   {257, 3, 1, 2}, {258, 3, 3, 134}, {259, 3, 1, 1},  {262, 3, 1, 2},
                                  {273, 4, 1, 140}, {277, 3, 1, 3}, {278, 3, 1, 2},   {279, 4, 1, 12}, {284, 3, 1, 1}};
    put(std::size(fields), 2);
    for (const auto& f : fields) put(f[0], 2), put(f[1], 2), put(f[2], 4), put(f[3], 4);
    put(0, 4);
    for (int i = 0; i < 3; ++i) put(8, 2);
    return out + texels;
}

TEST(Untrusted, TerrariumTilesAreNoTerrainRgb) {
    const Folder folder;
    // For 100 m Terrarium packs 256 R + G + B / 256 = 32768 + 100; Terrain-RGB packs 65536 R + 256 G + B = (10000 + 100) * 10.
    std::string terrarium, mapbox;
    for (int i = 0; i < 4; ++i) {
        terrarium += std::string("\x80\x64\0", 3);
        const int code = (10000 + 100 + i) * 10;
        for (const int shift : {16, 8, 0}) mapbox += char(code >> shift & 255);
    }
    const std::string path = folder.write("a.tif", tinyTiff(terrarium));
    try {
        loadScene(path, {1, 1, 1, true});
        ADD_FAILURE() << "mountains of 832 km";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("not packed as Terrain-RGB"), std::string::npos) << e.what();
    }
    const Scene scene = loadScene(folder.write("b.tif", tinyTiff(mapbox)), {1, 1, 1, true});
    EXPECT_NEAR(scene.surfaces[0].positions[3].y, 103, 1e-3);
}

TEST(Untrusted, AnImageOfAnotherFormatIsNotTried) {
    const Folder folder;
    for (const char* head : {"BM", "P6\n2 2\n255\n", "DDS ", "GIF89a", "#?RADIANCE\n"})
        EXPECT_THROW(loadScene(folder.write("a.png", head + std::string(200, '\1'))), Error) << head;
}

TEST(Untrusted, AMeshFileOpensNothingElse) {
    const Folder folder;
    mkfifo((folder.path / "pipe.mtl").c_str(), 0600);
    const std::string obj = "mtllib pipe.mtl\nmtllib ../../../dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(triangleCount(loadScene(folder.write("a.obj", obj))), 1u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60)) << "waits for a pipe";
    mkfifo((folder.path / "scene.obj").c_str(), 0600);
    mkfifo((folder.path / "scene.glb").c_str(), 0600);
    EXPECT_THROW(loadScene(folder / "scene.obj"), Error);
    EXPECT_THROW(loadScene(folder / "scene.glb"), Error);
}

TEST(PendingFile, LeavesNothingAndClearsWhatAKilledRunLeft) {
    const Folder folder;
    const std::string path = folder / "a.glb";
    std::string left, held;
    {
        PendingFile file(path);
        left = file.name();
        folder.write("other.apertura-00000000.glb", "not ours");
        EXPECT_EQ(folder.files(), 2u);
        const PendingFile second(path);  // two runs at once have different temporary names
        EXPECT_TRUE(fs::exists(left)) << "the lock holds";
        EXPECT_NE(second.name(), left);
    }
    EXPECT_EQ(folder.files(), 1u);
    std::ofstream(left) << "what a killed run left";
    const int fd = open((folder.write(".a.apertura-01234567.glb", "being written")).c_str(), O_RDWR);
    ASSERT_EQ(flock(fd, LOCK_EX), 0);
    writeTextFile(folder / "b.glb", "another name");
    EXPECT_EQ(folder.files(), 4u);
    writeTextFile(path, "whole");
    EXPECT_FALSE(fs::exists(left));
    EXPECT_TRUE(fs::exists(folder / ".a.apertura-01234567.glb"));
    close(fd);
    writeTextFile(path, "whole again");
    EXPECT_EQ(folder.files(), 3u);  // a, b, other
}

TEST(PendingFile, NamesAsLongAsTheFileSystemTakes) {
    const Folder folder;
    for (const size_t length : {100, 240, 246, 250, 255}) {
        const std::string name = std::string(length - 4, 'n') + ".glb";
        writeTextFile(folder / name, "x");
        EXPECT_TRUE(fs::exists(folder / name)) << length;
    }
    EXPECT_THROW(PendingFile(folder / (std::string(252, 'n') + ".glb")), Error);
    EXPECT_EQ(folder.files(), 5u);
}

}  // namespace
}  // namespace apertura::test
