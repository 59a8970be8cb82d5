// Samples on faces: lattices, what is fitted to them, how an asset holds them, and what is drawn and measured of them.
#include "apertura/bake/fit/faces.h"

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <set>

#include "apertura/bake/fit/least_squares.h"
#include "apertura/bake/measure/measure.h"
#include "apertura/bake/measure/seams.h"
#include "apertura/bake/scene/load.h"
#include "apertura/bake/scene/shapes.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/faces.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/runtime/render/geometry.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/any_asset.h"
#include "tests/baseline.h"
#include "tests/changed_gltf.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

glm::vec3 anyBarycentrics(Random& random) {
    const double root = std::sqrt(random()), v = random();
    return {float(1 - root), float(root * (1 - v)), float(root * v)};
}

TEST(Lattice, ACellsSamplesSurroundThePoint) {
    Random random(1);
    for (int level = 1; level <= APERTURA_MAX_LATTICE_LEVEL; ++level) {
        const int steps = aperturaLatticeSteps(level);
        std::set<std::pair<int, int>> points;
        for (int k = 0; k < aperturaLatticeSize(steps); ++k) {
            const glm::vec3 p = latticePoint(k, steps) * float(steps);
            EXPECT_EQ(p, glm::round(p));
            EXPECT_TRUE(points.emplace(int(p.y), int(p.z)).second);
        }
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 at = anyBarycentrics(random);
            const AperturaLatticeCell cell = aperturaLatticeCell(at, steps);
            glm::vec3 sum(0);
            for (int c = 0; c < 3; ++c) {
                ASSERT_GE(cell.samples[c], 0);
                ASSERT_LT(cell.samples[c], aperturaLatticeSize(steps));
                EXPECT_GE(cell.weights[c], -1e-5f);
                const glm::vec3 sample = latticePoint(cell.samples[c], steps);
                EXPECT_LE(glm::length(sample - at), 1.5f / float(steps));
                sum += cell.weights[c] * sample;
            }
            EXPECT_LT(glm::length(sum - at), 3 * APERTURA_LATTICE_MARGIN) << level;
        }
        // A fragment's weights may lie a little outside.
        for (const glm::vec3& at : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(-1e-6f, 0.5f, 0.500001f)})
            for (int c = 0; c < 3; ++c) {
                EXPECT_GE(aperturaLatticeCell(at, steps).samples[c], 0);
                EXPECT_LT(aperturaLatticeCell(at, steps).samples[c], aperturaLatticeSize(steps));
            }
    }
}

TEST(LeastSquares, FindsWhatIsLinearAndClosesWhatIsUnknown) {
    Random random(2);
    const Visibility ends[3] = {{{1, 0.5f, 0}, 3}, {{0.2f, 1, 0.1f}, 2.5f}, {{0, 0, 0.4f}, 1}};
    const auto at = [&](const glm::vec3& w) {
        Visibility out{glm::vec3(0), 0};
        for (int c = 0; c < 3; ++c) out.direction += w[c] * ends[c].direction, out.area += w[c] * ends[c].area;
        return out;
    };
    const int steps = 4;
    LeastSquares equations(size_t(aperturaLatticeSize(steps)) + 1);
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 w = anyBarycentrics(random);
        const AperturaLatticeCell cell = aperturaLatticeCell(w, steps);
        std::vector<Term> terms;
        for (int c = 0; c < 3; ++c) terms.emplace_back(uint32_t(cell.samples[c]), cell.weights[c]);
        equations.add(terms, at(w));
    }
    const std::vector<Visibility> found = equations.solve();
    for (int k = 0; k < aperturaLatticeSize(steps); ++k) {
        const Visibility truth = at(latticePoint(k, steps));
        EXPECT_NEAR(found[size_t(k)].area, truth.area, 2e-3) << k;
        EXPECT_LT(glm::length(found[size_t(k)].direction - truth.direction), 0.1) << k;  // no sharper than the mean about it
    }
    EXPECT_EQ(found.back().area, 0);
}

