// Baking of difficult geometry: faces that coincide or have no area, vertices inside other geometry, normals that contradict
// windings, scenes far from the origin, tiny and huge ones.
#include "apertura/bake/sampling/vertices.h"

#include <glm/gtc/matrix_transform.hpp>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/sampling/solids.h"
#include "apertura/bake/scene/shapes.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

Scene sceneOf(std::vector<Surface> surfaces, const glm::mat4& transform = glm::mat4(1)) {
    Scene scene;
    scene.name = "test";
    for (size_t i = 0; i < surfaces.size(); ++i) scene.instances.push_back({int(i), transform});
    scene.surfaces = std::move(surfaces);
    return scene;
}

struct Baked {
    BakedVisibility visibility;
    MeshIssues issues;
    std::vector<double> open(size_t instance = 0) const {  // visible fraction of the hemisphere, per vertex
        std::vector<double> out;
        for (const Visibility& v : visibility[instance].visibility) out.push_back(v.area / (2 * pi));
        return out;
    }
};

Baked bake(const Scene& scene) {
    Baked out;
    out.visibility = bakeVertices(scene, Tracer(scene), {.rays = 256}, {}, &out.issues);
    return out;
}

Surface panel(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, double cell) {
    Surface surface;
    addPanel(surface, corner, u, v, cell);
    return surface;
}

// The inside of a cube of one-sided walls, in cells of about `cell`.
Surface room(double cell) {
    Surface surface;
    const glm::dvec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
    addPanel(surface, {-1, -1, -1}, z, x, cell), addPanel(surface, {-1, 1, -1}, x, z, cell);
    addPanel(surface, {-1, -1, -1}, y, z, cell), addPanel(surface, {1, -1, -1}, z, y, cell);
    addPanel(surface, {-1, -1, -1}, x, y, cell), addPanel(surface, {-1, -1, 1}, y, x, cell);
    return surface;
}

Surface blob() {
    Surface surface;
    addBlob(surface, {0, 0, 0}, 48, [](const glm::dvec3& w) { return 1 + 0.15 * noise(3.0 * w, 5); });
    return surface;
}

const glm::mat4 kTurned = glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(1, 2, 3)));

TEST(Vertices, SealedRoomIsDarkAndBallIsOpenAtEverySizeAndPlace) {
    Surface ball;
    addBlob(ball, {0, 0, 0}, 64, [](const glm::dvec3&) { return 1.0; });
    for (const double size : {1e-4, 1e-2, 1.0, 30.0, 1e5})
        for (const glm::vec3& place : {glm::vec3(0), glm::vec3(1e6f, -1e6f, 3e5f)})
            for (const glm::mat4& turn : {glm::mat4(1), kTurned}) {
                const glm::mat4 transform = glm::scale(glm::translate(glm::mat4(1), place) * turn, glm::vec3(float(size)));
                for (const double open : bake(sceneOf({room(0.5)}, transform)).open())
                    ASSERT_EQ(open, 0) << "light leaks in: " << size << " m at " << place.x;
                for (const double open : bake(sceneOf({ball}, transform)).open())
                    ASSERT_NEAR(open, 1, 1e-6) << "it hits itself: " << size << " m at " << place.x;
                // With two instances rays are transformed into the surfaces' frames.
                Scene two = sceneOf({ball}, transform);
                two.instances.push_back({0, glm::translate(glm::mat4(1), glm::vec3(float(size * 40), 0, 0)) * transform});
                for (const double open : bake(two).open())
                    ASSERT_GT(open, 0.996) << "it hits itself, instanced: " << size << " m at " << place.x;
            }
}

TEST(Vertices, BumpySurfaceIsTheSameAtEverySizeAndPlace) {
    const std::vector<double> expected = bake(sceneOf({blob()})).open();
    double least = 1;
    for (const double open : expected) least = std::min(least, open);
    EXPECT_LT(least, 0.95);  // it has hollows
    for (const double size : {1e-4, 7.0, 1e5})
        for (const glm::vec3& place : {glm::vec3(0), glm::vec3(1e6f, 2e6f, -1e6f)}) {
            const auto open = bake(sceneOf({blob()}, glm::scale(glm::translate(glm::mat4(1), place), glm::vec3(float(size))))).open();
            for (size_t i = 0; i < open.size(); ++i)
                ASSERT_NEAR(open[i], expected[i], 3.5 / 256) << size << " m at " << place.x;  // a few grazing rays may differ
        }
}

