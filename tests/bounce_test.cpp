// Light that bounces, without paths: the ambient transfer, what is baked, and what the renderer makes of both.
#include "apertura/bake/fit/bounce.h"
#include <map>
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/bounces.h"
#include "apertura/bake/measure/reference.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/load.h"
#include "apertura/bake/scene/shapes.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/materials.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/runtime/render/renderer.h"
#include "apertura/sh/packing.h"

#include "tests/changed_gltf.h"
#include "tests/open_plane.h"
#include "tests/program.h"

namespace apertura::test {
namespace {

TEST(Bounce, TheTransferIsThePapers) {
    Random random(5);
    for (int i = 0; i < 10000; ++i) {
        const double open = i < 100 ? std::pow(10, -i / 3.0) : random();
        const dvec3 albedo(random(0, 0.95), random(0, 0.95), random(0, 0.95));
        const vec3 w = aperturaAmbientTransfer(float(open), vec3(1.0 - albedo));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(w[c], open / (1 - (1 - open) * albedo[c]), 3e-6 * (1 + open / (1 - albedo[c])));
    }
    EXPECT_EQ(aperturaAmbientTransfer(0, vec3(APERTURA_LEAST_ABSORBED)), vec3(0));
    EXPECT_EQ(aperturaAmbientTransfer(1, vec3(0.3f)), vec3(1));
}

TEST(Bounce, TheLobeOfALightHasItsShareAndItsMeanDirection) {
    for (const double length : {0.0, 0.2, 0.5, 2 / 3.0, 0.85}) {
        const dvec3 towards = length * glm::normalize(dvec3(1, 2, -2));
        dvec3 mean(0);
        double sum = 0;
        const std::vector<dvec3> lattice = sphereLattice(40000);
        for (const dvec3& w : lattice) {
            const AperturaCapLight light = apertura::aperturaCapLight(vec3(w), 0.01f);
            const double e = double(aperturaBouncedLight({vec3(0.1f), vec3(towards)}, light).y) / double(light.area);
            sum += e, mean += e * w;
        }
        // Under light from everywhere surfaces give the share of what an unblocked sky gives: pi of 4 pi.
        EXPECT_NEAR(sum / double(lattice.size()), 0.1 / 4, 1e-5) << length;
        EXPECT_NEAR(glm::distance(mean / sum, towards), 0, 2e-3) << length;
    }
}

TEST(Bounce, NothingIsInfiniteNorBrighterThanItsLight) {
    int closings = 0;
    for (const BounceSweep& sweep : bounceSweeps()) {
        EXPECT_EQ(sweep.notFinite, 0) << sweep.name << ", " << sweep.albedo;
        EXPECT_EQ(sweep.outside, 0) << sweep.name << ", " << sweep.albedo;
        // d/dO of O / (O + (1 - O) b) is 1 / b at its steepest, where nothing is open.
        if (sweep.name == "an opening closes") {
            EXPECT_LE(sweep.steepest, 1.001 / std::max(1 - sweep.albedo, double(APERTURA_LEAST_ABSORBED)));
            ++closings;
        }
    }
    EXPECT_EQ(closings, 7);
}

TEST(Bounce, BytesKeepWhatTheyPromise) {
    Random random(8);
    for (int i = 0; i < 20000; ++i) {
        const AperturaBounce b{vec3(float(random()), float(std::pow(10, random(-6, 0))), i == 0 ? 1.0f : 0.0f),
                               vec3(random.direction() * random())};
        const PackedBounce p = pack(b);
        const AperturaBounce back = unpackBounce(vec3(p.share[0], p.share[1], p.share[2]) / 255.0f,
                                                 vec3(p.towards[0], p.towards[1], p.towards[2]) / 127.0f);
        for (int c = 0; c < 3; ++c) {
            EXPECT_LE(std::abs(back.share[c] - b.share[c]), std::sqrt(b.share[c]) / 255 + 4e-6f);
            EXPECT_LE(std::abs(back.towards[c] - b.towards[c]), 0.5f / 127 + 0.004f);
        }
    }
    const PackedBounce wild = pack({vec3(7, -1, 0.25f), vec3(0, -30, 0)});
    EXPECT_EQ(wild.share, (std::array<uint8_t, 3>{255, 0, 128}));
    EXPECT_EQ(wild.towards, (std::array<int8_t, 3>{0, -127, 0}));
}

// A scene of two instances of a surface, one turned, both under a slab.
Scene twoBoxes() {
    Scene scene;
    scene.name = "boxes";
    Surface box, slab;
    addBox(box, glm::dvec3(-0.5, 0, -0.5), glm::dvec3(0.5, 1, 0.5), 0.5);
    addPanel(slab, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 1);
    scene.surfaces = {slab, box};
    glm::mat4 turned(1);
    turned[0] = glm::vec4(0, 0, -1, 0), turned[2] = glm::vec4(1, 0, 0, 0), turned[3] = glm::vec4(1.5f, 0.01f, 0, 1);
    glm::mat4 moved(1);
    moved[3] = glm::vec4(0, 0.01f, 0, 1);
    scene.instances = {{0}, {1, moved}, {1, turned}};
    return scene;
}

Asset bakedWith(const Scene& scene, const Albedo& albedo, int rays = 256) {
    Asset asset{scene, {}, {}};
    BakeOptions options;
    options.rays = rays;
    const Tracer tracer(scene);
    asset.seen = bakeScene(scene, tracer, options);
    asset.info.at = "faces";
    asset.info.bounce = "materials";
    BounceOptions bounce;
    bounce.albedo = albedo;
    bounce.rays = rays;
    bakeBounces(scene, tracer, asset.seen, bounce);
    return asset;
}

TEST(Bounce, WhatIsBakedIsWhatPathsFind) {
    for (const char* name : {"builtin:room-2", "builtin:arcade"}) {
        const Scene scene = loadScene(name);
        const Albedo albedo{vec3(0.8f, 0.5f, 0.2f), true};
        if (kSanitized && name != std::string("builtin:arcade")) continue;
        const Asset asset = bakedWith(scene, albedo, kSanitized ? 64 : 256);
        const Tracer tracer(scene);
        dvec3 off(0);
        double count = 0;
        for (const SurfaceSample& p : sampleReceivers(scene, kSanitized ? 40 : 200, 2)) {
            const vec3 direct = skyByPaths(tracer, albedo, p.at, 512, 0, 1, uint64_t(count)),
                       all = skyByPaths(tracer, albedo, p.at, 512, 24, 1, uint64_t(count));
            if (direct.x <= 0 && all.x <= 0) continue;  // inside solids
            const dvec3 error = dvec3(bounceAt(asset, p.instance, p.triangle, p.weights).share) - dvec3(all - direct);
            off += error * error, ++count;
        }
        off = glm::sqrt(off / count);
        std::printf("%s: baked bounces err by %.4f %.4f %.4f\n", name, off.x, off.y, off.z);
        for (int c = 0; c < 3; ++c) EXPECT_LE(off[c], kSanitized ? 0.08 : 0.035) << name << ", channel " << c;
    }
}

TEST(Bounce, WhiteRoomsAreAsBrightAsPathsFind) {
    // Through two windows light goes around for a hundred bounces.
    const Scene scene = loadScene("builtin:room-2");
    const Tracer tracer(scene);
    const Albedo albedo{vec3(0.95f), true};
    BakeOptions options;
    options.rays = 64;
    Asset asset{scene, bakeVertices(scene, tracer, options), {}};
    bakeBounces(scene, tracer, asset.seen, {.albedo = albedo, .rays = 64});
    double mean = 0, bias = 0;
    const std::vector<SurfaceSample> points = sampleReceivers(scene, kSanitized ? 20 : 60, 2);
    for (const SurfaceSample& p : points) {
        const float direct = skyByPaths(tracer, albedo, p.at, 64, 0, 1, 0).x, all = skyByPaths(tracer, albedo, p.at, 64, 400, 1, 0).x;
        mean += double(all - direct), bias += double(bounceAt(asset, p.instance, p.triangle, p.weights).share.x) - double(all - direct);
    }
    EXPECT_GT(mean / double(points.size()), 0.2);
    EXPECT_LE(std::abs(bias), 0.08 * mean);
}

TEST(Bounce, OfASunItTakesMostOfWhatIsMissing) {
    const Scene scene = loadScene("builtin:arcade");
    const Albedo albedo{vec3(0.8f), true};
    const Asset asset = bakedWith(scene, albedo, kSanitized ? 64 : 128);
    std::vector<SurfacePoint> points;
    std::vector<AperturaBounce> none, baked;
    const Tracer tracer(scene);
    const Solids solids(scene, tracer);
    for (const SurfaceSample& p : sampleReceivers(scene, kSanitized ? 40 : 120, 2)) {
        if (solids.backsSeen(p.at, 0) > Solids::kProbes / 4) continue;
        points.push_back(p.at);
        none.push_back({vec3(0), vec3(0)});
        baked.push_back(bounceAt(asset, p.instance, p.triangle, p.weights));
    }
    const auto truth = traceBounces(tracer, points, albedo, 16, kSanitized ? 128 : 1024, 1);
    EXPECT_LE(bounceRow("baked", truth, baked).light, (kSanitized ? 0.7 : 0.45) * bounceRow("none", truth, none).light);
}

TEST(Bounce, AnyNumberOfThreadsBakesTheSame) {
    const Scene scene = twoBoxes();
    const Tracer tracer(scene);
    BakeOptions options;
    options.rays = 32;
    const BakedVisibility seen = bakeScene(scene, tracer, options);
    std::vector<BakedVisibility> baked;
    for (const int threads : {1, 3}) {
        baked.push_back(seen);
        bakeBounces(scene, tracer, baked.back(), {.rays = 32, .threads = threads});
    }
    for (size_t i = 0; i < seen.size(); ++i)
        for (size_t v = 0; v < seen[i].visibility.size(); ++v) {
            EXPECT_EQ(baked[0][i].bounces[v].share, baked[1][i].bounces[v].share);
            EXPECT_EQ(baked[0][i].bounces[v].towards, baked[1][i].bounces[v].towards);
        }
}

TEST(Bounce, BlackSurfacesAndOpenOnesReflectNothing) {
    Scene scene = twoBoxes();
    for (const SeenByInstance& seen : bakedWith(scene, {vec3(0), true}, 32).seen)
        for (const AperturaBounce& b : seen.bounces) EXPECT_EQ(b.share, vec3(0));
    scene.instances.resize(1);  // the slab alone
    for (const SeenByInstance& seen : bakedWith(scene, {vec3(1), true}, 32).seen)
        for (const AperturaBounce& b : seen.bounces) EXPECT_EQ(b.share, vec3(0));
}

TEST(Bounce, AClosedRoomWithWhiteWallsIsDark) {
    Scene scene;
    scene.name = "room";
    Surface box;
    addBox(box, glm::dvec3(-1), glm::dvec3(1), 1);
    for (auto& t : box.triangles) std::swap(t[1], t[2]);
    for (vec3& n : box.normals) n = -n;
    scene.surfaces = {box};
    scene.instances = {{0}};
    Asset asset = bakedWith(scene, {vec3(1), true}, 64);
    for (const AperturaBounce& b : asset.seen[0].bounces) EXPECT_EQ(b.share, vec3(0));
}

TEST(Bounce, TheAssetKeepsItAndALaterBakeTakesItOut) {
    const Folder folder;
    const Asset asset = bakedWith(twoBoxes(), {vec3(0.9f, 0.5f, 0.1f), true}, 64);
    ASSERT_TRUE(hasSamplesOnFaces(asset));
    writeAsset(folder / "a.glb", asset.scene, asset.seen, asset.info);
    const Asset back = loadAsset(folder / "a.glb");
    EXPECT_TRUE(back.scene.notes.empty());
    EXPECT_EQ(back.info.bounce, "materials");
    ASSERT_EQ(back.seen.size(), 3u);
    double brightest = 0;
    for (size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(back.seen[i].bounces.size(), asset.seen[i].bounces.size());
        ASSERT_EQ(back.seen[i].faces.bounces.size(), asset.seen[i].faces.bounces.size());
        const auto same = [&](const AperturaBounce& a, const AperturaBounce& b) {
            brightest = std::max(brightest, double(a.share.x));
            EXPECT_NEAR(a.share.x, b.share.x, 0.004);
            EXPECT_NEAR(glm::distance(a.towards, b.towards), 0, 0.01) << "instance " << i;
        };
        for (size_t v = 0; v < asset.seen[i].bounces.size(); ++v) same(asset.seen[i].bounces[v], back.seen[i].bounces[v]);
        for (size_t s = 0; s < asset.seen[i].faces.bounces.size(); ++s) same(asset.seen[i].faces.bounces[s], back.seen[i].faces.bounces[s]);
    }
    EXPECT_GT(brightest, 0.1);
    BakedVisibility plain = asset.seen;
    for (SeenByInstance& seen : plain) seen.bounces.clear(), seen.faces.bounces.clear();
    BakeInfo info = asset.info;
    info.bounce.clear();
    writeAsset(folder / "b.glb", back.scene, plain, info);
    EXPECT_EQ(slurp(folder / "b.glb").find("_BOUNCE"), std::string::npos);
    EXPECT_GT(slurp(folder / "a.glb").size(), slurp(folder / "b.glb").size() + bytesOfBounces(back));
}

TEST(Bounce, WhatIsDamagedIsLeftOutWithANote) {
    const Folder folder;
    const Asset asset = bakedWith(twoBoxes(), {vec3(0.5f), true}, 32);
    writeAsset(folder / "a.glb", asset.scene, asset.seen, asset.info);
    const auto damaged = [&](const std::function<void(Json&)>& change) {
        const Asset back = loadAsset(changed(folder, folder / "a.glb", change));
        ASSERT_EQ(back.scene.notes.size(), 1u);
        EXPECT_NE(back.scene.notes[0].find("what its surfaces reflect"), std::string::npos) << back.scene.notes[0];
        EXPECT_FALSE(hasBounces(back));
        EXPECT_TRUE(hasSamplesOnFaces(back)) << "the rest is there";
    };
    damaged([](Json& json) { json["meshes"][0]["primitives"][0]["attributes"].erase("_BOUNCE"); });
    damaged([](Json& json) { json["meshes"][1]["primitives"][0]["attributes"].erase("_BOUNCE_TOWARDS"); });
    for (const char* name : {"_BOUNCE_SAMPLES", "_BOUNCE_TOWARDS_SAMPLES"}) {
        const auto at = [name](Json& json) -> Json& {
            for (Json& accessor : json["accessors"])
                if (accessor.value("name", "") == name) return accessor;
            throw std::runtime_error("it is not there");
        };
        damaged([&](Json& json) { at(json).erase("name"); });
        damaged([&](Json& json) { at(json)["count"] = at(json)["count"].get<int>() - 1; });
        damaged([&](Json& json) { at(json)["normalized"] = false; });
        damaged([&](Json& json) { at(json)["type"] = "VEC2"; });
    }
    // Without its word in the extras nothing is expected.
    const Asset none = loadAsset(
        changed(folder, folder / "a.glb", [](Json& json) { json["asset"]["extras"]["apertura"].erase("bounce"); }));
    EXPECT_TRUE(none.scene.notes.empty());
    EXPECT_FALSE(hasBounces(none));
}

// The plane, half of whose sky is blocked everywhere, with what surfaces reflect.
Asset halfOpenPlane() {
    Asset asset = openPlane();
    for (Visibility& v : asset.seen[0].visibility) v = {vec3(0.3f, float(pi) / 2, 0), float(pi)};
    asset.seen[0].bounces.assign(4, {vec3(0.25f, 0.16f, 0.04f), vec3(0, 0.5f, 0)});
    return asset;
}

TEST(Bounce, TheRendererAddsItToTheSkyAndTheSun) {
    const Gpu gpu({.validate = true});
    for (const bool onFaces : {false, true}) {
        if (onFaces && kSanitized) continue;
        Asset asset = halfOpenPlane();
        if (onFaces) {
            SeenByInstance& seen = asset.seen[0];
            seen.faces.setLevels({2, 0}, false);
            for (Visibility& v : seen.faces.visibility) v = seen.visibility[0];
            seen.faces.bounces.assign(seen.faces.visibility.size(), seen.bounces[0]);
        }
        Renderer renderer(gpu, asset);
        for (const bool lamp : {false, true})
            for (const char* name : {"soft", "aperture"})
                for (const LightAt at : {LightAt::Pixels, LightAt::Vertices}) {
                    if (at == LightAt::Vertices && onFaces) continue;
                    if (lamp && (onFaces || name == std::string("aperture"))) continue;
                    View view;
                    view.width = view.height = 8;
                    view.camera = {{0.1f, 5, 0.01f}, {0, 0, 0}, 0.5f};
                    view.sky = vec3(0.1f, 0.2f, 0.3f);
                    view.albedo = vec3(0.5f, 0.25f, 0.75f);
                    view.aroundAlbedo = vec3(0.8f, 0.4f, 0);
                    view.lights = {directionalLight({0, 0.5, std::sqrt(0.75)}, 0.02, vec3(100))};
                    if (lamp) view.lights.push_back(sphereLight({0, 60, 0}, 0.01, vec3(1)));
                    const auto pixel = [&] { return dvec3(renderer.draw(view, *findModel(name), at).pixels[8 * 4 + 4]); };
                    const dvec3 without = pixel();
                    view.bounces = 1;
                    // What was baked, by closed forms: pi share of the sky, and of the sun, 60 degrees from `towards`, (e + 1) / 4 (3/4)^e,
                    // with e = 2 for a `towards` of 1/2, in all of its E.
                    const double sun = 100 * pi * std::sin(0.02) * std::sin(0.02) * 0.75 * 0.75 * 0.75;
                    const double tolerance = 2e-3;
                    for (const auto around : {View::Around::Baked, View::Around::Given, View::Around::Own}) {
                        view.around = around;
                        const dvec3 with = pixel();
                        for (int c = 0; c < 3; ++c) {
                            const double albedo = around == View::Around::Own ? view.albedo[c] : view.aroundAlbedo[c];
                            const double open = 0.5, share = around == View::Around::Baked ? std::array{0.25, 0.16, 0.04}[size_t(c)]
                                                                                           : open / (1 - albedo * (1 - open)) - open;
                            double light = sun;
                            if (around != View::Around::Baked) {
                                // Towards .6 D / A = (.18 / pi, .3, 0).
                                const dvec3 towards(0.6 * 0.3 / pi, 0.3, 0);
                                const double r = glm::length(towards), e = 2 * r / (1 - r);
                                light = 100 * pi * std::sin(0.02) * std::sin(0.02) * (e + 1) / 4 * std::pow(0.5 + 0.5 * 0.15 / r, e);
                            }
                            EXPECT_NEAR(with[c] - without[c],
                                        view.albedo[c] / pi * share * (pi * double(view.sky.towards(vec3(0, 1, 0))[c]) + light), tolerance)
                                << name << ", channel " << c << ", around " << int(around) << ", faces " << onFaces << ", at vertices "
                                << (at == LightAt::Vertices);
                        }
                    }
                }
    }
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
}

TEST(Bounce, PlainViewsAreNotLitByWhatColouredSurfacesReflect) {
    const Gpu gpu;
    const Asset asset = halfOpenPlane();
    const Renderer renderer(gpu, asset);
    View view;
    EXPECT_EQ(renderer.bouncesOf(view), APERTURA_BOUNCES_NONE);
    view.bounces = 3;
    EXPECT_EQ(renderer.bouncesOf(view), APERTURA_BOUNCES_BAKED);
    view.plain = true;
    EXPECT_EQ(renderer.bouncesOf(view), APERTURA_BOUNCES_GIVEN);
    Asset grey = asset;
    grey.info.bounce = "0.8";
    EXPECT_EQ(bounceSourceOf(view, grey), APERTURA_BOUNCES_BAKED) << "baked with the albedo that is drawn";
    view.albedo = vec3(0.5f);
    EXPECT_EQ(bounceSourceOf(view, grey), APERTURA_BOUNCES_GIVEN);
    for (const auto& [text, albedo] : std::map<std::string, std::optional<vec3>>{{"0.5", vec3(0.5f)},
                                                                                 {"0.5,0.25,1", vec3(0.5f, 0.25f, 1)},
                                                                                 {"materials", {}},
                                                                                 {"", {}},
                                                                                 {"0.5,1", {}},
                                                                                 {"7", {}},
                                                                                 {"nan", {}}}) {
        grey.info.bounce = text;
        EXPECT_EQ(bakedAlbedo(grey.info), albedo) << text;
    }
}

double squaredDifference(const Picture& a, const Picture& b) {
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) sum += glm::dot(a.pixels[i] - b.pixels[i], a.pixels[i] - b.pixels[i]) / 3;
    return sum / double(a.pixels.size());
}

TEST(Bounce, ThePictureOfACanyonAtNoonIsNearTheTrueOne) {
    if (kSanitized) GTEST_SKIP() << "the tests before it run the same code";
    Scene scene = makeBuiltin("canyon");
    const Asset baked = bakedWith(scene, {}, 128);
    Asset four = baked;
    for (SeenByInstance& seen : four.seen) seen.bounces.clear(), seen.faces.bounces.clear();
    View view;
    view.camera = viewOf(scene);
    view.width = 96, view.height = 54;
    view.lights = {directionalLight({0.1f, 1, 0.15f}, 0.0047, vec3(30000))};
    view.aroundAlbedo = view.albedo;
    view.bounces = 8;
    const Picture truth = traceReference(Tracer(scene), view, {});
    const Gpu gpu;
    Renderer drawBaked(gpu, baked), drawFour(gpu, four);
    const Model& soft = *findModel("soft");
    const double withBaked = squaredDifference(drawBaked.draw(view, soft), truth),
                 with = squaredDifference(drawFour.draw(view, soft), truth);
    view.bounces = 0;
    const double without = squaredDifference(drawFour.draw(view, soft), truth);
    std::printf("canyon at noon: squared difference %.4f, with the four numbers alone %.4f, baked %.4f\n", without, with, withBaked);
    EXPECT_LE(with, without / 4);
    EXPECT_LE(withBaked, without / 8);
}

TEST(Bounce, TheErrorsOfTheSkyFallAsTheyShould) {
    double plain[2]{}, given[2]{}, bias = 0;
    for (const char* name : {"canyon", "terrain", "colonnade", "arcade"}) {
        const Scene scene = makeBuiltin(name);
        const Tracer tracer(scene);
        std::vector<SurfacePoint> points;
        for (const SurfaceSample& p : sampleReceivers(scene, kSanitized ? 40 : 150, 1)) points.push_back(p.at);
        for (int k = 0; k < 2; ++k) {
            const double a = k ? 0.8 : 0.5;
            const auto truth = traceBounces(tracer, points, {vec3(float(a)), true}, 8, 128, 1);
            std::vector<AperturaBounce> none(points.size(), {vec3(0), vec3(0)}), made;
            for (const BounceTruth& t : truth)
                made.push_back(
                    aperturaBounceAround(float(pi) * t.open, vec4(t.visibility.direction, t.visibility.area), vec3(float(1 - a))));
            const BounceRow before = bounceRow("none", truth, none), after = bounceRow("given", truth, made);
            EXPECT_LE(after.sky, before.sky) << name << ", " << a;
            EXPECT_LE(after.light, before.light) << name << ", " << a;
            plain[k] += before.sky, given[k] += after.sky;
            bias += after.skyBias / 8;
        }
    }
    EXPECT_LE(given[0], 0.40 * plain[0]);
    EXPECT_LE(given[1], 0.25 * plain[1]);
    EXPECT_LE(std::abs(bias), 0.02);
}

TEST(Bounce, TheMeanAlbedoIsByArea) {
    Scene scene;
    Surface wide, small;
    addPanel(wide, {0, 0, 0}, {3, 0, 0}, {0, 0, -1}, 3);
    addPanel(small, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, 3);
    wide.material = 0, small.material = 1;
    scene.materials = {{.baseColour = {1, 0.5f, 0, 1}}, {.baseColour = {0, 0.5f, 5, 1}}};
    scene.surfaces = {wide, small};
    scene.instances = {{0}, {1}};
    EXPECT_NEAR(glm::distance(meanAlbedo(scene, vec3(0.8f)), vec3(0.75f, 0.5f, 0.25f)), 0, 1e-6);
    scene.materials.clear();
    EXPECT_EQ(meanAlbedo(scene, vec3(0.8f)), vec3(0.8f));
}

TEST(Bounce, TheProgramRefusesWhatIsNoAlbedo) {
    const Folder folder;
    const std::string glb = folder / "a.glb", png = " -o " + (folder / "a.png") + " --size 16x9 ";
    ASSERT_EQ(run("bake builtin:room-1 -o " + glb + " --rays 16 --bounce --albedo 1").code, 0);
    for (const char* albedo : {"1.2", "-0.1", "nan", "inf", "0.5,0.5", "x", "0.1,0.2,2"})
        expectRefusal("render " + glb + png + "--bounces 2 --albedo " + albedo, 2, "--albedo");
    for (const char* albedo : {"1.2", "nan"}) {
        const std::string given = std::string(" --albedo ") + albedo;
        expectRefusal("compare " + glb + " --bounces 2" + given, 2, "--albedo");
        expectRefusal("bake builtin:room-1 -o " + (folder / "b.glb") + " --bounce" + given, 2, "--albedo");
        expectRefusal("render " + glb + png + "--bounces 2 --around " + albedo, 2, "--around");
    }
    expectRefusal("render " + glb + png + "--around own", 2, "--bounces");
    expectRefusal("render " + glb + png + "--bounces -1", 2, "--bounces");
    expectRefusal("render " + glb + png + "--bounces 2 --model shadow-map", 2, "shadow map");
    expectRefusal("render " + glb + png + "--plain --albedo 0.5", 2, "--plain");
    expectRefusal("render " + glb + png + "--bounces 2 --plain --around 0.5", 2, "--around");
    expectRefusal("bake builtin:room-1 -o " + (folder / "b.glb") + " --bounce --max-distance 2", 2, "--max-distance");
    expectRefusal("compare " + glb + " --albedo 0.5", 2, "--bounces");
    expectRefusal("bake builtin:room-1 -o " + (folder / "b.glb") + " --albedo 0.5", 2, "--bounce");
    expectRefusal("bake builtin:room-1 -o " + (folder / "b.glb") + " --bounce --at texels", 2, "--bounce");
    expectRefusal("bake " + smallScene("heights_geotiff.tif") + " -o " + (folder / "b.glb") + " --bounce", 2, "--engine rays");
    for (const char* more : {" --around own", " --around 1,0,0", " --albedo 1"})
        EXPECT_EQ(run("render " + glb + png + "--bounces 2" + more).code, 0) << more;
    EXPECT_EQ(run("render builtin:room-1 --model reference --bounces 3 --albedo 1" + png).code, 0);
    const Result r = run("compare " + glb + " --bounces 2 --models soft --light-radii 5 --receivers 20 --json " + (folder / "c.json"));
    EXPECT_EQ(r.code, 0) << r.error;
    for (const char* word : {"none", "given", "baked", "bounced"}) EXPECT_NE(r.out.find(word), std::string::npos) << r.out;
    EXPECT_NE(slurp(folder / "c.json").find("ambient_bounced_rmse"), std::string::npos);
    EXPECT_NE(run("info " + glb).out.find("reflect"), std::string::npos);
    EXPECT_NE(run("info " + glb + " --json").out.find("bounce_bytes"), std::string::npos);
}

}  // namespace
}  // namespace apertura::test
