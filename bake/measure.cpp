#include "bake/measure.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "bake/watch.h"
#include "sh/packing.h"

namespace apertura {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPathRadius = 5;  // degrees, of the light that PathRow speaks of

CapLight capLight(const glm::vec3& direction, double radius) {
    const float s = float(std::sin(radius));
    return {direction, s, heightFromSin(s)};
}

// E / (L pi sin^2 r) as the model has it.
float modelValue(int model, const Receiver& receiver, const CapLight& light) {
    return lightThrough(model, receiver, light) / (PI * light.sinRadius * light.sinRadius);
}

// The receivers of a scene, their lights, and the truth for each radius.
struct Ground {
    std::vector<SpreadPoint> points;
    std::vector<std::vector<glm::vec3>> lights;               // a receiver
    std::vector<std::vector<std::vector<TruthSample>>> truth;  // [receiver][radius][light]
};

Ground traceGround(const Scene& scene, const Tracer& tracer, const MeasureOptions& options, const Progress& progress) {
    Ground ground;
    ground.points = spreadReceivers(scene, options.receivers, options.seed);
    const size_t n = ground.points.size();
    ground.lights.resize(n);
    ground.truth.resize(n);
    Watch watch(progress, n);
    tbb::parallel_for(size_t(0), n, [&](size_t i) {
        if (watch.stopped()) return;
        const SurfacePoint& point = ground.points[i].at;
        ground.lights[i] = lightDirections(scene, point, options.seed, i);
        for (size_t r = 0; r < options.lightRadii.size(); ++r) {
            std::vector<TruthSample> row;
            for (size_t k = 0; k < ground.lights[i].size(); ++k)
                row.push_back(traceLight(tracer, point, ground.lights[i][k], options.lightRadii[r] * kPi / 180,
                                         options.lightSamples, 2 * kPi * hashUnit(options.seed, i, 100 + k)));
            ground.truth[i].push_back(std::move(row));
        }
        watch.add(1);
    });
    watch.throwIfStopped();
    return ground;
}

void addRows(const Ground& ground, const std::vector<Receiver>& receivers, const std::string& source, int bytes,
             const MeasureOptions& options, std::vector<MeasureRow>& rows) {
    for (const ModelInfo& model : options.models)
        for (size_t r = 0; r < options.lightRadii.size(); ++r) {
            MeasureRow row;
            row.model = model.name;
            row.source = source;
            row.numbers = model.numbers;
            row.bytes = bytes > 0 ? bytes : model.numbers;
            row.lightRadius = options.lightRadii[r];
            size_t count = 0;
            for (size_t i = 0; i < receivers.size(); ++i)
                for (size_t k = 0; k < ground.lights[i].size(); ++k) {
                    const TruthSample& truth = ground.truth[i][r][k];
                    const CapLight light = capLight(ground.lights[i][k], row.lightRadius * kPi / 180);
                    const double e = modelValue(model.id, receivers[i], light) - truth.mean();
                    row.rmse += e * e;
                    row.bias += e;
                    row.max = std::max(row.max, std::abs(e));
                    row.rmsTruth += double(truth.mean()) * truth.mean();
                    row.noise += double(truth.noise()) * truth.noise();
                    ++count;
                }
            row.rmse = std::sqrt(row.rmse / double(count));
            row.rmsTruth = std::sqrt(row.rmsTruth / double(count));
            row.noise = std::sqrt(row.noise / double(count));
            row.bias /= double(count);
            rows.push_back(row);
        }
}

std::vector<Receiver> receiversFrom(const Ground& ground, const std::vector<Visibility>& visibility) {
    std::vector<Receiver> out;
    for (size_t i = 0; i < visibility.size(); ++i)
        out.push_back(toReceiver(toVertex(visibility[i], ground.points[i].at.normal), ground.points[i].at.normal));
    return out;
}

PathRow comparePath(const Ground& ground, const std::string& stage, const std::string& source,
                    const std::vector<Receiver>& reference, const std::vector<Receiver>& changed) {
    PathRow row{stage, source};
    double lights = 0, axes = 0;
    for (size_t i = 0; i < reference.size(); ++i) {
        const Aperture &a = reference[i].aperture, &b = changed[i].aperture;
        const double radius = (double(capRadius(b.height)) - capRadius(a.height)) * 180 / kPi;
        row.radiusRms += radius * radius;
        row.radiusMax = std::max(row.radiusMax, std::abs(radius));
        if (a.height > 1e-4f) {  // a closed point has no direction to lose
            const double angle = 2 * std::asin(std::min(0.5 * glm::length(glm::dvec3(a.axis) - glm::dvec3(b.axis)), 1.0)) * 180 / kPi;
            row.directionRms += angle * angle;
            row.directionMax = std::max(row.directionMax, angle);
            ++axes;
        }
        for (const glm::vec3& l : ground.lights[i]) {
            const CapLight light = capLight(l, kPathRadius * kPi / 180);
            const double e = modelValue(MODEL_APERTURE, changed[i], light) - modelValue(MODEL_APERTURE, reference[i], light);
            row.irradianceRms += e * e;
            ++lights;
        }
    }
    row.directionRms = std::sqrt(row.directionRms / std::max(axes, 1.0));
    row.radiusRms = std::sqrt(row.radiusRms / double(reference.size()));
    row.irradianceRms = std::sqrt(row.irradianceRms / std::max(lights, 1.0));
    return row;
}

float throughByte(float value, float top) { return std::round(std::clamp(value / top, -1.0f, 1.0f) * 127) / 127 * top; }

// The four coefficients themselves as bytes, each over its possible range.
Visibility shThroughBytes(const Visibility& v) {
    const Sh4 largest = toSh4({glm::vec3(float(kPi)), float(2 * kPi)});
    Sh4 sh = toSh4(v);
    for (int i = 0; i < 4; ++i) sh.c[i] = throughByte(sh.c[i], largest.c[i]);
    return toVisibility(sh);
}

// An aperture's axis and radius as bytes.
Receiver apertureThroughBytes(Receiver receiver) {
    Aperture& a = receiver.aperture;
    for (int i = 0; i < 3; ++i) a.axis[i] = throughByte(a.axis[i], 1);
    a.axis = glm::normalize(a.axis);
    const float radius = (throughByte(capRadius(a.height) * 4 / PI - 1, 1) + 1) * PI / 4;
    a.height = 1 - std::cos(radius);
    return receiver;
}

std::vector<PathRow> comparePaths(const Scene& scene, const Tracer& tracer, const Ground& ground,
                                  const std::vector<Visibility>& sh, const std::vector<Visibility>& rays,
                                  const BakeOptions& bake, const Progress& progress) {
    const std::vector<Receiver> reference = receiversFrom(ground, sh);
    std::vector<PathRow> out;
    out.push_back(comparePath(ground, "at the receiver, unquantised: the same by construction", "rays", reference, receiversFrom(ground, rays)));
    auto through = [&](auto&& change) {
        std::vector<Visibility> changed;
        for (const Visibility& v : sh) changed.push_back(change(v));
        return receiversFrom(ground, changed);
    };
    out.push_back(comparePath(ground, "the asset's 4 bytes", "sh", reference, through([](const Visibility& v) { return unpack(pack8(v)); })));
    out.push_back(comparePath(ground, "the asset's 8 bytes", "sh", reference, through([](const Visibility& v) { return unpack(pack16(v)); })));
    out.push_back(comparePath(ground, "4 bytes of raw coefficients", "sh", reference, through(shThroughBytes)));
    std::vector<Receiver> packed;
    for (const Receiver& r : reference) packed.push_back(apertureThroughBytes(r));
    out.push_back(comparePath(ground, "4 bytes of axis and radius", "rays", reference, packed));

    // The corners of each receiver's triangle, seen with its own normal; then mixed.
    std::vector<SurfacePoint> corners;
    for (const SpreadPoint& p : ground.points) {
        const Instance& instance = scene.instances[p.instance];
        const Surface& surface = scene.surfaces[instance.surface];
        for (uint32_t v : surface.triangles[p.triangle]) {
            const glm::vec3 world(instance.toWorld * glm::vec4(surface.positions[v], 1));
            corners.push_back({glm::mix(world, p.at.position, 0.01f), p.at.normal});
        }
    }
    const std::vector<Visibility> at = bakePoints(tracer, corners, bake, progress);
    auto mixed = [&](bool even, bool coefficients) {
        std::vector<Receiver> receivers;
        for (size_t i = 0; i < ground.points.size(); ++i) {
            const glm::vec3 w = even ? glm::vec3(1 / 3.0f) : ground.points[i].weights, n = ground.points[i].at.normal;
            Visibility sum;
            VertexVisibility mix{vec4(0), vec4(0), vec4(0)};
            for (int c = 0; c < 3; ++c) {
                const Visibility& v = at[3 * i + c];
                sum.area += w[c] * v.area;
                sum.direction += w[c] * v.direction;
                const VertexVisibility vertex = toVertex(v, n);
                mix.visibility += w[c] * vertex.visibility;
                mix.aperture += w[c] * vertex.aperture;
                mix.soft += w[c] * vertex.soft;
            }
            receivers.push_back(toReceiver(coefficients ? toVertex(sum, n) : mix, n));
        }
        return receivers;
    };
    out.push_back(comparePath(ground, "interpolated over its triangle, then converted", "sh", reference, mixed(false, true)));
    out.push_back(comparePath(ground, "apertures interpolated over its triangle", "rays", reference, mixed(false, false)));
    out.push_back(comparePath(ground, "filtered over its triangle, then converted", "sh", reference, mixed(true, true)));
    out.push_back(comparePath(ground, "apertures filtered over its triangle", "rays", reference, mixed(true, false)));
    return out;
}

std::optional<tbb::global_control> limitThreads(int threads) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
    return limit;
}