TEST(Vertices, CloseUpOfAHugeSceneIsNotLiftedOffIt) {
    // A step of 1 mm on a plane of 100 km: rays that start above it by a fraction of its size would miss the step.
    Surface ground = panel({-5e4, 0, 5e4}, {1e5, 0, 0}, {0, 0, -1e5}, 1e5);
    const Surface wall = panel({0, 0, -0.05}, {0, 0.001, 0}, {0, 0, 0.1}, 0.001),
                  floor = panel({0, 0, 0.05}, {0.1, 0, 0}, {0, 0, -0.1}, 0.01);
    const Scene scene = sceneOf({ground, wall, floor});
    const BakedVisibility baked = bakeVertices(scene, Tracer(scene), {.rays = 1024});
    int seen = 0;
    for (size_t v = 0; v < floor.positions.size(); ++v) {
        if (floor.positions[v].x > 0 || std::abs(floor.positions[v].z) > 0.02f) continue;
        EXPECT_NEAR(baked[2].visibility[v].area / (2 * pi), 0.5, 0.02);  // at the wall's foot
        ++seen;
    }
    EXPECT_GE(seen, 3);
}

TEST(Vertices, DoubledAndCoplanarFacesBlockNothing) {
    // The planes are turned, so that their coordinates agree only within rounding.
    const glm::dvec3 x(kTurned[0]), z(kTurned[2]);
    const Surface back = panel(-5.0 * x + 5.0 * z, -10.0 * z, 10.0 * x, 1);  // the other way round
    const Scene scene = sceneOf({panel(-5.0 * x + 5.0 * z, 10.0 * x, -10.0 * z, 1), panel(-5.0 * x + 5.0 * z, 10.0 * x, -10.0 * z, 1),
                                 panel(-3.1 * x + 2.7 * z, 4.9 * x, -5.3 * z, 0.37), back});
    const Baked baked = bake(scene);
    for (size_t instance = 0; instance < 4; ++instance)
        for (const double open : baked.open(instance)) EXPECT_NEAR(open, 1, 1e-6);
}

TEST(Vertices, TrianglesOfNoAreaAreCountedAndBlockNothing) {
    Surface plane = panel({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, 1);
    const auto n = uint32_t(plane.positions.size());
    for (const glm::vec3& p : {glm::vec3(0, 1, 0), glm::vec3(1, 1, 0), glm::vec3(2, 1, 0)})
        plane.positions.push_back(p), plane.normals.emplace_back(0, 1, 0);
    plane.triangles.push_back({n, n + 1, n + 2});
    plane.triangles.push_back({3, 3, 4});
    plane.triangles.push_back({7, 7, 7});
    const Baked baked = bake(sceneOf({plane}));
    EXPECT_EQ(baked.issues.degenerate, 3u);
    EXPECT_EQ(baked.issues.withoutFaces, 3u);
    for (const double open : baked.open()) EXPECT_NEAR(open, 1, 1e-6);
}

TEST(Vertices, GroundUnderABoxIsNotBlackAroundIt) {
    // A coarse ground: some vertices lie inside the box, and their triangles reach out of it.
    Surface box;
    addBox(box, {-1.4, 0, -1.4}, {1.4, 1, 1.4}, 0.1);
    const Scene scene = sceneOf({panel({-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, 1), box});
    const Baked baked = bake(scene);
    EXPECT_EQ(baked.issues.moved, 8u);         // the ring of nine vertices but the middle one,
    EXPECT_EQ(baked.issues.insideSolids, 1u);  // whose triangles are all inside
    const Surface& ground = scene.surfaces[0];
    int inside = 0;
    for (size_t v = 0; v < ground.positions.size(); ++v) {
        const glm::vec3 p = ground.positions[v];
        const bool under = std::abs(p.x) < 1.4f && std::abs(p.z) < 1.4f, middle = glm::length(p) < 0.1f;
        inside += under;
        const double open = baked.open()[v];
        if (middle) {
            EXPECT_EQ(open, 0);
        } else {
            EXPECT_GT(open, under ? 0.45 : 0.7) << p.x << ' ' << p.z;
        }
    }
    EXPECT_EQ(inside, 9);
}

TEST(Vertices, WallsSeeNothingFromBelowTheGroundTheyStandOn) {
    Surface box;
    addBox(box, {-1, 0, -1}, {1, 1, 1}, 0.5, false);
    const Scene scene = sceneOf({panel({-60, 0, 60}, {120, 0, 0}, {0, 0, -120}, 6), box});
    const Baked baked = bake(scene);
    for (size_t v = 0; v < box.positions.size(); ++v) {
        if (box.normals[v].y > 0.5f) continue;
        EXPECT_NEAR(baked.open(1)[v], 0.5, 0.03) << box.positions[v].y;  // half of what it sees is ground
    }
}

TEST(Vertices, LargeTrianglesAreCounted) {
    // Squares of 1/15 and 1/30 of the panel: so are their diagonals relative to its own.
    for (const auto& [cell, large] : {std::pair(1.0, 2u * 15 * 15), std::pair(0.5, 0u)}) {
        const Baked baked = bake(sceneOf({panel({0, 0, 15}, {15, 0, 0}, {0, 0, -15}, cell)}));
        EXPECT_EQ(baked.issues.large, large) << cell;
        EXPECT_EQ(describe(baked.issues).size(), large > 0 ? 1u : 0u);
    }
}

TEST(Vertices, WindingAgainstNormalsIsSaidAndTheNormalsCount) {
    Surface flipped = blob();
    for (auto& t : flipped.triangles) std::swap(t[1], t[2]);
    const Baked straight = bake(sceneOf({blob()})), turned = bake(sceneOf({flipped}));
    EXPECT_EQ(straight.issues.inverted, 0u);
    EXPECT_EQ(turned.issues.inverted, flipped.triangles.size());
    EXPECT_EQ(turned.open(), straight.open());
    // A mirroring transform turns both.
    const Baked mirrored = bake(sceneOf({blob()}, glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1))));
    EXPECT_EQ(mirrored.issues.inverted, 0u);
    for (const double open : mirrored.open()) EXPECT_GT(open, 0.3);
}

