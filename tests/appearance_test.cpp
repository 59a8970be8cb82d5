#include "apertura/bake/measure/appearance.h"

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/measure.h"
#include "apertura/bake/sampling/neighbours.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/runtime/asset/faces.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// Patches of the points of a grid that has no rim, whose neighbours are those at most `reach` steps away along its lines.
std::vector<Patch> gridPatches(int side, int reach) {
    std::vector<Patch> out;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            Patch patch{uint32_t(y * side + x)};
            for (int j = -reach; j <= reach; ++j)
                for (int i = -reach; i <= reach; ++i)
                    if ((i || j) && std::abs(i) + std::abs(j) <= reach)
                        patch.push_back(uint32_t((y + j + side) % side * side + (x + i + side) % side));
            out.push_back(patch);
        }
    return out;
}

TEST(Appearance, MottleOfWhiteNoiseIsItsDeviation) {
    const int side = 64;
    const size_t lights = 3;
    const std::vector<Patch> patches = gridPatches(side, 2);
    ASSERT_EQ(patches[0].size(), 13u);
    Random random(1);
    std::vector<float> errors(size_t(side * side) * lights), truth(errors.size(), 0.5f);
    double squares = 0;
    for (float& e : errors) e = float(random(-0.3, 0.3)), squares += double(e) * e;
    const double deviation = std::sqrt(squares / double(errors.size()));
    // The mean of twelve others adds a twelfth of the variance.
    EXPECT_NEAR(mottleOf(patches, errors, truth, lights), deviation * std::sqrt(1 + 1 / 12.0), 0.01 * deviation);
    for (float& e : errors) e = 0.2f;
    EXPECT_NEAR(mottleOf(patches, errors, truth, lights), 0, 1e-7) << "an even error is none that is seen";
}

TEST(Appearance, MottleOfACheckerboard) {
    const int side = 8;
    const std::vector<Patch> patches = gridPatches(side, 2);
    std::vector<float> errors, truth(size_t(side * side), 0.5f);
    for (int i = 0; i < side * side; ++i) errors.push_back((i % side + i / side) % 2 ? 0.1f : -0.1f);
    // Of twelve neighbours, four have the other sign: their mean is a third of the point's own.
    EXPECT_NEAR(mottleOf(patches, errors, truth, 1), 0.1 * 2 / 3, 1e-6);
}

TEST(Appearance, MottleIsCountedWhereTruthIsSmooth) {
    const int side = 32;
    const std::vector<Patch> patches = gridPatches(side, 2);
    std::vector<float> errors(size_t(side * side), 0.0f), truth(errors.size(), 0.0f);
    // One straight edge, and its counterpart where the grid closes; the model has it one column aside.
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            truth[size_t(y * side + x)] = x >= 8 && x < 24;
            errors[size_t(y * side + x)] = float(x >= 9 && x < 25) - truth[size_t(y * side + x)];
        }
    // Two columns on either side of both edges are left out; of the other 24, two have one wrong neighbour of twelve.
    EXPECT_NEAR(mottleOf(patches, errors, truth, 1), std::sqrt(2 / 24.0) / 12, 1e-6);
    for (float& e : errors) e = 0;
    for (int y = 0; y < side; ++y) errors[size_t(y * side + 16)] = 1;  // a bright line where truth is even
    EXPECT_GT(mottleOf(patches, errors, truth, 1), 0.1);
    EXPECT_EQ(mottleOf({}, errors, truth, 1), 0);
}

TEST(Appearance, WidthOfARampAndAStep) {
    std::vector<double> at;
    std::vector<float> ramp, step, smear, none;
    for (int i = 0; i <= 400; ++i) {
        const double x = -2 + 0.01 * i;
        at.push_back(x);
        ramp.push_back(float(std::clamp(0.5 + x / 1.5, 0.0, 1.0)));
        step.push_back(x > 0);
        smear.push_back(x < -1 ? 0 : x < 1 ? 0.5f : 1);
        none.push_back(0.7f);
    }
    EXPECT_NEAR(edgeWidth(at, ramp), 0.8 * 1.5, 1e-3);
    EXPECT_NEAR(edgeWidth(at, step), 0, 0.01);
    EXPECT_NEAR(edgeWidth(at, smear), 4.8 * 0.25 * 2, 0.02) << "half light over two metres";
    EXPECT_NEAR(edgeWidth(at, none), 0.8 * 4, 1e-6);
}

TEST(Appearance, StoredPointsHaveNeighboursAcrossSplitVertices) {
    // Two triangles that share an edge's places, and no vertices; and one more across a crease.
    Scene scene;
    Surface surface;
    surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}, {1, 0, 0}, {1, -1, 0}, {1, 0, -1}};
    surface.normals = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    surface.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    scene.surfaces = {surface};
    scene.instances = {{0}};
    const auto list = [](std::span<const uint32_t> s) { return std::vector<uint32_t>(s.begin(), s.end()); };
    const StoredPoints vertices(scene, 0);
    EXPECT_EQ(vertices.firstTwin(3), 1u);
    EXPECT_EQ(vertices.firstTwin(5), 2u);
    EXPECT_EQ(vertices.firstTwin(6), 6u) << "a crease";
    EXPECT_EQ(list(vertices.neighbours(0)), (std::vector<uint32_t>{1, 2}));
    EXPECT_EQ(list(vertices.neighbours(3)), (std::vector<uint32_t>{0, 2, 4}));
    EXPECT_EQ(vertices.withinTwo(0), (std::vector<uint32_t>{1, 2, 4}));
    EXPECT_EQ(list(vertices.neighbours(6)), (std::vector<uint32_t>{7, 8}));
    // A lattice of two steps on the first two triangles: they meet in three samples.
    SeenOnFaces faces;
    faces.setLevels({2, 2, 0}, false);
    const StoredPoints stored(scene, 0, &faces);
    ASSERT_EQ(stored.size(), 9u + 12u);
    EXPECT_EQ(stored.place(0).triangle, -1) << "samples are drawn in its place";
    // Sample 4 of the first triangle lies between corners 1 and 2, as does sample 3 of the second, between its corners 0 and 2.
    EXPECT_EQ(stored.firstTwin(9 + 6 + 3), 9u + 4);
    EXPECT_EQ(stored.withinTwo(9 + 4).size(), 8u);
    EXPECT_EQ(stored.neighbours(9 + 4).size(), 6u);
}

