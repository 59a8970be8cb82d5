// The parameters of every model: packing, rotation, and their light for regions with closed forms.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/fit/choose.h"
#include "apertura/bake/fit/lobe_sums.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/params_stream.h"
#include "tests/support.h"

#include <map>

namespace apertura::test {
namespace {

const vec3 kUp(0, 0, 1);

// Samples of the open region where `inside` is true. The normal is +Z.
template <typename Inside>
Samples samplesOf(const SampleLattice& lattice, Inside&& inside) {
    std::vector<uint8_t> blocked;
    for (const vec3& w : lattice.directions()) blocked.push_back(!inside(dvec3(w)));
    return Samples(lattice, blocked);
}

// RMSE of a recipe's model from the exact E / (L pi sin^2 r), over lights of one radius in radians.
template <typename Exact>
double errorOf(const char* recipeName, const char* modelName, const FitTools& tools, const Samples& samples, double radius, Exact&& exact) {
    const Recipe& recipe = *findRecipe(recipeName);
    const Model& model = *findModel(modelName);
    const BakedPoint point = recipe.make(tools, samples, mat3(1), {});
    const AperturaReceiver receiver = toReceiver(point.visibility,
                                                 toParams(model, point.visibility, recipe.model >= 0 ? &point.params : nullptr, kUp), kUp);
    double sum = 0;
    int count = 0;
    for (const vec3& l : fibonacciHemisphere(200)) {
        const AperturaCapLight light = aperturaCapLight(dvec3(l), radius);
        const double e = aperturaIrradianceThrough(model.id, receiver, light, lightClassOf(light.sinRadius)) / light.area - exact(dvec3(l));
        sum += e * e;
        ++count;
    }
    return std::sqrt(sum / count);
}

TEST(Models, EachIsFoundByItsNameAndIsMadeOrStored) {
    for (const Model& model : models()) {
        EXPECT_EQ(findModel(model.name), &model);
        EXPECT_TRUE(model.fromVisibility || model.isStored()) << model.name;
    }
    EXPECT_EQ(findModel("nothing"), nullptr);
    for (const Recipe& recipe : recipes()) EXPECT_EQ(findRecipe(recipe.name), &recipe);
}

TEST(Models, EachHasAFormulaForEveryClassOfLightsAndARecipe) {
    for (const Model& model : models()) {
        if (model.kind == ModelKind::Choice) continue;
        for (int lightClass : {APERTURA_LIGHTS_ANY, APERTURA_LIGHTS_MEDIUM, APERTURA_LIGHTS_SMALL, APERTURA_LIGHTS_SUN})
            EXPECT_TRUE(hasFormula(model, lightClass)) << model.name;
        EXPECT_NO_THROW(recipeFor(model)) << model.name;
    }
    const AperturaCapLight light = aperturaCapLight(kUp, 0.1f);
    const AperturaReceiver receiver{kUp, vec4(0, 0, 1, 2), {}};
    EXPECT_EQ(aperturaIrradianceThrough(APERTURA_MODEL_COUNT, receiver, light, APERTURA_LIGHTS_ANY), APERTURA_NO_FORMULA);
    EXPECT_EQ(aperturaIrradianceThrough(-1, receiver, light, APERTURA_LIGHTS_ANY), APERTURA_NO_FORMULA);
    AperturaReceiver undecided = receiver;  // `auto` may not choose horizon
    undecided.params[APERTURA_CHOICE_SLOT] = aperturaWithChoice(vec4(0), {APERTURA_MODEL_HORIZON_16, false});
    EXPECT_EQ(aperturaIrradianceThrough(APERTURA_MODEL_AUTO, undecided, light, APERTURA_LIGHTS_SUN), APERTURA_NO_FORMULA);
}

TEST(Models, AutoSpendsTheLeastOfWhatItIsAskedToSave) {
    const Scene scene = makeBuiltin("statue");
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, 120, 4)) points.push_back(p.at);
    const FitTools tools(256);
    const RayOcclusion source(tracer);
    const Price prices[] = {Price::Numbers, Price::Bytes, Price::Cycles};
    double spent[3][3]{};  // what was saved, and what it cost in each currency
    for (int saved = 0; saved < 3; ++saved) {
        BakeOptions options;
        options.recipe = "auto";
        options.price = prices[saved];
        const AutoPlan plan = planAuto(source, points, tools, options, options.tolerance, {});
        ASSERT_NE(plan.alone, nullptr);
        EXPECT_GT(priceOf(*plan.alone, options.price), 0);
        options.lambda = plan.lambda;
        for (const BakedPoint& p : bakePoints(source, points, options))
            for (int k = 0; k < 3; ++k) spent[saved][k] += priceOf(chosenModel(models()[APERTURA_MODEL_AUTO], p.params), prices[k]);
    }
    for (int saved = 0; saved < 3; ++saved)
        for (int other = 0; other < 3; ++other) EXPECT_LE(spent[saved][saved], 1.05 * spent[other][saved]) << saved << " against " << other;
    // Alone: by hand from made-up errors. Of those within 0.05 APERTURA_MODEL_FIRM_2 has the fewest bytes, and APERTURA_MODEL_SOFT_L2 the
    // fewest cycles.
    std::vector<CandidateErrors> errors(2, CandidateErrors(candidates().size(), 0.2));
    for (size_t i = 0; i < candidates().size(); ++i)
        if (candidates()[i].model->id == APERTURA_MODEL_FIRM_2 || candidates()[i].model->id == APERTURA_MODEL_SOFT_L2)
            errors[0][i] = 0.06, errors[1][i] = 0.01;
    EXPECT_EQ(leastAlone(errors, 0.05, Price::Bytes)->id, APERTURA_MODEL_FIRM_2);
    EXPECT_EQ(leastAlone(errors, 0.05, Price::Cycles)->id, APERTURA_MODEL_SOFT_L2);
    EXPECT_EQ(leastAlone(errors, 0.04, Price::Bytes), nullptr);
}

