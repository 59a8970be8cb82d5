#include "apertura/bake/measure/reference.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "apertura/bake/sampling/paths.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr int kMostLayers = 32;

// The lights of a view as they are seen from a point.
class LightsFrom {
public:
    LightsFrom(const View& view, const glm::vec3& position) : view_(view), position_(position) {
        caps_.reserve(view.lights.size());
        for (const AperturaLight& light : view.lights) caps_.push_back(aperturaCapSeenFrom(position, light, APERTURA_LIGHTS_ANY));
    }
    size_t count() const { return caps_.size(); }
    const AperturaCapLight& cap(size_t light) const { return caps_[light]; }
    bool isIn(size_t light, const glm::vec3& direction) const { return glm::dot(direction, caps_[light].axis) >= 1 - caps_[light].height; }
    bool isInAny(const glm::vec3& direction) const {
        for (size_t i = 0; i < caps_.size(); ++i)
            if (isIn(i, direction)) return true;
        return false;
    }
    // True if another light stands before this one in a direction.
    bool isHidden(size_t index, const glm::vec3& direction) const {
        for (size_t k = 0; k < caps_.size(); ++k) {
            const bool before = aperturaIsSphere(view_.lights[index]) || aperturaIsSphere(view_.lights[k])
                                  ? k != index && aperturaStandsBefore(view_.lights[k], view_.lights[index], position_)
                                  : k < index;
            if (before && isIn(k, direction)) return true;
        }
        return false;
    }
    // How far a ray from `origin` reaches until it is in a light, metres.
    float reach(size_t light, const glm::dvec3& origin, const glm::vec3& ray) const {
        return aperturaIsSphere(view_.lights[light]) ? distanceTo(view_.lights[light].sphere, origin, ray) : kNoLimit;
    }

private:
    // Metres along a unit ray to where it enters a sphere, or to its point nearest the sphere if it misses.
    static float distanceTo(const vec4& sphere, const glm::dvec3& origin, const glm::dvec3& ray) {
        const glm::dvec3 toCentre = glm::dvec3(sphere) - origin;
        const double along = glm::dot(toCentre, ray), aside = glm::dot(toCentre, toCentre) - along * along;
        return float(std::max(along - std::sqrt(std::max(double(sphere.w) * sphere.w - aside, 0.0)), 0.0));
    }

    const View& view_;
    glm::vec3 position_;
    std::vector<AperturaCapLight> caps_;
};

class Shader {
public:
    Shader(const Tracer& tracer, const View& view, const ReferenceOptions& options)
        : tracer_(tracer),
          view_(view),
          options_(options),
          sky_(fibonacciHemisphere(options.skyRays)),
          paths_(fibonacciCosine(view.bounces > 0 ? options.paths : 0)) {}

