#include "bake/stability.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "bake/choose.h"
#include "bake/receivers.h"
#include "runtime/form_stream.h"
#include "bake/watch.h"
#include "sh/cap_reference.h"

namespace apertura {
namespace {

using glm::dvec3;
constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr float kAboveOne = 0.012f;   // of the light overhead, that is let pass above the unblocked light
constexpr double kLeastShare = 1e-3;  // of the light, that an error is measured against
const dvec3 kUp(0, 0, 1);

// A direction `angle` radians from +Z, towards +X turned by `turn`.
dvec3 tilted(double angle, double turn = 0) {
    return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
}

// `axis` moved by `angle` towards +X's side of the great circle through +Y.
dvec3 away(const dvec3& axis, double angle) {
    const dvec3 across = glm::normalize(glm::cross(dvec3(0, 1, 0), axis));
    return std::cos(angle) * axis + std::sin(angle) * across;
}

template <typename Frame>
Sweep makeSweep(std::string_view name, std::string_view what, int frames, Frame&& frame) {
    Sweep out{name, what, {}};
    for (int i = 0; i < frames; ++i) out.frames.push_back(frame(double(i) / (frames - 1)));
    for (size_t i = 1; i < out.frames.size(); ++i) {
        SweepFrame &now = out.frames[i], &before = out.frames[i - 1];
        const double moved = 2 * std::asin(std::min(0.5 * glm::length(now.light - before.light), 1.0));
        const bool alone = now.aperture == before.aperture && now.apertureRadius == before.apertureRadius && now.lightRadius == before.lightRadius;
        now.moved = alone ? moved : 0;
    }
    return out;
}

// A light that crosses an aperture from beyond one edge to beyond the other.
Sweep crossing(std::string_view name, std::string_view what, double aperture, double light, double tilt, int frames) {
    const double reach = aperture + 1.5 * light;
    return makeSweep(name, what, frames, [=](double t) {
        const dvec3 axis = tilted(tilt);
        return SweepFrame{axis, aperture, away(axis, reach * (2 * t - 1)), light};
    });
}

// E / (L pi sin^2 r) through the intersection of caps and the horizon.
double share(std::vector<ExactCap> caps, const dvec3& normal, double radius) {
    for (const ExactCap& cap : caps)
        if (cap.radius <= 0) return 0;
    caps.push_back({normal, kPi / 2});
    const double s = std::sin(radius);
    return glm::dot(normal, vectorIrradiance(caps)) / (kPi * s * s);
}

double radiusOf(float height) { return std::acos(1 - std::clamp(double(height), 0.0, 2.0)); }

double linkOf(double f) { return 0.5 + 0.5 * f / std::sqrt(1 + f * f); }

// The visibility of a model of lobes in one direction.
double lobesAt(const Model& model, const Receiver& r, const dvec3& w) {
    auto lobe = [&](int k) { return linkOf(double(r.form[k].w) + glm::dot(dvec3(r.form[k]), w)); };
    if (model.id == MODEL_SOFT) return lobe(0);
    if (model.id == MODEL_SOFT_L2) {
        const SoftQuadric q{vec3(r.form[0]), r.form[0].w, r.form[1], r.form[2].x};
        return linkOf(double(q.offset) + glm::dot(dvec3(q.slope) + dvec3(bendTimes(q, vec3(w))), w));
    }
    const int count = model.numbers == 12 ? 4 : model.numbers == 9 ? 3 : 2;
    vec4 each(1);
    for (int k = 0; k < count; ++k) each[k] = float(lobe(k));
    return lobesTogether(count, plainProducts(each), r.form[count]);
}

}  // namespace

// What shrinks to nothing ends at 3 seconds of arc: an axis in float32 holds no more.
std::vector<Sweep> singularSweeps() {
    const double sun = 0.00465;
    std::vector<Sweep> out;
    out.push_back(makeSweep("light opposite the axis", "a 30 degree light passes through the antipode of a 60 degree aperture's axis", 201, [](double t) {
        const dvec3 axis = tilted(50 * kDegree);
        return SweepFrame{axis, 60 * kDegree, away(-axis, (t - 0.5) * 0.2), 30 * kDegree};
    }));
    out.push_back(makeSweep("equal caps, one direction", "aperture and light are the same cap, and both shrink to nothing", 201, [](double t) {
        const double r = 0.5 * std::pow(10, -4.5 * t);
        return SweepFrame{tilted(0.4), r, tilted(0.4), r};
    }));
    out.push_back(crossing("through distance 0", "a 5 degree light crosses a 5 degree aperture: equal radii, d from 2r through 0 to 2r", 5 * kDegree, 5 * kDegree, 0.5, 401));
    out.push_back(crossing("equal radii of 30 degrees", "a 30 degree light crosses a 30 degree aperture", 30 * kDegree, 30 * kDegree, 0.4, 401));
    out.push_back(crossing("sun over a 50 degree aperture", "its edges", 50 * kDegree, sun, 0.2, 4001));
    out.push_back(crossing("sun over a 2 degree aperture", "its edges", 2 * kDegree, sun, 0.5, 401));
    out.push_back(makeSweep("sun across the horizon", "everything is open", 201, [=](double t) {
        return SweepFrame{kUp, kPi / 2, tilted(kPi / 2 + sun * (1.5 - 3 * t)), sun};
    }));
    out.push_back(makeSweep("15 degree light across the horizon", "everything is open", 401, [](double t) {
        return SweepFrame{kUp, kPi / 2, tilted(kPi / 2 + 15 * kDegree * (1.5 - 3 * t)), 15 * kDegree};
    }));
    out.push_back(makeSweep("15 degree light across the horizon, aperture aside", "of an aperture of 60 degrees that the horizon cuts", 401, [](double t) {
        return SweepFrame{tilted(70 * kDegree), 60 * kDegree, tilted(kPi / 2 + 15 * kDegree * (1.5 - 3 * t)), 15 * kDegree};
    }));
    out.push_back(makeSweep("half a sky of light", "90 degrees, over a 30 degree aperture that tilts from 0 to 90 degrees", 201, [](double t) {
        return SweepFrame{tilted(t * kPi / 2), 30 * kDegree, kUp, kPi / 2};
    }));
    out.push_back(makeSweep("light shrinks to nothing", "at the edge of a 30 degree aperture", 201, [](double t) {
        return SweepFrame{tilted(0.3), 30 * kDegree, away(tilted(0.3), 30 * kDegree), 0.5 * std::pow(10, -4.5 * t)};
    }));
    out.push_back(makeSweep("aperture shrinks to nothing", "inside a 5 degree light", 201, [](double t) {
        return SweepFrame{tilted(0.3), 0.5 * std::pow(10, -4.5 * t), away(tilted(0.3), 2 * kDegree), 5 * kDegree};
    }));
    out.push_back(makeSweep("aperture opens to all", "from a hemisphere to everything and beyond, under a 5 degree light", 201, [](double t) {
        SweepFrame f{kUp, kPi / 2, tilted(1.2), 5 * kDegree};
        f.areaScale = 1 + 1e-6 + t * t;
        return f;
    }));
    out.push_back(makeSweep("axis of another length", "0.9995 to 1.0005, as 8 bits give, sun inside and at the edge", 201, [=](double t) {
        SweepFrame f{tilted(0.3), 0.6, away(tilted(0.3), 0.6), sun};
        f.axisLength = 0.9995 + 0.001 * t;
        return f;
    }));
    out.push_back(makeSweep("axis of no length", "1 to 0, under a 5 degree light", 201, [](double t) {
        SweepFrame f{tilted(0.3), 0.6, tilted(0.5), 5 * kDegree};
        f.axisLength = 1 - t;
        return f;
    }));
    out.push_back(crossing("3 and 10 degrees: just below", "a light of 2.99 degrees crosses an aperture of 40", 40 * kDegree, 2.99 * kDegree, 0.5, 801));
    out.push_back(crossing("3 and 10 degrees: above 3", "a light of 3.05 degrees", 40 * kDegree, 3.05 * kDegree, 0.5, 801));
    out.push_back(crossing("3 and 10 degrees: below 10", "a light of 9.95 degrees", 40 * kDegree, 9.95 * kDegree, 0.5, 401));
    out.push_back(crossing("3 and 10 degrees: above 10", "a light of 10.05 degrees", 40 * kDegree, 10.05 * kDegree, 0.5, 401));
    return out;
}

double exactThroughCap(const SweepFrame& f) {
    if (f.apertureRadius <= 0) return 0;
    return share({{f.aperture, f.apertureRadius}, {f.light, f.lightRadius}}, kUp, f.lightRadius);
}

double exactInModel(const Model& any, const Receiver& r, const dvec3& light, double radius) {
    const dvec3 n(r.normal);
    const Model& model = models()[size_t(any.id == MODEL_AUTO ? int(r.form[4].y + 0.5f) : any.id)];
    const ExactCap lit{light, radius};
    auto cap = [&](int k) { return ExactCap{glm::normalize(dvec3(r.form[k])), radiusOf(r.form[k].w)}; };
    auto through = [&](int k) { return share({lit, cap(k)}, n, radius); };
    const double open = share({lit}, n, radius);
    switch (model.id) {
        case MODEL_APERTURE: return through(0);
        case MODEL_ALPHA: return double(r.form[1].x) * through(0);
        case MODEL_ANTI: return through(0) + double(r.form[2].x) * (open - through(1) - through(0));
        case MODEL_CAP_ANTI: {
            const double both = share({lit, cap(0), cap(1)}, n, radius);
            return r.form[2].x > 0.5f ? open - both : both;
        }
        case MODEL_MULTI_2:
        case MODEL_MULTI_3:
        case MODEL_MULTI_4: {
            double seen = 0;  // by inclusion and exclusion
            const int count = model.numbers / 3;
            for (int set = 1; set < 1 << count; ++set) {
                std::vector<ExactCap> caps{lit};
                for (int k = 0; k < count; ++k)
                    if (set >> k & 1) caps.push_back(cap(k));
                seen += (std::popcount(unsigned(set)) % 2 ? 1 : -1) * share(caps, n, radius);
            }
            return seen;
        }
        case MODEL_AO: return open * std::min(double(r.visibility.w) / (2 * kPi), 1.0);
        default: break;
    }
    const double height = 2 * std::pow(std::sin(radius / 2), 2), s = std::sin(radius);
    static const std::vector<glm::vec3> unit = capLattice(2000, 1);
    const dvec3 u(tangentTo(vec3(light))), v = glm::cross(light, u);
    double sum = 0;
    for (const glm::vec3& p : unit) {  // even in height is even in area, of a smaller cap too
        const double down = height * (1 - double(p.z)), across = std::sqrt(down * (2 - down)), flat = std::hypot(double(p.x), double(p.y));
        const dvec3 w = (1 - down) * light + across * (double(p.x) * u + double(p.y) * v) / std::max(flat, 1e-12);
        const double z = glm::dot(n, w);
        if (z > 0) sum += z * lobesAt(model, r, w);
    }
    return 2 * height / (s * s) * sum / double(unit.size());
}

SweptModel sweepModel(const Model& model, const FitTools& tools, const Sweep& sweep) {
    SweptModel out{&model, {}};
    const vec3 normal(kUp);
    const Recipe* recipe = model.fromVisibility ? nullptr : findRecipe(model.name);
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        const SweepFrame* before = i ? &sweep.frames[i - 1] : nullptr;
        if (before && before->aperture == f.aperture && before->apertureRadius == f.apertureRadius && before->axisLength == f.axisLength
            && before->areaScale == f.areaScale) {
            out.receivers.push_back(out.receivers.back());
            continue;
        }
        const double half = std::sin(f.apertureRadius / 2), area = 4 * kPi * half * half * f.areaScale;
        const Visibility v{vec3(f.aperture * area * (1 - area / (4 * kPi)) * f.axisLength), float(area)};
        Form form;
        if (recipe) {
            std::vector<uint8_t> blocked;
            for (const vec3& w : tools.lattice.directions()) blocked.push_back(glm::dot(dvec3(w), f.aperture) < std::cos(f.apertureRadius));
            FitOptions how;
            how.price = 1 / (how.tolerance * how.tolerance);
            const BakedPoint point = makePoint(*recipe, tools, Samples(tools.lattice, blocked), mat3(1), how);
            form = toForm(model, point.visibility, &point.form, normal);
        } else {
            form = toForm(model, v, nullptr, normal);
        }
        // As mixing leaves it; models that are not mixed have axes from a decoder, which makes them unit.
        if (model.mixes && f.axisLength != 1)
            for (int k = 0; k < 2; ++k) form[k] = vec4(vec3(form[k]) * float(f.axisLength), form[k].w);
        const Receiver receiver = toReceiver(v, form, normal);
        out.receivers.push_back(model.mixes ? settled(model.id, receiver) : receiver);
    }
    return out;
}