TEST(Models, AutoChoosesByTagsThatAssetsHoldForEver) {
    const char* names[] = {"ao-area", "aperture", "soft", "firm-2", "soft-2", "firm-3", "soft-l2", "firm-4"};
    for (size_t tag = 0; tag < std::size(names); ++tag) EXPECT_EQ(autoModels()[tag]->name, names[tag]);
    int numbers = 0;
    for (const Candidate& candidate : candidates()) {
        EXPECT_GE(candidate.model->numbers, numbers) << candidate.model->name;
        numbers = candidate.model->numbers;
        EXPECT_TRUE(candidate.recipe->model == candidate.model->id || candidate.recipe->model < 0);
    }
    EXPECT_EQ(candidates().size(), autoModels().size() + 1);  // `soft` is there twice: converted and fitted
}

TEST(Models, ASlotGivesBackWhatWasPutIn) {
    Random random(57);
    for (int i = 0; i < 1000; ++i) {
        auto aperture = [&] { return aperturaMakeAperture(vec3(random.direction()), float(random(0, 2))); };
        auto expectSame = [](const AperturaAperture& a, const AperturaAperture& b) {
            EXPECT_EQ(a.axis, b.axis);
            EXPECT_EQ(a.height, b.height);
            EXPECT_EQ(vec2(a.terms), vec2(b.terms));
        };
        const AperturaAperture a = aperture(), b = aperture(), c = aperture();
        expectSame(aperturaOnlyApertureIn(aperturaWithAperture({}, a, 0.25f)), a);
        EXPECT_EQ(aperturaOpacityIn(aperturaWithAperture({}, a, 0.25f)), 0.25f);
        const AperturaTwoCaps two = aperturaTwoCapsIn(aperturaWithTwoCaps({}, {a, b, 0.75f, -0.5f}));
        expectSame(two.first, a), expectSame(two.second, b);
        EXPECT_EQ(vec2(two.weight, two.axesDot), vec2(0.75f, -0.5f));
        EXPECT_EQ(two.first.terms, a.terms);
        EXPECT_EQ(two.second.terms, b.terms);
        const AperturaReceiver all = aperturaWithApertureOfUnion(
            aperturaWithApertureOfUnion(aperturaWithApertureOfUnion({}, 3, 0, a), 3, 1, b), 3, 2, c);
        expectSame(aperturaApertureOfUnion(all, 3, 0), a), expectSame(aperturaApertureOfUnion(all, 3, 1), b),
            expectSame(aperturaApertureOfUnion(all, 3, 2), c);
        // The combination of four lobes and the choice of `auto` are in the same slot.
        const vec4 slot = aperturaWithChoice(aperturaWithCombination(vec4(0), {1, 2}), {APERTURA_MODEL_FIRM_4, true});
        EXPECT_EQ(aperturaCombinationIn(slot).complement, 1);
        EXPECT_EQ(aperturaCombinationIn(slot).pairs, 2);
        EXPECT_EQ(aperturaChoiceIn(slot).model, APERTURA_MODEL_FIRM_4);
        EXPECT_TRUE(aperturaChoiceIn(slot).outOfReach);
        EXPECT_EQ(aperturaCombinationIn(aperturaWithCombination(slot, {0, 1})).pairs, 1);
        EXPECT_EQ(aperturaChoiceIn(aperturaWithCombination(slot, {0, 1})).model, APERTURA_MODEL_FIRM_4);
    }
}