// Least squares overshoots beside a step. What was seen is nowhere nearer to a cap than this, and so is nothing that is fitted.
TEST(LeastSquares, MakesNothingSharperThanWhatWasSeen) {
    Random random(8);
    const int steps = 8;
    const float area = 2, most = 0.9f;
    const float length = most * area * (1 - area / float(4 * pi));
    LeastSquares equations(size_t(aperturaLatticeSize(steps)));
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 w = anyBarycentrics(random);
        const AperturaLatticeCell cell = aperturaLatticeCell(w, steps);
        std::vector<Term> terms;
        for (int c = 0; c < 3; ++c) terms.emplace_back(uint32_t(cell.samples[c]), cell.weights[c]);
        equations.add(terms, {{w.x < 0.45f ? length : -length, 0, 0}, area});
    }
    for (const Visibility& v : equations.solve()) EXPECT_LE(capness(v), most + 1e-3f);
}

TEST(FaceSamples, ComeBackFromTheFile) {
    const Folder folder;
    Scene scene = boxOnFloor();
    scene.instances.push_back({1, glm::mat4(0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 4, 0, 0, 1)});
    for (const char* model : {"sh", "firm-2"})
        for (const int bits : {8, 16}) {
            Asset asset = anyAsset(scene, model, 3);
            asset.info.bits = bits;
            writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
            const Asset back = loadAsset(folder / "a.glb");
            EXPECT_TRUE(back.scene.notes.empty());
            EXPECT_EQ(visibilityBytes(back), visibilityBytes(asset));
            const Model& drawn = storedModel(asset.info) ? *storedModel(asset.info) : *findModel("sh-l1");
            const AperturaCapLight light = aperturaCapLight(glm::dvec3(0.6, 0.64, 0.48), 0.3);
            Random random(4);
            for (size_t i = 0; i < scene.instances.size(); ++i) {
                ASSERT_EQ(back.seen[i].faces.levels, asset.seen[i].faces.levels);
                for (size_t k = 0; k < asset.seen[i].faces.visibility.size(); ++k) {
                    const Visibility &a = asset.seen[i].faces.visibility[k], &b = back.seen[i].faces.visibility[k];
                    EXPECT_NEAR(a.area, b.area, bits == 8 ? 0.03 : 2e-4);
                    EXPECT_LT(glm::length(a.direction - b.direction), bits == 8 ? 0.08 : 4e-4);
                }
                const size_t triangles = scene.surfaces[size_t(scene.instances[i].surface)].triangles.size();
                for (int k = 0; bits == 16 && k < 100; ++k) {
                    const int t = int(random(0, double(triangles)));
                    const glm::vec3 w = anyBarycentrics(random), n(0, 1, 0);
                    const auto e = [&](const Asset& of) {
                        double sum = 0;
                        for (const auto& [share, r] : receiverAt(of, drawn, int(i), t, w, n))
                            sum += share * aperturaIrradianceThrough(drawn.id, r, light, APERTURA_LIGHTS_ANY) / light.area;
                        return sum;
                    };
                    EXPECT_NEAR(e(asset), e(back), 5e-3) << model;
                }
            }
            // A second bake replaces the first.
            Scene again = back.scene;
            BakedVisibility plain;
            for (const SeenByInstance& seen : asset.seen) plain.push_back({seen.visibility, {}, {}, {}});
            writeAsset(folder / "b.glb", again, plain, {});
            EXPECT_LT(std::filesystem::file_size(folder / "b.glb"), std::filesystem::file_size(folder / "a.glb"));
            EXPECT_TRUE(loadAsset(folder / "b.glb").seen[0].faces.levels.empty());
        }
}

