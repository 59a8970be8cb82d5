// The path tracer, compared with closed forms and with radiosity by patches.
#include "apertura/bake/sampling/paths.h"

#include "apertura/bake/measure/reference.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/load.h"
#include "apertura/bake/scene/shapes.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

Albedo grey(double a) { return {glm::vec3(float(a)), true}; }

Scene sceneOf(const Surface& surface) {
    Scene scene;
    scene.name = "test";
    scene.surfaces = {surface};
    scene.instances = {{0}};
    return scene;
}

// A closed box of 2 x 2 x 2 metres about the origin, seen from inside.
Scene closedBox() {
    Surface box;
    addBox(box, glm::dvec3(-1), glm::dvec3(1), 2);
    for (auto& t : box.triangles) std::swap(t[1], t[2]);
    for (glm::vec3& n : box.normals) n = -n;
    return sceneOf(box);
}

TEST(Paths, InAFurnaceEverythingIsAsBrightAsTheSky) {
    for (const char* name : {"builtin:colonnade", "builtin:statue", "builtin:canyon"}) {
        const Scene scene = loadScene(name);
        const Tracer tracer(scene);
        for (const SurfaceSample& p : sampleSurface(scene, 20, 3)) {
            // What is inside of a solid finds no way out.
            if (skyByPaths(tracer, grey(1), p.at, 64, 0, 1, 0).x < 0.1f) continue;
            EXPECT_NEAR(skyByPaths(tracer, grey(1), p.at, 64, 400, 1, 0).y, 1, 0.035) << name;
        }
    }
}

TEST(Paths, InAClosedBoxTheSeriesOfAlbedosIsSummed) {
    // Every wall glows alike: after n bounces the radiance is 1 + a + ... + a^n, at last 1 / (1 - a).
    struct Glow {
        double sum = 1;  // of the wall that is met first
        bool ends(const glm::dvec3&, const glm::vec3&, float) const { return false; }
        bool reflects(const Hit&, const SurfacePoint&, const glm::vec3& throughput) { return sum += throughput.x, true; }
        void escapes(const glm::vec3&, const glm::vec3&) { ADD_FAILURE() << "out of a closed box"; }
    };
    const Scene scene = closedBox();
    const Tracer tracer(scene);
    for (const double a : {0.2, 0.5, 0.8})
        for (const int bounces : {0, 1, 7, 100})
            for (const uint64_t path : {1, 2, 3}) {
                Glow glow;
                followPath(tracer, grey(a), {0.1, 0.2, 0.3}, glm::normalize(glm::vec3(1, 2, 3)), bounces, 1, path, glow);
                EXPECT_NEAR(glow.sum, (1 - std::pow(a, bounces + 1)) / (1 - a), 1e-4);
            }
}

// The irradiance over pi at two places of a plate of 2 x 2 metres that faces another, `apart` metres above it, under a sky of unit
// radiance, by patches and all their bounces: Goral et al., "Modeling the interaction of light between diffuse surfaces", 1984.
std::array<double, 2> byRadiosity(double apart, double albedo, glm::dvec2 place) {
    constexpr int n = 30, all = n * n;
    const double area = 4.0 / all;
    const auto middle = [&](int i) { return glm::dvec2(i % n + 0.5, i / n + 0.5) * (2.0 / n) - 1.0; };
    const auto form = [&](glm::dvec2 a, glm::dvec2 b) {
        const double squared = glm::dot(a - b, a - b) + apart * apart;
        return area * apart * apart / (pi * squared * squared);
    };
    std::vector<double> open(all, 1), out(all, 0);
    for (int i = 0; i < all; ++i)
        for (int j = 0; j < all; ++j) open[size_t(i)] -= form(middle(i), middle(j));
    for (int bounce = 0; bounce < 60; ++bounce) {  // both plates are alike
        std::vector<double> next(all);
        for (int i = 0; i < all; ++i) {
            double from = open[size_t(i)];
            for (int j = 0; j < all; ++j) from += form(middle(i), middle(j)) * out[size_t(j)];
            next[size_t(i)] = albedo * from;
        }
        out = next;
    }
    double direct = 1, sum = 0;
    for (int j = 0; j < all; ++j) direct -= form(place, middle(j)), sum += form(place, middle(j)) * out[size_t(j)];
    return {direct, direct + sum};
}