// The part from..to of the whole.
Progress part(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [&progress, from, to](double share) { return progress(from + (to - from) * share); };
}

}  // namespace

Measurement measureScene(const Scene& scene, const MeasureOptions& options, const Progress& progress) {
    const auto limit = limitThreads(options.threads);
    const Tracer tracer(scene, part(progress, 0, 0));
    const Ground ground = traceGround(scene, tracer, options, part(progress, 0, 0.8));
    std::vector<SurfacePoint> points;
    for (const SpreadPoint& p : ground.points) points.push_back(p.at);
    BakeOptions bake;
    bake.rays = options.rays;
    bake.seed = options.seed;
    const std::vector<Visibility> sh = bakePoints(tracer, points, bake, part(progress, 0.8, 0.85));
    bake.model = BakeModel::Rays;
    const std::vector<Visibility> rays = bakePoints(tracer, points, bake, part(progress, 0.85, 0.9));
    Measurement out{scene.name, int(points.size()), {}, {}};
    addRows(ground, receiversFrom(ground, sh), "sh", 0, options, out.rows);
    addRows(ground, receiversFrom(ground, rays), "rays", 0, options, out.rows);
    bake.model = BakeModel::Sh;
    out.paths = comparePaths(scene, tracer, ground, sh, rays, bake, part(progress, 0.9, 1));
    return out;
}

