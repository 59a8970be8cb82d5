#include "apertura/bake/measure/stability.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/sh/cap_reference.h"

namespace apertura {
namespace {

using glm::dvec3;
using std::numbers::pi;
constexpr double kDegree = pi / 180;
constexpr double kLeastShare = 1e-3;  // of the whole light: the least that an error is relative to
const dvec3 kUp(0, 0, 1);

// E / (L pi sin^2 r) through the intersection of caps and the horizon.
double share(std::vector<ExactCap> caps, const dvec3& normal, double radius) {
    for (const ExactCap& cap : caps)
        if (cap.radius <= 0) return 0;
    caps.push_back({normal, pi / 2});
    const double s = std::sin(radius);
    return glm::dot(normal, vectorIrradiance(caps)) / (pi * s * s);
}

double radiusOf(float height) { return std::acos(1 - std::clamp(double(height), 0.0, 2.0)); }

}  // namespace

double exactThroughCap(const SweepFrame& f) {
    if (f.apertureRadius <= 0) return 0;
    return share({{f.aperture, f.apertureRadius}, {f.light, f.lightRadius}}, kUp, f.lightRadius);
}

double exactInModel(const Model& any, const AperturaReceiver& r, const dvec3& light, double radius) {
    const dvec3 n(r.normal);
    const Model& model = chosenModel(any, paramsOf(r));
    const ExactCap lit{light, radius};
    auto cap = [&](int k) { return ExactCap{glm::normalize(dvec3(r.params[k])), radiusOf(r.params[k].w)}; };
    auto through = [&](int k) { return share({lit, cap(k)}, n, radius); };
    const double open = share({lit}, n, radius);
    switch (model.kind) {
        case ModelKind::Area: return open * std::min(double(r.visibility.w) / (2 * pi), 1.0);
        case ModelKind::Aperture: return aperturaOpacityIn(r) * through(0);
        case ModelKind::Anti: return through(0) + double(aperturaTwoCapsIn(r).weight) * (open - through(1) - through(0));
        case ModelKind::CapAnti: {
            const double both = share({lit, cap(0), cap(1)}, n, radius);
            return aperturaTwoCapsIn(r).weight > 0.5f ? open - both : both;
        }
        case ModelKind::Union: {
            double seen = 0;  // inclusion-exclusion
            for (int set = 1; set < 1 << model.parts; ++set) {
                std::vector<ExactCap> caps{lit};
                for (int k = 0; k < model.parts; ++k)
                    if (set >> k & 1) caps.push_back(cap(k));
                seen += (std::popcount(unsigned(set)) % 2 ? 1 : -1) * share(caps, n, radius);
            }
            return seen;
        }
        default: break;
    }
    // Quadrature over directions in the light. The model's visibility in a direction is its formula for a point light.
    const double height = 2 * std::pow(std::sin(radius / 2), 2), s = std::sin(radius);
    static const std::vector<glm::vec3> unit = fibonacciCap(2000, 1);
    const dvec3 u(aperturaTangentTo(vec3(light))), v = glm::cross(light, u);
    double sum = 0;
    for (const glm::vec3& p : unit) {  // uniform in height is uniform in area, so a unit cap's points can be scaled to a smaller one
        const double down = height * (1 - double(p.z)), across = std::sqrt(down * (2 - down)), flat = std::hypot(double(p.x), double(p.y));
        const dvec3 w = (1 - down) * light + across * (double(p.x) * u + double(p.y) * v) / std::max(flat, 1e-12);
        if (glm::dot(n, w) <= 0) continue;
        const AperturaCapLight point = aperturaCapLight(vec3(w), 1e-4f);
        sum += double(aperturaIrradianceThrough(model.id, r, point, APERTURA_LIGHTS_SUN)) / point.area;
    }
    return 2 * height / (s * s) * sum / double(unit.size());
}

namespace {

// All that is open is one cap.
class CapOpening : public OcclusionSource {
public:
    CapOpening(const dvec3& axis, double radius) : axis_(axis), height_(std::cos(radius)) {}
    void occluded(const SurfacePoint&, std::span<const vec3> directions, uint8_t* blocked) const override {
        for (size_t i = 0; i < directions.size(); ++i) blocked[i] = glm::dot(dvec3(directions[i]), axis_) < height_;
    }

private:
    dvec3 axis_;
    double height_;
};

}  // namespace

SweptModel sweepModel(const Model& model, const FitTools& tools, const Sweep& sweep) {
    SweptModel out{&model, {}};
    const vec3 normal(kUp);
    const Recipe* recipe = model.fromVisibility ? nullptr : &recipeFor(model);
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        const SweepFrame* before = i ? &sweep.frames[i - 1] : nullptr;
        if (before && before->aperture == f.aperture && before->apertureRadius == f.apertureRadius && before->axisLength == f.axisLength
            && before->areaScale == f.areaScale) {
            out.receivers.push_back(out.receivers.back());
            continue;
        }
        const double half = std::sin(f.apertureRadius / 2), area = 4 * pi * half * half * f.areaScale;
        const Visibility v{vec3(f.aperture * area * (1 - area / (4 * pi)) * f.axisLength), float(area)};
        Visibility seen = v;
        ModelParams params;
        if (recipe) {
            const CapOpening opening(f.aperture, f.apertureRadius);
            const SurfacePoint point{dvec3(0), normal};
            std::vector<uint8_t> blocked(tools.lattice.directions().size());
            opening.occluded(point, tools.lattice.directions(), blocked.data());
            Samples samples(tools.lattice, blocked);
            samples.source = &opening, samples.point = &point;
            FitOptions fitOptions;
            fitOptions.lambda = 1 / (fitOptions.tolerance * fitOptions.tolerance);
            const BakedPoint baked = makePoint(*recipe, tools, samples, mat3(1), fitOptions);
            params = toParams(model, baked.visibility, &baked.params, normal);
            if (!model.baseline) seen = baked.visibility;
        } else {
            params = toParams(model, v, nullptr, normal);
            // A bake sees only the part of the opening above the horizon.
            if (!model.baseline && f.apertureRadius > 0)
                seen.direction = vec3(vectorIrradiance(std::array{ExactCap{f.aperture, f.apertureRadius}, ExactCap{kUp, pi / 2}}));
        }
        // Interpolation changes the length of axes. Models that are not interpolated get unit axes from their decoder.
        if (model.mixes && f.axisLength != 1)
            for (int k = 0; k < 2; ++k) params[k] = vec4(vec3(params[k]) * float(f.axisLength), params[k].w);
        const AperturaReceiver receiver = toReceiver(seen, params, normal);
        out.receivers.push_back(model.mixes ? aperturaRenormalised(model.id, receiver) : receiver);
    }
    return out;
}