StabilityRow measureSweep(const SweptModel& swept, const Sweep& sweep, const FrameEvaluator& device) {
    const Model& model = *swept.model;
    StabilityRow row{std::string(model.name), std::string(sweep.name), model.baseline};
    row.onDevice = device ? 0 : -1;
    double before = 0, exactBefore = 0, truthBefore = 0;
    std::vector<float> found[4];
    std::vector<Evaluation> inputs[4];
    std::vector<int> place;
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        Evaluation e{vec4(swept.receivers[i].normal, 0), vec4(vec3(f.light), float(std::sin(f.lightRadius))), swept.receivers[i].visibility, {}};
        std::copy_n(swept.receivers[i].form, MAX_SLOTS, e.form);
        inputs[lightsOf(e.light.w)].push_back(e);
    }
    if (device)
        for (int size = 0; size < 4; ++size)
            if (!inputs[size].empty()) found[size] = device(model.id, size, inputs[size]);
    size_t taken[4]{};
    for (size_t i = 0; i < sweep.frames.size(); ++i) {
        const SweepFrame& f = sweep.frames[i];
        const CapLight light = capLight(vec3(f.light), float(std::sin(f.lightRadius)));
        const int size = lightsOf(light.sinRadius);
        const float raw = lightThrough(model.id, swept.receivers[i], light, size);
        const double value = light.area > 0 ? double(raw) / light.area : 0;
        ++row.frames;
        const size_t at = taken[size]++;
        if (!std::isfinite(raw) || (device && !std::isfinite(found[size][at]))) {
            ++row.notFinite;
            continue;
        }
        if (device) row.onDevice = std::max(row.onDevice, std::abs(double(found[size][at]) - raw) / std::max(double(light.area), 1e-12));
        const double unblocked = lightOnSurface(vec3(kUp), light, LIGHTS_ANY) / std::max(light.area, 1e-30f);
        row.outside += value < -1e-6 || value > 1.006 * unblocked + kAboveOne;
        const double truth = exactThroughCap(f);
        const double exact = model.baseline ? truth : exactInModel(model, swept.receivers[i], f.light, f.lightRadius);
        const double smaller = std::sin(std::min({f.apertureRadius, f.lightRadius, kPi / 2})) / std::sin(f.lightRadius);
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
                    const double angle = std::min((light + aperture) * kDegree * d / 20.0, kPi);
                    const dvec3 u = away(axis, kPi / 2), v = glm::cross(axis, u), side = std::cos(turn * kPi / 2) * u + std::sin(turn * kPi / 2) * v;
                    sweep.frames.push_back({axis, aperture * kDegree, std::cos(angle) * axis + std::sin(angle) * side, light * kDegree});
                }
                const StabilityRow row = measureSweep(sweepModel(model, tools, sweep), sweep, nullptr);
                out.push_back({std::string(model.name), light, aperture, d / 20.0, row.notFinite ? 1e9 : row.error});
            }
        }
    return out;
}

