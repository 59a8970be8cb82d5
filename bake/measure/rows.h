#pragma once
// What models and baselines make of lit receivers, against the truth: the rows of a Measurement.
#include "apertura/bake/measure/measure.h"
#include "apertura/bake/measure/truth.h"

namespace apertura {

// The model's E / (L pi sin^2 r).
inline float modelValue(int model, const AperturaReceiver& receiver, const AperturaCapLight& light) {
    return aperturaIrradianceThrough(model, receiver, light, lightClassOf(light.sinRadius)) / light.area;
}

// The receivers of a scene, their lights, and the truth for each radius.
struct LitReceivers {
    std::vector<SurfaceSample> points;
    std::vector<std::vector<glm::vec3>> lights;                // [receiver][light]
    std::vector<std::vector<std::vector<TruthSample>>> truth;  // [receiver][radius][light]
    int buried = 0;                                            // receivers that were left out, because nobody can see them
    std::vector<BounceTruth> bounces;                          // if light bounces: the truth at each receiver,
    std::vector<AperturaBounce> baked;                         // what an asset stores there,
    glm::vec3 absorbed{0};                                     // or, without that, what surfaces absorb

    // What surfaces reflect to a receiver that gets this E of a sky of unit radiance.
    AperturaBounce bounceAt(size_t receiver, float sky) const {
        if (!baked.empty()) return baked[receiver];
        const Visibility& v = bounces[receiver].visibility;
        return aperturaBounceAround(sky, vec4(v.direction, v.area), absorbed);
    }

    std::vector<SurfacePoint> surfacePoints() const {
        std::vector<SurfacePoint> out;
        out.reserve(points.size());
        for (const SurfaceSample& p : points) out.push_back(p.at);
        return out;
    }
};

// Places receivers in the region, lights them and traces the truth. Those are left out of whose hemisphere more than a quarter meets backs
// of one-sided faces: they lie inside solids. Throws as sampleSurface does, Cancelled, and Error naming the scene where all are buried.
LitReceivers traceLitReceivers(const Scene& scene, const MeasuredRegion& region, const Tracer& tracer, const MeasureOptions& options,
                               const Progress& progress);

// One model at every receiver, as weighted Receivers: one if the model's parameters may be interpolated, else three, those
// of the triangle's corners.
struct ModelReceivers {
    const Model* model;
    std::string source;
    double numbers, bytes;
    std::vector<std::vector<std::pair<float, AperturaReceiver>>> receivers;
};

// Traces the truth of light that bounces, if the options want it, and takes what is known without: from `asset`, where it stores that and
// was baked with this albedo, or from the mean of what they reflect. Returns the rows of Measurement::bounces. Throws Cancelled.
std::vector<BounceRow> traceLitBounces(LitReceivers& lit, const Tracer& tracer, const Asset* asset, const MeasureOptions& options,
                                       const Progress& progress);

// Appends a row for each light radius. `truth`: what each receiver sees, for the sky.
void addRows(const LitReceivers& lit, const ModelReceivers& made, const std::vector<Visibility>& truth, const MeasureOptions& options,
             std::vector<MeasureRow>& rows);

// The same of a shadow map with percentage-closer soft shadows (shaders/soft_shadow.glsl), the renderer's baseline, under a sky that
// nothing blocks. Rays fill in the texels that are read. `bounds`: of the scene, world, metres.
void addShadowRows(const LitReceivers& lit, const Tracer& tracer, const Box& bounds, const std::vector<Visibility>& truth,
                   const MeasureOptions& options, std::vector<MeasureRow>& rows);

}  // namespace apertura
