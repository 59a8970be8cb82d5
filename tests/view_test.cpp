// The window, on a virtual screen: scripts of keys and mouse, whose pictures are those of `apertura render`; and films.
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "apertura/bake/scene/geotiff.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/png.h"
#include "tests/program.h"

namespace apertura::test {
namespace {

// A virtual screen for as long as the object lives. `words`: before a program that is to show its window there.
struct Screen {
    Folder folder;
    std::string words;
    Screen() {
        const std::string number = folder / "number", process = folder / "process";
        const std::string command = "Xvfb -displayfd 3 -screen 0 1024x768x24 -nolisten tcp 3>" + number + " >/dev/null 2>&1 & echo $! >"
                                  + process;
        EXPECT_EQ(std::system(command.c_str()), 0);
        std::string display;
        for (int i = 0; i < 600 && display.find('\n') == std::string::npos; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            display = slurp(number);
        }
        EXPECT_NE(display.find('\n'), std::string::npos) << "Xvfb (package xvfb) does not start";
        words = "env -u WAYLAND_DISPLAY DISPLAY=:" + display.substr(0, display.find('\n'));
    }
    ~Screen() { EXPECT_EQ(std::system(("kill $(cat " + (folder / "process") + ")").c_str()), 0); }
};

class View : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = new Folder;
        screen = new Screen;
        EXPECT_EQ(run("bake builtin:arcade -o " + *folder / "arcade.glb" + " --rays 32 --at vertices").code, 0);
    }
    static void TearDownTestSuite() {
        delete screen;
        delete folder;
    }
    // The output of `view`, which must succeed, without a word on standard error.
    static std::string replay(const std::string& script, const std::string& more = "") {
        const Result r = run("view " + *folder / "arcade.glb" + " --script " + folder->write("script.txt", script) + " --save "
                                 + folder->path.string() + " --size 200x120 --validate " + more,
                             screen->words);
        EXPECT_EQ(r.code, 0) << r.error;
        EXPECT_EQ(withoutProgress(r.error), "");
        return r.out;
    }
    static Folder* folder;
    static Screen* screen;
};
Folder* View::folder = nullptr;
Screen* View::screen = nullptr;

PngImage png(const std::string& path) { return decodePng(readFile(path), path); }

// The largest difference of two pictures, of 255.
int largest(const std::string& a, const std::string& b) {
    const PngImage x = png(a), y = png(b);
    EXPECT_EQ(x.samples.size(), y.samples.size());
    int out = 0;
    for (size_t i = 0; i < std::min(x.samples.size(), y.samples.size()); ++i)
        out = std::max(out, std::abs(int(x.samples[i]) - int(y.samples[i])));
    return out;
}

TEST_F(View, ShowsWhatRenderDraws) {
    const std::string lights = folder->write("lamps.json", R"([{"at":[0,2,-1],"radius":0.3,"radiance":[20,10,4]}])");
    const std::string out = replay(
        "# from the file's camera\nwait\nline\nsave 0.png\n"
        "drag left 60 60 90 75\nwheel 1\nwait\nline\nsave 1.png\n"
        "drag right 60 60 20 70\nkey n\nwait\nline\nsave 2.png\n"
        "model aperture\nkey home\nkey left\nsun 200 30\nwait\nline\nsave 3.png\n"
        "drag middle 60 60 70 50\nkey up\nwait\nline\nsave 4.png\n",
        "--lights " + lights + " --tone neutral --exposure 0.5");
    std::istringstream all(out);
    int count = 0;
    for (std::string line; std::getline(all, line); ++count) {
        const std::string begin = "apertura render ", name = std::to_string(count) + ".png";
        ASSERT_EQ(line.rfind(begin, 0), 0u) << line;
        const size_t o = line.find("picture.png");
        const std::string drawn = *folder / ("drawn" + name);
        EXPECT_EQ(run(line.substr(begin.size() - 7, o - begin.size() + 7) + drawn + line.substr(o + 11)).code, 0) << line;
        EXPECT_LE(largest(*folder / name, drawn), 1) << line;
        if (count == 0) continue;
        EXPECT_GT(largest(*folder / name, *folder / (std::to_string(count - 1) + ".png")), 20) << line;
    }
    EXPECT_EQ(count, 5);
}

TEST_F(View, MakesNothingWhileTheSunAndLampsMove) {
    const std::string lights = folder->write("two.json", R"([{"at":[0,2,-1],"radius":0.3,"radiance":[20,10,4]},
        {"at":[2,1,2],"radius":0.2,"radiance":[4,10,40]}])");
    for (const std::string& more : {std::string(), "--lights " + lights}) {
        const auto made = nlohmann::json::parse(replay("wait\nframes 300\n", more));
        EXPECT_EQ(made["frames"], 300);
        EXPECT_EQ(made["pipelines"], 0) << more;
        EXPECT_EQ(made["allocations"], 0) << more;
        EXPECT_EQ(made["copies"], 0) << more;
    }
}

