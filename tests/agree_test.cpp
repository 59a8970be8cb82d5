#include "apertura/bake/fit/agree.h"

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/scene/builtin.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// Points on a line over the floor of a builtin scene, each fitted alone.
struct Line {
    Line(const Model& model, int count, const FitTools& tools, const FitOptions& options = {})
        : scene(makeBuiltin("room-3")), tracer(scene) {
        const SurfacePoint first = sampleSurface(scene, 1, 5)[0].at;
        std::vector<std::pair<uint32_t, uint32_t>> edges;
        for (int i = 0; i < count; ++i) {
            points.push_back(first);
            points.back().position += 0.02 * i * glm::dvec3(aperturaTangentTo(first.normal));
            if (i > 0) edges.emplace_back(i, i - 1);
        }
        neighbours = Neighbours(size_t(count), edges);
        fitted.resize(points.size());
        samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 1, {}, [&](size_t i, const Samples& samples, const mat3& frame) {
            fitted[i] = {makePoint(recipeFor(model), tools, samples, frame, options), frame, samples.bits};
        });
    }
    Scene scene;
    Tracer tracer;
    std::vector<SurfacePoint> points;
    std::vector<FittedPoint> fitted;
    Neighbours neighbours;
};

// The blocked directions of a lattice, from Samples::bits.
std::vector<uint8_t> blockedOf(const SampleLattice& lattice, std::span<const uint64_t> bits) {
    std::vector<uint8_t> out(lattice.byHeight.size());
    for (size_t i = 0; i < out.size(); ++i) out[size_t(lattice.byHeight[i])] = !(bits[i / 64] >> i % 64 & 1);
    return out;
}

// What the model lets through at a point in the directions of the first point's lattice.
std::vector<float> seenBy(const Model& model, const FittedPoint& point, const FitTools& tools, const mat3& frame) {
    const ModelParams local = rotateParams(chosenModel(model, point.baked.params), point.baked.params, transpose(frame));
    return visibleTo(tools.lattice.directions(), model, {{}, local});
}

// Mean square difference from each point to the next.
double disagreement(const Model& model, const Line& line, const FitTools& tools) {
    double sum = 0;
    for (size_t i = 1; i < line.fitted.size(); ++i) {
        const auto a = seenBy(model, line.fitted[i - 1], tools, line.fitted[0].frame),
                   b = seenBy(model, line.fitted[i], tools, line.fitted[0].frame);
        for (size_t k = 0; k < a.size(); ++k) sum += double(a[k] - b[k]) * (a[k] - b[k]) / double(a.size());
    }
    return sum / double(line.fitted.size() - 1);
}

double meanError(const Model& model, const Line& line, const FitTools& tools) {
    double sum = 0;
    for (const FittedPoint& point : line.fitted) {
        const std::vector<uint8_t> blocked = blockedOf(tools.lattice, point.openBits);
        const std::vector<float> seen = seenBy(model, point, tools, point.frame);
        for (size_t k = 0; k < seen.size(); ++k) {
            const double off = tools.lattice.directions()[k].z * (seen[k] - !blocked[k]);
            sum += 3 * off * off / double(seen.size());
        }
    }
    return sum / double(line.fitted.size());
}

TEST(Agree, NeighboursTakeTheSameLobesAndErrNoMore) {
    const FitTools tools(1024, FitTools::Use::Fits);
    for (const int id :
         {APERTURA_MODEL_FIRM_2, APERTURA_MODEL_FIRM_4, APERTURA_MODEL_SOFT_2, APERTURA_MODEL_MULTI_2, APERTURA_MODEL_CAP_ANTI}) {
        const Model& model = models()[size_t(id)];
        Line line(model, 40, tools);
        // Every third point is given what another part of the room would have: lobes turned about the normal by a right angle.
        const std::vector<FittedPoint> alone = line.fitted;
        const mat3 turn = frameFromZ(line.points[0].normal, 1.5) * transpose(frameFromZ(line.points[0].normal, 0));
        for (size_t i = 1; i < line.fitted.size(); i += 3)
            line.fitted[i].baked.params = rotateParams(model, line.fitted[i].baked.params, turn);
        const double before = disagreement(model, line, tools);
        agree(model, tools, {}, line.fitted, line.neighbours, 1, {});
        const double after = disagreement(model, line, tools), error = meanError(model, line, tools);
        line.fitted = alone;
        std::printf("%-8s disagreement %.5f -> %.5f, alone %.5f; error %.5f, alone %.5f\n", std::string(model.name).c_str(), before, after,
                    disagreement(model, line, tools), error, meanError(model, line, tools));
        EXPECT_LT(after, 0.2 * before) << model.name;
        EXPECT_LT(after, 1.05 * disagreement(model, line, tools)) << model.name;
        EXPECT_LT(error, 1.1 * meanError(model, line, tools) + 1e-4) << model.name;
    }
}

