// The command line: exit codes, one line on standard error, no file left behind.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "apertura/runtime/asset/asset.h"
#include "tests/program.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

namespace fs = std::filesystem;

TEST(Cli, BakesInfoComparesAndRenders) {
    const Folder folder;
    const std::string glb = folder / "statue.glb";
    Result r = run("bake builtin:statue -o " + glb + " --rays 32 --at vertices");
    ASSERT_EQ(r.code, 0) << r.error;
    EXPECT_EQ(withoutProgress(r.error), "") << r.error;  // no progress bar in a pipe
    r = run("info " + glb + " --json");
    const auto info = nlohmann::json::parse(r.out);
    EXPECT_EQ(info["bytes_per_vertex"], 4);
    EXPECT_EQ(info["rays"], 32);
    EXPECT_EQ(info["vertices"], 50882);
    EXPECT_EQ(run("info " + glb).code, 0);
    r = run("compare " + glb + " --models aperture,soft --light-radii 5,15 --receivers 40 --json " + (folder / "c.json"));
    ASSERT_EQ(r.code, 0) << r.error;
    const auto table = nlohmann::json::parse(slurp(folder / "c.json"));
    EXPECT_EQ(table["receivers"], 40);
    ASSERT_EQ(table["rows"].size(), 4u);
    for (const auto& row : table["rows"]) {
        for (const char* key : {"model", "source", "numbers", "bytes", "light_radius_deg", "rmse", "bias", "max", "rms_truth", "noise"})
            EXPECT_TRUE(row.contains(key)) << key;
        EXPECT_EQ(row["source"], "sh");
    }
    for (const char* model : {"soft", "reference"})
        EXPECT_EQ(run("render " + glb + " -o " + (folder / model) + ".png --size 32x20 --model " + model).code, 0);
    EXPECT_EQ(run("render " + glb + " -o " + (folder / "x.exr") + " --size 32x20").code, 0);
    EXPECT_EQ(folder.files(), 5u);
}

TEST(Cli, SameBytesForAnyNumberOfThreads) {
    const Folder folder;
    for (int threads : {1, 2, 5})
        ASSERT_EQ(
            run("bake builtin:arcade -o " + (folder / std::to_string(threads)) + ".glb --rays 64 --threads " + std::to_string(threads))
                .code,
            0);
    const std::string one = slurp(folder / "1.glb");
    EXPECT_EQ(one, slurp(folder / "2.glb"));
    EXPECT_EQ(one, slurp(folder / "5.glb"));
}

TEST(Cli, HelpHasAnExample) {
    for (const char* verb : {"bake", "info", "render", "compare"}) {
        const Result r = run(std::string(verb) + " --help");
        EXPECT_EQ(r.code, 0);
        EXPECT_NE(r.out.find("Example: apertura " + std::string(verb)), std::string::npos) << r.out;
    }
    EXPECT_EQ(run("--version").code, 0);
}

TEST(Cli, WrongUseIsTwo) {
    const Folder folder;
    const std::string out = folder / "o.glb", picture = folder / "o.png";
    expectRefusal("", 2, "subcommand");
    expectRefusal("fly", 2, "fly");
    expectRefusal("bake", 2, "SCENE");
    expectRefusal("bake builtin:statue", 2, "-o");
    expectRefusal("bake builtin:statue -o " + (folder / "o.obj"), 2, ".glb");
    expectRefusal("bake builtin:statue -o " + out + " --rays 0", 2, "--rays");
    expectRefusal("bake builtin:statue -o " + out + " --rays many", 2, "--rays");
    expectRefusal("bake builtin:statue -o " + out + " --bits 12", 2, "--bits");
    expectRefusal("bake builtin:statue -o " + out + " --seed -1", 2, "--seed");
    expectRefusal("bake builtin:statue -o " + out + " --model best", 2, "--model");
    expectRefusal("bake x.tif -o " + out + " --spacing 0", 2, "0");
    expectRefusal("bake x.tif -o " + out + " --spacing 3xx", 2, "3xx");
    expectRefusal("render a.glb -o " + picture + " --model best", 2, "best");
    expectRefusal("render a.glb -o " + picture + " --size 0x9", 2, "0x9");
    expectRefusal("render a.glb -o " + picture + " --size 99999x9", 2, "--size");
    expectRefusal("render a.glb -o " + picture + " --sky blue", 2, "blue");
    expectRefusal("render a.glb -o " + picture + " --camera 1,2,3", 2, "1,2,3");
    expectRefusal("compare builtin:statue --models soft,best", 2, "best");
    expectRefusal("compare builtin:statue --light-radii 0", 2, "--light-radii");
    expectRefusal("compare builtin:statue --light-radii nan", 2, "--light-radii");
    expectRefusal("bake builtin:statue -o " + out + " --max-distance nan", 2, "--max-distance");
    expectRefusal("render a.glb -o " + picture + " --camera 0,0,0,0,0,1e300", 2, "1e300");
    expectRefusal("compare builtin:statue --receivers 0", 2, "--receivers");
    EXPECT_EQ(folder.files(), 0u);
}