HostileInput hostileInput(const Model& model, uint32_t seed, uint64_t index) {
    uint64_t draw = 0;
    auto unit = [&] { return hashUnit(seed, index, 1 + draw++); };
    auto among = [&](std::initializer_list<float> values) { return values.begin()[size_t(unit() * double(values.size()))]; };
    auto direction = [&] { return vec3(tilted(std::acos(1 - 2 * unit()), 2 * kPi * unit())); };
    auto corner = [&] { return vec3(among({-1, 0, 1}), among({-1, 0, 1}), among({0, 1})); };
    auto axis = [&](const vec3& other) {
        const double kind = unit();
        if (kind < 0.5) return direction();
        if (kind < 0.6) return other;
        if (kind < 0.7) return -other;
        if (kind < 0.8) return vec3(among({0.0f, -0.0f}), among({0.0f, 1.0f, -1.0f}), 0.0f);
        if (kind < 0.9) return direction() * among({0.9995f, 1.0005f, 1e-20f, 1e-4f, 30.0f, 1e10f});
        return corner();
    };
    HostileInput out;
    const vec3 normal = unit() < 0.8 ? direction() : axis(direction());
    const vec3 light = axis(normal);
    const float sine = unit() < 0.6 ? float(std::pow(10, -5 * unit())) : among({0.0f, 1e-30f, 1e-8f, 1e-4f, 0.00465f, 0.0105f, 0.0524f, 0.1737f, 0.7071f, 1.0f});
    auto form = [&] {
        const float pi = float(kPi);
        const float area = unit() < 0.6 ? float(2 * kPi * unit()) : among({0.0f, 1e-38f, 1e-9f, 1e-4f, pi, 2 * pi, 6.2831860f, 7.0f, 4 * pi, 1e30f, -1.0f});
        const float share = unit() < 0.5 ? float(unit()) : among({0.0f, 1.0f, 1.0001f, 1e-6f, 10.0f});
        const Visibility v{axis(unit() < 0.5 ? normal : light) * std::clamp(area * (1 - area / (4 * pi)) * share, -1e30f, 1e30f), area};
        const Model* stored = &model;
        if (model.id == MODEL_AUTO) stored = &models()[size_t(autoChoices()[size_t(unit() * double(autoChoices().size()))])];
        std::vector<float> numbers(size_t(storedNumbers(*stored)) + 1);
        for (float& n : numbers) n = unit() < 0.7 ? float(2 * unit() - 1) : among({-1.0f, 1.0f, 0.0f, -0.0f, 1 / 127.0f, -1 / 127.0f, 1e-20f});
        Form raw = unpackForm(*stored, numbers);
        if (model.id == MODEL_AUTO) raw[4].y = float(stored->id);
        const bool hasForm = stored->storedFields > 0 || model.id == MODEL_AUTO;
        const Visibility possible = clampToPossible(v);
        return toReceiver(possible, toForm(model, v, hasForm ? &raw : nullptr, normal), normal);
    };
    out.receiver = form();
    if (model.mixes && unit() < 0.3) {
        const Receiver other = form();
        const float t = among({0.0f, 0.5f, 0.25f, 1.0f});
        out.receiver.visibility = mix(out.receiver.visibility, other.visibility, t);
        for (int k = 0; k < MAX_SLOTS; ++k) out.receiver.form[k] = mix(out.receiver.form[k], other.form[k], t);
        out.receiver = settled(model.id, out.receiver);
    }
    out.light = vec4(light, sine);
    out.sound = std::abs(dot(normal, normal) - 1) < 1e-5f && std::abs(dot(light, light) - 1) < 1e-5f;
    return out;
}