TEST(FaceSamples, OfFewFacesTakeFewBytes) {
    const Folder folder;
    const Scene scene = makeBuiltin("statue");
    Asset asset{scene, {}, {}};
    const Surface& surface = scene.surfaces[0];
    asset.seen.push_back({std::vector<Visibility>(surface.positions.size()), {}, {}, {}});
    const size_t alone = visibilityBytes(asset);
    std::vector<uint8_t> levels(surface.triangles.size(), 0);
    levels[7] = 3, levels[90000] = 1, levels.back() = 2;
    asset.seen[0].faces.setLevels(levels, false);
    asset.seen[0].faces.visibility[16] = {{0, 0, 1}, 2};
    EXPECT_EQ(visibilityBytes(asset), alone + 3 * 5 + 4 * (15 + 3 + 6));
    writeAsset(folder / "a.glb", scene, asset.seen, {});
    const Asset back = loadAsset(folder / "a.glb");
    EXPECT_EQ(back.seen[0].faces.levels, levels);
    EXPECT_NEAR(back.seen[0].faces.visibility[16].area, 2, 0.03);
}

TEST(FaceSamples, OfOtherTrianglesAreLeftAlone) {
    const Folder folder;
    const Scene scene = boxOnFloor();
    const Asset asset = anyAsset(scene, "sh", 5);
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    const auto lonely = [&](const std::function<void(Json&)>& change) {
        const Asset back = loadAsset(changed(folder, folder / "a.glb", change));
        EXPECT_EQ(back.scene.notes.size(), 1u);
        EXPECT_EQ(back.info.at, "vertices");
        for (const SeenByInstance& seen : back.seen) EXPECT_TRUE(seen.faces.visibility.empty());
    };
    lonely([](Json& json) { std::swap(json["nodes"][0]["mesh"], json["nodes"][1]["mesh"]); });
    // Extras that are gone, as where two files are merged.
    lonely([](Json& json) { json["asset"]["extras"]["apertura"].erase("faces"); });
    lonely([](Json& json) {
        for (Json& accessor : json["accessors"])
            if (accessor.value("name", "") == "_VISIBILITY_SAMPLES") accessor.erase("name");
    });
    // Samples that no bytes stand for: glTF takes them for 0.
    lonely([](Json& json) {
        for (Json& accessor : json["accessors"])
            if (accessor.value("name", "") == "_VISIBILITY_SAMPLES") accessor.erase("bufferView");
    });
    // Accessors may stand in another order: they are found by their names.
    const Asset same = loadAsset(changed(folder, folder / "a.glb", [](Json&) {}));
    EXPECT_EQ(same.seen[0].faces.levels, asset.seen[0].faces.levels);
}

TEST(FaceSamples, OfInstancesOfOneMeshAreNotTakenForEachOther) {
    const Folder folder;
    Scene scene = boxOnFloor();
    scene.instances.push_back({1, glm::translate(glm::mat4(1), glm::vec3(4, 0, 0))});
    Asset asset = anyAsset(scene, "sh", 7);
    asset.info.at = "faces";
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    EXPECT_EQ(loadAsset(folder / "a.glb").info.at, "faces");
    const auto swapped = [](Json& json) {
        Json& nodes = json["scenes"][0]["nodes"];
        ASSERT_EQ(nodes.size(), 3u);
        std::swap(nodes[1], nodes[2]);
    };
    const Asset back = loadAsset(changed(folder, folder / "a.glb", swapped));
    EXPECT_EQ(back.scene.notes.size(), 1u);
    EXPECT_TRUE(back.seen[1].faces.visibility.empty());
    // Not even where their vertices see the same.
    asset.seen[2].visibility = asset.seen[1].visibility;
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    EXPECT_EQ(loadAsset(folder / "a.glb").info.at, "faces");
    EXPECT_EQ(loadAsset(changed(folder, folder / "a.glb", swapped)).scene.notes.size(), 1u);
}