TEST(Cli, WhatCannotBeDoneIsOne) {
    const Folder folder;
    const std::string out = folder / "o.glb";
    expectRefusal("bake builtin:palace -o " + out, 1, "palace");
    expectRefusal("bake no/such.obj -o " + out, 1, "no/such.obj");
    expectRefusal("bake " + folder.path.string() + " -o " + out, 1, "folder");
    expectRefusal("bake builtin:statue -o " + (folder / "no/o.glb"), 1, "no/o.glb");
    expectRefusal("bake builtin:statue -o /proc/o.glb", 1, "/proc/o.glb");
    expectRefusal("compare builtin:statue --receivers 2 --json /proc/o.json", 1, "/proc/o.json");
    expectRefusal("render builtin:statue -o " + (folder / "o.png"), 1, "apertura bake");
    expectRefusal("info builtin:statue", 1, "builtin:statue");
    EXPECT_EQ(folder.files(), 0u);
    const struct {
        const char *name, *text;
    } files[] = {{"empty.obj", ""},
                 {"none.obj", "v 0 0 0\nv 1 0 0\n"},
                 {"nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"},
                 {"range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"},
                 {"far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n"},
                 {"crash.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty "},
                 {"text.stl", "solid a\nfacet"},
                 {"scene.xyz", "hello"},
                 {"picture.png", "\x89PNG\r\n\x1a\n"}};
    for (const auto& file : files) expectRefusal("bake " + folder.write(file.name, file.text) + " -o " + out, 1, file.name);
    folder.write("pixel.ppm", "P5 1 1 255\nx");
    EXPECT_FALSE(fs::exists(out));
    EXPECT_EQ(folder.files(), std::size(files) + 1);
}

TEST(Cli, DoesNotReplaceItsInputNorWhatIsNoFile) {
    const Folder folder;
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", path = folder.write("a.obj", text);
    expectRefusal("compare " + path + " --json " + path, 2, "input itself");
    EXPECT_EQ(slurp(path), text);
    expectRefusal("compare builtin:statue --receivers 2 --json /dev/null", 1, "/dev/null");
    EXPECT_EQ(folder.files(), 1u);
}

TEST(Cli, RefusesAHeightMapOfOnePixel) {
    const Folder folder;
    // The smallest PNG: 1 x 1, 8 bits of grey.
    static const unsigned char bytes[] = {0x89, 'P',  'N',  'G',  13,  10,  26,  10,   0,    0,    0,    13,  'I',  'H',  'D',  'R',  0,
                                          0,    0,    1,    0,    0,   0,   1,   8,    0,    0,    0,    0,   0x3a, 0x7e, 0x9b, 0x55, 0,
                                          0,    0,    10,   'I',  'D', 'A', 'T', 0x78, 0x9c, 0x63, 0x60, 0,   0,    0,    2,    0,    1,
                                          0x48, 0xaf, 0xa4, 0x71, 0,   0,   0,   0,    'I',  'E',  'N',  'D', 0xae, 0x42, 0x60, 0x82};
    const std::string path = folder.write("one.png", std::string(reinterpret_cast<const char*>(bytes), sizeof bytes));
    expectRefusal("bake " + path + " -o " + (folder / "o.glb"), 1, "2 x 2");
}

