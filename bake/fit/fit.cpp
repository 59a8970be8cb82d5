#include "apertura/bake/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/fit/rivals.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/sh/soft.h"

namespace apertura {
namespace {

constexpr float kCapSharpness = 120;  // length of the slope of the soft-edged lobes that stand for caps in a fit
constexpr int kLongSteps = 40;        // for fits with one start that may be far from the solution
constexpr float kAmbientWeight = 60;  // keeps the sky's E right to about 0.003

}  // namespace

Visibility project(const Samples& samples) {
    const SampleLattice& lattice = *samples.lattice;
    std::vector<vec3> open;
    for (size_t i = 0; i < lattice.directions().size(); ++i)
        if (samples.isOpen(i)) open.push_back(lattice.directions()[i]);
    return toVisibility(apertura::project(open, lattice.solidAngle()));
}

namespace {

Visibility sumUp(const Samples& samples) {
    const SampleLattice& lattice = *samples.lattice;
    int count = 0;
    glm::dvec3 sum(0);
    for (size_t i = 0; i < lattice.directions().size(); ++i)
        if (samples.isOpen(i)) ++count, sum += glm::dvec3(lattice.directions()[i]);
    return {vec3(sum * lattice.solidAngle()), float(count * lattice.solidAngle())};
}

BakedPoint fromSh(const FitTools&, const Samples& s, const mat3&, const FitOptions&) { return {project(s), {}}; }
BakedPoint fromRays(const FitTools&, const Samples& s, const mat3&, const FitOptions&) { return {sumUp(s), {}}; }

// What a baker of cosine-weighted transfer (T = integral of V max(0, n.w) Y) stores, taken for visibility after the
// scaling that makes an open hemisphere right: DC by 2, the linear band by 3/2.
BakedPoint fromTransfer(const FitTools&, const Samples& samples, const mat3&, const FitOptions&) {
    const SampleLattice& lattice = *samples.lattice;
    double area = 0;
    glm::dvec3 direction(0);
    for (size_t i = 0; i < lattice.directions().size(); ++i) {
        if (!samples.isOpen(i)) continue;
        const vec3 w = lattice.directions()[i];
        area += w.z;
        direction += double(w.z) * glm::dvec3(w);
    }
    return {clampToPossible({vec3(direction * lattice.solidAngle() * 1.5), float(2 * area * lattice.solidAngle())}), {}};
}

vec4 bestLobe(const Samples& samples, float ambientWeight) {
    const AperturaSoftAperture start = toSoft(project(samples), vec3(0, 0, 1));
    LobeFitOptions fitOptions;
    fitOptions.ambientWeight = ambientWeight;
    fitOptions.steps = kLongSteps;
    return improveLobe(samples, vec4(start.slope, start.offset), fitOptions).lobes[0];
}

// The coefficients of the best soft aperture, in place of those of the visibility.
BakedPoint fittedSh(const FitTools&, const Samples& samples, const mat3&, const FitOptions&) {
    const SampleLattice& lattice = *samples.lattice;
    const vec4 lobe = bestLobe(samples, kAmbientWeight);
    double area = 0;
    glm::dvec3 direction(0);
    for (const vec3& w : lattice.directions()) {
        const double f = lobe.w + dot(vec3(lobe), w), v = 0.5 + 0.5 * f / std::sqrt(1 + f * f);
        area += v;
        direction += v * glm::dvec3(w);
    }
    return {{vec3(direction * lattice.solidAngle()), float(area * lattice.solidAngle())}, {}};
}

// Softer edges are taken where they err a little more, too: hard ones that lie beside the true edge are seen as mottle.
constexpr float kSofterShare = 0.2f;

// Two hard edges are fitted from few starts: more would lower the error by a fiftieth, at a third of the speed.
LobeFitOptions hardLobes(int lobes, float sharpness) {
    LobeFitOptions fitOptions;
    fitOptions.lobes = lobes;
    fitOptions.sharpness = sharpness;
    fitOptions.pairs = true;
    fitOptions.softer = sharpness > 0 ? kSofterSharpness : 0;
    fitOptions.softerShare = kSofterShare;
    if (lobes != 2 || sharpness == 0) {
        fitOptions.starts = 6;
        fitOptions.firstSteps = 6;
        fitOptions.steps = 20;
    }
    return fitOptions;
}

LobeFitOptions asCaps(int lobes) {
    LobeFitOptions fitOptions = hardLobes(lobes, kCapSharpness);
    fitOptions.pairs = false;
    fitOptions.softer = 0;
    return fitOptions;
}

// Lobes that stand for a cap, or for the blocked part outside of one, and back.
vec4 toCap(const vec4& lobe, bool complement) {
    const float slope = std::max(length(vec3(lobe)), 1e-6f);
    const float height = std::clamp(1 + lobe.w / slope, 0.0f, 2.0f);
    return complement ? vec4(-vec3(lobe) / slope, 2 - height) : vec4(vec3(lobe) / slope, height);
}
vec4 fromCap(const vec4& cap, bool complement) {
    return kCapSharpness * (complement ? vec4(-vec3(cap), 1 - cap.w) : vec4(vec3(cap), cap.w - 1));
}

// The better of one cap and one anti-cap.
ModelParams antiOf(const LobeFit& fit) {
    const vec4 cap = toCap(fit.lobes[0], false);
    const bool anti = cap.w > 1;
    const vec4 own = anti ? vec4(-vec3(cap), 2 - cap.w) : cap;
    const AperturaAperture aperture = aperturaMakeAperture(vec3(own), own.w);
    return paramsOf(aperturaWithTwoCaps({}, {aperture, aperture, anti ? 1.0f : 0.0f, 0}));
}
LobeFit lobeOfAnti(const ModelParams& params) {
    LobeFit out;
    out.count = 1;
    const vec4 own = params[0];
    out.lobes[0] = fromCap(aperturaCombinationIn(params[2]).complement > 0.5f ? vec4(-vec3(own), 2 - own.w) : own, false);
    return out;
}

template <int K>
ModelParams capsOf(const LobeFit& fit) {
    ModelParams out{};
    for (int k = 0; k < K; ++k) out[size_t(k)] = toCap(fit.lobes[k], true);
    return out;
}
template <int K>
LobeFit lobesOfCaps(const ModelParams& params) {
    LobeFit out;
    out.count = K;
    out.complement = true;
    for (int k = 0; k < K; ++k) out.lobes[k] = fromCap(params[size_t(k)], true);
    return out;
}

ModelParams capAntiOf(const LobeFit& fit) {
    auto cap = [&](int k) { return aperturaApertureIn(toCap(fit.lobes[k], false), vec3(0)); };
    return paramsOf(aperturaWithTwoCaps({}, {cap(0), cap(1), fit.complement ? 1.0f : 0.0f, 0}));
}
LobeFit lobesOfCapAnti(const ModelParams& params) {
    LobeFit out;
    out.count = 2;
    out.complement = aperturaCombinationIn(params[2]).complement > 0.5f;
    for (int k = 0; k < 2; ++k) out.lobes[k] = fromCap(params[size_t(k)], false);
    return out;
}

template <int K>
ModelParams lobesOf(const LobeFit& fit) {
    ModelParams out{};
    for (int k = 0; k < K; ++k) out[size_t(k)] = fit.lobes[k];
    out[K] = aperturaWithCombination(vec4(0), {fit.complement ? 1.0f : 0.0f, float(fit.pairs)});
    return out;
}
template <int K>
LobeFit lobesOfLobes(const ModelParams& params) {
    LobeFit out;
    out.count = K;
    out.complement = aperturaCombinationIn(params[K]).complement > 0.5f;
    out.pairs = int(aperturaCombinationIn(params[K]).pairs);
    for (int k = 0; k < K; ++k) out.lobes[k] = params[size_t(k)];
    return out;
}

const LobeForm* lobeForm(int model) {
    using enum LobeFitSides;
    static const std::map<int, LobeForm> all{
        {APERTURA_MODEL_ANTI, {Product, asCaps(1), antiOf, lobeOfAnti}},
        {APERTURA_MODEL_FIRM_2, {Both, hardLobes(2, kHardSharpness), lobesOf<2>, lobesOfLobes<2>}},
        {APERTURA_MODEL_SOFT_2, {Both, hardLobes(2, 0), lobesOf<2>, lobesOfLobes<2>}},
        {APERTURA_MODEL_FIRM_3, {Both, hardLobes(3, kHardSharpness), lobesOf<3>, lobesOfLobes<3>}},
        {APERTURA_MODEL_FIRM_4, {Both, hardLobes(4, kHardSharpness), lobesOf<4>, lobesOfLobes<4>}},
        {APERTURA_MODEL_MULTI_2, {Complement, asCaps(2), capsOf<2>, lobesOfCaps<2>}},
        {APERTURA_MODEL_MULTI_3, {Complement, asCaps(3), capsOf<3>, lobesOfCaps<3>}},
        {APERTURA_MODEL_MULTI_4, {Complement, asCaps(4), capsOf<4>, lobesOfCaps<4>}},
        {APERTURA_MODEL_CAP_ANTI, {Both, asCaps(2), capAntiOf, lobesOfCapAnti}},
    };
    const auto found = all.find(model);
    return found == all.end() ? nullptr : &found->second;
}

template <int Model>
BakedPoint fittedLobes(const FitTools& tools, const Samples& samples, const mat3&, const FitOptions&) {
    const LobeForm& form = *lobeForm(Model);
    return {project(samples), form.toParams(fitLobes(samples, tools.dictionary, form.sides, form.options))};
}

BakedPoint quadric(const FitTools&, const Samples& samples, const mat3&, const FitOptions&) {
    LobeFitOptions fitOptions;
    fitOptions.steps = kLongSteps;
    const QuadricFit fit = fitQuadric(samples, bestLobe(samples, 0), fitOptions);
    const float* b = fit.bend;
    return {project(samples), paramsOf(aperturaWithQuadric({}, {vec3(fit.lobe), fit.lobe.w, vec4(b[0], b[1], b[2], b[3]), b[4]}))};
}

BakedPoint bands(const FitTools&, const Samples& samples, const mat3&, const FitOptions&) {
    const SampleLattice& lattice = *samples.lattice;
    BakedPoint out{project(samples), {}};
    for (size_t i = 0; i < lattice.directions().size(); ++i) {
        if (!samples.isOpen(i)) continue;
        const AperturaHighBands y = aperturaHighBands(lattice.directions()[i]);
        for (int c = 0; c < 6; ++c) out.params[c] += float(lattice.solidAngle()) * y.c[c];
    }
    return out;
}

constexpr Recipe kRecipes[] = {
    {"sh", "sh", -1, -1, "the four coefficients of the visibility itself", fromSh},
    {"rays", "rays", -1, -1, "area and mean direction straight from the rays", fromRays},
    {"transfer", "transfer", -1, -1, "cosine-weighted transfer, as direct-lighting bakers give it, converted", fromTransfer},
    {"sh-fit", "sh-fit", -1, APERTURA_MODEL_SOFT, "the four coefficients of the best soft aperture", fittedSh},
    {"sh-l2", "sh", APERTURA_MODEL_SH_L2, -1, "SH to band 2", bands},
    {"sh-l4", "sh", APERTURA_MODEL_SH_L4, -1, "SH to band 4", bands},
    {"anti", "fit", APERTURA_MODEL_ANTI, -1, "the better of one aperture and one anti-aperture", fittedLobes<APERTURA_MODEL_ANTI>},
    {"firm-2", "fit", APERTURA_MODEL_FIRM_2, -1, "two hard-edged lobes", fittedLobes<APERTURA_MODEL_FIRM_2>},
    {"soft-2", "fit", APERTURA_MODEL_SOFT_2, -1, "two soft lobes", fittedLobes<APERTURA_MODEL_SOFT_2>},
    {"soft-l2", "fit", APERTURA_MODEL_SOFT_L2, -1, "a soft aperture with a quadratic exponent", quadric},
    {"firm-3", "fit", APERTURA_MODEL_FIRM_3, -1, "three hard-edged lobes", fittedLobes<APERTURA_MODEL_FIRM_3>},
    {"firm-4", "fit", APERTURA_MODEL_FIRM_4, -1, "four hard-edged lobes", fittedLobes<APERTURA_MODEL_FIRM_4>},
    {"multi-2", "fit", APERTURA_MODEL_MULTI_2, -1, "two apertures", fittedLobes<APERTURA_MODEL_MULTI_2>},
    {"multi-3", "fit", APERTURA_MODEL_MULTI_3, -1, "three apertures", fittedLobes<APERTURA_MODEL_MULTI_3>},
    {"multi-4", "fit", APERTURA_MODEL_MULTI_4, -1, "four apertures", fittedLobes<APERTURA_MODEL_MULTI_4>},
    {"cap-anti", "fit", APERTURA_MODEL_CAP_ANTI, -1, "two of aperture and anti-aperture", fittedLobes<APERTURA_MODEL_CAP_ANTI>},
    {"horizon-4", "rays", APERTURA_MODEL_HORIZON_4, -1, "the horizon at 4 azimuths", horizon<4>},
    {"horizon-8", "rays", APERTURA_MODEL_HORIZON_8, -1, "the horizon at 8 azimuths", horizon<8>},
    {"horizon-16", "rays", APERTURA_MODEL_HORIZON_16, -1, "the horizon at 16 azimuths", horizon<16>},
    {"horizon-32", "rays", APERTURA_MODEL_HORIZON_32, -1, "the horizon at 32 azimuths", horizon<32>},
    {"cube-6", "fit", APERTURA_MODEL_CUBE_6, -1, "visibility as an ambient cube", ambientCube},
    {"zh3", "sh", APERTURA_MODEL_ZH3, -1, "SH bands 0 and 1 and a zonal band 2", zonalBand},
    {"bits-32", "rays", APERTURA_MODEL_BITS_32, -1, "32 sectors of the hemisphere as bits", sectors<4>},
    {"bits-128", "rays", APERTURA_MODEL_BITS_128, -1, "128 sectors as bits", sectors<8>},
    {"auto", "fit", APERTURA_MODEL_AUTO, -1, "the least model for each point", chooseModel},
};

}  // namespace

FitTools::FitTools(int rays, Use use) : lattice(rays), dictionary(lattice, use == Use::Samples ? 0 : 60, 10) {
    if (use == Use::Choice) probes = makeProbes(lattice);
}

const LobeForm* lobeFormOf(int model) { return lobeForm(model); }

FitTools::Use useOf(const Recipe& recipe) {
    if (recipe.model == APERTURA_MODEL_AUTO) return FitTools::Use::Choice;
    return recipe.source == "fit" && recipe.model >= 0 ? FitTools::Use::Fits : FitTools::Use::Samples;
}

std::span<const Recipe> recipes() {
    static const bool allThere = std::all_of(models().begin(), models().end(), [](const Model& model) {
        return model.fromVisibility
            || std::any_of(std::begin(kRecipes), std::end(kRecipes), [&](const Recipe& r) { return r.model == model.id; });
    });
    if (!allThere) throw std::logic_error("a stored model of sh/models.cpp has no recipe in bake/fit/fit.cpp");
    return kRecipes;
}

const Recipe* findRecipe(std::string_view name) {
    const Model* model = findModel(name);  // a model may have an alias
    for (const Recipe& recipe : kRecipes)
        if (recipe.name == name || (model && recipe.name == model->name)) return &recipe;
    return nullptr;
}

const Recipe& recipeNamed(std::string_view name) {
    const Recipe* recipe = findRecipe(name);
    if (!recipe) throw Error("there is no recipe '" + std::string(name) + "'");
    return *recipe;
}

const Recipe& recipeFor(const Model& model) {
    if (model.fromVisibility) return recipeNamed("sh");
    for (const Recipe& recipe : kRecipes)
        if (recipe.model == model.id) return recipe;
    throw Error("no recipe makes the model '" + std::string(model.name) + "'");
}

BakedPoint makePoint(const Recipe& recipe, const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options) {
    BakedPoint out = recipe.make(tools, samples, frame, options);
    out.visibility.direction = frame * out.visibility.direction;
    if (recipe.model >= 0) out.params = rotateParams(chosenModel(models()[size_t(recipe.model)], out.params), out.params, frame);
    return out;
}

}  // namespace apertura