TEST(FaceSamples, ThatLieAreRefused) {
    const Folder folder;
    const Scene scene = boxOnFloor();
    const Asset asset = anyAsset(scene, "firm-2", 6);
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    const auto refused = [&](const std::function<void(Json&)>& change) {
        const std::string path = changed(folder, folder / "a.glb", change);
        try {
            loadAsset(path);
            ADD_FAILURE() << "was accepted";
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
        }
    };
    const auto accessor = [](Json& json, const std::string& name) -> Json& {
        for (Json& a : json["accessors"])
            if (a.value("name", "") == name) return a;
        throw Error("no accessor " + name);
    };
    for (const char* name : {"_VISIBILITY_LEVELS", "_VISIBILITY_SAMPLES", "_VISIBILITY_NUMBERS"})
        refused([&](Json& json) { accessor(json, name)["count"] = accessor(json, name)["count"].get<int>() - 1; });
    refused([&](Json& json) { accessor(json, "_VISIBILITY_SAMPLES").erase("normalized"); });
    refused([&](Json& json) { json["asset"]["extras"]["apertura"]["faces"]["numbers"][0] = 1e9; });
    refused([&](Json& json) { json["asset"]["extras"]["apertura"]["faces"].erase("numbers"); });
    // Levels that stand for more samples than a face may have.
    refused([&](Json& json) { accessor(json, "_VISIBILITY_LEVELS")["bufferView"] = accessor(json, "_VISIBILITY_NUMBERS")["bufferView"]; });
}

// Nothing blocks a convex solid: what a model errs there is noise, which samples do not lower.
TEST(BakeScene, AConvexSolidIsLeftToItsVertices) {
    const Scene cube = loadScene(smallScene("cube.obj"));
    const Tracer tracer(cube);
    for (const char* recipe : {"sh", "firm-2", "auto"}) {
        BakeOptions options;
        options.recipe = recipe;
        options.at = At::Faces;
        size_t samples = 0;
        for (const SeenByInstance& seen : bakeScene(cube, tracer, options)) samples += seen.faces.visibility.size();
        EXPECT_LE(samples, 12u * 6) << recipe;
    }
}

TEST(BakeScene, StoresWhatVerticesCannot) {
    const Scene scene = boxOnFloor();
    const Tracer tracer(scene);
    MeasureOptions measure;
    measure.models = {findModel("soft")};
    measure.only = true;
    measure.shadowMap = false;
    measure.lightRadii = {5};
    measure.receivers = 300;
    FaceReport report;
    const auto baked = [&](At at, int threads) {
        BakeOptions options;
        options.at = at;
        options.threads = threads;
        Asset out{scene, bakeScene(scene, tracer, options, {}, nullptr, nullptr, &report), {}};
        return out;
    };
    const Asset faces = baked(At::Faces, 1), again = baked(At::Faces, 3);
    const MeasureRow coarse = measureAsset(baked(At::Vertices, 0), measure).rows[0], fine = measureAsset(faces, measure).rows[0];
    std::printf("box on a floor: own %.4f, at vertices %.4f (sky %.4f), on faces %.4f (sky %.4f)\n", fine.own, coarse.rmse, coarse.ambient,
                fine.rmse, fine.ambient);
    EXPECT_GT(coarse.rmse, 2 * fine.own);  // the box stands where no vertex of the floor is
    EXPECT_LT(fine.rmse, 1.5 * fine.own);
    EXPECT_LT(fine.rmse, atMost(baseline::kBoxOnFaces));
    EXPECT_LT(fine.ambient, atMost(baseline::kSkyOfBoxOnFaces));
    // The report says about what is measured, though it knows nothing of these receivers.
    baked(At::Faces, 0);
    const double added = std::sqrt(fine.rmse * fine.rmse - fine.own * fine.own);
    EXPECT_GT(report.error, 0.4 * added);
    EXPECT_LT(report.error, 1.6 * added);
    EXPECT_LT(report.skyError, 1.6 * fine.ambient);
    // A program that loses the samples is left with what would have been stored at the vertices alone.
    Asset lost = faces;
    for (SeenByInstance& seen : lost.seen) seen.faces = {};
    const MeasureRow left = measureAsset(lost, measure).rows[0];
    EXPECT_LT(left.rmse, 1.02 * coarse.rmse);
    EXPECT_LT(left.ambient, 1.02 * coarse.ambient);
    // The box's own faces each see the same everywhere and have three samples, for their vertices lean: others go to the floor.
    EXPECT_LT(4 * faces.seen[1].faces.visibility.size(), faces.seen[0].faces.visibility.size());
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        EXPECT_EQ(faces.seen[i].faces.levels, again.seen[i].faces.levels);
        for (size_t k = 0; k < faces.seen[i].faces.visibility.size(); ++k)
            ASSERT_EQ(faces.seen[i].faces.visibility[k].area, again.seen[i].faces.visibility[k].area);
    }
}