TEST(Cli, RefusesWhatIsMalformedWithOneLine) {
    const Folder bad, folder;
    const std::string made = "/usr/bin/python3 -B \"" APERTURA_SOURCE "/tests/data/malformed.py\" " + bad.path.string();
    ASSERT_EQ(std::system(made.c_str()), 0);
    for (const auto& entry : fs::directory_iterator(bad.path))
        expectRefusal("bake " + entry.path().string() + " -o " + (folder / "o.glb"), 1, entry.path().filename().string());
    EXPECT_GT(bad.files(), 30u);
    EXPECT_EQ(folder.files(), 0u);
}

TEST(RealScenes, MalformedOnesAreRefusedWithOneLine) {
    NEEDS_REAL_SCENES();
    const Folder folder;
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(realScenes() / "malformed")) {
        if (!entry.is_regular_file() || entry.path().extension() == ".bin") continue;
        expectRefusal("bake " + entry.path().string() + " -o " + (folder / "o.glb"), 1, entry.path().filename().string());
        ++count;
    }
    EXPECT_GT(count, 25);
    EXPECT_EQ(folder.files(), 0u);
}

TEST(Cli, AnInterruptLeavesNothing) {
    const Folder folder;
    const pid_t pid = fork();
    if (pid == 0) {
        std::freopen("/dev/null", "w", stderr);
        execl(APERTURA_PROGRAM, APERTURA_PROGRAM, "bake", "builtin:terrain", "-o", (folder / "o.glb").c_str(), "--rays", "65536", nullptr);
        _exit(99);
    }
    std::this_thread::sleep_for(std::chrono::seconds(2));
    kill(pid, SIGINT);
    int status = 0;
    waitpid(pid, &status, 0);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
    EXPECT_EQ(folder.files(), 0u);
}

TEST(Cli, WhatCannotBeWrittenIsSaidBeforeTheWork) {
    const Folder folder;
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", latin = "caf\xe9";
    const std::string scene = folder.write(latin + ".obj", text), plain = folder.write("a.obj", text), out = folder / "o.glb";
    // The refusal must come before the rays, which would take minutes.
    const auto start = std::chrono::steady_clock::now();
    expectRefusal("bake " + scene + " -o " + out + " --rays 1048576", 1, latin + ".obj");
    expectRefusal("bake builtin:terrain -o " + (folder / std::string(252, 'n')) + ".glb --rays 1048576", 1, "name too long");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(120));
    EXPECT_EQ(folder.files(), 2u);
    EXPECT_EQ(run("bake " + plain + " -o " + (folder / latin) + ".glb --rays 4").code, 0)
        << "the name of an asset need not be UTF-8: it is not in it";
    EXPECT_EQ(run("bake " + plain + " -o " + (folder / std::string(251, 'n')) + ".glb --rays 4").code, 0);
    EXPECT_EQ(folder.files(), 4u);
}

TEST(Cli, ModelsWithHardEdgesTakeMoreRays) {
    const Folder folder;
    const std::string scene = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), glb = folder / "a.glb";
    for (const auto& [model, rays] :
         {std::pair("sh", 256), {"soft", 256}, {"soft-l2", 256}, {"auto", 256}, {"firm-2", 1024}, {"multi-2", 1024}}) {
        ASSERT_EQ(run("bake " + scene + " -o " + glb + " --at vertices --model " + model).code, 0) << model;
        EXPECT_EQ(loadAsset(glb).info.rays, rays) << model;
    }
    ASSERT_EQ(run("bake " + scene + " -o " + glb + " --at vertices --model firm-2 --rays 64").code, 0);
    EXPECT_EQ(loadAsset(glb).info.rays, 64);
}