HostileCount countHostile(const Model& model, uint32_t seed, uint64_t inputs, const FrameEvaluator& device) {
    const uint64_t batch = device ? 1 << 18 : 1 << 14;  // the device is set up for each
    const uint64_t batches = (inputs + batch - 1) / batch;
    std::vector<HostileCount> counts(batches);
    auto judge = [](HostileCount& count, float e, const HostileInput& input) {
        const CapLight light = capLight(vec3(input.light), input.light.w);
        ++count.inputs;
        count.notFinite += !std::isfinite(e);
        count.outside += input.sound && (e < -1e-6f * light.area || e > 1.006f * lightOnSurface(input.receiver.normal, light, LIGHTS_ANY) + kAboveOne * light.area);
    };
    auto onProcessor = [&](uint64_t b) {
        for (uint64_t i = b * batch; i < std::min(inputs, (b + 1) * batch); ++i) {
            const HostileInput input = hostileInput(model, seed, i);
            judge(counts[b], lightThrough(model.id, input.receiver, capLight(vec3(input.light), input.light.w), lightsOf(input.light.w)), input);
        }
    };
    auto onDevice = [&](uint64_t b) {
        std::vector<HostileInput> all[4];
        std::vector<Evaluation> frames[4];
        for (uint64_t i = b * batch; i < std::min(inputs, (b + 1) * batch); ++i) {
            const HostileInput input = hostileInput(model, seed, i);
            const auto size = size_t(lightsOf(input.light.w));
            Evaluation e{vec4(input.receiver.normal, 0), input.light, input.receiver.visibility, {}};
            std::copy_n(input.receiver.form, MAX_SLOTS, e.form);
            frames[size].push_back(e);
            all[size].push_back(input);
        }
        for (size_t size = 0; size < 4; ++size) {
            if (frames[size].empty()) continue;
            const std::vector<float> found = device(model.id, int(size), frames[size]);
            for (size_t i = 0; i < found.size(); ++i) judge(counts[b], found[i], all[size][i]);
        }
    };
    if (device)
        for (uint64_t b = 0; b < batches; ++b) onDevice(b);
    else
        tbb::parallel_for(uint64_t(0), batches, onProcessor);
    HostileCount sum;
    for (const HostileCount& c : counts) sum.inputs += c.inputs, sum.notFinite += c.notFinite, sum.outside += c.outside;
    return sum;
}