// A grate of square bars that cross each other in one plane, over a floor.
Scene grate(int bars) {
    Scene scene;
    scene.name = "grate";
    const auto add = [&](const glm::vec3& centre, const glm::vec3& half) {
        Surface box;
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {-1.0f, 1.0f}) {
                const auto first = uint32_t(box.positions.size());
                glm::vec3 n(0), u(0), v(0);
                n[axis] = side, u[(axis + 1) % 3] = 1, v[(axis + 2) % 3] = side;
                for (const auto& [a, b] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
                    box.positions.push_back(centre + half * (n + float(a) * u + float(b) * v));
                    box.normals.push_back(n);
                }
                box.triangles.push_back({first, first + 1, first + 2});
                box.triangles.push_back({first, first + 2, first + 3});
            }
        scene.instances.push_back({int(scene.surfaces.size()), glm::mat4(1)});
        scene.surfaces.push_back(box);
    };
    add({0, -0.1f, 0}, {1.5f, 0.1f, 1.5f});
    for (int i = 0; i < bars; ++i) {
        const float at = -1 + 2 * (float(i) + 0.5f) / float(bars);
        add({at, 0.5f, 0}, {0.03f, 0.03f, 1.1f});
        add({0, 0.5f, at}, {1.1f, 0.025f, 0.03f});
    }
    return scene;
}

// Few witnesses choose the samples of each face, and those that see little by chance leave it as it is: new points must say the same.
TEST(BakeScene, IsAsGoodAtNewPointsAsItWasToBe) {
    const Scene scene = grate(8);
    const Tracer tracer(scene);
    BakeOptions options;
    FaceReport report;
    bakeScene(scene, tracer, options, {}, nullptr, nullptr, &report);
    const double sky = report.skyError * report.tolerance / report.skyTolerance,
                 error = std::sqrt(report.error * report.error + sky * sky) / report.tolerance;
    std::printf("grate: light %.4f of %.4f, sky %.4f of %.4f: %.3f; %zu samples\n", report.error, report.tolerance, report.skyError,
                report.skyTolerance, error, report.samples);
    EXPECT_EQ(report.unmet, 0);
    EXPECT_LT(error, 1.3);
}

// An edge of a lobe is where it is, and no blur of what points about it see, wherever visibility is straight.
TEST(BakeScene, LobesErrLittleMoreBetweenSamples) {
    const Scene scene = boxOnFloor();
    const Tracer tracer(scene);
    BakeOptions options;
    options.recipe = "firm-2";
    options.rays = 1024;
    const Asset asset{scene, bakeScene(scene, tracer, options), {.model = "firm-2"}};
    MeasureOptions measure;
    measure.models = {findModel("firm-2")};
    measure.only = true;
    measure.shadowMap = false;
    measure.lightRadii = {5};
    measure.receivers = 600;
    const MeasureRow row = measureAsset(asset, measure).rows[0];
    std::printf("box on a floor, firm-2: own %.4f, on faces %.4f\n", row.own, row.rmse);
    EXPECT_LT(row.rmse, 2 * row.own);
}

