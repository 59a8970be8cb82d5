// The ray-traced reference picture, compared with closed forms for lamps between walls.
#include "apertura/bake/measure/reference.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// A square that faces up, 2 `half` metres per side, at `height` metres.
Surface plate(double half, double height, double x = 0) {
    Surface out;
    const auto h = float(half), y = float(height), x0 = float(x);
    out.positions = {{x0 - h, y, h}, {x0 + h, y, h}, {x0 + h, y, -h}, {x0 - h, y, -h}};
    out.triangles = {{0, 1, 2}, {0, 2, 3}};
    makeNormals(out);
    return out;
}

// E / L at the middle of a floor under one sphere light, with blockers between. Lengths in metres.
double underSphere(const glm::dvec3& centre, double radius, const std::vector<Surface>& blockers = {}) {
    Scene scene;
    scene.name = "lamp";
    scene.surfaces = {plate(20, 0)};
    scene.surfaces.insert(scene.surfaces.end(), blockers.begin(), blockers.end());
    for (size_t i = 0; i < scene.surfaces.size(); ++i) scene.instances.push_back({int(i)});
    View view;
    view.camera = {{0.02f, 0.5f, 0.01f}, {0, 0, 0}, 0.01f};  // sees a few millimetres, from below the blockers
    view.width = view.height = 2;
    view.lights = {sphereLight(glm::vec3(centre), radius, glm::vec3(1))};
    view.sky = glm::vec3(0);
    view.albedo = glm::vec3(1);
    ReferenceOptions options;
    options.lightRays = 4096;
    const Picture picture = traceReference(Tracer(scene), view, options);
    return pi * picture.pixels[0].x;
}

TEST(Reference, ASphereOverAFloorIsTheClosedForm) {
    // A sphere of radius R at distance d, wholly above the horizon: E = pi L (R / d)^2 cos(theta).
    EXPECT_NEAR(underSphere({0, 4, 0}, 1), pi / 16, 2e-3 * pi / 16);
    EXPECT_NEAR(underSphere({0, 4, 0}, 3), pi * 9 / 16, 2e-3 * pi * 9 / 16);
    EXPECT_NEAR(underSphere({3, 4, 0}, 1), pi / 25 * 4 / 5, 2e-3 * pi / 25);
}

TEST(Reference, WhatIsInsideALampDoesNotDarkenIt) {
    const double open = underSphere({0, 4, 0}, 1);
    EXPECT_NEAR(underSphere({0, 4, 0}, 1, {plate(0.5, 3.3)}), open, 1e-6);  // its corners are within the sphere
    EXPECT_NEAR(underSphere({0, 4, 0}, 1, {plate(3, 4.5)}), open, 1e-6) << "nor what is behind its front";
    EXPECT_LT(underSphere({0, 4, 0}, 1, {plate(0.5, 2.5)}), 0.6 * open) << "but what hangs below it does";
}

TEST(Reference, WhatIsBeforeALampsLimbDarkensIt) {
    // Two plates at height 2.3 hide the limb of a sphere of radius 2 at height 4: they are farther from the receiver than
    // the sphere's nearest point, but outside it. The expected value is a brute-force sum over the sphere.
    const std::vector<Surface> sides{plate(0.1, 2.3, 1.22), plate(0.1, 2.3, -1.22)};
    double expected = 0;
    constexpr int kSteps = 1500;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            // Uniform steps over the disc x, z of directions to the sphere: E is the disc's area.
            const double x = (i + 0.5) / kSteps - 0.5, z = (j + 0.5) / kSteps - 0.5;
            if (x * x + z * z > 0.25) continue;
            const double y = std::sqrt(1 - x * x - z * z), t = 2.3 / y;
            const bool hidden = std::abs(std::abs(t * x) - 1.22) < 0.1 && std::abs(t * z) < 0.1;
            const double enters = 4 * y - std::sqrt(std::max(4 - 16 * (1 - y * y), 0.0));
            expected += hidden && t < enters ? 0 : 1.0 / (kSteps * kSteps);
        }
    const double open = underSphere({0, 4, 0}, 2);
    EXPECT_LT(expected, 0.99 * open);
    EXPECT_NEAR(underSphere({0, 4, 0}, 2, sides), expected, 2e-3 * open);
}

}  // namespace
}  // namespace apertura::test