TEST(Cli, OutputThatCannotBeWrittenIsAFailure) {
    const Folder folder;
    const std::string glb = folder / "o.glb";
    ASSERT_EQ(run("bake " + folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") + " -o " + glb + " --rays 4").code, 0);
    for (const std::string& arguments : {"info --json " + glb, "info " + glb, "compare " + glb + " --receivers 2 --models soft",
                                         std::string("--help"), std::string("bake --help")}) {
        const std::string command = std::string(APERTURA_PROGRAM) + " " + arguments + " >/dev/full 2>" + (folder / "err");
        const int status = std::system(command.c_str());
        EXPECT_EQ(WEXITSTATUS(status), 1) << arguments;
        EXPECT_NE(slurp(folder / "err").find("standard output"), std::string::npos) << slurp(folder / "err");
    }
}

TEST(Cli, FilesThatDoNotFitAreAFailure) {
    const Folder folder;
    const std::string glb = folder / "o.glb";
    ASSERT_EQ(run("bake builtin:room-1 -o " + glb + " --rays 4 --at vertices").code, 0);
    // Files are limited to a kilobyte: the picture, the table and the asset are larger.
    for (const std::string& arguments : {"render " + glb + " -o " + (folder / "p.png") + " --size 300x300",
                                         "render " + glb + " -o " + (folder / "p.exr") + " --size 300x300",
                                         "bake " + glb + " -o " + (folder / "p.glb") + " --rays 4 --at vertices",
                                         "compare " + glb + " --receivers 4 --json " + (folder / "p.json")}) {
        const int status = std::system(("ulimit -f 2; " APERTURA_PROGRAM " " + arguments + " >/dev/null 2>/dev/null").c_str());
        EXPECT_EQ(WEXITSTATUS(status), 1) << arguments;
        EXPECT_EQ(folder.files(), 1u) << arguments;
    }
}

TEST(Cli, WhatAKilledBakeLeftGoesWithTheNext) {
    const Folder folder;
    const std::string out = folder / "o.glb", scene = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    // Kill the program as soon as its temporary file exists.
    const std::string again = "bake " + scene + " -o " + out + " --rays 4";
    for (int i = 0; i < 3; ++i) {
        const pid_t pid = fork();
        if (pid == 0) {
            execl(APERTURA_PROGRAM, APERTURA_PROGRAM, "bake", "builtin:canyon", "-o", out.c_str(), "--rays", "1", "--at", "vertices",
                  nullptr);
            _exit(99);
        }
        for (int wait = 0; wait < 4000 && folder.files() < 2; ++wait) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        kill(pid, SIGKILL);
        waitpid(pid, nullptr, 0);
        ASSERT_EQ(run(again).code, 0);
        EXPECT_EQ(folder.files(), 2u) << "the scene and the asset";
        fs::remove(out);
    }
    // A file under the name that a killed run leaves, whether or not one was left above.
    folder.write(".o.apertura-0badcafe.glb", "half");
    ASSERT_EQ(run(again).code, 0);
    EXPECT_EQ(folder.files(), 2u);
}

TEST(Cli, SaysThatAnInsideOutMeshIsClosed) {
    const Folder folder;
    const char* const faces[] = {
        "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n",
        "f 4 3 1\nf 2 4 1\nf 8 6 5\nf 7 8 5\nf 6 2 1\nf 5 6 1\nf 8 7 3\nf 4 8 3\nf 7 5 1\nf 3 7 1\nf 8 4 2\nf 6 8 2\n"};
    for (const int inside : {0, 1}) {
        const std::string path = folder.write(
            "a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n") + faces[inside]);
        const Result r = run("bake " + path + " -o " + (folder / "o.glb") + " --rays 64");
        EXPECT_EQ(r.code, 0);
        EXPECT_EQ(r.out.find("wound inside out") != std::string::npos, inside == 1) << r.out;
    }
}

TEST(Cli, MutantsEndInOneLine) {
    const std::string program = APERTURA_PROGRAM;
    const Folder folder;
    const char* runs = kSanitized ? "30" : "120";  // tools/test --all does thousands
    const std::string command = std::string("/usr/bin/python3 " APERTURA_SOURCE "/tests/mutants.py ") + program
                              + " --jobs 2 --seconds 120 --runs " + runs + " --keep "
                              + (std::filesystem::temp_directory_path() / "apertura-mutants").string() + " >" + (folder / "log") + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << slurp(folder / "log");
}

TEST(Cli, AssetsPassTheKhronosValidator) {
    if (!std::getenv("GLTF_VALIDATOR")) GTEST_SKIP() << "the Khronos glTF validator is not here (tools/test installs it)";
    const Folder folder;
    // Only valid files: faults in the content of an input would be kept.
    std::vector<std::string> scenes{"builtin:canyon", smallScene("arcade.glb") + " --at texels --texels 32"};
    for (const char* name : {"cube.gltf", "cube_interleaved.glb", "cube_strips_fans.gltf", "cube_sparse.gltf", "cube_quantized.glb",
                             "cube_compressed.gltf", "cube.obj"})
        scenes.push_back(smallScene(name));
    if (fs::exists(realScenes()))
        for (const char* file : {"gltf/BoxInterleaved.glb", "gltf/CesiumMilkTruck.glb", "gltf/CesiumMilkTruck_quantized.glb",
                                 "gltf/MultiUVTest/MultiUVTest.gltf", "gltf/SimpleMeshes_embedded.gltf",
                                 "gltf/SimpleSparseAccessor_embedded.gltf", "gltf/PrimitiveMode/Mesh_PrimitiveMode_04.gltf",
                                 "gltf/VirtualCity_geom.glb", "gltf/Duck_meshopt_quantized_vp12.glb", "arch/cornell_box.obj"})
            scenes.push_back((realScenes() / file).string());
    for (const std::string& scene : scenes)
        for (const char* bits : {"8", "16"}) {
            const std::string at = scene.starts_with("builtin:") ? " --at vertices" : "";  // it is large
            ASSERT_EQ(run("bake " + scene + " -o " + (folder / "o.glb") + " --rays 4 --bits " + bits + at).code, 0) << scene;
            const std::string command = std::string("node ") + APERTURA_SOURCE + "/tests/validate_gltf.js \"$GLTF_VALIDATOR\" "
                                      + (folder / "o.glb");
            EXPECT_EQ(std::system(command.c_str()), 0) << scene;
        }
}

TEST(Cli, BakesStoredModelsAndSaysWhatAutoChose) {
    const Folder folder;
    const std::string obj = folder.write(
        "box.obj", "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -1 2 -1\nv 1 2 -1\nf 1 2 3\nf 1 3 4\nf 4 3 6\nf 4 6 5\n");
    for (const char* model : {"sh-fit", "anti", "soft-2", "soft-l2", "sh-l4", "horizon", "auto"}) {
        if (kSanitized && std::string(model).starts_with("s") && std::string(model) != "soft-2") continue;
        const std::string glb = folder / (std::string(model) + ".glb");
        Result r = run("bake " + obj + " -o " + glb + " --rays 64 --at vertices --model " + model);
        ASSERT_EQ(r.code, 0) << model << r.error;
        r = run("info " + glb + " --json");
        ASSERT_EQ(r.code, 0) << model << r.error;
        const auto info = nlohmann::json::parse(r.out);
        EXPECT_EQ(info["model"], std::string(model) == "horizon" ? "horizon-16" : model);  // its name before there were several
        if (std::string(model) == "soft-2") {
            EXPECT_EQ(info["bytes_per_vertex"], 12);
        }
        if (std::string(model) == "auto") {
            double shares = 0;
            for (const auto& [name, share] : info["auto"]["shares"].items()) shares += share.get<double>();
            EXPECT_NEAR(shares, 1, 1e-6);
            EXPECT_EQ(info["auto"]["tolerance"], 0.05);
            EXPECT_EQ(info["auto"]["price"], "numbers");
            const std::string said = run("info " + glb).out;
            EXPECT_NE(said.find("least model within 0.05, by numbers: "), std::string::npos) << said;
            EXPECT_NE(said.find("as one model for the whole scene: "), std::string::npos) << said;
        }
        const bool stored = std::string(model) != "sh-fit" && std::string(model) != "transfer";
        r = run("render " + glb + " -o " + (folder / "p.png") + " --size 32x32 --model " + (stored ? model : "soft"));
        EXPECT_EQ(r.code, 0) << model << r.error;
        r = run("compare " + glb + " --receivers 8 --light-radii 5 --models " + (stored ? model : "soft"));
        EXPECT_EQ(r.code, 0) << model << r.error;
    }
    expectRefusal("render " + (folder / "soft-2.glb") + " -o " + (folder / "q.png") + " --model horizon", 1, "does not hold horizon");
    // The file names a model whose numbers it does not hold.
    for (const char* said : {"soft", "firm-2", "nobody"}) {
        std::string bytes = slurp(folder / "soft-2.glb");
        const std::string from = "\"model\":\"soft-2\"", to = std::string("\"model\":\"") + said + "\"";
        const size_t at = bytes.find(from);
        ASSERT_NE(at, std::string::npos);
        bytes.replace(at, from.size(), to + std::string(from.size() - to.size(), ' '));
        const std::string lie = "compare " + folder.write("lie.glb", bytes) + " --receivers 4 --light-radii 5";
        if (std::string(said) != "firm-2") {
            expectRefusal(lie, 1, "lie.glb");
            continue;
        }
        const Result r = run(lie);
        EXPECT_EQ(r.code, 0) << r.error;
        EXPECT_NE(r.out.find("the four numbers alone are used"), std::string::npos) << r.out;
    }
    EXPECT_FALSE(fs::exists(folder / "q.png"));
}

TEST(Cli, RefusesTolerancesAndModelsThatAreNone) {
    expectRefusal("bake builtin:statue -o x.glb --price bytes", 2, "--price is for --model auto");
    expectRefusal("bake builtin:statue -o x.glb --model auto --price gold", 2, "gold");
    expectRefusal("render x.glb -o x.png --light-at dawn", 2, "dawn");
    const Folder folder;
    const std::string onFaces = folder / "faces.glb";
    ASSERT_EQ(run("bake builtin:arcade -o " + onFaces + " --rays 16 --storage-tolerance 0.2").code, 0);
    expectRefusal("render " + onFaces + " -o " + (folder / "f.png") + " --light-at vertices", 1, "samples on its faces");
    const std::string imaged = folder / "i.glb";
    ASSERT_EQ(run("bake " APERTURA_SOURCE "/tests/data/arcade.glb -o " + imaged + " --at texels --texels 16 --rays 8").code, 0);
    expectRefusal("render " + imaged + " -o " + (folder / "f.png") + " --light-at vertices", 1, "has images");
    const std::string out = folder / "o.glb";
    for (const char* tolerance : {"0", "-1", "nan", "inf", "much"})
        expectRefusal("bake builtin:room-1 -o " + out + " --model auto --tolerance " + tolerance, 2, "--tolerance");
    expectRefusal("bake builtin:room-1 -o " + out + " --model clever", 2, "clever");
    expectRefusal("chart builtin:room-9 -o " + (folder / "chart"), 1, "room-9");
    expectRefusal("chart -o " + (folder / "chart") + " --models clever", 2, "clever");
    const std::string file = folder.write("file", "x");
    expectRefusal("chart -o " + file + "/chart", 1, "chart");
    EXPECT_FALSE(fs::exists(out));
}

// Runs `chart` with the least that its page needs. Returns the exit code and what the program printed.
std::string chart(const Folder& folder, const std::string& environment) {
    const std::string out = folder / "chart";
    const std::string command = environment + " " APERTURA_PROGRAM " chart builtin:room-2 builtin:room-1 -o " + out
                              + " --models unshadowed,ao,soft,aperture --whole soft,aperture --receivers 12 --light-radii 1,5 >"
                              + (folder / "log") + " 2>&1";
    const int status = std::system(command.c_str());
    return std::to_string(WEXITSTATUS(status)) + " " + slurp(folder / "log");
}

TEST(Cli, ChartLeavesATableAndAPageThatSortsInABrowser) {
    const Folder folder;
    const std::string said = chart(folder, "");
    ASSERT_EQ(said[0], '0') << said;
    const std::string out = folder / "chart";
    const std::string csv = slurp(out + "/models.csv");
    EXPECT_EQ(lines(csv), 1 + 2 * 2 * 5) << csv;  // 2 scenes, 2 radii, 4 models, of which soft is from two sources
    for (const char* picture :
         {"error-bytes", "error-cycles-pixel-navi21", "error-frame-ratio", "error-bake-ratio", "scenes", "places", "worst-scenes"})
        for (const char* kind : {".png", ".svg"}) EXPECT_GT(slurp(out + "/" + picture + kind).size(), 2000u) << picture;
    // What stands under `whole` is what `compare` says of the asset.
    const std::string glb = folder / "room.glb", json = folder / "room.json";
    ASSERT_EQ(run("bake builtin:room-1 -o " + glb).code, 0);
    ASSERT_EQ(run("compare " + glb + " --models aperture --receivers 12 --light-radii 5 --json " + json).code, 0);
    const nlohmann::json row = nlohmann::json::parse(slurp(json))["rows"][0];
    std::istringstream table(csv);
    double whole = -1;
    for (std::string line; std::getline(table, line);)
        if (std::vector<std::string> cells; line.starts_with("\"builtin:room-1\",aperture,sh,")) {
            std::istringstream words(line);
            for (std::string word; std::getline(words, word, ',');) cells.push_back(word);
            if (cells[6] == "5") whole = std::stod(cells[18]);
        }
    EXPECT_NEAR(whole, row["rmse"], 1e-6);
    // And so it is under `places`, where `soft` is stored.
    ASSERT_EQ(run("compare " + glb + " --models soft --receivers 12 --light-radii 5 --json " + json).code, 0);
    const nlohmann::json soft = nlohmann::json::parse(slurp(json))["rows"][0];
    const std::string places = slurp(out + "/places.csv");
    EXPECT_EQ(lines(places), 1 + 2 * 2) << places;  // no coordinates, no images
    const size_t faces = places.find("\"builtin:room-1\",faces,0,");
    ASSERT_NE(faces, std::string::npos) << places;
    double bytes = 0, rmse = 0;
    ASSERT_EQ(std::sscanf(places.c_str() + faces, "\"builtin:room-1\",faces,0,%lf,%lf,", &bytes, &rmse), 2);
    EXPECT_NEAR(rmse, soft["rmse"], 1e-6);
    EXPECT_GT(bytes, 100);
    const std::string html = slurp(out + "/index.html");
    EXPECT_EQ(html.find("src=\"http"), std::string::npos);
    EXPECT_EQ(html.find('@'), std::string::npos);
    if (!fs::exists("/usr/bin/chromium")) GTEST_SKIP() << "there is no Chromium";
    // Click on RMSE, the sixth column, then read the column that the browser shows.
    const std::string probe =
        "<script>document.querySelectorAll('#all th')[5].click();"
        "document.body.innerHTML = 'SORTED ' + [...document.getElementById('all').tBodies[0].rows].map(r => r.cells[5].textContent).join(' "
        "') + ' END';</script></body>";
    std::string changed = html;
    changed.replace(changed.find("</body>"), 7, probe);
    const std::string page = folder.write("probe.html", changed);
    std::system(("timeout 60 /usr/bin/chromium --headless --no-sandbox --disable-gpu --user-data-dir=" + (folder / "profile")
                 + " --dump-dom file://" + page + " >" + (folder / "dom") + " 2>/dev/null")
                    .c_str());
    const std::string dom = slurp(folder / "dom");
    const size_t at = dom.find("SORTED ");
    ASSERT_NE(at, std::string::npos) << dom.substr(0, 300);
    std::istringstream words(dom.substr(at + 7, dom.find(" END", at) - at - 7));
    std::vector<double> values;
    for (double v; words >> v;) values.push_back(v);
    EXPECT_EQ(values.size(), 3u * 2 * 5);  // the mean and two scenes
    EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
}

TEST(Cli, ChartWithoutMatplotlibStillLeavesTheTable) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the test before it runs the same code";
#endif
    const Folder folder;
    const std::string said = chart(folder, "APERTURA_PYTHON='/usr/bin/python3 -S'");  // without any package
    EXPECT_EQ(said[0], '1') << said;
    EXPECT_NE(said.find("matplotlib is missing"), std::string::npos) << said;
    EXPECT_GT(lines(slurp(folder / "chart/models.csv")), 10);
}