// Where fine samples end at coarse ones, the straight edge between them shows.
TEST(BakeScene, FacesThatMeetSmoothlyAreSampledAlike) {
    Scene scene = boxOnFloor();
    Surface& floor = scene.surfaces[0];
    floor = {};
    addPanel(floor, {-5, 0, -5}, {0, 0, 10}, {10, 0, 0}, 2.5);
    const Tracer tracer(scene);
    BakeOptions options;
    options.rays = 64;
    const SeenOnFaces faces = bakeScene(scene, tracer, options)[0].faces;
    const auto spacing = [&](size_t t) {
        const auto c = cornersOf(scene, 0, int(t));
        return std::sqrt(glm::length(glm::cross(c[1] - c[0], c[2] - c[0]))) / aperturaLatticeSteps(std::max(1, faces.level(t)));
    };
    std::map<std::pair<uint32_t, uint32_t>, std::vector<size_t>> edges;
    for (size_t t = 0; t < floor.triangles.size(); ++t)
        for (size_t e = 0; e < 3; ++e) {
            const uint32_t a = floor.triangles[t][e], b = floor.triangles[t][(e + 1) % 3];
            edges[std::minmax(a, b)].push_back(t);
        }
    int compared = 0;
    for (const auto& [edge, sides] : edges)
        for (size_t s = 0; sides.size() == 2 && s < 2; ++s)
            if (faces.level(sides[s]) > 1) {
                EXPECT_LT(spacing(sides[1 - s]), 2.1 * spacing(sides[s])) << sides[1 - s] << " beside " << sides[s];
                ++compared;
            }
    EXPECT_GT(compared, 20);
}

TEST(BakeScene, KeepsWithinItsBytes) {
    const Scene scene = boxOnFloor();
    const Tracer tracer(scene);
    for (const char* recipe : {"sh", "firm-2"}) {
        BakeOptions options;
        options.recipe = recipe;
        options.rays = 64;
        options.maxBytes = 3000;
        FaceReport report;
        Asset asset{scene, bakeScene(scene, tracer, options, {}, nullptr, nullptr, &report), {}};
        asset.info.model = recipe;
        EXPECT_LE(visibilityBytes(asset), 3000u) << recipe;
        EXPECT_GT(report.samples, 50u) << recipe;
        EXPECT_GT(report.unmet, 0) << recipe;
        EXPECT_TRUE(report.full && !report.overfull) << recipe;
    }
    BakeOptions options;
    options.rays = 16;
    options.maxBytes = 10;
    FaceReport report;
    bakeScene(scene, tracer, options, {}, nullptr, nullptr, &report);
    EXPECT_TRUE(report.overfull);
    EXPECT_EQ(report.samples, 0u);
}

TEST(BakeScene, VerticesThatNoTriangleHasWeighNothing) {
    // An open plane of which each vertex is there twice.
    Surface plane;
    for (int copy = 0; copy < 2; ++copy)
        for (const glm::vec3& p : {glm::vec3(-1, 0, -1), glm::vec3(1, 0, -1), glm::vec3(1, 0, 1), glm::vec3(-1, 0, 1)})
            plane.positions.push_back(p);
    plane.normals.assign(8, {0, 1, 0});
    plane.triangles = {{0, 2, 1}, {0, 3, 2}};
    Scene scene;
    scene.name = "a plane";
    scene.surfaces = {plane};
    scene.instances = {{0}};
    for (const At at : {At::Vertices, At::Faces}) {
        BakeOptions options;
        options.rays = 64;
        options.at = at;
        const BakedVisibility seen = bakeScene(scene, Tracer(scene), options);
        for (size_t v = 0; v < 4; ++v) EXPECT_NEAR(seen[0].visibility[v].area, 2 * pi, 1e-3) << v;
    }
}