namespace {

// The receivers of a scene as models have them, one after another: use(point, frame, model, receiver).
template <typename Use>
void forReceivers(const Scene& scene, const std::vector<const Model*>& asked, int receivers, int rays, uint32_t seed, const Progress& progress, Use&& use) {
    const Tracer tracer(scene);
    std::vector<SurfacePoint> points;
    for (const SpreadPoint& p : spreadReceivers(scene, receivers, seed)) points.push_back(p.at);
    const FitTools tools(rays);
    BakeOptions bake;
    bake.rays = rays;
    bake.seed = seed;
    FitOptions how;
    how.price = 1 / (how.tolerance * how.tolerance);
    samplePoints(tracer, points, tools.lattice, bake, progress, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        for (size_t m = 0; m < asked.size(); ++m) {
            const Model& model = *asked[m];
            const Recipe& recipe = *findRecipe(model.fromVisibility ? "sh" : model.name);
            const BakedPoint point = makePoint(recipe, tools, samples, frame, how);
            use(i, frame, m, toReceiver(point.visibility, toForm(model, point.visibility, recipe.model >= 0 ? &point.form : nullptr, points[i].normal), points[i].normal));
        }
    });
}

// Calls use(light, first) for two arcs of lights of a radius, degrees, across the sky above `frame`, a step at a time.
template <typename Use>
void forArcs(const glm::mat3& frame, uint32_t seed, size_t index, double degrees, double step, Use&& use) {
    const double radius = degrees * kDegree;
    for (int arc = 0; arc < 2; ++arc) {
        const double turn = kPi * (hashUnit(seed, index, 7) + 0.5 * arc);
        bool first = true;
        for (double a = -kPi / 2 - 1.2 * radius; a < kPi / 2 + 1.2 * radius; a += step, first = false)
            use(capLight(frame * vec3(tilted(a, turn)), float(std::sin(radius))), first);
    }
}

}  // namespace