TEST(Appearance, OfAnAssetThatIsRight) {
    // Nothing blocks the ball's sky but itself, and a cap is just that: no model errs less from vertex to vertex than one that is exact.
    if (kSanitized) GTEST_SKIP() << "minutes with sanitizers; the other tests run the same code";
    Scene scene = makeBuiltin("sphere-over-plane");
    const Tracer tracer(scene);
    Asset asset{scene, {}, {}};
    BakeOptions bake;
    bake.recipe = "sh";
    asset.seen = bakeScene(scene, tracer, bake);
    std::vector<SurfaceSample> receivers;
    for (const SurfaceSample& p : sampleReceivers(scene, 200, 1)) receivers.push_back(p);
    const Appearance appearance(asset, tracer, receivers, {0.27, 5}, 1, {});
    EXPECT_LT(appearance.mottle(models()[APERTURA_MODEL_SOFT], 5), 0.02);
    // The same with the vertices' visible area thrown about by a tenth.
    Random random(3);
    for (SeenByInstance& seen : asset.seen) {
        for (Visibility& v : seen.visibility) v.area *= float(random(0.8, 1.0));
        for (Visibility& v : seen.faces.visibility) v.area *= float(random(0.8, 1.0));
    }
    EXPECT_GT(appearance.mottle(models()[APERTURA_MODEL_AO_AREA], 5), 0.02);
}

// A floor under half a ceiling: the shadow of its rim is a straight line.
TEST(Appearance, EdgesUnderAStraightRim) {
    Scene scene;
    Surface floor, ceiling;
    floor.positions = {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}};
    floor.triangles = {{0, 1, 2}, {0, 2, 3}};
    ceiling.positions = {{-90, 2, 90}, {0, 2, 90}, {0, 2, -90}, {-90, 2, -90}};
    ceiling.triangles = {{0, 1, 2}, {0, 2, 3}};
    makeNormals(floor);
    makeNormals(ceiling);
    scene.surfaces = {floor, ceiling};
    scene.instances = {{0}, {1}};
    const Tracer tracer(scene);
    std::vector<SurfaceSample> receivers;
    for (const SurfaceSample& p : sampleSurface(scene, 60, 1, {{true, false}, {}})) receivers.push_back(p);
    // At x the sky is open where a direction w has x w.y + 2 w.x > 0: a hard lobe, or a wide one, at each sample.
    const auto edgeOf = [&](uint8_t level, float sharpness, double radius) {
        Asset asset{scene, {}, {}};
        asset.info.model = "firm-2";
        for (const Instance& instance : scene.instances) {
            const Surface& surface = scene.surfaces[instance.surface];
            SeenByInstance& seen = asset.seen.emplace_back();
            const auto fill = [&](std::vector<Visibility>& visibility, std::vector<ModelParams>& params, size_t at, const vec3& p) {
                visibility[at] = {vec3(0, 2, 0), 4};
                params[at][0] = params[at][1] = sharpness * normalize(vec4(2, p.x, 0, 0));
            };
            seen.visibility.resize(surface.positions.size());
            seen.allParams.resize(surface.positions.size());
            for (size_t v = 0; v < surface.positions.size(); ++v) fill(seen.visibility, seen.allParams, v, surface.positions[v]);
            seen.faces.setLevels({level, level}, true);
            for (size_t t = 0; t < 2 && level > 0; ++t)
                for (int i = 0; i < aperturaLatticeSize(aperturaLatticeSteps(level)); ++i) {
                    const vec3 weights = latticePoint(i, aperturaLatticeSteps(level));
                    vec3 p(0);
                    for (int c = 0; c < 3; ++c) p += weights[c] * surface.positions[surface.triangles[t][size_t(c)]];
                    fill(seen.faces.visibility, seen.faces.allParams, seen.faces.first[t] + size_t(i), p);
                }
        }
        return Appearance(asset, tracer, receivers, {radius}, 1, {}).edge(models()[APERTURA_MODEL_FIRM_2], radius);
    };
    // With samples 6 cm apart, edges are as wide as the lobes' own, and those of a light of 5 degrees about as wide as truth's.
    EXPECT_NEAR(edgeOf(8, 4000, 5), 1.1, 0.15);
    EXPECT_GT(edgeOf(8, kSofterSharpness, 5), 1.3);
    // With samples at four corners there is no edge at all.
    EXPECT_GT(edgeOf(0, kHardSharpness, 0.27), 20);
}

}  // namespace
}  // namespace apertura::test
