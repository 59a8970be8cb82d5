#include "tools/view/probe.h"

#include <cmath>
#include <numbers>

#include "apertura/bake/measure/reference.h"
#include "apertura/bake/sampling/paths.h"
#include "apertura/bake/sampling/vertices.h"
#include "apertura/runtime/asset/bounces.h"

namespace apertura {
namespace {

// What a model gives at the point, W/m2.
double irradianceOf(const WeightedReceivers& receivers, const Model& model, const View& view, const glm::vec3& position,
                    const glm::vec3& albedo, const std::optional<AperturaBounce>& baked) {
    const std::vector<AperturaLight> lights = arrangedLights(view);
    const int lightClass = APERTURA_LIGHTS_ANY;
    AperturaIrradiance sum{vec3(0), vec3(0), 0};
    vec4 visibility(0), brightest(0);
    for (const auto& [weight, receiver] : receivers) {
        for (size_t i = 0; i < lights.size(); ++i)
            sum = aperturaWithLight(sum, lights[i], aperturaCapSeenFrom(position, lights[i], lightClass),
                                    weight * aperturaIrradianceBeside(model.id, receiver, position, lights.data(), int(i), lightClass),
                                    view.sky.bands());
        sum.sky += weight * aperturaSkyIrradiance(model.id, receiver);
        visibility += weight * receiver.visibility;
    }
    for (const AperturaLight& light : lights) brightest = max(brightest, light.radiance);
    const vec3 mean = aperturaSkyThrough(model.id, receivers.front().second.normal, visibility, view.sky.bands());
    AperturaBounce bounce{vec3(0), vec3(0)};
    if (baked)
        bounce = *baked;
    else if (view.bounces > 0)
        bounce = aperturaBounceAround(sum.sky, visibility, max(1.0f - albedo, vec3(APERTURA_LEAST_ABSORBED)));
    const vec3 all = aperturaSumOf(sum, aperturaSkyBounced(sum.sky, mean, bounce), vec3(brightest))
                   + aperturaBouncedLights(bounce, lights.data(), int(lights.size()), lightClass);
    return double(all.r + all.g + all.b) / 3;
}

}  // namespace

std::optional<glm::vec3> directionOfCell(int x, int y) {
    // Equal areas of the disc are equal solid angles: the radius is sin(theta / 2), up to 45 degrees.
    const double u = (x + 0.5) / ProbeResult::kCells * 2 - 1, v = 1 - (y + 0.5) / ProbeResult::kCells * 2, r2 = u * u + v * v;
    if (r2 > 1) return std::nullopt;
    const double cosine = 1 - r2, sine = std::sqrt(std::max(1 - cosine * cosine, 0.0)), r = std::sqrt(std::max(r2, 1e-12));
    return glm::vec3(sine * u / r, sine * v / r, cosine);
}

std::optional<ProbeResult> Probe::at(const View& view, const glm::vec3& ray, const Model& model) const {
    const std::optional<Hit> hit = tracer_.nearest(view.camera.eye, ray);
    if (!hit) return std::nullopt;
    ProbeResult out;
    out.position = hit->at.position;
    out.normal = hit->at.normal;
    const glm::dvec3 origin = rayOrigin(tracer_, {hit->at.position, hit->at.normal, hit->at.longest});
    const glm::mat3 frame = frameFromZ(out.normal, 0);
    const WeightedReceivers drawn = receiverAt(asset_, model, hit->instance, hit->triangle, hit->barycentrics, out.normal);
    for (int y = 0; y < ProbeResult::kCells; ++y)
        for (int x = 0; x < ProbeResult::kCells; ++x) {
            const std::optional<glm::vec3> cell = directionOfCell(x, y);
            out.traced.push_back(-1);
            out.shown.push_back(-1);
            if (!cell) continue;
            const glm::vec3 w = frame * *cell;
            out.traced.back() = tracer_.occluded(origin, w, kNoLimit) ? 0 : 1;
            const AperturaCapLight light = aperturaCapLight(w, 0.01f);
            const float open = aperturaUnoccludedIrradiance(out.normal, light, APERTURA_LIGHTS_SUN);
            float seen = 0;
            for (const auto& [weight, receiver] : drawn)
                seen += weight * aperturaIrradianceThrough(model.id, receiver, light, APERTURA_LIGHTS_SUN);
            out.shown.back() = glm::clamp(seen / std::max(open, 1e-9f), 0.0f, 1.0f);
        }
    // As scene.frag has it.
    const glm::vec3 own(albedoAt(asset_.scene, *hit, {view.albedo, view.plain}));
    const glm::vec3 around = view.around == View::Around::Own ? own : view.plain ? view.albedo : view.aroundAlbedo;
    std::optional<AperturaBounce> baked;
    if (bounceSourceOf(view, asset_) == APERTURA_BOUNCES_BAKED) baked = bounceAt(asset_, hit->instance, hit->triangle, hit->barycentrics);
    const Model* const stored = storedModel(asset_.info);
    for (const Model& each : models()) {
        if (!each.fromVisibility && &each != stored) continue;
        const WeightedReceivers receivers = receiverAt(asset_, each, hit->instance, hit->triangle, hit->barycentrics, out.normal);
        if (each.id == APERTURA_MODEL_SH_L1)
            out.visibility = {vec3(receivers.front().second.visibility), receivers.front().second.visibility.w};
        out.models.push_back({std::string(each.name), irradianceOf(receivers, each, view, out.position, around, baked)});
    }
    const glm::vec3 truth = referenceIrradiance(tracer_, view, {hit->at.position, hit->at.normal, hit->at.longest},
                                                {.lightRays = 1024, .skyRays = 4096, .paths = 4096, .threads = 1});
    out.truth = double(truth.r + truth.g + truth.b) / 3;
    return out;
}

}  // namespace apertura