TEST(Seams, AreWhatSamplesOnTheTwoSidesDiffer) {
    // Two triangles of one plane, of unequal density, open and closed: every light but what lies below jumps by all that it is.
    Scene scene = boxOnFloor();
    scene.instances = {{0}};
    Asset asset{scene, {}, {}};
    const Visibility open{{0, float(pi), 0}, float(2 * pi)}, closed{glm::vec3(0), 0};
    asset.seen.push_back({std::vector<Visibility>(4, open), {}, {}, {}});
    SeenOnFaces& faces = asset.seen[0].faces;
    faces.setLevels({2, 3}, false);
    const auto fill = [&](size_t from, size_t to, const Visibility& v) {
        std::fill(faces.visibility.begin() + ptrdiff_t(from), faces.visibility.begin() + ptrdiff_t(to), v);
    };
    fill(0, faces.visibility.size(), open);
    const std::vector<const Model*> soft{findModel("soft")};
    for (const Seam& seam : measureSeams(asset, soft, {1}, 10, 1)) {
        EXPECT_EQ(seam.edges, seam.unequal ? 1u : 0u);
        EXPECT_LT(seam.max, 1e-5);
    }
    fill(faces.first[1], faces.visibility.size(), closed);
    const Seam seam = measureSeams(asset, soft, {1}, 10, 1)[1];
    EXPECT_NEAR(seam.max, 1, 0.05);
    EXPECT_NEAR(seam.rms, std::sqrt(1 / 3.0), 0.03);  // of the cosine over the hemisphere
}

TEST(Seams, OfABakedSceneAreThoseOfItsBytes) {
    const Scene scene = boxOnFloor();
    const Folder folder;
    BakeOptions options;
    options.rays = 64;
    Asset asset{scene, bakeScene(scene, Tracer(scene), options), {}};
    asset.info.at = "faces";
    size_t unequal = 0;
    const std::vector<const Model*> models{findModel("sh-l1"), findModel("soft")};
    // Along an edge of unequal density the four numbers are the same from both sides; what `soft` makes of them at each sample, and is
    // mixed between samples, is nearly so.
    const auto bound = [&](const Seam& seam) { return seam.model == "soft" && seam.unequal ? 0.08 : 1e-4; };
    for (const Seam& seam : measureSeams(asset, models, {5}, 100, 1)) {
        unequal += seam.unequal ? seam.edges : 0;
        EXPECT_LT(seam.max, bound(seam)) << seam.model << seam.unequal;
    }
    EXPECT_GT(unequal, 0u);
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    for (const Seam& seam : measureSeams(loadAsset(folder / "a.glb"), models, {5}, 100, 1))
        EXPECT_LT(seam.max, bound(seam) + 0.04) << seam.model << seam.unequal;  // of bytes
}