std::vector<SceneSteps> measureSceneSteps(const Scene& scene, const std::vector<const Model*>& asked, int receivers, int rays, uint32_t seed,
                                          const std::vector<double>& radii, const Progress& progress) {
    std::vector<std::vector<double>> largest(size_t(receivers), std::vector<double>(asked.size() * radii.size()));
    forReceivers(scene, asked, receivers, rays, seed, progress, [&](size_t i, const glm::mat3& frame, size_t m, const Receiver& receiver) {
        for (size_t r = 0; r < radii.size(); ++r) {
            const double step = std::min(radii[r] * kDegree / 6, kDegree);
            double before = 0;
            forArcs(frame, seed, i, radii[r], step, [&](const CapLight& light, bool first) {
                const double value = double(lightThrough(asked[m]->id, receiver, light, lightsOf(light.sinRadius))) / light.area;
                double& most = largest[i][m * radii.size() + r];
                if (!first) most = std::isfinite(value) ? std::max(most, std::abs(value - before) / stepBound(step, radii[r] * kDegree)) : 1e30;
                before = value;
            });
        }
    });
    std::vector<SceneSteps> out;
    for (size_t m = 0; m < asked.size(); ++m)
        for (size_t r = 0; r < radii.size(); ++r) {
            SceneSteps row{scene.name, std::string(asked[m]->name), asked[m]->baseline, radii[r], 0};
            for (const auto& each : largest) row.step = std::max(row.step, each[m * radii.size() + r]);
            out.push_back(row);
        }
    return out;
}