TEST(Cli, StabilityLeavesTablesAndCharts) {
    const Folder folder;
    const std::string out = folder / "stability";
    const std::string command = APERTURA_PROGRAM " stability -o " + out + " --models oat,aperture --inputs "
                              + (kSanitized ? "2000" : "20000") + " --device-inputs 500 --receivers 1 >" + (folder / "log") + " 2>&1";
    const int status = std::system(command.c_str());
    ASSERT_EQ(WEXITSTATUS(status), 0) << slurp(folder / "log");
    for (const char* table : {"sweeps.csv", "scenes.csv", "map.csv", "counts.csv", "decode.csv", "mixing.csv", "half.csv", "seams.csv"})
        EXPECT_GE(lines(slurp(out + "/" + table)), 3) << table;
    for (const char* picture :
         {"sweep-errors.png", "sweep-steps.svg", "scene-steps.png", "failures.png", "decode.png", "mixing.png", "half.png"})
        EXPECT_GT(slurp(out + "/" + picture).size(), 2000u) << picture;
    expectRefusal("stability -o " + (folder / "other") + " --models clever", 2, "clever");
    expectRefusal("stability -o " + folder.write("file", "x") + "/deep", 1, "deep");
    EXPECT_FALSE(fs::exists(folder / "other"));
}

}  // namespace
}  // namespace apertura::test