// A square opening has four sides, of which two lobes are any two: which ones, only neighbours can say.
TEST(Agree, WhereLobesErrAlikeNeighboursDecide) {
    const FitTools tools(1024, FitTools::Use::Fits);
    const Model& model = models()[APERTURA_MODEL_FIRM_2];
    const float half = 0.4f;
    std::vector<uint64_t> bits(tools.lattice.wordWeight.size());
    for (size_t i = 0; i < tools.lattice.byHeight.size(); ++i) {
        const vec3 w = tools.lattice.directions()[size_t(tools.lattice.byHeight[i])];
        if (std::abs(w.x) < half && std::abs(w.y) < half) bits[i / 64] |= uint64_t(1) << i % 64;
    }
    const std::vector<uint8_t> blocked = blockedOf(tools.lattice, bits);
    const Samples samples(tools.lattice, blocked);
    // The optimum next to the two sides that meet in the corner `towards`.
    const auto across = [&](const vec2& towards) {
        LobeFit start;
        start.count = 2;
        start.lobes[0] = kHardSharpness * vec4(-towards.x, 0, 0, half);
        start.lobes[1] = kHardSharpness * vec4(0, -towards.y, 0, half);
        LobeFitOptions options = lobeFormOf(model.id)->options;
        options.steps = 60;
        return FittedPoint{{{}, lobeFormOf(model.id)->toParams(improveLobes(samples, start, options))}, mat3(1), bits};
    };
    const FittedPoint x = across({1, 1}), y = across({-1, -1});
    for (const auto& [middle, others] : {std::pair(x, y), std::pair(y, x)}) {
        std::vector<FittedPoint> points(7, others);
        points[0] = middle;
        std::vector<std::pair<uint32_t, uint32_t>> edges;
        for (uint32_t k = 1; k <= 6; ++k) edges.insert(edges.end(), {{0, k}, {k, k % 6 + 1}});
        agree(model, tools, {}, points, Neighbours(points.size(), edges), 1, {});
        const auto lets = [&](const FittedPoint& point) { return seenBy(model, point, tools, mat3(1)); };
        const auto own = lets(points[0]), before = lets(middle), theirs = lets(others);
        double kept = 0, taken = 0;
        for (size_t i = 0; i < own.size(); ++i) kept += std::abs(own[i] - before[i]), taken += std::abs(own[i] - theirs[i]);
        EXPECT_LT(taken, 0.2 * kept);
    }
}

TEST(Agree, APointWithoutNeighboursStaysAsItIs) {
    const FitTools tools(256, FitTools::Use::Fits);
    const Model& model = models()[APERTURA_MODEL_FIRM_2];
    Line line(model, 4, tools);
    const std::vector<FittedPoint> alone = line.fitted;
    agree(model, tools, {}, line.fitted, Neighbours(4, {}), 1, {});
    for (size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(line.fitted[i].baked.params, alone[i].baked.params);
    std::vector<FittedPoint> none;
    agree(model, tools, {}, none, Neighbours(0, {}), 1, {});
}

TEST(Agree, AChoiceGivesWayToItsNeighboursForATwentieth) {
    const FitTools tools(256);
    const Model& model = models()[APERTURA_MODEL_AUTO];
    FitOptions options{.tolerance = 0.05, .lambda = 4000};
    Line line(model, 24, tools, options);
    const std::vector<FittedPoint> alone = line.fitted;
    const Model& own = chosenModel(model, alone[12].baked.params);
    const std::vector<uint8_t> blocked = blockedOf(tools.lattice, alone[12].openBits);
    const Samples samples(tools.lattice, blocked);
    // All points but the one in the middle are given another model. It follows them where that costs it a twentieth more at most.
    int followed = 0, stayed = 0;
    for (const Candidate& candidate : candidates()) {
        if (candidate.model == &own) continue;
        const auto given = [&](size_t i, double share) {
            const std::vector<uint8_t> its = blockedOf(tools.lattice, alone[i].openBits);
            return withModel(tools, Samples(tools.lattice, its), alone[i].frame, options, alone[i].baked, *candidate.model, share);
        };
        line.fitted = alone;
        for (size_t i = 0; i < line.fitted.size(); ++i)
            if (i != 12) line.fitted[i].baked = given(i, 1e6);
        const Model& follows = chosenModel(model, given(12, 0.05).params);
        (&follows == candidate.model ? followed : stayed) += 1;
        agree(model, tools, options, line.fitted, line.neighbours, 1, {});
        EXPECT_EQ(&chosenModel(model, line.fitted[12].baked.params), &follows) << candidate.model->name;
    }
    EXPECT_GT(stayed, 0);
    EXPECT_GT(followed, 0);
    std::printf("of %d models, a point took %d from its neighbours\n", followed + stayed, followed);
    line.fitted = alone;
    for (const Candidate& candidate : candidates()) {
        const BakedPoint kept = withModel(tools, samples, line.fitted[12].frame, options, line.fitted[12].baked, *candidate.model, 1e6);
        EXPECT_EQ(&chosenModel(model, kept.params), candidate.model) << "at any price";
        if (candidate.model == &own) continue;
        const BakedPoint refused = withModel(tools, samples, line.fitted[12].frame, options, line.fitted[12].baked, *candidate.model, -1);
        EXPECT_EQ(refused.params, line.fitted[12].baked.params) << "at none";
    }
}

}  // namespace
}  // namespace apertura::test