std::vector<HalfError> measureHalf(const std::vector<Scene>& scenes, const std::vector<const Model*>& asked, int receivers, int rays, uint32_t seed,
                                   const std::vector<double>& radii, const FrameEvaluator& half) {
    const size_t places = size_t(receivers), kinds = asked.size() * radii.size();
    std::vector<std::vector<Evaluation>> lights(scenes.size() * places * kinds);
    for (size_t s = 0; s < scenes.size(); ++s)
        forReceivers(scenes[s], asked, receivers, rays, seed, {}, [&](size_t i, const glm::mat3& frame, size_t m, const Receiver& receiver) {
            for (size_t r = 0; r < radii.size(); ++r)
                forArcs(frame, seed, i, radii[r], 2 * kDegree, [&](const CapLight& light, bool) {
                    Evaluation e{vec4(receiver.normal, 0), vec4(light.axis, light.sinRadius), receiver.visibility, {}};
                    std::copy_n(receiver.form, MAX_SLOTS, e.form);
                    lights[(s * places + i) * kinds + m * radii.size() + r].push_back(e);
                });
        });
    std::vector<HalfError> out;
    for (size_t kind = 0; kind < kinds; ++kind) {
        const Model& model = *asked[kind / radii.size()];
        HalfError row{std::string(model.name), radii[kind % radii.size()]};
        std::vector<Evaluation> all;
        for (size_t k = kind; k < lights.size(); k += kinds) all.insert(all.end(), lights[k].begin(), lights[k].end());
        const int size = lightsOf(float(std::sin(row.radius * kDegree)));
        const std::vector<float> found = half(model.id, size, all);
        double sum = 0;
        for (size_t k = 0; k < all.size(); ++k) {
            const CapLight light = capLight(vec3(all[k].light), all[k].light.w);
            Receiver receiver{vec3(all[k].normal), all[k].visibility, {}};
            std::copy_n(all[k].form, MAX_SLOTS, receiver.form);
            const double e = (double(found[k]) - lightThrough(model.id, receiver, light, size)) / light.area;
            ++row.lights;
            row.notFinite += !std::isfinite(e);
            if (!std::isfinite(e)) continue;
            sum += e * e;
            row.max = std::max(row.max, std::abs(e));
        }
        row.rms = std::sqrt(sum / std::max(row.lights - row.notFinite, 1));
        out.push_back(row);
    }
    return out;
}

}  // namespace apertura
