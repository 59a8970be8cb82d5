#include "apertura/bake/measure/bounces.h"

#include <oneapi/tbb/parallel_for.h>

#include <cmath>

namespace apertura {
namespace {

using std::numbers::pi;

// Sums what comes along the paths of a receiver that meet a surface.
struct Visitor {
    const Tracer& tracer;
    std::span<const glm::vec3> lights;
    std::vector<glm::dvec3> fromLights;
    glm::dvec3 fromSky{0};
    int met = 0;
    std::vector<uint8_t> blocked;

    bool ends(const glm::dvec3&, const glm::vec3&, float) const { return false; }
    bool reflects(const Hit&, const SurfacePoint& point, const glm::vec3& throughput) {
        ++met;
        blocked.resize(lights.size());
        tracer.occluded(rayOrigin(tracer, point, kTruthOffset), lights, kNoLimit, blocked.data());
        for (size_t k = 0; k < lights.size(); ++k)
            if (const float cosine = glm::dot(lights[k], point.normal); cosine > 0 && !blocked[k])
                fromLights[k] += double(cosine) * glm::dvec3(throughput);
        return true;
    }
    void escapes(const glm::vec3&, const glm::vec3& throughput) {
        if (met > 0) fromSky += throughput;
    }
};

}  // namespace

std::vector<glm::vec3> bounceLights() {
    std::vector<glm::vec3> out;
    for (const glm::vec3& w : fibonacciHemisphere(64)) out.emplace_back(w.x, w.z, -w.y);
    return out;
}

std::vector<BounceTruth> traceBounces(const Tracer& tracer, std::span<const SurfacePoint> points, const Albedo& albedo, int bounces,
                                      int rays, uint32_t seed, const Progress& progress) {
    std::vector<BounceTruth> out(points.size());
    const std::vector<glm::vec3> lights = bounceLights(), cosines = fibonacciCosine(rays), even = fibonacciHemisphere(4096);
    ProgressCounter counter(progress, points.size());
    tbb::parallel_for(size_t(0), points.size(), [&](size_t i) {
        if (counter.stopped()) return;
        const glm::mat3 frame = frameFromZ(points[i].normal, 2 * pi * hashUnit(seed, i, 31));
        const glm::dvec3 origin = rayOrigin(tracer, points[i], kTruthOffset);
        BounceTruth& truth = out[i];
        std::vector<glm::vec3> turned;
        for (const glm::vec3& w : even) turned.push_back(frame * w);
        std::vector<uint8_t> blocked(turned.size());
        tracer.occluded(origin, turned, kNoLimit, blocked.data());
        const auto each = float(2 * pi / double(turned.size()));
        for (size_t k = 0; k < turned.size(); ++k)
            if (!blocked[k]) truth.visibility.direction += each * turned[k], truth.visibility.area += each;
        truth.open = std::max(glm::dot(truth.visibility.direction, points[i].normal), 0.0f) / float(pi);
        Visitor visitor{tracer, lights, std::vector<glm::dvec3>(lights.size(), glm::dvec3(0))};
        for (size_t k = 0; k < cosines.size(); ++k) {
            visitor.met = 0;
            followPath(tracer, albedo, origin, frame * cosines[k], bounces, seed, i * cosines.size() + k, visitor);
        }
        truth.sky = truth.open + glm::vec3(visitor.fromSky / double(cosines.size()));
        for (const glm::dvec3& sum : visitor.fromLights) truth.lights.emplace_back(sum / double(cosines.size()));
        counter.add(1);
    });
    counter.throwIfStopped();
    return out;
}

BounceRow bounceRow(const std::string& by, std::span<const BounceTruth> truth, std::span<const AperturaBounce> made) {
    BounceRow row{by};
    const std::vector<glm::vec3> lights = bounceLights();
    double skies = 0, all = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const glm::dvec3 off = glm::vec3(truth[i].open) + made[i].share - truth[i].sky;
        row.sky += glm::dot(off, off);
        row.skyBias += off.x + off.y + off.z;
        skies += 3;
        for (size_t k = 0; k < lights.size(); ++k) {
            const AperturaCapLight light = aperturaCapLight(lights[k], 0.0047f);
            const glm::dvec3 error = aperturaBouncedLight(made[i], light) / light.area - truth[i].lights[k];
            row.light += glm::dot(error, error);
            row.lightBias += error.x + error.y + error.z;
            all += 3;
        }
    }
    row.sky = std::sqrt(row.sky / std::max(skies, 1.0)), row.skyBias /= std::max(skies, 1.0);
    row.light = std::sqrt(row.light / std::max(all, 1.0)), row.lightBias /= std::max(all, 1.0);
    return row;
}

std::vector<BounceSweep> bounceSweeps() {
    constexpr int kFrames = 4001;
    std::vector<BounceSweep> out;
    const auto count = [](BounceSweep& sweep, double value, double least, double most) {
        ++sweep.frames;
        if (!std::isfinite(value)) ++sweep.notFinite;
        if (value < least - 1e-6 || value > most + 1e-6) ++sweep.outside;
    };
    for (const double albedo : {0.0, 0.5, 0.8, 0.95, 0.99, 1.0, 1.5}) {
        const auto around = [&](float sky, const vec4& visibility) {
            return aperturaBounceAround(sky, visibility, max(vec3(float(1 - albedo)), vec3(APERTURA_LEAST_ABSORBED)));
        };
        BounceSweep closing{"an opening closes", albedo}, closed{"a closed room", albedo};
        double before = 0, width = 0;
        for (int i = 0; i < kFrames; ++i) {
            // Evenly at first, and by ever smaller steps at last, to nothing.
            const double t = double(i) / (kFrames - 1), open = t < 0.5 ? 1 - 2 * t + 1e-3 : t < 1 ? std::pow(10, -3 - 80 * (t - 0.5)) : 0;
            const auto sky = float(pi * std::min(open, 1.0));
            const double whole = double(sky) / pi + double(around(sky, {0, sky, 0, 2 * sky}).share.x);
            count(closing, whole, std::min(open, 1.0), 1);
            if (i > 0 && width - open > 1e-9) closing.steepest = std::max(closing.steepest, std::abs(whole - before) / (width - open));
            before = whole, width = open;
        }
        const AperturaBounce none = around(0, vec4(0));
        count(closed, double(none.share.x), 0, 0);
        count(closed, double(aperturaBouncedLight(none, aperturaCapLight(vec3(0, 1, 0), 0.0047f)).x), 0, 0);
        out.push_back(closing);
        out.push_back(closed);
    }
    for (const double share : {0.1, 0.5, 1.0})
        for (const double length : {0.0, 0.3, 0.6, 0.9, 0.99, 1.0, 1.5}) {
            BounceSweep moving{"a light moves, towards " + std::to_string(length).substr(0, 4), share};
            double before = 0;
            for (int i = 0; i < kFrames; ++i) {
                const double angle = pi * i / (kFrames - 1);
                const AperturaCapLight light = aperturaCapLight(vec3(float(std::sin(angle)), float(std::cos(angle)), 0), 0.0047f);
                const double e = double(aperturaBouncedLight({vec3(float(share)), vec3(0, float(length), 0)}, light).x)
                               / double(light.area);
                count(moving, e, 0, 1);
                if (i > 0) moving.steepest = std::max(moving.steepest, std::abs(e - before) * (kFrames - 1) / pi);
                before = e;
            }
            out.push_back(moving);
        }
    return out;
}

}  // namespace apertura