TEST_F(View, ComparesWithTruth) {
    replay("key t\nwait converged\nsave split.png\nkey t\nkey tab\nsecond shadow-map\nwait\nsave models.png\nclick 100 90\nwait 1\n",
           "--sun-radius 10");
    // Right of the middle stands the reference, left of it the model.
    EXPECT_EQ(run("render " + *folder / "arcade.glb" + " -o " + *folder / "left.png --size 200x120 --sun-radius 10").code, 0);
    EXPECT_EQ(
        run("render " + *folder / "arcade.glb" + " -o " + *folder / "right.png --size 200x120 --sun-radius 10 --model reference").code, 0);
    const PngImage split = png(*folder / "split.png"), left = png(*folder / "left.png"), right = png(*folder / "right.png");
    double apart[2][2]{};  // of each half from each picture
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 200; ++x)
            for (int c = 0; c < 3; ++c) {
                const size_t at = (size_t(y) * 200 + size_t(x)) * 3 + size_t(c);
                apart[x >= 100][0] += std::abs(int(split.samples[at]) - int(left.samples[at]));
                apart[x >= 100][1] += std::abs(int(split.samples[at]) - int(right.samples[at]));
            }
    EXPECT_LT(apart[0][0], 0.1 * apart[0][1]);
    EXPECT_LT(apart[1][1], 0.5 * apart[1][0]);
}

// A second picture that was not drawn while the handle stood at the edge is drawn when it comes back.
TEST_F(View, TheSecondPictureIsNeverOld) {
    replay(
        "second ao-area\nwait\ndrag left 100 60 260 60\ndrag right 60 60 120 30\nwait\ndrag left 199 60 0 60\nwait\nline\nsave "
        "second.png\n");
    const std::string line = replay("model ao-area\ndrag right 60 60 120 30\nwait\nsave only.png\n");
    EXPECT_LE(largest(*folder / "second.png", *folder / "only.png"), 1);
}

TEST_F(View, BakesWhatIsNotBaked) {
    const Result r = run("view " + smallScene("cube.gltf") + " --script " + folder->write("s.txt", "wait\nsave cube.png\n") + " --save "
                             + folder->path.string() + " --size 64x64",
                         screen->words);
    EXPECT_EQ(r.code, 0) << r.error;
    EXPECT_NE(r.out.find("baked for this window alone"), std::string::npos) << r.out;
    EXPECT_EQ(png(*folder / "cube.png").width, 64);
}

TEST_F(View, SweepsAHeightMap) {
    const std::string map = *folder / "map.tif", glb = *folder / "map.glb";
    writeGeoTiff(map, 90, 70, {}, {"heights"}, [](const auto& put) {
        std::vector<float> band;
        for (int y = 0; y < 70; ++y)
            for (int x = 0; x < 90; ++x) band.push_back(float(8 * std::sin(x * 0.2) * std::cos(y * 0.15)));
        put(0, 0, band);
    });
    const Result shown = run("view " + map + " --script " + folder->write("map.txt", "wait\nsave map.png\n") + " --save "
                                 + folder->path.string() + " --size 200x120 --validate",
                             screen->words);
    ASSERT_EQ(shown.code, 0) << shown.error;
    // As `bake` and `render` have it, but for the bytes of the asset.
    ASSERT_EQ(run("bake " + map + " -o " + glb + " --bits 16").code, 0);
    ASSERT_EQ(run("render " + glb + " -o " + (*folder / "same.png") + " --size 200x120").code, 0);
    EXPECT_LE(largest(*folder / "map.png", *folder / "same.png"), 3);
}