Measurement measureAsset(const Asset& asset, const MeasureOptions& options, const Progress& progress) {
    const auto limit = limitThreads(options.threads);
    const Tracer tracer(asset.scene, part(progress, 0, 0));
    const Ground ground = traceGround(asset.scene, tracer, options, progress);
    std::vector<Receiver> receivers;
    for (const SpreadPoint& p : ground.points) {
        const Instance& instance = asset.scene.instances[p.instance];
        const Surface& surface = asset.scene.surfaces[instance.surface];
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        VertexVisibility mix{vec4(0), vec4(0), vec4(0)};
        for (int c = 0; c < 3; ++c) {
            const uint32_t v = surface.triangles[p.triangle][c];
            const VertexVisibility vertex =
                toVertex(asset.visibility[p.instance][v], glm::normalize(normals * surface.normals[v]));
            mix.visibility += p.weights[c] * vertex.visibility;
            mix.aperture += p.weights[c] * vertex.aperture;
            mix.soft += p.weights[c] * vertex.soft;
        }
        receivers.push_back(toReceiver(mix, p.at.normal));
    }
    Measurement out{asset.scene.name, int(receivers.size()), {}, {}};
    addRows(ground, receivers, asset.info.model, asset.info.bits / 2, options, out.rows);
    return out;
}

}  // namespace apertura
