#include "apertura/bake/measure/measure.h"
#include "apertura/bake/fit/bake.h"

#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/load.h"
#include "tests/baseline.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

double rmse(const Measurement& m, const std::string& model, double radius = 5, const std::string& source = "sh") {
    for (const MeasureRow& row : m.rows)
        if (row.model == model && row.source == source && row.lightRadius == radius) return row.rmse;
    ADD_FAILURE() << "no row " << model;
    return 0;
}

MeasureOptions at5(int receivers, std::initializer_list<const char*> models = {"ao-area", "sh-l1", "oat", "aperture", "soft"}) {
    MeasureOptions options;
    for (const char* model : models) options.models.push_back(findModel(model));
    options.lightRadii = {5};
    options.receivers = receivers;
    return options;
}

TEST(Truth, OfAnOpenLightIsTheClosedForm) {
    Scene scene;
    scene.name = "speck";
    Surface speck;
    speck.positions = {{0, -9, 0}, {1e-3f, -9, 0}, {0, -9, 1e-3f}};
    speck.triangles = {{0, 2, 1}};
    makeNormals(speck);
    scene.surfaces = {speck};
    scene.instances = {{0}};
    const Tracer tracer(scene);
    const SurfacePoint point{{0, 0, 0}, {0, 1, 0}};
    for (double degrees : {0.27, 5.0, 30.0})
        for (double elevation : {1.0, 20.0, 90.0}) {
            const double r = degrees * pi / 180, e = elevation * pi / 180;
            const dvec3 axis(std::cos(e), std::sin(e), 0);
            const TruthSample t = traceLight(tracer, point, glm::vec3(axis), r, 1024, 0.3);
            EXPECT_NEAR(t.mean(), exactFraction({0, 1, 0}, {{axis, r}}, r), 2e-3);
        }
}

TEST(Measure, ModelsStandInTheOrderOfTheTable) {
    // At 5 degrees, in every scene soft beats aperture, aperture beats oat, and soft beats ao-area.
    for (const char* name : {"terrain", "sphere-over-plane", "room-2", "canyon", "colonnade", "forest", "statue"}) {
        const Measurement m = measureScene(makeBuiltin(name), at5(150));
        EXPECT_LT(rmse(m, "soft"), rmse(m, "aperture")) << name;
        EXPECT_LT(rmse(m, "aperture"), rmse(m, "oat")) << name;
        EXPECT_LT(rmse(m, "soft"), rmse(m, "sh-l1")) << name;
        EXPECT_LT(rmse(m, "sh-l1"), rmse(m, "ao-area") + 0.002) << name;
        EXPECT_LT(m.rows[0].noise, 0.01) << name;
        EXPECT_NEAR(rmse(m, "soft"), rmse(m, "soft", 5, "rays"), 1e-4) << name;
        ASSERT_FALSE(m.paths.empty());
        EXPECT_LT(m.paths[0].directionMax, 0.01);  // the same by construction
    }
}

TEST(RealScenes, ModelsReachTheirFigures) {
    NEEDS_REAL_SCENES();
    for (const baseline::RealScene& c : baseline::kRealScenes) {
        const Measurement m = measureScene(loadScene((realScenes() / c.file).string(), {90, 90}), at5(600));
        std::printf("%s: soft %.4f aperture %.4f\n", c.file, rmse(m, "soft"), rmse(m, "aperture"));
        EXPECT_LE(rmse(m, "soft"), atMost(c.soft)) << c.file;
        EXPECT_LE(rmse(m, "aperture"), atMost(c.aperture)) << c.file;
    }
}

TEST(Measure, ModelsReachTheirMeansOverTheBuiltInScenes) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "minutes with sanitizers; the other tests run the same code";
#endif
    const auto& cases = baseline::kBuiltInScenes;
    const auto scenes = double(builtinNames().size());
    double sum[std::size(cases)][3]{}, numbers = 0, ambient = 0;
    for (const std::string& name : builtinNames()) {
        MeasureOptions options = at5(100, {"soft", "firm-2", "firm-3", "firm-4", "auto"});
        options.lightRadii = {5, 15, 30};
        options.rays = 1024;
        const Measurement m = measureScene(makeBuiltin(name), options);
        for (size_t c = 0; c < std::size(cases); ++c)
            for (int r = 0; r < 3; ++r) sum[c][r] += rmse(m, cases[c].model, options.lightRadii[size_t(r)], cases[c].source) / scenes;
        for (const MeasureRow& row : m.rows) {
            if (row.model == "auto" && row.lightRadius == 5) numbers += row.numbers / scenes;
            if (row.model == "soft" && row.source == "sh-fit" && row.lightRadius == 5) ambient += row.ambient / scenes;
        }
    }
    for (size_t c = 0; c < std::size(cases); ++c) {
        std::printf("%-8s %-4s", cases[c].model, cases[c].source);
        for (int r = 0; r < 3; ++r) {
            std::printf(" %.4f", sum[c][r]);
            EXPECT_LE(sum[c][r], atMost(cases[c].rmse[r])) << cases[c].model;
        }
        std::printf("\n");
    }
    std::printf("auto: %.2f numbers a point; sky of the fitted coefficients %.4f\n", numbers, ambient);
    EXPECT_LE(numbers, atMost(baseline::kNumbersOfAuto));
    EXPECT_LE(ambient, atMost(baseline::kSkyOfFittedCoefficients));
}

TEST(Measure, AnAssetAddsItsBytesAndInterpolation) {
    const Scene scene = makeBuiltin("statue");
    Asset asset;
    asset.scene = scene;
    asset.seen = bakeVertices(scene, Tracer(scene), {});
    asset.info.model = "sh";
    const Measurement whole = measureAsset(asset, at5(300)), own = measureScene(scene, at5(300));
    EXPECT_GT(rmse(whole, "soft"), rmse(own, "soft"));
    EXPECT_LT(rmse(whole, "soft"), rmse(own, "soft") + 0.1);
    EXPECT_EQ(whole.rows[0].bytes, 4);
}

TEST(Measure, ASceneThatIsClosedIsDarkAndFinite) {
    // Every receiver is inside a shell and sees its inner wall alone.
    Scene scene;
    scene.name = "shell";
    Surface shell;
    shell.positions = {{-1, -1, -1}, {1, -1, -1}, {0, -1, 1}, {0, 1, 0}};
    shell.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    makeNormals(shell);
    for (glm::vec3& n : shell.normals) n = -n;
    const glm::vec3 centre(0, -0.5f, 0);
    if (glm::dot(shell.normals[3], centre - shell.positions[3]) < 0)
        for (glm::vec3& n : shell.normals) n = -n;
    scene.surfaces = {shell};
    scene.instances = {{0}};
    MeasureOptions options = at5(20, {});
    options.rays = 256;
    const Measurement m = measureScene(scene, options);
    for (const MeasureRow& row : m.rows) {
        if (row.model == "unshadowed") continue;
        EXPECT_EQ(row.rmsTruth, 0);
        // These take a point without sky for one of any other bent normal: their authors' formulas do. A shadow map leaks along edges.
        const bool leaks = row.model.starts_with("xegtao") || row.model == "micro-shadow";
        EXPECT_LT(row.rmse, leaks ? 0.5 : row.model == "shadow-map" ? 0.05 : 1e-3) << row.model;
    }
}

}  // namespace
}  // namespace apertura::test