// The device draws what receiverAt has: here, samples on faces that lie on the line between the vertices.
TEST(FaceSamples, AreDrawn) {
    const Gpu gpu;
    Scene scene = boxOnFloor();
    Asset plain = anyAsset(scene, "sh", 7), lined = plain;
    for (size_t i = 0; i < plain.seen.size(); ++i) {
        plain.seen[i].faces = {};
        const Surface& surface = scene.surfaces[size_t(scene.instances[i].surface)];
        SeenOnFaces& faces = lined.seen[i].faces;
        for (size_t t = 0; t < faces.levels.size(); ++t)
            for (int k = 0; faces.level(t) && k < aperturaLatticeSize(aperturaLatticeSteps(faces.level(t))); ++k) {
                const glm::vec3 w = latticePoint(k, aperturaLatticeSteps(faces.level(t)));
                Visibility& v = faces.visibility[faces.first[t] + size_t(k)];
                v = {glm::vec3(0), 0};
                for (int c = 0; c < 3; ++c) {
                    const Visibility& corner = plain.seen[i].visibility[surface.triangles[t][size_t(c)]];
                    v.direction += w[c] * corner.direction, v.area += w[c] * corner.area;
                }
            }
    }
    View view;
    view.camera = {{7, 6, 9}, {0, 0.5f, 0}};
    view.width = 160, view.height = 90;
    view.lights = {directionalLight({0.4f, 0.8f, 0.3f}, 0.1, glm::vec3(2))};
    // Both models' light is linear in what is stored; what the sky gives is not, where normals differ.
    view.sky = glm::vec3(0);
    for (const char* name : {"sh-l1", "unshadowed"}) {
        const Picture a = Renderer(gpu, plain).draw(view, *findModel(name)), b = Renderer(gpu, lined).draw(view, *findModel(name));
        double most = 0, spread = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i)
            most = std::max(most, double(std::abs(a.pixels[i].g - b.pixels[i].g))), spread = std::max(spread, double(a.pixels[i].g));
        EXPECT_LT(most, 2e-3 * spread) << name;
    }
    // And other samples are drawn otherwise.
    view.sky = {};
    for (SeenByInstance& seen : lined.seen)
        for (Visibility& v : seen.faces.visibility) v = {glm::vec3(0), 0};
    const Picture a = Renderer(gpu, plain).draw(view, *findModel("sh-l1")), b = Renderer(gpu, lined).draw(view, *findModel("sh-l1"));
    double most = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) most = std::max(most, double(std::abs(a.pixels[i].g - b.pixels[i].g)));
    EXPECT_GT(most, 0.05);
}

// What a device cannot bind at once is drawn in parts: here none of them may have more than 18 vertices or 32 samples.
TEST(FaceSamples, AreDrawnInPartsAsInOne) {
    const Scene scene = boxOnFloor();
    const Asset asset = anyAsset(scene, "firm-2", 7);
    const Gpu large({.validate = true}), small({.validate = true, .largestBuffer = 4096});
    EXPECT_LT(splitGeometry(asset, {SIZE_MAX, SIZE_MAX, SIZE_MAX}).size(), 2u);
    const std::vector<GeometryPart> parts = splitGeometry(asset, {18, 32, 256});
    EXPECT_GT(parts.size(), 3u);
    size_t triangles = 0;
    for (const GeometryPart& part : parts) {
        triangles += part.triangles;
        EXPECT_TRUE(part.triangles == 1 || (part.vertices <= 18 && part.vertices + part.moreSamples <= 32));
        EXPECT_EQ(verticesOf(asset, part).size(), part.vertices);
        EXPECT_EQ(indicesOf(asset, part, true, false).size(), 4 * part.triangles);
    }
    EXPECT_EQ(triangles, triangleCount(scene));
    Renderer whole(large, asset), split(small, asset);
    View view;
    view.camera = {{7, 6, 9}, {0, 0.5f, 0}};
    view.width = 160, view.height = 90;
    view.lights = {directionalLight({0.4f, 0.8f, 0.3f}, 0.1, glm::vec3(2))};
    const Model &soft = *findModel("soft"), &firm = *findModel("firm-2");
    EXPECT_TRUE(whole.draw(view, soft).pixels == split.draw(view, soft).pixels);
    EXPECT_TRUE(whole.draw(view, firm).pixels == split.draw(view, firm).pixels);
    EXPECT_TRUE(whole.draw(view, firm, LightAt::Vertices).pixels == split.draw(view, firm, LightAt::Vertices).pixels);
    EXPECT_TRUE(whole.drawShadowMapped(view).pixels == split.drawShadowMapped(view).pixels);
    EXPECT_FALSE(whole.draw(view, soft).pixels == whole.draw(view, firm).pixels);
    for (const Gpu* gpu : {&large, &small})
        for (const std::string& message : gpu->messages()) ADD_FAILURE() << message;
}

}  // namespace
}  // namespace apertura::test
