// What somebody sees who uses it for the first time: default pictures, a ground, and options that do not fit.
#include "apertura/bake/measure/reference.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/samples.h"
#include "apertura/bake/scene/ground.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/program.h"

namespace apertura::test {
namespace {

// Where the scene's vertices lie in a picture, -1..1 across and up it.
Box inPicture(const Scene& scene, const Camera& camera, double aspect) {
    Box out;
    const glm::mat4 toClip = clipTransform(camera, aspect, 1e-3);
    for (const Instance& instance : scene.instances)
        for (const glm::vec3& p : scene.surfaces[size_t(instance.surface)].positions) {
            const glm::vec4 clip = toClip * glm::vec4(glm::vec3(worldPosition(instance, p)), 1);
            const glm::vec3 at(clip.x / clip.w, clip.y / clip.w, clip.w > 0 ? 0 : 1);
            out = {glm::min(out.low, at), glm::max(out.high, at)};
        }
    return out;
}

TEST(FirstLook, TheDefaultCameraFillsThePicture) {
    for (const char* name : {"statue", "terrain", "forest"})
        for (const double aspect : {16.0 / 9, 1.0, 0.5}) {
            Scene scene = makeBuiltin(name);
            scene.cameras.clear();
            for (Instance& instance : scene.instances) instance.toWorld[3] += glm::vec4(300, -20, 5, 0);
            const Box seen = inPicture(scene, viewOf(scene, aspect), aspect);
            EXPECT_EQ(seen.high.z, 0) << "behind the eye";
            const float width = std::max(-seen.low.x, seen.high.x), height = std::max(-seen.low.y, seen.high.y);
            EXPECT_NEAR(std::max(width, height), 0.92f, 5e-3f) << name << ", " << aspect;
            // It stands in the middle, of both sides.
            EXPECT_NEAR(-seen.low.x, seen.high.x, 0.02) << name;
            EXPECT_NEAR(-seen.low.y, seen.high.y, 0.02) << name;
        }
}

// A plane that rises away from the eye: its near end is much wider in the picture than its far one.
TEST(FirstLook, TheDefaultCameraSeesAllOfWhatIsFarFromRound) {
    Random random(3);
    for (int i = 0; i < 300; ++i) {
        const double width = std::pow(10, random(-1, 2)), length = std::pow(10, random(-1, 3)), slope = random(-2, 2),
                     turn = random(0, 2 * pi);
        Scene scene;
        Surface ramp;
        for (const double z : {-0.5, 0.5})
            for (const double x : {-0.5, 0.5}) {
                const double a = x * width, b = z * length;
                ramp.positions.emplace_back(a * std::cos(turn) - b * std::sin(turn), slope * b, a * std::sin(turn) + b * std::cos(turn));
            }
        ramp.triangles = {{0, 2, 3}, {0, 3, 1}};
        scene.surfaces = {ramp};
        scene.instances = {{0}};
        for (const double aspect : {16.0 / 9, 0.5}) {
            const Box seen = inPicture(scene, viewOf(scene, aspect), aspect);
            EXPECT_EQ(seen.high.z, 0) << "behind the eye";
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_GE(seen.low[axis], -0.925f) << width << " x " << length << ", slope " << slope;
                EXPECT_LE(seen.high[axis], 0.925f) << width << " x " << length << ", slope " << slope;
            }
            EXPECT_GT(std::max({-seen.low.x, seen.high.x, -seen.low.y, seen.high.y}), 0.75f);
        }
    }
}

// The extent of what stands on the ground, and where it stands.
void expectGround(const Scene& before, const Scene& after, float tolerance) {
    const Box box = worldBounds(before), all = worldBounds(after);
    const glm::vec3 size = box.high - box.low;
    const float extent = std::max({size.x, size.y, size.z});
    EXPECT_EQ(after.instances.size(), before.instances.size() + 1);
    EXPECT_NEAR(all.high.x - all.low.x, kGroundSize * extent, tolerance);
    EXPECT_NEAR(all.high.z - all.low.z, kGroundSize * extent, tolerance);
    EXPECT_NEAR(all.low.y, box.low.y, 1e-3f * extent);
    EXPECT_LT(all.low.y, box.low.y);
    EXPECT_EQ(all.high.y, box.high.y);
    // What it is seen by frames what stands on it.
    EXPECT_LT(glm::length(viewOf(after).eye - viewOf(before).eye), 1e-3f * extent);
}

TEST(FirstLook, AGroundLiesUnderWhatHasNone) {
    const Folder folder;
    const Scene statue = makeBuiltin("statue");
    expectGround(statue, withGround(statue), 1e-4f);
    for (const char* file : {"cube.glb", "cube_compressed.gltf"}) {
        const Scene cube = loadScene(smallScene(file));
        const Scene grounded = withGround(cube);
        expectGround(cube, grounded, 1e-3f);
        // And the asset holds it.
        BakedVisibility seen;
        for (const Instance& instance : grounded.instances)
            seen.push_back({std::vector<Visibility>(grounded.surfaces[size_t(instance.surface)].positions.size(), Visibility{{0, 3, 0}, 6}),
                            {},
                            {},
                            {}});
        writeAsset(folder / "a.glb", grounded, seen, {});
        expectGround(cube, loadAsset(folder / "a.glb").scene, 1e-3f);
    }
}

TEST(FirstLook, AGroundKeepsItsShapeFarAway) {
    Scene far = loadScene(smallScene("cube.obj"));
    far.instances[0].toWorld[3] = glm::vec4(1e7f, 5e6f, 1e7f, 1);
    const Scene grounded = withGround(far);
    const Surface& ground = grounded.surfaces.back();
    for (const auto& t : ground.triangles)
        EXPECT_GT(glm::length(glm::cross(ground.positions[t[1]] - ground.positions[t[0]], ground.positions[t[2]] - ground.positions[t[0]])),
                  0);
    EXPECT_LT(worldBounds(grounded).low.y, worldBounds(far).low.y);
    Scene point = loadScene(smallScene("cube.obj"));
    for (glm::vec3& p : point.surfaces[0].positions) p = glm::vec3(1);
    EXPECT_THROW(withGround(point), Error);
}

TEST(FirstLook, TheBackgroundIsItsOwn) {
    Scene scene = makeBuiltin("sphere-over-plane");
    View view;
    view.width = 40, view.height = 30;
    view.camera = {{0, 30, 0}, {0, 60, 1}};  // nothing but the sky
    view.sky = glm::vec3(0.5f, 0.6f, 0.7f);
    const Tracer tracer(scene);
    Asset asset{scene, {}, {}};
    for (const Instance& instance : scene.instances)
        asset.seen.push_back(
            {std::vector<Visibility>(scene.surfaces[size_t(instance.surface)].positions.size(), Visibility{{0, 3, 0}, 6}), {}, {}, {}});
    const Gpu gpu;
    Renderer renderer(gpu, asset);
    for (const std::optional<glm::vec3>& background : {std::optional<glm::vec3>(), std::optional(glm::vec3(0.1f, 0.2f, 0.3f))}) {
        view.background = background;
        const glm::vec3 expected = background.value_or(glm::vec3(0.5f, 0.6f, 0.7f));
        for (const Picture& picture : {traceReference(tracer, view, {}, {}), renderer.draw(view, *findModel("soft"))})
            for (const glm::vec3& pixel : picture.pixels) ASSERT_LT(glm::length(pixel - expected), 1e-3f);
    }
}

TEST(FirstLook, RaysErrAsTheirNumberSays) {
    // Area of the sky, against many rays, over some scenes.
    for (const int rays : {64, 256}) {
        double sum = 0, count = 0;
        for (const char* name : {"canyon", "colonnade", "statue", "terrain"}) {
            const Scene scene = makeBuiltin(name);
            const Tracer tracer(scene);
            const auto open = [&](const SurfacePoint& point, int n, double spin) {
                const glm::mat3 frame = frameFromZ(point.normal, spin);
                std::vector<glm::vec3> all;
                for (const glm::vec3& w : fibonacciHemisphere(n)) all.push_back(frame * w);
                std::vector<uint8_t> blocked(all.size());
                tracer.occluded(rayOrigin(tracer, point), all, kNoLimit, blocked.data());
                return double(std::count(blocked.begin(), blocked.end(), 0)) / n;
            };
            for (const SurfaceSample& p : sampleReceivers(scene, 150, 3)) {
                const double truth = open(p.at, 8192, 0);
                if (truth <= 0 || truth >= 1) continue;
                sum += std::pow(open(p.at, rays, hashUnit(1, uint64_t(count), 2) * 6) - truth, 2);
                count += 1;
            }
        }
        const double rms = std::sqrt(sum / count), said = raysError(rays).area;
        EXPECT_GT(rms, 0.6 * said) << rays;
        EXPECT_LT(rms, 1.3 * said) << rays;
    }
}

TEST(FirstLook, TruthSeesWhatTheOffsetOfABakeLeapsOver) {
    Scene scene;
    scene.name = "a gap";
    Surface floor, sheet;
    for (const float z : {-4000.0f, 4000.0f})
        for (const float x : {-4000.0f, 4000.0f}) floor.positions.emplace_back(x, 0, z);
    floor.normals.assign(4, {0, 1, 0});
    floor.triangles = {{0, 2, 3}, {0, 3, 1}};
    scene.surfaces = {floor};
    scene.instances = {{0}};
    const double offset = Tracer(scene).offset({1000, 0, 1000}, 8000.0);
    EXPECT_GT(offset, 5e-3);
    sheet = floor;
    for (glm::vec3& p : sheet.positions) p.y = float(offset / 2);
    scene.surfaces.push_back(sheet);
    scene.instances.push_back({1});
    const Tracer tracer(scene);
    const SurfacePoint point{{1000, 0, 1000}, {0, 1, 0}, 8000};
    EXPECT_FALSE(tracer.occluded(rayOrigin(tracer, point), {0, 1, 0}, kNoLimit));
    const TruthSample truth = traceLight(tracer, point, {0, 1, 0}, 0.1, 64, 0);
    EXPECT_EQ(truth.first, 0);
    EXPECT_EQ(truth.second, 0);
}

TEST(FirstLook, WhatDoesNotFitIsSaid) {
    const Folder folder;
    const std::string cube = smallScene("cube.obj"), map = smallScene("heights_u16.png"), out = folder / "o.glb";
    expectRefusal("bake " + cube + " --spacing 3 -o " + out, 2, "--spacing is for height maps");
    expectRefusal("compare " + cube + " --terrain-rgb", 2, "--terrain-rgb is for height maps");
    expectRefusal("chart " + cube + " --vertical-scale 2 -o " + (folder / "c"), 2, "--vertical-scale is for height maps");
    expectRefusal("compare builtin:room-1 --models soft --tolerance .1", 2, "--tolerance is for the model auto");
    expectRefusal("chart builtin:room-1 --models soft --tolerance .1 -o " + (folder / "c"), 2, "--tolerance is for the model auto");
    expectRefusal("bake " + map + " --spacing 0 -o " + out, 2, "--spacing: '0' is not a positive number");
    expectRefusal("bake " + map + " --ground -o " + out, 2, "is a height map, which is a ground itself");
    expectRefusal("chart builtin:room-1 --headline 7 -o " + (folder / "c"), 2, "--headline: 7 is not one of --light-radii");
    expectRefusal("render " + cube + " --model reference --background blue -o " + (folder / "a.png"), 2,
                  "neither a colour RRGGBB nor the word sky");
    expectRefusal("render " + cube + " --model reference -o " + (folder / "a.jpg"), 2, "pictures are .png or .exr");
    expectRefusal("info " + cube, 1, "make one of it with `apertura bake`");
    const Result baked = run("bake " + cube + " --ground --model soft --rays 64 -o " + out);
    EXPECT_EQ(baked.code, 0) << baked.error;
    EXPECT_NE(baked.out.find("soft is made from the four numbers when it is drawn"), std::string::npos) << baked.out;
    expectRefusal("render " + out + " --ground -o " + (folder / "a.png"), 1, "is baked already");
    const Result info = run("info " + out);
    EXPECT_NE(info.out.find("error bounds  of the bytes alone"), std::string::npos) << info.out;
    EXPECT_NE(info.out.find("rays add      about 0.019 of the hemisphere in area"), std::string::npos) << info.out;
    EXPECT_NE(info.out.find("m above the surface"), std::string::npos) << info.out;
    EXPECT_EQ(run("render " + out + " --size 32x32 --sky '#ff8800' --background sky -o " + (folder / "a.png")).code, 0);
}

}  // namespace
}  // namespace apertura::test