TEST(Models, AnyNumbersUnpackToAFiniteFormAndPackAgain) {
    Random random(51);
    for (const Model& model : models()) {
        std::vector<float> numbers(size_t(storedNumbers(model))), again(numbers.size());
        for (int i = 0; i < 2000 && !numbers.empty(); ++i) {
            for (float& n : numbers) n = i % 5 ? float(random(-1, 1)) : float(std::lround(random(-1.4, 1.4)));
            const ModelParams params = unpackParams(model, numbers);
            for (const vec4& slot : params)
                for (int c = 0; c < 4; ++c) ASSERT_TRUE(std::isfinite(slot[c])) << model.name;
            packParams(model, params, again);
            const ModelParams back = unpackParams(model, again);
            // An axis can have several encodings: the light is compared.
            const Visibility v{vec3(0, 0, 1), 3};
            for (int k = 0; k < 4; ++k) {
                const AperturaCapLight light = aperturaCapLight(random.direction(), 0.1);
                const float a = aperturaIrradianceThrough(model.id, toReceiver(v, toParams(model, v, &params, kUp), kUp), light,
                                                          APERTURA_LIGHTS_ANY);
                const float b = aperturaIrradianceThrough(model.id, toReceiver(v, toParams(model, v, &back, kUp), kUp), light,
                                                          APERTURA_LIGHTS_ANY);
                ASSERT_TRUE(std::isfinite(a));
                ASSERT_NEAR(a / light.area, b / light.area, 0.02) << model.name;
            }
        }
    }
}

