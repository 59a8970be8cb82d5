#include "apertura/bake/measure/reference.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/vertices.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr int kMostLayers = 32;

class Shader {
public:
    Shader(const Tracer& tracer, const View& view, const ReferenceOptions& options)
        : tracer_(tracer), view_(view), options_(options), sky_(fibonacciHemisphere(options.skyRays)) {}

    // `layers`: how many transparent surfaces the ray may still pass.
    glm::vec3 radiance(const glm::dvec3& eye, const glm::vec3& direction, uint64_t sample, int layers = kMostLayers) {
        const std::optional<Hit> hit = tracer_.nearest(eye, direction);
        if (const std::optional<glm::vec3> light = lightAlong(eye, direction, hit ? hit->distance : kNoLimit)) return *light;
        if (!hit) return view_.sky.towards(glm::normalize(direction));
        const glm::dvec3 origin = rayOrigin(tracer_, {hit->at.position, hit->at.normal});
        caps_.clear();
        for (const AperturaLight& light : view_.lights) caps_.push_back(aperturaCapSeenFrom(hit->at.position, light, APERTURA_LIGHTS_ANY));
        glm::vec3 irradiance(0);
        for (size_t i = 0; i < caps_.size(); ++i) irradiance += fromLight(i, origin, hit->at.position, hit->at.normal, sample);
        irradiance += fromSky(origin, hit->at.normal, sample);
        const Scene& scene = tracer_.scene();
        const bool plain = view_.plain || scene.materials.empty();
        const Surface& surface = scene.surfaces[size_t(scene.instances[size_t(hit->instance)].surface)];
        const auto triangle = size_t(hit->triangle);
        const float spread = spreadAt(*hit, direction);
        const glm::vec4 base = scene.materials.empty() ? glm::vec4(1) : baseColourAt(scene, surface, triangle, hit->barycentrics, spread);
        glm::vec3 out = (plain ? view_.albedo : glm::vec3(base)) / float(pi) * irradiance;
        if (!plain) out += emissionAt(scene, surface, triangle, hit->barycentrics, spread);
        if (base.a >= 1 || layers == 0) return out;
        const glm::dvec3 behind = hit->at.position + 4 * tracer_.offset(hit->at.position) * glm::dvec3(glm::normalize(direction));
        return base.a * out + (1 - base.a) * radiance(behind, direction, sample, layers - 1);
    }

private:
    // Metres, in the surface's own frame, that a sample of the picture covers at a hit.
    float spreadAt(const Hit& hit, const glm::vec3& direction) const {
        const double angle = 2 * std::tan(double(view_.camera.verticalFov) / 2) / (2 * view_.height);
        const glm::mat3 toWorld(tracer_.scene().instances[size_t(hit.instance)].toWorld);
        const double scale = std::cbrt(std::abs(double(glm::determinant(toWorld))));
        return float(double(hit.distance) * double(glm::length(direction)) * angle / std::max(scale, 1e-30));
    }

    bool isIn(size_t light, const glm::vec3& direction) const { return glm::dot(direction, caps_[light].axis) >= 1 - caps_[light].height; }

    // The light that is seen along a ray, nearer than `distance` lengths of it.
    std::optional<glm::vec3> lightAlong(const glm::dvec3& eye, const glm::vec3& direction, float distance) const {
        const float length = glm::length(direction);
        const glm::vec3 ray = direction / length;
        float nearest = distance * length;
        std::optional<glm::vec3> out;
        for (const AperturaLight& light : view_.lights) {
            if (aperturaIsSphere(light)) {
                const float along = aperturaDistanceToLamp(light.sphere, vec3(eye), ray);
                if (along > 0 && along < nearest) nearest = along, out = vec3(light.radiance);
            } else if (distance == kNoLimit && !out && aperturaIsWithin(light.cap, ray)) {
                out = vec3(light.radiance);
            }
        }
        return out;
    }

