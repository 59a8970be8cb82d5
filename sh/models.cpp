#include "sh/models.h"

#include <algorithm>
#include <cmath>

#include "sh/aperture.h"
#include "sh/soft.h"

namespace apertura {
namespace {

ModelParams nothing(const Visibility&, const vec3&) { return {}; }

vec4 slotOf(const Aperture& a) { return vec4(a.axis, a.height); }

ModelParams oneCap(const Visibility& v, const vec3& normal) {
    const Aperture a = toAperture(v, normal);
    return {slotOf(a), vec4(0, a.terms)};
}

// The cap of uniform opacity with all four numbers: its height from |D| / A, which is 1 - height / 2.
ModelParams alphaCap(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    Aperture a = toAperture(v, normal);
    const float share = v.area > 0 ? length(v.direction) / v.area : 1;
    const float area = a.height;
    a.height = std::clamp(2 - 2 * share, area, 2.0f);
    return {slotOf(a), vec4(a.height > 0 ? area / a.height : 0, capTermsOf(a.height))};
}

// The cap and the anti-cap of the blocked part, weighed by which of the two is nearer to being a cap.
ModelParams capAndAnti(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const Visibility blocked{PI * normal - v.direction, 2 * PI - v.area};
    auto deficit = [](const Visibility& x) {
        return std::max(x.area * (1 - x.area / (4 * PI)) - length(x.direction), 0.0f);
    };
    const float open = deficit(v), closed = deficit(blocked);
    const float sum = open + closed;
    const Aperture cap = toAperture(v, normal), anti = toAperture(blocked, normal);
    return {slotOf(cap), slotOf(anti), vec4(sum > 1e-6f ? open / sum : 0, 0, cap.terms.z, anti.terms.z),
            vec4(vec2(cap.terms), vec2(anti.terms))};
}

// No number of a lobe reaches beyond what 16 bits can square, anywhere on the sphere.
constexpr double kFarthest = 250;

// A lobe's edge no harder than a sun's is wide: a point-like light would step over a harder one. The lobe keeps the area of
// the sphere that it lets through, or keeps back where that is less: 2 pi / S times the integral of softStep up to its value f at
// the axis, (f + sqrt(1 + f^2)) / 2. (Where the horizon cuts it, the part above changes.)
vec4 limitSharpness(const vec4& lobe) {
    constexpr double kSharpest = 240;
    const double sharp = length(dvec3(lobe)), side = lobe.w > 0 ? -1 : 1;
    if (!(sharp > kSharpest) && !(sharp + std::abs(lobe.w) > kFarthest)) return lobe;
    if (sharp < 1e-6) return vec4(vec3(0), float(-side * kFarthest));
    const double peak = sharp + side * lobe.w, root = std::sqrt(1 + peak * peak);
    const double height = std::clamp((peak > 0 ? peak + root : 1 / (root - peak)) / (2 * sharp), 1e-12, 1.0);  // area / 2 pi
    // Of slope S that area needs f = S height - 1 / (4 S height), and the offset f - S. The sharpest S whose numbers stay
    // within bounds solves S + (S - f) = kFarthest; of an area too small for any, the faintest lobe is taken.
    const double left = kFarthest * kFarthest - (2 - height) / height;
    const double S = std::min({(kFarthest + std::sqrt(std::max(left, 0.0))) / (2 * (2 - height)), sharp, kSharpest});
    const double f = std::max(S * height - 1 / (4 * S * height), 2 * S - kFarthest);
    return vec4(vec3(dvec3(lobe) * (S / sharp)), float(side * (f - S)));
}

// A quadric within the same bounds; its edge becomes softer, its area stays nearly.
void limitQuadric(vec4& lobe, vec4& bend, float& bendYz) {
    const double reach = length(dvec3(lobe)) + std::abs(lobe.w) + std::sqrt(glm::dot(glm::dvec4(bend), glm::dvec4(bend)) + double(bendYz) * bendYz);
    const float scale = float(std::min(1.0, kFarthest / std::max(reach, 1e-6)));
    lobe *= scale, bend *= scale, bendYz *= scale;
}

ModelParams oneLobe(const Visibility& v, const vec3& normal) {
    const SoftAperture s = toSoft(v, normal);
    return {limitSharpness(vec4(s.slope, s.offset))};
}

using enum Field;
constexpr Model kModels[] = {
    {MODEL_UNSHADOWED, "unshadowed", 0, 0, true, true, "N.L, no visibility: the baseline of cost", nothing, {}, 0, -1},
    {MODEL_AO, "ao", 1, 0, true, true, "visible area alone", nothing, {}, 0, -1},
    {MODEL_SH_L1, "sh-l1", 4, 0, true, true, "SH bands 0 and 1 of visibility, evaluated at the light", nothing, {}, 0, -1},
    {MODEL_SH_L2, "sh-l2", 9, 2, true, true, "SH bands 0 to 2", nullptr, {Bands2}, 1, -1},
    {MODEL_SH_L4, "sh-l4", 25, 6, true, true, "SH bands 0 to 4", nullptr, {Bands4}, 1, -1},
    {MODEL_OAT, "oat", 3, 1, true, true, "aperture, formula as published in 2006", oneCap, {}, 0, -1},
    {MODEL_APERTURE, "aperture", 3, 2, false, false, "aperture, exact overlap of caps within 0.003", oneCap, {}, 0, -1},
    {MODEL_ALPHA, "alpha", 4, 2, false, false, "translucent aperture with all four numbers", alphaCap, {}, 0, -1},
    {MODEL_ANTI, "anti", 4, 4, false, false, "aperture, anti-aperture or a blend of both", capAndAnti, {Cap}, 1, 2},
    {MODEL_SOFT, "soft", 4, 1, true, false, "soft-edged aperture, uses all four numbers", oneLobe, {}, 0, -1},
    {MODEL_FIRM_2, "firm-2", 6, 3, false, false, "two hard-edged lobes", nullptr, {HardLobe, HardLobe}, 2, 2},
    {MODEL_SOFT_2, "soft-2", 8, 3, false, false, "two soft lobes", nullptr, {Lobe, Lobe}, 2, 2},
    {MODEL_SOFT_L2, "soft-l2", 9, 3, true, false, "soft aperture with a quadratic exponent", nullptr, {Lobe, Bend}, 2, -1},
    {MODEL_FIRM_3, "firm-3", 9, 4, false, false, "three hard-edged lobes", nullptr, {HardLobe, HardLobe, HardLobe}, 3, 3},
    {MODEL_FIRM_4, "firm-4", 12, 5, false, false, "four hard-edged lobes", nullptr, {HardLobe, HardLobe, HardLobe, HardLobe}, 4, 4},
    {MODEL_MULTI_2, "multi-2", 6, 3, false, false, "two apertures", nullptr, {Cap, Cap}, 2, -1},
    {MODEL_MULTI_3, "multi-3", 9, 5, false, false, "three apertures", nullptr, {Cap, Cap, Cap}, 3, -1},
    {MODEL_MULTI_4, "multi-4", 12, 6, false, false, "four apertures", nullptr, {Cap, Cap, Cap, Cap}, 4, -1},
    {MODEL_CAP_ANTI, "cap-anti", 6, 4, false, false, "two of aperture and anti-aperture", nullptr, {Cap, Cap}, 2, 2},
    {MODEL_HORIZON, "horizon", 16, 4, false, true, "horizon at 16 azimuths: the rival", nullptr, {Heights}, 1, -1},
    {MODEL_AUTO, "auto", 0, 5, false, false, "the least model, chosen for each point", nullptr, {}, 0, -1},
};
static_assert(std::size(kModels) == MODEL_COUNT);
static_assert([] {
    for (int i = 0; i < MODEL_COUNT; ++i)
        if (kModels[i].id != i || kModels[i].slots > MAX_SLOTS) return false;
    return true;
}());

}  // namespace

std::span<const Model> models() { return kModels; }

const Model* findModel(std::string_view name) {
    for (const Model& model : kModels)
        if (model.name == name) return &model;
    return nullptr;
}

namespace {

// Stored lobes with their sharpness limited, and the sizes of stored caps in the slots behind them where the shaders look for them.
ModelParams withCapTerms(const Model& model, ModelParams params) {
    if (model.id == MODEL_SOFT_L2) {
        limitQuadric(params[0], params[1], params[2].x);
        return params;
    }
    for (int k = 0; k < model.storedFields && (model.stored[size_t(k)] == Lobe || model.stored[size_t(k)] == HardLobe); ++k)
        params[size_t(k)] = limitSharpness(params[size_t(k)]);
    int caps = 0;
    while (caps < model.storedFields && model.stored[size_t(caps)] == Cap) ++caps;
    const int behind = model.combineSlot >= 0 ? model.combineSlot + 1 : caps;
    for (int k = 0; k < caps; ++k) {
        const float height = params[size_t(k)].w;
        // Of a product of caps, the complement of one over a hemisphere is what is evaluated.
        const vec3 terms = capTermsOf(model.id == MODEL_CAP_ANTI ? std::min(height, 2 - height) : height);
        vec4& slot = params[size_t(behind + k / 2)];
        (k % 2 ? slot.z : slot.x) = terms.x;
        (k % 2 ? slot.w : slot.y) = terms.y;
        if (model.id == MODEL_CAP_ANTI) (k % 2 ? params[2].w : params[2].z) = terms.z;
    }
    if (model.id == MODEL_CAP_ANTI) params[2].y = dot(vec3(params[0]), vec3(params[1]));
    return params;
}

}  // namespace

ModelParams toParams(const Model& model, const Visibility& visibility, const ModelParams* stored, const vec3& anyNormal) {
    const float squared = dot(anyNormal, anyNormal);
    const vec3 normal = squared > 0 && std::isfinite(squared) ? anyNormal / std::sqrt(squared) : vec3(0, 1, 0);
    if (!stored) return model.fromVisibility ? model.fromVisibility(visibility, normal) : ModelParams{};
    if (model.id == MODEL_ANTI) {
        const vec3 terms = capTermsOf((*stored)[0].w);
        return {(*stored)[0], (*stored)[0], vec4((*stored)[2].x, 0, terms.z, terms.z), vec4(vec2(terms), vec2(terms))};
    }
    const Model& chosen = kModels[chosenModel(model.id, *stored)];
    if (!chosen.fromVisibility) return withCapTerms(chosen, *stored);
    ModelParams out = chosen.fromVisibility(visibility, normal);
    out[4] = (*stored)[4];
    return out;
}

}  // namespace apertura
