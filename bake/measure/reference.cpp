#include "apertura/bake/measure/reference.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/vertices.h"

namespace apertura {
namespace {

using std::numbers::pi;

class Shader {
public:
    Shader(const Tracer& tracer, const View& view, const ReferenceOptions& options)
        : tracer_(tracer), view_(view), options_(options), sky_(fibonacciHemisphere(options.skyRays)) {}

    glm::vec3 radiance(const glm::vec3& eye, const glm::vec3& direction, uint64_t sample) {
        const std::optional<Hit> hit = tracer_.nearest(eye, direction);
        if (!hit) return view_.sky;
        const glm::dvec3 origin = rayOrigin(tracer_, {hit->at.position, hit->at.normal});
        std::vector<AperturaCapLight> caps;
        glm::vec3 irradiance(0);
        for (const AperturaLight& light : view_.lights) {
            const AperturaCapLight cap = aperturaCapSeenFrom(hit->at.position, light, APERTURA_LIGHTS_ANY);
            irradiance += fromLight(light, cap, origin, hit->at.normal, sample, caps.size());
            caps.push_back(cap);
        }
        irradiance += fromSky(caps, origin, hit->at.normal, sample);
        return view_.albedo / float(pi) * irradiance;
    }

private:
    glm::vec3 fromLight(const AperturaLight& light, const AperturaCapLight& cap, const glm::dvec3& origin, const glm::vec3& normal,
                        uint64_t sample, size_t index) {
        const glm::mat3 frame = frameFromZ(cap.axis, 2 * pi * hashUnit(options_.seed, sample, 2 + index));
        rays_.clear();
        reach_.clear();
        for (const glm::vec3& w : fibonacciCap(options_.lightRays, cap.height))
            if (const glm::vec3 d = frame * w; glm::dot(d, normal) > 0) {
                rays_.push_back(d);
                reach_.push_back(aperturaIsSphere(light) ? distanceTo(light.sphere, origin, d) : kNoLimit);
            }
        const double cosines = openCosines(origin, normal, {});
        return float(cosines * 2 * pi * cap.height / options_.lightRays) * vec3(light.radiance);
    }

    // Metres along a unit ray to where it enters a sphere, or to its point nearest the sphere if it misses.
    static float distanceTo(const vec4& sphere, const glm::dvec3& origin, const glm::dvec3& ray) {
        const glm::dvec3 toCentre = glm::dvec3(sphere) - origin;
        const double along = glm::dot(toCentre, ray), aside = glm::dot(toCentre, toCentre) - along * along;
        return float(std::max(along - std::sqrt(std::max(double(sphere.w) * sphere.w - aside, 0.0)), 0.0));
    }

    // Irradiance from the sky, which the lights hide where they stand.
    glm::vec3 fromSky(const std::vector<AperturaCapLight>& caps, const glm::dvec3& origin, const glm::vec3& normal, uint64_t sample) {
        const glm::mat3 frame = frameFromZ(normal, 2 * pi * hashUnit(options_.seed, sample, 1));
        rays_.clear();
        for (const glm::vec3& w : sky_) rays_.push_back(frame * w);
        reach_.assign(rays_.size(), kNoLimit);
        return float(openCosines(origin, normal, caps) * 2 * pi / options_.skyRays) * view_.sky;
    }

    // Sum of the cosines to the normal of those rays_ that are unblocked over their reach_ and lie in no cap of `skip`.
    double openCosines(const glm::dvec3& origin, const glm::vec3& normal, const std::vector<AperturaCapLight>& skip) {
        blocked_.resize(rays_.size());
        tracer_.occluded(origin, rays_, reach_, blocked_.data());
        double sum = 0;
        for (size_t i = 0; i < rays_.size(); ++i) {
            bool counts = !blocked_[i];
            for (const AperturaCapLight& cap : skip) counts = counts && glm::dot(rays_[i], cap.axis) < 1 - cap.height;
            if (counts) sum += glm::dot(rays_[i], normal);
        }
        return sum;
    }

    const Tracer& tracer_;
    const View& view_;
    const ReferenceOptions& options_;
    std::vector<glm::vec3> sky_, rays_;
    std::vector<float> reach_;  // metres, one per ray
    std::vector<uint8_t> blocked_;
};

}  // namespace

Picture traceReference(const Tracer& tracer, const View& view, const ReferenceOptions& options, const Progress& progress) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const int width = 2 * view.width, height = 2 * view.height;
    Picture picture{width, height, std::vector<glm::vec3>(size_t(width) * height)};
    ProgressCounter counter(progress, size_t(height));
    tbb::parallel_for(0, height, [&](int y) {
        if (counter.stopped()) return;
        Shader shader(tracer, view, options);
        for (int x = 0; x < width; ++x) {
            const size_t sample = size_t(y) * width + x;
            const glm::vec3 ray = rayThrough(view.camera, double(view.width) / view.height, (x + 0.5) / width, (y + 0.5) / height);
            picture.pixels[sample] = shader.radiance(view.camera.eye, ray, sample);
        }
        counter.add(1);
    });
    counter.throwIfStopped();
    return halved(picture);
}

}  // namespace apertura