    glm::vec3 fromLight(size_t index, const glm::dvec3& origin, const glm::vec3& position, const glm::vec3& normal, uint64_t sample) {
        const AperturaLight& light = view_.lights[index];
        const AperturaCapLight& cap = caps_[index];
        const glm::mat3 frame = frameFromZ(cap.axis, 2 * pi * hashUnit(options_.seed, sample, 2 + index));
        rays_.clear();
        reach_.clear();
        for (const glm::vec3& w : fibonacciCap(options_.lightRays, cap.height))
            if (const glm::vec3 d = frame * w; glm::dot(d, normal) > 0 && !isHidden(index, position, d)) {
                rays_.push_back(d);
                reach_.push_back(aperturaIsSphere(light) ? distanceTo(light.sphere, origin, d) : kNoLimit);
            }
        const double cosines = openCosines(origin, normal);
        return float(cosines * 2 * pi * cap.height / options_.lightRays) * vec3(light.radiance);
    }

    // True if another light stands before this one in a direction.
    bool isHidden(size_t index, const glm::vec3& position, const glm::vec3& direction) const {
        for (size_t k = 0; k < caps_.size(); ++k) {
            const bool before = aperturaIsSphere(view_.lights[index]) || aperturaIsSphere(view_.lights[k])
                                  ? k != index && aperturaStandsBefore(view_.lights[k], view_.lights[index], position)
                                  : k < index;
            if (before && isIn(k, direction)) return true;
        }
        return false;
    }

    // Metres along a unit ray to where it enters a sphere, or to its point nearest the sphere if it misses.
    static float distanceTo(const vec4& sphere, const glm::dvec3& origin, const glm::dvec3& ray) {
        const glm::dvec3 toCentre = glm::dvec3(sphere) - origin;
        const double along = glm::dot(toCentre, ray), aside = glm::dot(toCentre, toCentre) - along * along;
        return float(std::max(along - std::sqrt(std::max(double(sphere.w) * sphere.w - aside, 0.0)), 0.0));
    }

    // Irradiance from the sky, which the lights hide where they stand.
    glm::vec3 fromSky(const glm::dvec3& origin, const glm::vec3& normal, uint64_t sample) {
        const glm::mat3 frame = frameFromZ(normal, 2 * pi * hashUnit(options_.seed, sample, 1));
        rays_.clear();
        for (const glm::vec3& w : sky_) {
            const glm::vec3 ray = frame * w;
            bool hidden = false;
            for (size_t i = 0; i < caps_.size(); ++i) hidden = hidden || isIn(i, ray);
            if (!hidden) rays_.push_back(ray);
        }
        reach_.assign(rays_.size(), kNoLimit);
        const double each = 2 * pi / options_.skyRays;
        if (!view_.sky.picture()) return float(openCosines(origin, normal) * each) * view_.sky.towards(normal);
        trace(origin);
        glm::dvec3 sum(0);
        for (size_t i = 0; i < rays_.size(); ++i)
            if (!blocked_[i]) sum += double(glm::dot(rays_[i], normal)) * glm::dvec3(view_.sky.towards(rays_[i]));
        return each * sum;
    }

    // Sum of the cosines to the normal of those rays_ that are unblocked over their reach_.
    double openCosines(const glm::dvec3& origin, const glm::vec3& normal) {
        trace(origin);
        double sum = 0;
        for (size_t i = 0; i < rays_.size(); ++i)
            if (!blocked_[i]) sum += glm::dot(rays_[i], normal);
        return sum;
    }

    void trace(const glm::dvec3& origin) {
        blocked_.resize(rays_.size());
        tracer_.occluded(origin, rays_, reach_, blocked_.data());
    }

    const Tracer& tracer_;
    const View& view_;
    const ReferenceOptions& options_;
    std::vector<glm::vec3> sky_, rays_;
    std::vector<AperturaCapLight> caps_;  // of the view's lights, from the receiver
    std::vector<float> reach_;            // metres, one per ray
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
