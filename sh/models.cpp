#include "apertura/sh/models.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apertura/sh/aperture.h"
#include "apertura/sh/soft.h"

namespace apertura {
namespace {

ModelParams nothing(const Visibility&, const vec3&) { return {}; }

ModelParams oneCap(const Visibility& v, const vec3& normal) { return paramsOf(aperturaWithAperture({}, toAperture(v, normal), 1)); }

// The cap of uniform opacity that has all four numbers: |D| / A = 1 - height / 2 gives its height.
ModelParams alphaCap(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    AperturaAperture a = toAperture(v, normal);
    const float share = v.area > 0 ? length(v.direction) / v.area : 1;
    const float area = a.height;
    a = aperturaMakeAperture(a.axis, std::clamp(2 - 2 * share, area, 2.0f));
    return paramsOf(aperturaWithAperture({}, a, a.height > 0 ? area / a.height : 0));
}

// The cap of the open part and the anti-cap of the blocked part, weighted by their deficits: the part that is nearer to
// being a cap gets the larger weight.
ModelParams capAndAnti(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const Visibility blocked{APERTURA_PI * normal - v.direction, 2 * APERTURA_PI - v.area};
    auto deficit = [](const Visibility& x) { return std::max(x.area * (1 - x.area / (4 * APERTURA_PI)) - length(x.direction), 0.0f); };
    const float open = deficit(v), closed = deficit(blocked);
    const float sum = open + closed;
    return paramsOf(aperturaWithTwoCaps({}, {toAperture(v, normal), toAperture(blocked, normal), sum > 1e-6f ? open / sum : 0, 0}));
}

// Scales a quadric down to the same limit. Its edge becomes softer, its area stays nearly the same.
AperturaSoftQuadric limitQuadric(const AperturaSoftQuadric& q) {
    const double bend = glm::dot(glm::dvec4(q.bend), glm::dvec4(q.bend)) + double(q.bendYz) * q.bendYz;
    const double reach = length(dvec3(q.slope)) + std::abs(q.offset) + std::sqrt(bend);
    const float scale = float(std::min(1.0, APERTURA_LOBE_FARTHEST / std::max(reach, 1e-6)));
    return {q.slope * scale, q.offset * scale, q.bend * scale, q.bendYz * scale};
}

ModelParams oneLobe(const Visibility& v, const vec3& normal) {
    const AperturaSoftAperture s = toSoft(v, normal);
    return {limitedLobe(vec4(s.slope, s.offset))};
}

using enum Field;
using Kind = ModelKind;
// A row a model.
// clang-format off
constexpr Model kModels[] = {
    {.id = APERTURA_MODEL_UNSHADOWED, .name = "unshadowed", .numbers = 0, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "N.L, no visibility: the baseline of cost"},
    {.id = APERTURA_MODEL_AO_AREA, .name = "ao-area", .kind = Kind::Area, .numbers = 1, .mixes = true, .baseline = true, .fromVisibility = nothing, .autoTag = 0, .cycles = 1,
     .what = "visible area over that of the hemisphere, times N.L", .alias = "ao", .ownBytes = 1},
    {.id = APERTURA_MODEL_SH_L1, .name = "sh-l1", .numbers = 4, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "SH bands 0 and 1 of visibility, evaluated at the light"},
    {.id = APERTURA_MODEL_SH_L2, .name = "sh-l2", .numbers = 9, .slots = 2, .mixes = true, .baseline = true, .stored = {Bands2},
     .what = "SH bands 0 to 2"},
    {.id = APERTURA_MODEL_SH_L4, .name = "sh-l4", .numbers = 25, .slots = 6, .mixes = true, .baseline = true, .stored = {Bands4},
     .what = "SH bands 0 to 4"},
    {.id = APERTURA_MODEL_OAT, .name = "oat", .numbers = 3, .slots = 1, .mixes = true, .baseline = true, .fromVisibility = oneCap,
     .what = "aperture, formula as published in 2006"},
    {.id = APERTURA_MODEL_APERTURE, .name = "aperture", .kind = Kind::Aperture, .numbers = 3, .slots = 2, .fromVisibility = oneCap, .autoTag = 1, .cycles = 62,
     .what = "aperture, exact overlap of caps within 0.0023"},
    {.id = APERTURA_MODEL_ALPHA, .name = "alpha", .kind = Kind::Aperture, .numbers = 4, .slots = 2, .fromVisibility = alphaCap,
     .what = "translucent aperture with all four numbers"},
    {.id = APERTURA_MODEL_ANTI, .name = "anti", .kind = Kind::Anti, .numbers = 4, .slots = 4, .fromVisibility = capAndAnti, .stored = {Cap},
     .what = "aperture, anti-aperture or a blend of both"},
    {.id = APERTURA_MODEL_SOFT, .name = "soft", .kind = Kind::Lobes, .numbers = 4, .slots = 1, .mixes = true, .fromVisibility = oneLobe, .autoTag = 2, .cycles = 6,
     .what = "soft-edged aperture, uses all four numbers"},
    {.id = APERTURA_MODEL_FIRM_2, .name = "firm-2", .kind = Kind::Lobes, .parts = 2, .numbers = 6, .slots = 3, .stored = {HardLobe, HardLobe}, .autoTag = 3, .cycles = 210,
     .what = "two hard-edged lobes"},
    {.id = APERTURA_MODEL_SOFT_2, .name = "soft-2", .kind = Kind::Lobes, .parts = 2, .numbers = 8, .slots = 3, .stored = {Lobe, Lobe}, .autoTag = 4, .cycles = 210,
     .what = "two soft lobes"},
    {.id = APERTURA_MODEL_SOFT_L2, .name = "soft-l2", .kind = Kind::Quadric, .numbers = 9, .slots = 3, .mixes = true, .stored = {Lobe, Bend}, .autoTag = 6, .cycles = 102,
     .what = "soft aperture with a quadratic exponent"},
    {.id = APERTURA_MODEL_FIRM_3, .name = "firm-3", .kind = Kind::Lobes, .parts = 3, .numbers = 9, .slots = 4, .stored = {HardLobe, HardLobe, HardLobe},
     .autoTag = 5, .cycles = 426, .what = "three hard-edged lobes"},
    {.id = APERTURA_MODEL_FIRM_4, .name = "firm-4", .kind = Kind::Lobes, .parts = 4, .numbers = 12, .slots = 5,
     .stored = {HardLobe, HardLobe, HardLobe, HardLobe}, .autoTag = 7, .cycles = 722, .what = "four hard-edged lobes"},
    {.id = APERTURA_MODEL_MULTI_2, .name = "multi-2", .kind = Kind::Union, .parts = 2, .numbers = 6, .slots = 3, .stored = {Cap, Cap}, .what = "two apertures"},
    {.id = APERTURA_MODEL_MULTI_3, .name = "multi-3", .kind = Kind::Union, .parts = 3, .numbers = 9, .slots = 5, .stored = {Cap, Cap, Cap},
     .what = "three apertures"},
    {.id = APERTURA_MODEL_MULTI_4, .name = "multi-4", .kind = Kind::Union, .parts = 4, .numbers = 12, .slots = 6, .stored = {Cap, Cap, Cap, Cap},
     .what = "four apertures"},
    {.id = APERTURA_MODEL_CAP_ANTI, .name = "cap-anti", .kind = Kind::CapAnti, .parts = 2, .numbers = 6, .slots = 4, .stored = {Cap, Cap},
     .what = "two of aperture and anti-aperture"},
    {.id = APERTURA_MODEL_HORIZON_16, .name = "horizon-16", .numbers = 16, .slots = 4, .mixes = true, .baseline = true, .stored = {Heights16},
     .what = "the horizon at 16 azimuths", .alias = "horizon", .ownBytes = 17},
    {.id = APERTURA_MODEL_AUTO, .name = "auto", .kind = Kind::Choice, .numbers = 0, .slots = 5, .what = "the least model, chosen for each point"},
    {.id = APERTURA_MODEL_AO_COSINE, .name = "ao-cosine", .numbers = 1, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "cosine-weighted occlusion, as bakers write it, times N.L", .ownBytes = 1},
    {.id = APERTURA_MODEL_XEGTAO, .name = "xegtao", .numbers = 4, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "bent normal and occlusion, as XeGTAO lights with them", .ownBytes = 4},
    {.id = APERTURA_MODEL_XEGTAO_0, .name = "xegtao-0", .numbers = 4, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "the same without its margin of 0.1", .ownBytes = 4},
    {.id = APERTURA_MODEL_MICRO_SHADOW, .name = "micro-shadow", .numbers = 1, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "occlusion and N.L, as Filament lights with them", .ownBytes = 1},
    {.id = APERTURA_MODEL_BENT_CONES, .name = "bent-cones", .numbers = 4, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "a cone about the bent normal over the light's cone", .ownBytes = 4},
    {.id = APERTURA_MODEL_HORIZON_4, .name = "horizon-4", .numbers = 4, .slots = 1, .mixes = true, .baseline = true, .stored = {Heights4},
     .what = "the horizon at 4 azimuths, in four bytes as Stellarium has it", .ownBytes = 5},
    {.id = APERTURA_MODEL_HORIZON_8, .name = "horizon-8", .numbers = 8, .slots = 2, .mixes = true, .baseline = true, .stored = {Heights8},
     .what = "the horizon at 8 azimuths", .ownBytes = 9},
    {.id = APERTURA_MODEL_HORIZON_32, .name = "horizon-32", .numbers = 32, .slots = 8, .mixes = true, .baseline = true, .stored = {Heights32},
     .what = "the horizon at 32 azimuths", .ownBytes = 33},
    {.id = APERTURA_MODEL_CUBE_6, .name = "cube-6", .numbers = 6, .slots = 2, .mixes = true, .baseline = true, .stored = {Faces},
     .what = "visibility as an ambient cube, in 32 bits", .ownBytes = 4},
    {.id = APERTURA_MODEL_ZH3, .name = "zh3", .numbers = 5, .slots = 1, .mixes = true, .baseline = true, .stored = {Zonal},
     .what = "SH bands 0 and 1, and a zonal band 2", .ownBytes = 5},
    {.id = APERTURA_MODEL_ZH3_GUESS, .name = "zh3-guess", .numbers = 4, .mixes = true, .baseline = true, .fromVisibility = nothing,
     .what = "the same with the zonal number guessed from the others", .ownBytes = 4},
    {.id = APERTURA_MODEL_BITS_32, .name = "bits-32", .numbers = 4, .slots = 2, .baseline = true, .stored = {Bits32},
     .what = "32 sectors of the hemisphere as bits", .ownBytes = 5},
    {.id = APERTURA_MODEL_BITS_128, .name = "bits-128", .numbers = 16, .slots = 5, .baseline = true, .stored = {Bits128},
     .what = "128 sectors as bits", .ownBytes = 17},
};
// clang-format on
static_assert(std::size(kModels) == APERTURA_MODEL_COUNT,
              "MODEL_COUNT of shaders/receiver.glsl is the number of rows, one for every APERTURA_MODEL_...");

constexpr int autoCount() {
    return int(std::count_if(std::begin(kModels), std::end(kModels), [](const Model& model) { return model.autoTag >= 0; }));
}
constexpr std::array<const Model*, autoCount()> kAutoModels = [] {
    std::array<const Model*, autoCount()> out{};
    for (const Model& model : kModels)
        if (model.autoTag >= 0) out[size_t(model.autoTag)] = &model;
    return out;
}();

constexpr int slotsNeeded(const Model& model) {
    switch (model.kind) {
        case ModelKind::Lobes: return model.parts == 1 ? 1 : model.parts + 1;
        case ModelKind::Union: return model.parts + (model.parts + 1) / 2;
        case ModelKind::Anti:
        case ModelKind::CapAnti: return 4;
        case ModelKind::Aperture: return 2;
        case ModelKind::Quadric: return 3;
        case ModelKind::Choice: return APERTURA_CHOICE_SLOT + 1;
        default: return 0;
    }
}

// True where a row is what the code that reads the table assumes.
constexpr bool isSound(const Model& model, int place) {
    const bool made = model.fromVisibility || model.stored[0] != None || model.kind == ModelKind::Choice;
    const bool tagged = model.autoTag < 0 ? model.cycles == 0 : model.cycles > 0 && kAutoModels[size_t(model.autoTag)] == &model;
    return model.id == place && made && tagged && !model.name.empty() && !model.what.empty() && model.slots <= APERTURA_MAX_SLOTS
        && model.slots >= slotsNeeded(model);
}
static_assert(
    [] {
        for (int i = 0; i < APERTURA_MODEL_COUNT; ++i)
            if (!isSound(kModels[i], i)) return false;
        return std::find(kAutoModels.begin(), kAutoModels.end(), nullptr) == kAutoModels.end();
    }(),
    "rows stand in the order of their ids, are made or stored, have the slots that their kind needs, and tags without gaps");

}  // namespace

bool hasFormula(const Model& model, int lightClass) {
    AperturaReceiver receiver{vec3(0, 0, 1), vec4(0, 0, 1, 2), {}};
    const AperturaCapLight light = aperturaCapLight(receiver.normal, 0.01f);
    if (model.autoTag >= 0) {
        receiver.params[APERTURA_CHOICE_SLOT] = aperturaWithChoice(vec4(0), {model.id, false});
        if (aperturaIrradianceThrough(APERTURA_MODEL_AUTO, receiver, light, lightClass) == APERTURA_NO_FORMULA) return false;
    }
    return aperturaIrradianceThrough(model.id, receiver, light, lightClass) != APERTURA_NO_FORMULA;
}

std::span<const Model> models() {
    static const bool allHave = std::all_of(std::begin(kModels), std::end(kModels),
                                            [](const Model& m) { return m.kind == Kind::Choice || hasFormula(m, APERTURA_LIGHTS_ANY); });
    if (!allHave) throw std::logic_error("a model of sh/models.cpp has no formula in shaders/models.glsl");
    return kModels;
}

const Model* findModel(std::string_view name) {
    for (const Model& model : kModels)
        if (model.name == name || (!name.empty() && model.alias == name)) return &model;
    return nullptr;
}

std::span<const Model* const> autoModels() { return kAutoModels; }

const Model& chosenModel(const Model& model, const ModelParams& params) {
    if (model.kind != ModelKind::Choice) return model;
    const int id = aperturaChoiceIn(params[APERTURA_CHOICE_SLOT]).model;
    if (id < 0 || id >= APERTURA_MODEL_COUNT || kModels[id].autoTag < 0) throw std::logic_error("parameters of `auto` hold no choice");
    return kModels[id];
}

void setChoice(ModelParams& params, const Model& chosen, bool outOfReach) {
    params[APERTURA_CHOICE_SLOT] = aperturaWithChoice(params[APERTURA_CHOICE_SLOT], {chosen.id, outOfReach});
}

namespace {

AperturaAperture withTerms(const vec4& slot) { return aperturaApertureIn(slot, aperturaCapTermsOf(slot.w)); }

// Stored parameters with what the shader reads beside them: lobes within their limits, caps with their terms.
ModelParams completed(const Model& model, const ModelParams& stored) {
    AperturaReceiver r{};
    std::copy(stored.begin(), stored.end(), r.params);
    switch (model.kind) {
        case ModelKind::Quadric: r = aperturaWithQuadric(r, limitQuadric(aperturaQuadricIn(r))); break;
        case ModelKind::Lobes:
            for (int k = 0; k < model.parts; ++k) r.params[k] = limitedLobe(r.params[k]);
            break;
        case ModelKind::Union:
            for (int k = 0; k < model.parts; ++k) r = aperturaWithApertureOfUnion(r, model.parts, k, withTerms(r.params[k]));
            break;
        case ModelKind::Anti:  // the one stored cap serves as either of the two
            r = aperturaWithTwoCaps(r, {withTerms(r.params[0]), withTerms(r.params[0]), aperturaTwoCapsIn(r).weight, 0});
            break;
        case ModelKind::CapAnti: {
            // The formula evaluates a cap larger than a hemisphere through its complement, so it needs the terms of that.
            auto smaller = [](const vec4& slot) { return aperturaApertureIn(slot, aperturaCapTermsOf(std::min(slot.w, 2 - slot.w))); };
            r = aperturaWithTwoCaps(
                r, {smaller(r.params[0]), smaller(r.params[1]), aperturaTwoCapsIn(r).weight, dot(vec3(r.params[0]), vec3(r.params[1]))});
            break;
        }
        default: break;
    }
    return paramsOf(r);
}

}  // namespace

ModelParams toParams(const Model& model, const Visibility& visibility, const ModelParams* stored, const vec3& anyNormal) {
    const float squared = dot(anyNormal, anyNormal);
    const vec3 normal = squared > 0 && std::isfinite(squared) ? anyNormal / std::sqrt(squared) : vec3(0, 1, 0);
    if (!stored) return model.fromVisibility ? model.fromVisibility(visibility, normal) : ModelParams{};
    const Model& chosen = chosenModel(model, *stored);
    if (chosen.isStored()) return completed(chosen, *stored);
    ModelParams out = chosen.fromVisibility(visibility, normal);
    out[APERTURA_CHOICE_SLOT] = (*stored)[APERTURA_CHOICE_SLOT];
    return out;
}

float evaluateLight(const Model& model, const AperturaReceiver& receiver, const AperturaCapLight& light) {
    return aperturaIrradianceThrough(model.id, receiver, light, lightClassOf(light.sinRadius));
}

float evaluateSky(const Model& model, const AperturaReceiver& receiver) { return aperturaSkyIrradiance(model.id, receiver); }

}  // namespace apertura