StabilityRow measureSweep(const SweptModel& swept, const Sweep& sweep, const FrameEvaluator& device) {
    const Model& model = *swept.model;
    StabilityRow row{std::string(model.name), std::string(sweep.name), model.baseline};
    row.onDevice = device ? 0 : -1;
    double before = 0, exactBefore = 0, truthBefore = 0;
    std::vector<float> found[4];
    std::vector<AperturaEvaluation> inputs[4];
    std::vector<int> place;
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        AperturaEvaluation e{
            vec4(swept.receivers[i].normal, 0), vec4(vec3(f.light), float(std::sin(f.lightRadius))), swept.receivers[i].visibility, {}};
        std::copy_n(swept.receivers[i].params, APERTURA_MAX_SLOTS, e.params);
        inputs[lightClassOf(e.light.w)].push_back(e);
    }
    if (device)
        for (int lightClass = 0; lightClass < 4; ++lightClass)
            if (!inputs[lightClass].empty()) found[lightClass] = device(model.id, lightClass, inputs[lightClass]);
    size_t taken[4]{};
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        const AperturaCapLight light = aperturaCapLight(vec3(f.light), float(std::sin(f.lightRadius)));
        const int lightClass = lightClassOf(light.sinRadius);
        const float raw = aperturaIrradianceThrough(model.id, swept.receivers[i], light, lightClass);
        const double value = light.area > 0 ? double(raw) / light.area : 0;
        ++row.frames;
        const size_t at = taken[lightClass]++;
        if (!std::isfinite(raw) || (device && !std::isfinite(found[lightClass][at]))) {
            ++row.notFinite;
            continue;
        }
        if (device)
            row.onDevice = std::max(row.onDevice, std::abs(double(found[lightClass][at]) - raw) / std::max(double(light.area), 1e-12));
        const double unblocked = aperturaUnoccludedIrradiance(vec3(kUp), light, APERTURA_LIGHTS_ANY) / std::max(light.area, 1e-30f);
        row.outside += value < -1e-6 || value > 1.006 * unblocked + kAboveOne;
        const double truth = exactThroughCap(f);
        const double exact = model.baseline ? truth : exactInModel(model, swept.receivers[i], f.light, f.lightRadius);
        const double smaller = std::sin(std::min({f.apertureRadius, f.lightRadius, pi / 2})) / std::sin(f.lightRadius);
        const double error = std::abs(value - exact) / std::max(smaller * smaller, kLeastShare);
        if (error > row.error) row.error = error, row.worst = double(i) / double(sweep.frames.size() - 1);
        row.modelError = std::max(row.modelError, std::abs(value - truth));
        if (f.moved > 0) {
            const double bound = stepBound(f.moved, f.lightRadius);
            row.step = std::max(row.step, std::abs(value - before) / bound);
            row.exactStep = std::max({row.exactStep, std::abs(exact - exactBefore) / bound, std::abs(truth - truthBefore) / bound});
        }
        before = value, exactBefore = exact, truthBefore = truth;
    }
    return row;
}

std::vector<FailurePoint> failureMap(const Model& model, const FitTools& tools) {
    std::vector<FailurePoint> out;
    const dvec3 axis = tilted(35 * kDegree);
    for (const double light : {0.27, 5.0, 15.0, 45.0})
        for (int a = 0; a < 18; ++a) {
            const double aperture = 0.5 * std::pow(180, a / 17.0);  // 0.5 to 90 degrees
            for (int d = 0; d <= 22; ++d) {
                Sweep sweep{"", "", {}};
                for (int turn = 0; turn < 4; ++turn) {
                    const double angle = std::min((light + aperture) * kDegree * d / 20.0, pi);
                    const dvec3 u = away(axis, pi / 2), v = glm::cross(axis, u),
                                side = std::cos(turn * pi / 2) * u + std::sin(turn * pi / 2) * v;
                    sweep.frames.push_back({axis, aperture * kDegree, std::cos(angle) * axis + std::sin(angle) * side, light * kDegree});
                }
                const StabilityRow row = measureSweep(sweepModel(model, tools, sweep), sweep, nullptr);
                out.push_back({std::string(model.name), light, aperture, d / 20.0, row.notFinite ? 1e9 : row.error});
            }
        }
    return out;
}

}  // namespace apertura