    // `layers`: how many transparent surfaces the ray may still pass.
    glm::vec3 radiance(const glm::dvec3& eye, const glm::vec3& direction, uint64_t sample, int layers = kMostLayers) {
        const std::optional<Hit> hit = tracer_.nearest(eye, direction);
        if (const std::optional<glm::vec3> light = lightAlong(eye, direction, hit ? hit->distance : kNoLimit)) return *light;
        if (!hit) return view_.background ? *view_.background : view_.sky.towards(glm::normalize(direction));
        const glm::vec3 irradiance = irradianceAt({hit->at.position, hit->at.normal}, sample);
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

    glm::vec3 irradianceAt(const SurfacePoint& point, uint64_t sample) {
        const glm::dvec3 origin = rayOrigin(tracer_, point, kTruthOffset);
        const LightsFrom lights(view_, point.position);
        glm::vec3 out(0);
        for (size_t i = 0; i < lights.count(); ++i) out += fromLight(lights, i, origin, point.normal, sample);
        out += fromSky(lights, origin, point.normal, sample);
        out += fromSurfaces(origin, point.normal, sample);
        return out;
    }

private:
    // Metres, in the surface's own frame, that a sample of the picture covers at a hit.
    float spreadAt(const Hit& hit, const glm::vec3& direction) const {
        const double angle = 2 * std::tan(double(view_.camera.verticalFov) / 2) / (2 * view_.height);
        const glm::mat3 toWorld(tracer_.scene().instances[size_t(hit.instance)].toWorld);
        const double scale = std::cbrt(std::abs(double(glm::determinant(toWorld))));
        return float(double(hit.distance) * double(glm::length(direction)) * angle / std::max(scale, 1e-30));
    }

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

    glm::vec3 fromLight(const LightsFrom& lights, size_t index, const glm::dvec3& origin, const glm::vec3& normal, uint64_t sample) {
        const AperturaCapLight& cap = lights.cap(index);
        const glm::mat3 frame = frameFromZ(cap.axis, 2 * pi * hashUnit(options_.seed, sample, 2 + index));
        rays_.clear();
        reach_.clear();
        for (const glm::vec3& w : fibonacciCap(options_.lightRays, cap.height))
            if (const glm::vec3 d = frame * w; glm::dot(d, normal) > 0 && !lights.isHidden(index, d)) {
                rays_.push_back(d);
                reach_.push_back(lights.reach(index, origin, d));
            }
        const double cosines = openCosines(origin, normal);
        return float(cosines * 2 * pi * cap.height / options_.lightRays) * vec3(view_.lights[index].radiance);
    }

    // Irradiance by way of other surfaces: of paths that meet one, the light that falls on each that they meet, by one ray to each light,
    // and the sky at their ends. Materials that glow shine at the eye alone.
    glm::vec3 fromSurfaces(const glm::dvec3& origin, const glm::vec3& normal, uint64_t sample) {
        if (paths_.empty()) return glm::vec3(0);
        struct Visitor {
            Shader& shader;
            uint64_t path;
            glm::dvec3 sum{0};
            int met = 0;
            bool ends(const glm::dvec3& from, const glm::vec3& direction, float distance) const {
                return shader.lightAlong(from, direction, distance).has_value();
            }
            bool reflects(const Hit&, const SurfacePoint& point, const glm::vec3& throughput) {
                sum += glm::dvec3(throughput) * shader.directAt(point, path, uint64_t(++met)) / pi;
                return true;
            }
            void escapes(const glm::vec3& direction, const glm::vec3& throughput) {
                if (met > 0) sum += throughput * shader.view_.sky.towards(direction);
            }
        };
        const Albedo albedo{view_.albedo, view_.plain};
        const glm::mat3 frame = frameFromZ(normal, 2 * pi * hashUnit(options_.seed, sample, 40));
        glm::dvec3 sum(0);
        for (size_t k = 0; k < paths_.size(); ++k) {
            Visitor visitor{*this, sample * paths_.size() + k};
            followPath(tracer_, albedo, origin, frame * paths_[k], view_.bounces, options_.seed, visitor.path, visitor);
            sum += visitor.sum;
        }
        return pi / double(paths_.size()) * sum;
    }

    // Irradiance from the lights at the bounce `number` of a path.
    glm::dvec3 directAt(const SurfacePoint& point, uint64_t path, uint64_t number) const {
        const LightsFrom lights(view_, point.position);
        const glm::dvec3 origin = rayOrigin(tracer_, point, kTruthOffset);
        glm::dvec3 out(0);
        for (size_t i = 0; i < lights.count(); ++i) {
            const AperturaCapLight& cap = lights.cap(i);
            const uint64_t hash = (number * 64 + i) * 2 + (uint64_t(1) << 20);
            const double down = double(cap.height) * hashUnit(options_.seed, path, hash), across = std::sqrt(down * (2 - down));
            const glm::vec3 ray = frameFromZ(cap.axis, 2 * pi * hashUnit(options_.seed, path, hash + 1))
                                * glm::vec3(float(across), 0, float(1 - down));
            const double cosine = glm::dot(ray, point.normal);
            if (cosine <= 0 || lights.isHidden(i, ray) || tracer_.occluded(origin, ray, lights.reach(i, origin, ray))) continue;
            out += 2 * pi * double(cap.height) * cosine * glm::dvec3(view_.lights[i].radiance);
        }
        return out;
    }

    // Irradiance from the sky, which the lights hide where they stand.
    glm::vec3 fromSky(const LightsFrom& lights, const glm::dvec3& origin, const glm::vec3& normal, uint64_t sample) {
        const glm::mat3 frame = frameFromZ(normal, 2 * pi * hashUnit(options_.seed, sample, 1));
        rays_.clear();
        for (const glm::vec3& w : sky_) {
            const glm::vec3 ray = frame * w;
            if (!lights.isInAny(ray)) rays_.push_back(ray);
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
    std::vector<glm::vec3> sky_, paths_, rays_;
    std::vector<float> reach_;  // metres, one per ray
    std::vector<uint8_t> blocked_;
};

}  // namespace

glm::vec3 referenceIrradiance(const Tracer& tracer, const View& view, const SurfacePoint& point, const ReferenceOptions& options) {
    return Shader(tracer, view, options).irradianceAt(point, 0);
}

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