TEST(Vertices, NormalBehindItsFacesLooksOutOnTheirSide) {
    Surface bad = blob();
    const std::vector<double> straight = bake(sceneOf({bad})).open();
    for (size_t v = 0; v < bad.normals.size(); v += 50) bad.normals[v] = -bad.normals[v];
    const Baked baked = bake(sceneOf({bad}));
    EXPECT_EQ(baked.issues.normalsBehind, (bad.normals.size() + 49) / 50);
    for (size_t v = 0; v < bad.normals.size(); v += 50) EXPECT_NEAR(baked.open()[v], straight[v], 0.05);
}

TEST(Vertices, AMinorityWoundTheOtherWayIsBelievedToo) {
    Surface two;
    const auto one = [](const glm::dvec3&) { return 1.0; };
    addBlob(two, {0, 0, 0}, 32, one);
    const size_t first = two.triangles.size();
    addBlob(two, {5, 0, 0}, 16, one);
    for (size_t t = first; t < two.triangles.size(); ++t) std::swap(two.triangles[t][1], two.triangles[t][2]);
    const Baked baked = bake(sceneOf({two}));
    EXPECT_EQ(baked.issues.inverted, two.triangles.size() - first);
    EXPECT_EQ(baked.issues.normalsBehind + baked.issues.insideSolids + baked.issues.moved, 0u);
    for (const double open : baked.open()) EXPECT_GT(open, 0.9);
}

TEST(Vertices, SteepSheetsWithUprightNormalsAreNotInsideThemselves) {
    for (const double slope : {0.5, 1.5, 3.0}) {
        Surface sheet = panel({-1, -slope, 1}, {2, 2 * slope, 0}, {0, 0, -2}, 0.25);
        for (glm::vec3& n : sheet.normals) n = glm::vec3(0, 1, 0);
        const Baked baked = bake(sceneOf({sheet}));
        EXPECT_EQ(baked.issues.moved + baked.issues.insideSolids + baked.issues.normalsBehind, 0u) << slope;
        const double expected = 1 - std::atan(slope) / pi;  // the rising half of the sheet blocks a lune of the hemisphere
        for (const double open : baked.open()) {
            EXPECT_GE(open, expected - 0.03) << slope;
            EXPECT_LE(open, 1.0001) << slope;
        }
    }
}