TEST(Models, TheSharpnessOfHardLobesIsASignInTheirBytes) {
    Random random(53);
    for (const int id : {APERTURA_MODEL_FIRM_2, APERTURA_MODEL_FIRM_3, APERTURA_MODEL_FIRM_4}) {
        const Model& model = models()[size_t(id)];
        for (int i = 0; i < 64; ++i) {
            const float sharpness = i & 1 ? kSofterSharpness : kHardSharpness, complement = i & 2 ? 1 : 0,
                        pairs = model.parts > 2 ? float(i / 4 % (model.parts - 1)) : 0;
            ModelParams params{};
            std::vector<float> edges;
            for (size_t k = 0; k < size_t(model.parts); ++k) {
                edges.push_back(float(random(-0.9, 0.9)));
                params[k] = sharpness * vec4(vec3(random.direction()), edges[k]);
            }
            params[size_t(model.flagSlot())] = aperturaWithCombination(vec4(0), {complement, pairs});
            const auto bytes = packAllParams(model, {&params, 1}, mat3(1), 8);
            const ModelParams back = unpackAllParams(model, {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, 1,
                                                     mat3(1), 8)[0];
            for (size_t k = 0; k < size_t(model.parts); ++k) {
                EXPECT_NEAR(length(vec3(back[k])), sharpness, 1e-3) << model.name;
                EXPECT_NEAR(back[k].w / sharpness, edges[k], 0.03) << model.name;
            }
            EXPECT_EQ(aperturaCombinationIn(back[size_t(model.flagSlot())]).complement, complement);
            EXPECT_EQ(aperturaCombinationIn(back[size_t(model.flagSlot())]).pairs, pairs);
        }
    }
}

TEST(Models, FormsTurnWithTheirFrame) {
    Random random(52);
    for (const Model& model : models()) {
        if (storedNumbers(model) == 0 || model.ownBytes > 0) continue;  // what rivals store is made in the world, or about the normal there
        for (int i = 0; i < 50; ++i) {
            std::vector<float> numbers(size_t(storedNumbers(model)));
            for (float& n : numbers) n = float(random(-0.3, 0.3));
            const vec3 axis(random.direction());
            const mat3 turn = frameFromZ(axis, random(0, 6));
            const ModelParams params = unpackParams(model, numbers), turned = rotateParams(model, params, turn);
            const Visibility v{vec3(0.3f, 0.2f, 1), 3}, w{turn * v.direction, v.area};
            const AperturaCapLight light = aperturaCapLight(random.direction(), 0.15),
                                   moved = aperturaCapLight(dvec3(turn * light.axis), 0.15);
            const float a = aperturaIrradianceThrough(model.id, toReceiver(v, toParams(model, v, &params, kUp), kUp), light,
                                                      APERTURA_LIGHTS_MEDIUM);
            const float b = aperturaIrradianceThrough(model.id, toReceiver(w, toParams(model, w, &turned, turn * kUp), turn * kUp), moved,
                                                      APERTURA_LIGHTS_MEDIUM);
            EXPECT_NEAR(a / light.area, b / light.area, 2e-3) << model.name;
        }
    }
}

TEST(Models, HighBandsAreOrthonormal) {
    const auto lattice = sphereLattice(20000);
    double products[21][21]{};
    for (const dvec3& w : lattice) {
        const AperturaHighBands y = aperturaHighBands(vec3(w));
        for (int a = 0; a < 21; ++a)
            for (int b = 0; b <= a; ++b) products[a][b] += double(y.c[a / 4][a % 4]) * y.c[b / 4][b % 4] * 4 * pi / 20000;
    }
    for (int a = 0; a < 21; ++a)
        for (int b = 0; b <= a; ++b) EXPECT_NEAR(products[a][b], a == b, 2e-3) << a << " " << b;
}

TEST(Models, CapBlurIsTheMeanOverTheCap) {
    for (double r : {0.05, 0.3, 0.8}) {
        const double h = 1 - std::cos(r);
        double sum[4]{};
        for (int i = 0; i < 10000; ++i) {
            const double z = 1 - h * (i + 0.5) / 10000;  // uniform in height is uniform in area
            const double p[4] = {z, (3 * z * z - 1) / 2, (5 * z * z * z - 3 * z) / 2, (35 * z * z * z * z - 30 * z * z + 3) / 8};
            for (int l = 0; l < 4; ++l) sum[l] += p[l] / 10000;
        }
        const vec4 blur = aperturaCapBlur(float(h));
        for (int l = 0; l < 4; ++l) EXPECT_NEAR(blur[l], sum[l], 1e-5);
    }
}

TEST(Models, AlphaHasAllFourNumbers) {
    Random random(53);
    for (int i = 0; i < 1000; ++i) {
        const double r = random(0.1, 1.5), opacity = random(0.1, 1), area = 2 * pi * (1 - std::cos(r)) * opacity;
        const dvec3 axis = random.direction();
        const Visibility v{vec3(axis * area * (1 + std::cos(r)) / 2.0), float(area)};
        const ModelParams params = toParams(*findModel("alpha"), v, nullptr, kUp);
        EXPECT_NEAR(params[0].w, 1 - std::cos(r), 1e-4);
        EXPECT_NEAR(params[1].x, opacity, 2e-4);
    }
}

// All is open but one cap or two: the exact light follows from caps by inclusion-exclusion.
TEST(Models, AnAntiApertureIsRightAboutASphereOverAPlane) {
    const FitTools tools(4096);
    const dvec3 axis = normalize(dvec3(0.5, 0.2, 1));
    const double blocked = 0.5, radius = 0.0873;
    const Samples samples = samplesOf(tools.lattice, [&](const dvec3& w) { return dot(w, axis) < std::cos(blocked); });
    auto exact = [&](const dvec3& l) {
        return exactFraction({0, 0, 1}, {{l, radius}}, radius) - exactFraction({0, 0, 1}, {{l, radius}, {axis, blocked}}, radius);
    };
    EXPECT_LT(errorOf("sh", "anti", tools, samples, radius, exact), 0.02);
    EXPECT_LT(errorOf("anti", "anti", tools, samples, radius, exact), 0.02);
    EXPECT_LT(errorOf("cap-anti", "cap-anti", tools, samples, radius, exact), 0.03);
    EXPECT_LT(errorOf("firm-2", "firm-2", tools, samples, radius, exact), 0.03);
    EXPECT_LT(errorOf("soft-2", "soft-2", tools, samples, radius, exact), 0.03);
    EXPECT_GT(errorOf("sh", "aperture", tools, samples, radius, exact), 0.1);
}

TEST(Models, TwoOpeningsAreFoundAndLit) {
    const FitTools tools(4096);
    const dvec3 a = normalize(dvec3(1, 0, 0.8)), b = normalize(dvec3(-0.7, 0.6, 0.9));
    const double ra = 0.4, rb = 0.25;
    const Samples samples = samplesOf(tools.lattice, [&](const dvec3& w) { return dot(w, a) > std::cos(ra) || dot(w, b) > std::cos(rb); });
    for (double radius : {0.02, 0.0873, 0.26}) {
        auto exact = [&](const dvec3& l) {
            return exactFraction({0, 0, 1}, {{l, radius}, {a, ra}}, radius) + exactFraction({0, 0, 1}, {{l, radius}, {b, rb}}, radius);
        };
        for (const char* model : {"multi-2", "cap-anti", "firm-2", "soft-2", "firm-3", "firm-4"})
            EXPECT_LT(errorOf(model, model, tools, samples, radius, exact), 0.045) << model << " " << radius;
        // The third aperture of multi-3 overlaps the others, and light through both counts twice.
        EXPECT_LT(errorOf("multi-3", "multi-3", tools, samples, radius, exact), 0.065) << radius;
        EXPECT_GT(errorOf("sh", "soft", tools, samples, radius, exact), 0.06);
    }
}

// Two long and narrow openings: the four edges form two pairs, not one opening.
TEST(Models, PairsOfLobesAreSlits) {
    const FitTools tools(4096);
    const dvec3 a = normalize(dvec3(1, 0, 0.15)), b = normalize(dvec3(-1, 0, 0.35));
    const dvec3 c = normalize(dvec3(0.1, 1, 0.05)), d = normalize(dvec3(0.2, -1, 0.3));
    const double wide = 1.45;
    auto inside = [&](const dvec3& w, const dvec3& axis) { return dot(w, axis) > std::cos(wide); };
    const Samples samples = samplesOf(tools.lattice,
                                      [&](const dvec3& w) { return (inside(w, a) && inside(w, b)) || (inside(w, c) && inside(w, d)); });
    const double radius = 0.0873;
    auto exact = [&](const dvec3& l) {
        const std::vector<ExactCap> first{{l, radius}, {a, wide}, {b, wide}}, second{{l, radius}, {c, wide}, {d, wide}};
        const std::vector<ExactCap> both{{l, radius}, {a, wide}, {b, wide}, {c, wide}, {d, wide}};
        return exactFraction({0, 0, 1}, first, radius) + exactFraction({0, 0, 1}, second, radius) - exactFraction({0, 0, 1}, both, radius);
    };
    const double error = errorOf("firm-4", "firm-4", tools, samples, radius, exact);
    std::printf("two slits: firm-4 %.4f, soft-2 %.4f\n", error, errorOf("soft-2", "soft-2", tools, samples, radius, exact));
    EXPECT_LT(error, 0.04);
    EXPECT_GT(errorOf("soft-2", "soft-2", tools, samples, radius, exact), 2 * error);
}

// Checks one instance of sumLobes: the results with and without the instructions of newer processors are the same bytes,
// and its derivatives match central differences.
template <int K, int M, bool Hard, int L>
void checkSums(const SampleLattice& lattice, const Samples& samples) {
    using Sums = LobeSums<K, M, Hard>;
    constexpr int N = Sums::N;
    Random random(54);
    for (int i = 0; i < 20; ++i) {
        PatchedSamples patched{{}, samples.open.data(), lattice.blocks, lattice.patchSize, SampleLattice::kGroup, 1, i % 2 == 1};
        for (int f = 0; f < SampleLattice::kFeatures; ++f) patched.feature[f] = lattice.feature[f].data();
        float p[K * M], tangents[K * 6];
        for (float& x : p) x = float(random(-4, 4));
        for (float& x : tangents) x = float(random(-1, 1));
        Sums one, other;
        sumLobes<K, M, Hard, L>(patched, p, tangents, true, one);
        plain::sumLobes<K, M, Hard, L>(patched, p, tangents, true, other);
        for (int a = 0; a < N + 1; ++a) {
            ASSERT_EQ(one.sums[a], other.sums[a]);
            for (int b = 0; b <= a; ++b) ASSERT_EQ(one.products[a][b], other.products[a][b]);
        }
        for (int column = 0; column < N; ++column) {
            const int lobe = column / Sums::kColumns, c = column % Sums::kColumns;
            const float step = 0.01f;
            double value[2];
            for (int side = 0; side < 2; ++side) {
                float moved[K * M];
                std::copy_n(p, K * M, moved);
                const float by = side ? step : -step;
                for (int axis = 0; Hard && c > 0 && axis < 3; ++axis)
                    moved[lobe * M + 1 + axis] += by * tangents[(lobe * 2 + c - 1) * 3 + axis];
                if (!Hard || c == 0) moved[lobe * M + c] += by;
                Sums there;
                sumLobes<K, M, Hard, L>(patched, moved, tangents, false, there);
                value[side] = there.products[N][N];
            }
            const double slope = (value[1] - value[0]) / (4 * step);
            ASSERT_NEAR(one.products[N][column], slope,
                        0.01 * std::abs(slope) + 1e-3 * std::sqrt(one.products[N][N] * one.products[column][column]) + 6e-3)
                << K << " lobes, column " << column << ", pairs " << L;
        }
    }
}

TEST(Models, SumsAreTheSameOnEveryProcessorAndTheirDerivativesRight) {
    const SampleLattice lattice(1000);
    const Samples samples = samplesOf(lattice, [](const dvec3& w) { return w.x + w.z > 0.3; });
#define APERTURA_INSTANCE(K, M, Hard, L) checkSums<K, M, Hard, L>(lattice, samples);
    APERTURA_INSTANCES
#undef APERTURA_INSTANCE
}

// For every number of rays the patches of a group are neighbours, within 0.9 radians.
TEST(Models, GroupsOfPatchesAreNeighbours) {
    for (int rays : {256, 300, 500, 1000, 1024, 1500, 4096}) {
        const SampleLattice lattice(rays);
        std::map<std::pair<int, int>, std::vector<vec3>> groups;  // by lane and group
        for (size_t i = 0; i < lattice.directions().size(); ++i) {
            const int place = lattice.place[i], lane = place % SampleLattice::kLanes,
                      block = place / SampleLattice::kLanes / lattice.patchSize;
            groups[{lane, block / SampleLattice::kGroup}].push_back(lattice.directions()[i]);
        }
        ASSERT_LE(lattice.blocks, PatchedSamples::kMaxBlocks);
        float widest = 0;
        for (const auto& [key, all] : groups)
            for (const vec3& a : all)
                for (const vec3& b : all) widest = std::max(widest, std::acos(std::clamp(dot(a, b), -1.0f, 1.0f)));
        EXPECT_LT(widest, 0.9f) << rays;
    }
}

TEST(Models, FitsAreNoWorseThanALongSearch) {
    const Scene scene = makeBuiltin("room-3");
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, 24, 3)) points.push_back(p.at);
    const FitTools tools(256);
    const CapDictionary fine(tools.lattice, 200, 20);
    for (const float sharpness : {0.0f, kHardSharpness, 2 * kHardSharpness}) {  // soft, firm, and as hard as caps
        double own = 0, slow = 0;
        samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 1, {}, [&](size_t, const Samples& samples, const mat3&) {
            LobeFitOptions fitOptions;
            fitOptions.lobes = 2;
            fitOptions.sharpness = sharpness;
            own += fitLobes(samples, tools.dictionary, LobeFitSides::Both, fitOptions).error;
            fitOptions.starts = 24;
            fitOptions.firstSteps = fitOptions.steps = 100;
            slow += fitLobes(samples, fine, LobeFitSides::Both, fitOptions).error;
        });
        std::printf("two lobes, sharpness %g: %.4f, after a long search %.4f\n", sharpness, std::sqrt(own / 24), std::sqrt(slow / 24));
        EXPECT_LE(std::sqrt(own), (sharpness > 0 ? 1.03 : 1.12) * std::sqrt(slow));
    }
}