TEST(Paths, BetweenTwoPlatesTheyAreRadiosity) {
    Surface plates;
    addPanel(plates, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 2);
    addPanel(plates, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 2);
    const Scene scene = sceneOf(plates);
    const Tracer tracer(scene);
    for (const glm::dvec2 place : {glm::dvec2(0), glm::dvec2(0.8, 0.5)})
        for (const double albedo : {0.4, 0.9}) {
            const auto [direct, whole] = byRadiosity(1, albedo, place);
            const SurfacePoint point{{place.x, 0, place.y}, {0, 1, 0}};
            EXPECT_NEAR(skyByPaths(tracer, grey(albedo), point, 40000, 0, 1, 0).x, direct, 2e-3);
            EXPECT_NEAR(skyByPaths(tracer, grey(albedo), point, 40000, 80, 1, 0).x, whole, 6e-3) << albedo;
        }
}

TEST(Paths, EachBounceAddsAndNoneBringsMoreThanTheSky) {
    const Scene scene = loadScene("builtin:room-2");
    const Tracer tracer(scene);
    for (const SurfaceSample& p : sampleReceivers(scene, 10, 1)) {
        float before = -1;
        for (const int bounces : {0, 1, 2, 4, 16}) {
            const glm::vec3 e = skyByPaths(tracer, {glm::vec3(0.9f, 0.5f, 0), true}, p.at, 256, bounces, 1, 0);
            EXPECT_GE(e.x, before);
            EXPECT_LE(e.x, 1.00001f);
            EXPECT_LE(e.y, e.x);
            EXPECT_EQ(e.z, skyByPaths(tracer, grey(0), p.at, 256, 0, 1, 0).z) << "black walls add nothing";
            before = e.x;
        }
    }
}

TEST(Paths, AlbedosBeyondOneCountAsOne) {
    Scene scene = closedBox();
    Hit hit{};
    scene.materials = {{.baseColour = {3, -1, 0.5f, 1}}};
    scene.surfaces[0].material = 0;
    EXPECT_EQ(albedoAt(scene, hit, {}), glm::vec4(1, 0, 0.5f, 1));
    EXPECT_EQ(albedoAt(scene, hit, grey(0.25)), glm::vec4(0.25f, 0.25f, 0.25f, 1));
    scene.materials = {};
    EXPECT_EQ(albedoAt(scene, hit, {glm::vec3(0.3f)}), glm::vec4(0.3f, 0.3f, 0.3f, 1));
}

// The mean radiance of a picture of a closed box from inside.
double insideBox(const View& given, int bounces) {
    const Scene scene = closedBox();
    View view = given;
    view.sky = glm::vec3(5);  // is nowhere seen
    view.bounces = bounces;
    view.camera = {{-0.9f, -0.9f, -0.9f}, {1, 1, 1}, 1.6f};
    view.width = view.height = 24;
    ReferenceOptions options;
    options.paths = 32;
    options.lightRays = 64;
    double sum = 0;
    const Picture picture = traceReference(Tracer(scene), view, options);
    for (const glm::vec3& p : picture.pixels) sum += p.x;
    return sum / double(picture.pixels.size());
}

TEST(Paths, ALampInAClosedBoxIsAnIntegratingSphere) {
    // The light of a lamp of radiance L and radius R is pi L 4 pi R^2. By walls of area S and albedo a it comes back and back, and the
    // irradiance that is not direct is a / (1 - a) of the mean direct one, nearly the same all over the box.
    constexpr double a = 0.7, R = 0.02, S = 24;
    View view;
    view.albedo = glm::vec3(float(a));
    view.lights = {sphereLight(glm::vec3(0), R, glm::vec3(1000))};
    const double direct = insideBox(view, 0), all = insideBox(view, 60);
    const double flux = pi * 1000 * 4 * pi * R * R;
    EXPECT_NEAR((all - direct) * pi / a, flux / S * a / (1 - a), 0.04 * flux / S);
    EXPECT_NEAR((insideBox(view, 1) - direct) * pi / a, flux / S * a, 0.04 * flux / S);
}

}  // namespace
}  // namespace apertura::test