TEST_F(View, SaysWhatIsWrongInOneLine) {
    const std::string glb = *folder / "arcade.glb";
    const auto refused = [&](const std::string& arguments, int code, const std::string& cause, const std::string& before) {
        const Result r = run("view " + arguments, before);
        EXPECT_EQ(r.code, code) << arguments << r.error;
        EXPECT_EQ(lines(withoutProgress(r.error)), 1) << r.error;
        EXPECT_NE(r.error.find(cause), std::string::npos) << r.error;
    };
    refused(glb, 1, "no window can be shown", "env -u DISPLAY -u WAYLAND_DISPLAY");
    refused(glb, 1, "no window can be shown", screen->words + " VK_ICD_FILENAMES=/nowhere VK_DRIVER_FILES=/nowhere");
    refused(glb + " --model nothing", 2, "there is no model 'nothing'", "");
    refused(glb + " --script " + folder->write("bad.txt", "wait\n\njump 3\n"), 1, "bad.txt:3: there is no command 'jump'", "");
    refused(glb + " --script " + folder->write("bad.txt", "drag left 1 2 x 4\n"), 1, "bad.txt:1: 'x' is not a number", "");
    refused(glb + " --script " + folder->write("bad.txt", "save ../a.png\n"), 1, "bad.txt:1: '../a.png'", "");
    refused(glb + " --script " + folder->write("bad.txt", "save a.png\n"), 1, "--save DIR", "");
    refused(glb + " --script " + folder->write("bad.txt", "model firm-4\n") + " --save " + folder->path.string(), 1,
            "does not hold the model firm-4", screen->words);
    refused(glb + " --script " + folder->write("bad.txt", "frames 2.5\n"), 1, "'2.5' is not a number of frames", "");
    refused(glb + " --script " + folder->write("bad.txt", "wheel 1e300\n"), 1, "too large", "");
    refused(glb + " --save " + folder->path.string(), 2, "--save is for --script", "");
    refused(glb + " --script " + folder->write("bad.txt", "wait\nmodel shadow-map\nwait\n") + " --no-sun", 1, "one light from a direction",
            screen->words);
    refused(glb + " --sky " + folder->write("bad.exr", "no picture"), 1, "bad.exr: ", "");
    refused(glb + " --lights " + folder->write("bad.json", "[1]"), 1, "light 1 is not an object", "");
}

TEST(Film, FramesFollowTheSun) {
    const Folder folder;
    ASSERT_EQ(run("bake builtin:statue -o " + folder / "s.glb" + " --rays 16 --at vertices").code, 0);
    const std::string scene = "render " + folder / "s.glb", size = " --size 48x32";
    ASSERT_EQ(run(scene + " -o " + folder / "f%04d.png --frames 3 --sun-path 90,10:200,50" + size).code, 0);
    ASSERT_EQ(run(scene + " -o " + folder / "last.png --sun-azimuth 200 --sun-elevation 50" + size).code, 0);
    ASSERT_EQ(run(scene + " -o " + folder / "middle.png --sun-azimuth 145 --sun-elevation 30" + size).code, 0);
    EXPECT_EQ(largest(folder / "f0002.png", folder / "last.png"), 0);
    EXPECT_EQ(largest(folder / "f0001.png", folder / "middle.png"), 0);
    EXPECT_GT(largest(folder / "f0000.png", folder / "f0001.png"), 20);
    for (const char* const name : {"day.mp4", "day.webp"}) {
        const Result r = run(scene + " -o " + folder / name + " --frames 4 --sun-path 90,10:200,50" + size);
        EXPECT_EQ(r.code, 0) << r.error;
        EXPECT_GT(std::filesystem::file_size(folder / name), 500u);
    }
    const size_t before = folder.files();
    const std::string lamps = folder.write("f0001.json", "[]");
    std::filesystem::create_symlink(folder / "s.glb", folder / "k0000.png");
    expectRefusal(scene + " -o " + folder / "k%04d.png --frames 1 --sun-path 1,1:2,2", 2, "is the input itself");
    std::filesystem::remove(folder / "k0000.png");
    std::filesystem::remove(lamps);
    expectRefusal(scene + " -o " + folder / "x%04d%04d.png --frames 2 --sun-path 1,1:2,2", 2, "twice");
    expectRefusal(scene + " -o " + folder / "x.mp4", 2, "--frames");
    expectRefusal(scene + " -o " + folder / "x.png --frames 3 --sun-path 90,3:100,3", 2, "%04d");
    expectRefusal(scene + " -o " + folder / "x%04d.png --frames 3 --sun-path 90", 2, "--sun-path");
    expectRefusal(scene + " -o " + folder / "x%04d.png --frames 3 --sun-path 90,3", 2, "--sun-path");
    expectRefusal(scene + " -o " + folder / "x%04d.png --frames 3 --sun-path 90,3:100,3 --sun-azimuth 20", 2, "--sun-path");
    expectRefusal(scene + " -o " + folder / "x%04d.png --frames 3", 2, "--sun-path");
    expectRefusal(scene + " -o " + folder / "x.jpg", 2, ".png or .exr");
    expectRefusal(scene + " -o " + folder / "x.exr --exposure 1", 2, "--exposure");
    const Result lost = run(scene + " -o " + folder / "x.webp --frames 2 --sun-path 90,10:200,50" + size, "env PATH=/nowhere");
    EXPECT_EQ(lost.code, 1);
    EXPECT_NE(lost.error.find("ffmpeg"), std::string::npos) << lost.error;
    EXPECT_EQ(folder.files(), before);
}

}  // namespace
}  // namespace apertura::test