TEST(Models, BytesAddLittle) {
    const Scene scene = makeBuiltin("statue");
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SurfaceSample& p : sampleReceivers(scene, 30, 1)) points.push_back(p.at);
    const FitTools tools(256);
    for (const Recipe& recipe : recipes()) {
        if (recipe.model < 0) continue;
        const Model& model = models()[size_t(recipe.model)];
        double sum[2]{};
        int count = 0;
        samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 1, {}, [&](size_t i, const Samples& samples, const mat3& frame) {
            const BakedPoint point = makePoint(recipe, tools, samples, frame, {.lambda = 400});
            const vec3 normal = points[i].normal;
            for (int k = 0; k < 2; ++k) {
                const auto bytes = packAllParams(model, {&point.params, 1}, mat3(1), k ? 16 : 8);
                const ModelParams back = unpackAllParams(model, {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, 1,
                                                         mat3(1), k ? 16 : 8)[0];
                for (const vec3& l : fibonacciHemisphere(40)) {
                    const AperturaCapLight light = apertura::aperturaCapLight(frame * l, 0.0872f);
                    const float a = aperturaIrradianceThrough(
                        model.id, toReceiver(point.visibility, toParams(model, point.visibility, &point.params, normal), normal), light,
                        APERTURA_LIGHTS_MEDIUM);
                    const float b = aperturaIrradianceThrough(
                        model.id, toReceiver(point.visibility, toParams(model, point.visibility, &back, normal), normal), light,
                        APERTURA_LIGHTS_MEDIUM);
                    sum[k] += std::pow((a - b) / light.area, 2);
                    count += k;
                }
            }
        });
        std::printf("%-8s 8 bits add %.4f, 16 bits %.5f\n", std::string(model.name).c_str(), std::sqrt(sum[0] / count),
                    std::sqrt(sum[1] / count));
        EXPECT_LT(std::sqrt(sum[0] / count), 0.03) << model.name;
        EXPECT_LT(std::sqrt(sum[1] / count), 0.003) << model.name;
    }
}