TEST(Vertices, AGroundUnderAWallOfTwoSheetsKeepsToItsSide) {
    // The ground's triangles cross the wall; a vertex 0.1 m from it sees the sky on its own side.
    const Surface ground = panel({-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, 1);
    Surface wall = panel({0.1, 0, -30}, {0, 30, 0}, {0, 0, 60}, 60);
    const auto n = uint32_t(wall.positions.size());
    const Surface front = wall;
    for (size_t v = 0; v < n; ++v) wall.positions.push_back(front.positions[v]), wall.normals.push_back(-front.normals[v]);
    for (const auto& t : front.triangles) wall.triangles.push_back({t[0] + n, t[2] + n, t[1] + n});
    for (const bool flagged : {false, true}) {
        Surface sheet = flagged ? front : wall;
        sheet.twoSided = flagged;
        const Baked baked = bake(sceneOf({ground, sheet}));
        EXPECT_EQ(baked.issues.moved, 0u) << flagged;
        for (size_t v = 0; v < ground.positions.size(); ++v)
            if (std::abs(ground.positions[v].x) < 0.01f && std::abs(ground.positions[v].z) < 5) {
                EXPECT_LT(baked.visibility[0].visibility[v].direction.x, 0) << flagged;
            }
    }
}

TEST(Vertices, FacesBothWaysBetweenSharedVerticesAreFaces) {
    Surface both = panel({0, 0, 0}, {1, 0, 0}, {0, 0, -1}, 1);
    const auto triangles = both.triangles;
    for (const auto& t : triangles) both.triangles.push_back({t[0], t[2], t[1]});
    const Baked baked = bake(sceneOf({both}));
    EXPECT_EQ(baked.issues.withoutFaces, 0u);
    EXPECT_EQ(baked.issues.degenerate, 0u);
}

TEST(Vertices, InstancesOfTinyNumbersUnderLargeScalesBlock) {
    for (const double tiny : {1e-12, 1e-20, 1e-25}) {
        Surface wall = panel({0, 0, -1}, {0, 1, 0}, {0, 0, 2}, 1);
        for (glm::vec3& p : wall.positions) p *= float(tiny);
        Scene scene = sceneOf({wall, panel({0.01, 0, 0.5}, {1, 0, 0}, {0, 0, -1}, 0.25)});
        scene.instances[0].toWorld = glm::scale(glm::mat4(1), glm::vec3(float(1 / tiny)));
        scene.instances.push_back({0, glm::translate(glm::mat4(1), glm::vec3(-2, 0, 0)) * scene.instances[0].toWorld});
        const Baked baked = bake(scene);
        double least = 1;
        for (const double open : baked.open(1)) least = std::min(least, open);
        EXPECT_LT(least, 0.6) << tiny;
    }
}

TEST(Vertices, PartsOfTwoSidedMaterialsAreSolidWhereTheyClose) {
    // A ground, a box that stands in it without a bottom, and a curtain. The ground's middle lies within the box.
    Scene scene = sceneOf({panel({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, 1), {}, panel({3, 0, 2}, {0, 0, -4}, {0, 3, 0}, 1)});
    addBox(scene.surfaces[1], {-1.5, -0.5, -1.5}, {1.5, 2, 1.5}, 1, false);
    for (const bool twoSided : {false, true}) {
        for (Surface& surface : scene.surfaces) surface.twoSided = twoSided;
        const Tracer tracer(scene);
        const Solids solids(scene, tracer);
        EXPECT_EQ(solids.closedParts(), twoSided ? 1u : 0u);
        EXPECT_EQ(solids.backsSeen({{0, 0, 0}, {0, 1, 0}}, 0), Solids::kProbes) << twoSided;
        if (twoSided) {
            EXPECT_EQ(solids.backsSeen({{2.9, 0, 0}, {0, 1, 0}}, 0), 0);  // behind the curtain
        }
    }
}

TEST(Vertices, AHouseWithAnOpenFrontIsNoSolid) {
    // Ten metres by ten, four high, on a ground or alone; its front is open between two pillars and a lintel. From behind its sheets, one
    // ray in a hundred meets the sky.
    for (const bool ground : {true, false}) {
        Scene scene = sceneOf({panel({-5, 0, -5}, {0, 0, 10}, {0, 4, 0}, 1)});
        Surface& house = scene.surfaces[0];
        addPanel(house, {5, 0, 5}, {0, 0, -10}, {0, 4, 0}, 1);
        addPanel(house, {5, 0, -5}, {-10, 0, 0}, {0, 4, 0}, 1);
        addPanel(house, {-5, 4, 5}, {10, 0, 0}, {0, 0, -10}, 1);
        addPanel(house, {-5, 0, 5}, {1, 0, 0}, {0, 4, 0}, 1);
        addPanel(house, {4, 0, 5}, {1, 0, 0}, {0, 4, 0}, 1);
        addPanel(house, {-4, 3, 5}, {8, 0, 0}, {0, 1, 0}, 1);
        if (ground) {
            scene.surfaces.push_back(panel({-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, 1));
            scene.instances.push_back({1, glm::mat4(1)});
        }
        for (Surface& surface : scene.surfaces) surface.twoSided = true;
        const Tracer tracer(scene);
        const Solids solids(scene, tracer);
        EXPECT_EQ(solids.closedParts(), 0u) << ground;
        EXPECT_EQ(solids.backsSeen({{0, 1, 0}, {0, 1, 0}}, 0), 0) << ground;
    }
}

TEST(Vertices, PointInsideAClosedSolidIsCountedAndClosed) {
    Surface inner;
    addBlob(inner, {0, 0, 0}, 16, [](const glm::dvec3&) { return 0.3; });
    const Baked baked = bake(sceneOf({blob(), inner}));
    EXPECT_EQ(baked.issues.insideSolids, inner.positions.size());
    EXPECT_EQ(baked.issues.moved, 0u);
    for (const double open : baked.open(1)) EXPECT_EQ(open, 0);
    EXPECT_GT(baked.issues.large, 0u);
    EXPECT_EQ(describe(baked.issues).size(), 2u);
    EXPECT_TRUE(describe(MeshIssues{}).empty());
}

}  // namespace
}  // namespace apertura::test
