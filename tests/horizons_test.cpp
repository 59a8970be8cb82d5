// Horizons of height fields: closed forms, brute force by rays on the same triangles, and what has to be the same.
#include "apertura/bake/sampling/horizons.h"

#include <cmath>

#include "apertura/bake/fit/terrain.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/horizon_exact.h"
#include "apertura/bake/sampling/horizon_occlusion.h"
#include "apertura/bake/sampling/horizon_sweep.h"
#include "apertura/bake/sampling/sweep_fields.h"
#include "apertura/bake/scene/height_map.h"
#include "apertura/bake/scene/height_mesh.h"
#include "tests/mountains.h"
#include "tests/support.h"

namespace apertura {
namespace plain {
void sweepLines(SweepField& field, const SweepDirection& direction, int first, int end, const SweepHorizons& keep);
void exactTangents(const ExactCourse& course, int y0, int y1, int x, float* to, size_t stride);
}  // namespace plain

namespace test {
namespace {

constexpr double kDegree = pi / 180;
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

std::vector<std::vector<float>> horizonsOf(const HeightField& field, const std::vector<double>& degrees, HorizonOptions options = {}) {
    std::vector<double> azimuths;
    for (const double d : degrees) azimuths.push_back(d * kDegree);
    std::vector<std::vector<float>> out(degrees.size());
    findHorizons(field, azimuths, options,
                 [&](size_t k, int, std::span<const float> tangents) { out[k].insert(out[k].end(), tangents.begin(), tangents.end()); });
    return out;
}
HorizonOptions exactly() {
    HorizonOptions out;
    out.isExact = true;
    return out;
}
double degreesOf(float tangent) { return std::atan(double(tangent)) / kDegree; }

TEST(Horizons, OfAConeAPyramidAWallAndABallAreTheClosedForms) {
    constexpr int n = 201, middle = 100, foot = 40;
    const auto at = [](int x, int y) { return size_t(y) * n + size_t(x); };
    const HeightField cone = fieldOf(n, n, 1, 1, [](int x, int y) { return std::max(0.0, foot - std::hypot(x - middle, y - middle)); });
    const HeightField pyramid = fieldOf(
        n, n, 1, 1, [](int x, int y) { return std::max(0, foot - std::max(std::abs(x - middle), std::abs(y - middle))); });
    const HeightField wall = fieldOf(n, n, 1, 1, [](int, int y) { return y < 50 ? 30 : 0; });
    for (const HorizonOptions& options : {HorizonOptions{}, exactly()}) {
        // A cone of 45 degrees from its foot, in the four directions in which that is a texel.
        const std::vector<double> towards{0, 90, 180, 270, 45};
        const auto ofCone = horizonsOf(cone, towards, options);
        EXPECT_NEAR(degreesOf(ofCone[0][at(middle, middle + foot)]), 45, 1e-4);
        EXPECT_NEAR(degreesOf(ofCone[1][at(middle - foot, middle)]), 45, 1e-4);
        EXPECT_NEAR(degreesOf(ofCone[2][at(middle, middle - foot)]), 45, 1e-4);
        EXPECT_NEAR(degreesOf(ofCone[3][at(middle + foot, middle)]), 45, 1e-4);
        // And of its top from farther away.
        EXPECT_NEAR(degreesOf(ofCone[1][at(10, middle)]), std::atan(foot / 90.0) / kDegree, 1e-4);
        EXPECT_NEAR(degreesOf(ofCone[4][at(middle - 60, middle + 60)]), std::atan(foot / (60 * std::sqrt(2))) / kDegree, 1e-3);
        // A pyramid whose faces rise at 45 degrees, along the edge from a corner.
        const std::vector<double> diagonals{45, 135, 225, 315};
        const auto ofPyramid = horizonsOf(pyramid, diagonals, options);
        EXPECT_NEAR(degreesOf(ofPyramid[0][at(middle - foot, middle + foot)]), 35.26439, 1e-4);
        EXPECT_NEAR(degreesOf(ofPyramid[1][at(middle - foot, middle - foot)]), 35.26439, 1e-4);
        EXPECT_NEAR(degreesOf(ofPyramid[2][at(middle + foot, middle - foot)]), 35.26439, 1e-4);
        EXPECT_NEAR(degreesOf(ofPyramid[3][at(middle + foot, middle + foot)]), 35.26439, 1e-4);
        // A wall in the north at any angle to it: its top edge lies along y = 49.
        const std::vector<double> askew{0, 17, 40, 63, 320};
        const auto ofWall = horizonsOf(wall, askew, options);
        for (size_t k = 0; k < askew.size(); ++k)
            EXPECT_NEAR(degreesOf(ofWall[k][at(middle, 80)]), std::atan(30 * std::cos(askew[k] * kDegree) / 31) / kDegree,
                        options.isExact ? 1e-3 : 0.05)
                << askew[k];
        // Up there nothing is higher: the edge of the map, to the north, and none at all on that edge.
        EXPECT_NEAR(ofWall[0][at(middle, 20)], 0, 1e-6);
        EXPECT_EQ(ofWall[0][at(middle, 0)], -std::numeric_limits<float>::infinity());
    }
    // The tangent to a half ball of radius r from the distance d rises by asin(r / d); its facets lie a little inside it.
    const double r = 60;
    const HeightField ball = fieldOf(n, n, 1, 1, [&](int x, int y) {
        return std::sqrt(std::max(0.0, r * r - (x - middle) * (x - middle) - (y - middle) * (y - middle)));
    });
    const auto ofBall = horizonsOf(ball, {0, 90, 315}, exactly());
    EXPECT_NEAR(degreesOf(ofBall[0][at(middle, 190)]), std::asin(r / 90) / kDegree, 0.02);
    EXPECT_NEAR(degreesOf(ofBall[1][at(20, middle)]), std::asin(r / 80) / kDegree, 0.02);
    EXPECT_NEAR(degreesOf(ofBall[2][at(middle + 60, middle + 60)]), std::asin(r / (60 * std::sqrt(2))) / kDegree, 0.02);
}

// The steepest way from which a ray meets nothing, by bisection: radians.
double horizonByRays(const Tracer& tracer, const glm::dvec3& from, double azimuth) {
    double low = -pi / 2, high = pi / 2;
    for (int i = 0; i < 26; ++i) {
        const double h = (low + high) / 2;
        const glm::vec3 direction(std::cos(h) * std::sin(azimuth), std::sin(h), -std::cos(h) * std::cos(azimuth));
        (tracer.occluded(from, direction, kNoLimit) ? low : high) = h;
    }
    return high;
}

TEST(Horizons, AreThoseOfRaysOnTheStatedTriangles) {
    const HeightField field = mountains(61, 47, 30, 42);  // cells that are not square
    const Scene scene = terrainScene("mountains", {fullMesh(field)});
    const Tracer tracer(scene);
    const std::vector<double> degrees{0, 11.25, 33.75, 45, 90, 112.5, 200, 271};
    const auto exact = horizonsOf(field, degrees, exactly()), swept = horizonsOf(field, degrees);
    double squares = 0, most = 0, squaresSwept = 0;
    size_t count = 0;
    // Texels on the border look along it, where a ray slips through between rounding errors.
    for (int y = 1; y + 1 < field.height; ++y)
        for (int x = 1; x + 1 < field.width; ++x) {
            const size_t texel = size_t(y) * 61 + size_t(x);
            const glm::dvec3 from = placeOf(field, x, y, field.heights[texel]) + glm::dvec3(0, tracer.offset(), 0);
            for (size_t k = 0; k < degrees.size(); ++k) {
                const double truth = horizonByRays(tracer, from, degrees[k] * kDegree) / kDegree;
                if (truth < -80) continue;  // nothing but the ground below
                const double error = std::abs(degreesOf(exact[k][texel]) - truth);
                squares += error * error, most = std::max(most, error), ++count;
                squaresSwept += std::pow(degreesOf(swept[k][texel]) - truth, 2);
            }
        }
    EXPECT_GT(count, 15000u);
    EXPECT_LT(std::sqrt(squares / double(count)), 0.01);
    EXPECT_LT(most, 0.1);
    EXPECT_LT(std::sqrt(squaresSwept / double(count)), 1.0);
}

TEST(Horizons, OfTheSweepAreExactAlongTheGrid) {
    const HeightField field = mountains(70, 50, 20, 30);
    const std::vector<double> degrees{0, 90, 180, 270};
    const auto exact = horizonsOf(field, degrees, exactly()), swept = horizonsOf(field, degrees);
    for (size_t k = 0; k < degrees.size(); ++k)
        for (size_t i = 0; i < field.texels(); ++i) {
            if (std::isinf(exact[k][i]))
                EXPECT_EQ(swept[k][i], exact[k][i]) << degrees[k] << " at " << i;
            else
                EXPECT_NEAR(swept[k][i], exact[k][i], 1e-5) << degrees[k] << " at " << i;
        }
}

TEST(Horizons, OfARoundEarthSinkByTheSquareOfTheDistance) {
    constexpr int n = 401;
    const double curvature = (1 - 0.13) / (2 * 6371000), spacing = 250, tower = 900;
    // A plain with a tower in the south-east, 40 km and more away.
    HeightField field = fieldOf(n, n, spacing, spacing, [](int, int) { return 0; });
    field.heights[size_t(300) * n + 300] = float(tower);
    for (bool isExact : {false, true}) {
        HorizonOptions options;
        options.curvature = curvature, options.isExact = isExact;
        const auto horizons = horizonsOf(field, {135, 90}, options);
        for (const int away : {80, 160, 280}) {
            const double distance = away * std::sqrt(2) * spacing, expected = (tower - curvature * distance * distance) / distance;
            EXPECT_NEAR(horizons[0][size_t(300 - away) * n + size_t(300 - away)], expected, 1e-6) << isExact << " " << away;
        }
        // Without the tower the plain's own horizon is the nearest texel's, a little below 0.
        EXPECT_NEAR(horizons[1][size_t(50) * n + 50], -curvature * spacing, 1e-7) << isExact;
    }
}

TEST(Horizons, ComeFromNoFartherThanIsWanted) {
    const HeightField wall = fieldOf(120, 40, 2, 2, [](int x, int) { return x == 100 ? 50 : 0; });
    HorizonOptions options = exactly();
    options.farthest = 60;
    const auto horizons = horizonsOf(wall, {90}, options);
    EXPECT_NEAR(horizons[0][size_t(20) * 120 + 80], 50 / 40.0, 1e-6);
    EXPECT_NEAR(horizons[0][size_t(20) * 120 + 60], 0, 1e-6);
}

TEST(OpenSky, OfASlopeIsItsWholeHemisphere) {
    const HeightField slope = fieldOf(80, 60, 10, 15, [](int x, int y) { return 4.0 * x - 7.0 * y; });
    const OpenSky sky = openSky(slope, 0.001, {});
    const glm::vec3 normal = glm::normalize(glm::vec3(-4 / 10.0f, 1, 7 / 15.0f));
    for (size_t i = 0; i < slope.texels(); ++i) {
        EXPECT_NEAR(sky.area[i], 2 * pi, 1e-4);
        EXPECT_LT(glm::distance(sky.direction[i], float(pi) * normal), 0.01) << i;
    }
    EXPECT_LT(sky.areaError, 1e-4);
}

TEST(OpenSky, InTheMiddleOfACraterIsACap) {
    // A rim 20 degrees above the middle on all sides, and lower ground beyond.
    const double rim = 60, elevation = 20 * kDegree;
    const HeightField crater = fieldOf(161, 161, 1, 1, [&](int x, int y) {
        const double r = std::hypot(x - 80, y - 80);
        return r < 40 ? 0 : r < rim ? r * std::tan(elevation) : 0.5 * rim * std::tan(elevation);
    });
    const OpenSky sky = openSky(crater, 0.001, {});
    const size_t middle = size_t(80) * 161 + 80;
    // The rim is a polygon of texels, lower between them.
    EXPECT_NEAR(sky.area[middle] / (2 * pi), 1 - std::sin(elevation), 0.006);
    EXPECT_NEAR(sky.direction[middle].y, pi * std::cos(elevation) * std::cos(elevation), 0.03);
    EXPECT_NEAR(sky.direction[middle].x, 0, 0.01);
    EXPECT_NEAR(sky.direction[middle].z, 0, 0.01);
}

TEST(OpenSky, IsWhatManyRaysSee) {
    HeightField field = mountains(150, 130, 30, 36);
    field.heights[70 * 150 + 70] = kHole;
    const OpenSky sky = openSky(field, 0.005, {});
    const Scene scene = terrainScene("mountains", {fullMesh(field)});
    const Surface& surface = scene.surfaces[0];
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    std::vector<size_t> texels;
    for (uint64_t i = 0; i < 600; ++i) {
        const size_t v = size_t(hashUnit(7, i, 0) * double(surface.positions.size()));
        points.push_back({glm::dvec3(surface.positions[v]), surface.normals[v], 60});
        const glm::vec2 at = surface.coordinates[v] * glm::vec2(surface.grid);
        texels.push_back(size_t(at.y) * 150 + size_t(at.x));
    }
    const SampleLattice lattice(4096);
    std::vector<double> areas(points.size()), angles(points.size());
    samplePoints(RayOcclusion(tracer), points, lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        double area = 0;
        glm::vec3 direction(0);
        for (size_t k = 0; k < lattice.directions().size(); ++k)
            if (samples.isOpen(k))
                area += lattice.solidAngle(), direction += float(lattice.solidAngle()) * (frame * lattice.directions()[k]);
        areas[i] = (sky.area[texels[i]] - area) / (2 * pi);
        angles[i] = std::acos(std::min(1.0f, glm::dot(glm::normalize(direction), glm::normalize(sky.direction[texels[i]])))) / kDegree;
    });
    double area = 0, angle = 0;
    for (size_t i = 0; i < points.size(); ++i) area += areas[i] * areas[i], angle += angles[i] * angles[i];
    area = std::sqrt(area / double(points.size())), angle = std::sqrt(angle / double(points.size()));
    EXPECT_LT(area, 0.01);
    EXPECT_LT(angle, 1);
    // And what it says of itself, from horizons alone, is that.
    EXPECT_LT(sky.areaError, 0.005);
    EXPECT_NEAR(sky.areaError, area, 0.0015);
    EXPECT_NEAR(sky.directionError, angle, 0.2);
}

TEST(OpenSky, IsTheSameWhicheverWayTheMapLies) {
    const HeightField field = mountains(90, 60, 30, 20);
    HeightField turned = fieldOf(60, 90, 20, 30, [&](int x, int y) { return field.heights[size_t(x) * 90 + size_t(y)]; });
    const OpenSky one = openSky(field, 0, {}), other = openSky(turned, 0, {});
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 90; ++x) {
            const size_t a = size_t(y) * 90 + size_t(x), b = size_t(x) * 60 + size_t(y);
            // East becomes south, so that azimuths run the other way round: only rounding differs.
            EXPECT_NEAR(one.area[a], other.area[b], 2e-4);
            EXPECT_NEAR(one.direction[a].x, other.direction[b].z, 2e-4);
            EXPECT_NEAR(one.direction[a].y, other.direction[b].y, 2e-4);
        }
}

TEST(OpenSky, IsTheSameForAnyNumberOfThreads) {
    const HeightField field = mountains(140, 90, 30, 20);
    HorizonOptions one, many;
    one.threads = 1, many.threads = 5;
    const OpenSky a = openSky(field, 0.01, one), b = openSky(field, 0.01, many);
    EXPECT_EQ(a.area, b.area);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(horizonsOf(field, {33, 213, 90}, one), horizonsOf(field, {33, 213, 90}, many));
}

TEST(Horizons, AreTheSameOnAllProcessors) {
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has one of the two texts of sweepLines";
    HeightField field = mountains(90, 70, 30, 25);
    for (size_t i = 0; i < field.texels(); ++i)
        if (hashUnit(9, i, 0) < 0.05) field.heights[i] = kHole;
    for (const double degrees : {20.0, 45.0, 77.0, 90.0, 130.0, 200.0}) {
        SweepFields fields[2]{{field, true}, {field, true}};
        const SweepCourse course = courseOf(field, degrees * kDegree, 1e-7);
        std::vector<float> tangents[2][2], exacts[2];
        for (size_t k = 0; k < 2; ++k) {
            SweepField& across = course.columns ? fields[k].columns : fields[k].rows;
            SweepDirection direction = course.direction;
            for (int way = 0; way < 2; ++way)
                direction.crossings[way] = crossingsOf(across.stride, course.perStep(way), course.step, 1e-7, kNear);
            const auto sweepBy = k == 0 ? sweepLines : plain::sweepLines;
            sweepBy(across, direction, 0, sweepGroups(across, direction), {});
            for (std::vector<float>& t : tangents[k]) t.assign(across.size(), 0);
            sweepBy(across, direction, 0, sweepGroups(across, direction), {{tangents[k][0].data(), tangents[k][1].data()}});
            const SweepField& rows = fields[k].rows;
            const HighestHeights highest(rows);
            const glm::dvec2 perMetre(std::sin(degrees * kDegree) / field.spacingX, -std::cos(degrees * kDegree) / field.spacingZ);
            const ExactCourse exact(rows, highest, perMetre, 1e-7, 0);
            exacts[k].assign(rows.size(), 0);
            (k == 0 ? exactTangents : plain::exactTangents)(exact, 0, rows.along, 8, exacts[k].data(), rows.stride);
        }
        const SweepField &one = course.columns ? fields[0].columns : fields[0].rows,
                         &other = course.columns ? fields[1].columns : fields[1].rows;
        EXPECT_EQ(one.area, other.area) << degrees;
        EXPECT_EQ(one.vertical, other.vertical) << degrees;
        EXPECT_EQ(one.horizontal[0], other.horizontal[0]) << degrees;
        EXPECT_EQ(exacts[0], exacts[1]) << degrees;
        EXPECT_EQ(tangents[0][0], tangents[1][0]) << degrees;
        EXPECT_EQ(tangents[0][1], tangents[1][1]) << degrees;
        EXPECT_GT(one.area[one.at(30, 30)], 0);
    }
}

// RMS of the sweep's angles less the exact ones, degrees, at texels that `counts`; where one of them alone sees nothing is counted apart.
template <typename F>
double apart(const HeightField& field, const std::vector<double>& degrees, size_t& differ, const F& counts) {
    const auto swept = horizonsOf(field, degrees), exact = horizonsOf(field, degrees, exactly());
    double squares = 0, count = 0;
    differ = 0;
    for (size_t k = 0; k < degrees.size(); ++k)
        for (size_t i = 0; i < field.texels(); ++i) {
            if (std::isnan(field.heights[i]) || !counts(int(i % size_t(field.width)), int(i / size_t(field.width)))) continue;
            if (std::isinf(swept[k][i]) != std::isinf(exact[k][i])) ++differ;
            if (std::isinf(swept[k][i]) || std::isinf(exact[k][i])) continue;
            squares += std::pow(degreesOf(swept[k][i]) - degreesOf(exact[k][i]), 2), ++count;
        }
    return std::sqrt(squares / std::max(count, 1.0));
}

TEST(Horizons, OfTheSweepAreGoodBesideBordersAndHoles) {
    std::vector<double> degrees{85, 265, 5, 175};
    for (int k = 0; k < 16; ++k) degrees.push_back(22.5 * k);
    const HeightField field = mountains(120, 90, 30, 30);
    size_t differ = 0;
    EXPECT_LT(apart(field, degrees, differ, [](int x, int y) { return x > 4 && y > 4 && x < 115 && y < 85; }), 0.5);
    for (int edge = 0; edge < 3; ++edge) {
        const auto counts = [&](int x, int y) { return x == edge || y == edge || x == 119 - edge || y == 89 - edge; };
        EXPECT_LT(apart(field, degrees, differ, counts), 1.5) << edge;
        EXPECT_EQ(differ, 0u) << edge;
    }
    HeightField holes = field;
    for (size_t i = 0; i < holes.texels(); ++i)
        if (hashUnit(5, i, 0) < 0.1) holes.heights[i] = kHole;
    const auto everywhere = [](int, int) { return true; };
    EXPECT_LT(apart(holes, degrees, differ, everywhere), 1.2);
    EXPECT_LT(double(differ) / double(holes.texels() * degrees.size()), 0.001);
    // Along the grid it is exact, whatever has no data.
    for (size_t i = 0; i < holes.texels(); ++i) holes.heights[i] = (i % 120 + i / 120) % 2 ? kHole : field.heights[i];
    EXPECT_LT(apart(holes, {0, 90, 180, 270}, differ, everywhere), 1e-3);
    EXPECT_EQ(differ, 0u);
    // High ground beside a hole hides nothing but what it hides.
    HeightField wall = fieldOf(30, 30, 1, 1, [](int, int) { return 0; });
    wall.heights[10 * 30 + 10] = kHole, wall.heights[10 * 30 + 11] = 60, wall.heights[9 * 30 + 10] = 30;
    EXPECT_LT(apart(wall, {0, 90, 180, 270}, differ, everywhere), 1e-3);
    // Narrow maps, and an odd number of azimuths.
    for (const auto& [width, height] : {std::pair(2, 200), {200, 2}, {3, 3}}) {
        EXPECT_LT(apart(mountains(width, height, 30, 30), {0, 72, 144, 216, 288}, differ, everywhere), 4) << width;
        EXPECT_EQ(differ, 0u) << width;
    }
}

TEST(Horizons, AreTheSameInBandsOfAnyHeight) {
    const HeightField field = mountains(70, 83, 30, 20);
    const std::vector<double> degrees{0, 33, 90, 141, 262.5};
    HorizonOptions options = exactly();
    const auto whole = horizonsOf(field, degrees, options);
    for (const int band : {1, 7, 40, 100}) {
        options.band = band;
        EXPECT_EQ(horizonsOf(field, degrees, options), whole) << band;
    }
}

TEST(Horizons, NothingIsHiddenByTexelsWithoutData) {
    // A wall of holes, and one behind it that is seen over them.
    const HeightField field = fieldOf(100, 60, 1, 1, [](int x, int) { return x >= 50 && x < 53 ? double(kHole) : x == 80 ? 20 : 0; });
    for (const HorizonOptions& options : {HorizonOptions{}, exactly()}) {
        const auto horizons = horizonsOf(field, {90, 60, 270}, options);
        EXPECT_NEAR(horizons[0][size_t(30) * 100 + 40], 20 / 40.0, 1e-6);
        EXPECT_NEAR(horizons[1][size_t(30) * 100 + 60], 20 * std::sin(60 * kDegree) / 20, 1e-3);
        EXPECT_NEAR(horizons[2][size_t(30) * 100 + 53], 0, 1e-6);
        EXPECT_EQ(horizons[0][size_t(30) * 100 + 51], -std::numeric_limits<float>::infinity());
    }
    const OpenSky sky = openSky(field, 0.01, {});
    EXPECT_NEAR(sky.area[size_t(30) * 100 + 49], sky.area[size_t(30) * 100 + 47], 0.05);
}

TEST(HorizonOcclusion, BlocksWhatRaysFindBlocked) {
    const HeightField field = mountains(64, 64, 30, 30);
    const Scene scene = terrainScene("mountains", {fullMesh(field)});
    const Tracer tracer(scene);
    const HorizonOcclusion horizons(field, 64, {});
    const RayOcclusion rays(tracer);
    const std::vector<glm::vec3> lattice = fibonacciHemisphere(512);
    size_t apart = 0, blocked = 0, all = 0;
    for (size_t v = 100; v < scene.surfaces[0].positions.size(); v += 137) {
        const SurfacePoint point{glm::dvec3(scene.surfaces[0].positions[v]), scene.surfaces[0].normals[v], 60};
        const glm::mat3 frame = frameFromZ(point.normal, double(v));
        std::vector<glm::vec3> directions;
        for (const glm::vec3& w : lattice) directions.push_back(frame * w);
        std::vector<uint8_t> one(directions.size()), other(directions.size());
        horizons.occluded(point, directions, one.data());
        rays.occluded(point, directions, other.data());
        for (size_t i = 0; i < one.size(); ++i) apart += one[i] != other[i], blocked += other[i], ++all;
    }
    EXPECT_GT(double(blocked) / double(all), 0.05);
    EXPECT_LT(double(apart) / double(all), 0.01);
}

TEST(BakeTerrain, FitsModelsToHorizonsAsToRays) {
    const HeightField field = mountains(40, 40, 30, 30, 12);
    const Scene scene = terrainScene("mountains", {fullMesh(field)});
    BakeOptions options;
    options.recipe = "firm-2", options.at = At::Vertices, options.rays = 256;
    const BakedVisibility swept = bakeTerrain(scene, field, options, {});
    const Tracer tracer(scene);
    const BakedVisibility traced = bakeVertices(scene, tracer, options);
    ASSERT_EQ(swept[0].allParams.size(), scene.surfaces[0].positions.size());
    double squares = 0;
    for (size_t v = 0; v < swept[0].visibility.size(); ++v)
        squares += std::pow((swept[0].visibility[v].area - traced[0].visibility[v].area) / (2 * pi), 2);
    EXPECT_LT(std::sqrt(squares / double(swept[0].visibility.size())), 0.02);
}

}  // namespace
}  // namespace test
}  // namespace apertura