TEST(ParamsPacking, ErrsNoMoreThanItSays) {
    Random random(31);
    for (const int bits : {8, 16}) {
        const float top = bits == 16 ? 32767 : 127;
        for (const char* name : {"firm-2", "multi-2"}) {
            const Model& model = *findModel(name);
            const ParamsError bound = paramsError(model, bits);
            double axis = 0, edge = 0;
            for (int i = 0; i < 200000; ++i) {
                ModelParams params{};
                for (int k = 0; k < 2; ++k) {
                    const vec3 w(random.direction());
                    // Caps of any radius; lobes whose edge stands within a degree of the plane of the axis.
                    params[size_t(k)] = model.stored[0] == Field::Cap
                                          ? vec4(w, 1 - std::cos(float(random(0.1, 3))))
                                          : vec4(kHardSharpness * w, kHardSharpness * float(random(-0.0175, 0.0175)));
                }
                std::vector<float> numbers(size_t(storedNumbers(model)));
                packParams(model, params, numbers);
                for (float& n : numbers) n = std::round(n * top) / top;
                const ModelParams back = unpackParams(model, numbers);
                for (size_t k = 0; k < 2; ++k) {
                    const dvec3 a(params[k]), b(back[k]);
                    axis = std::max(axis, std::atan2(length(cross(a, b)), dot(a, b)));
                    const auto at = [&](const vec4& slot) {
                        return model.stored[0] == Field::Cap ? std::acos(1 - double(slot.w))
                                                             : std::asin(double(slot.w) / length(dvec3(slot)));
                    };
                    edge = std::max(edge, std::abs(at(params[k]) - at(back[k])));
                }
            }
            EXPECT_LE(axis, 1.01 * bound.axis + 1e-5) << name << ", " << bits;
            EXPECT_GE(axis, 0.9 * bound.axis) << name << ", " << bits;  // and not for want of trying
            EXPECT_LE(edge, 1.01 * bound.edge + 1e-5) << name << ", " << bits;
            EXPECT_GE(edge, 0.9 * bound.edge) << name << ", " << bits;
        }
    }
    EXPECT_EQ(paramsError(*findModel("soft"), 8).axis, 0);
    EXPECT_GE(paramsError(*findModel("auto"), 8).axis, paramsError(*findModel("firm-2"), 8).axis);
}

TEST(FormStream, RefusesWhatCannotBe) {
    const Model& two = *findModel("soft-2");
    const Model& automatic = *findModel("auto");
    std::vector<unsigned char> bytes(24, 7);
    EXPECT_EQ(unpackAllParams(two, bytes, 3, mat3(1), 8).size(), 3u);
    EXPECT_THROW(unpackAllParams(two, bytes, 4, mat3(1), 8), Error);
    EXPECT_THROW(unpackAllParams(two, bytes, 2, mat3(1), 8), Error);
    EXPECT_THROW(unpackAllParams(two, bytes, 3, mat3(1), 16), Error);
    EXPECT_THROW(unpackAllParams(automatic, bytes, 25, mat3(1), 8), Error);
    bytes = {0, 1, 2, 0x80};  // four points without numbers; for the last no model reached the tolerance
    const std::vector<ModelParams> allParams = unpackAllParams(automatic, bytes, 4, mat3(1), 8);
    EXPECT_EQ(chosenModel(automatic, allParams[2]).id, APERTURA_MODEL_SOFT);
    EXPECT_FALSE(aperturaChoiceIn(allParams[0][APERTURA_CHOICE_SLOT]).outOfReach);
    EXPECT_TRUE(aperturaChoiceIn(allParams[3][APERTURA_CHOICE_SLOT]).outOfReach);
    bytes[1] = 100;
    EXPECT_THROW(unpackAllParams(automatic, bytes, 4, mat3(1), 8), Error);
}

}  // namespace
}  // namespace apertura::test
