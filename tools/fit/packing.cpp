// Where the bytes of a lobe's slope and of a quadric's bend are finest.
// fits sh/params_packing.cpp kMiddleSlope 4
// fits sh/params_packing.cpp kMiddleBend 10
// with sh/params_packing.cpp
// reason: assets hold these bytes, and files of 0.1 are read for ever.
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "scene_lights.h"

using namespace apertura;
using namespace apertura::test;

namespace {

// The mean of what bytes add to the light on receivers of the built-in scenes, for lights of 1, 5 and 15 degrees all over the sky.
double meanError(const Model& model, const std::vector<SceneReceiver>& receivers) {
    double sum = 0;
    int count = 0;
    std::vector<float> numbers(size_t(storedNumbers(model)));
    for (const SceneReceiver& r : receivers) {
        packParams(model, paramsOf(r.receiver), numbers);
        for (float& x : numbers) x = std::round(x * 127) / 127;
        const ModelParams params = unpackParams(model, numbers);
        const AperturaReceiver stored = toReceiver({vec3(r.receiver.visibility), r.receiver.visibility.w},
                                                   toParams(model, {}, &params, r.receiver.normal), r.receiver.normal);
        Random random(114 + r.index);
        for (int i = 0; i < 60; ++i) {
            dvec3 towards = random.direction();
            if (dot(towards, dvec3(r.receiver.normal)) < 0) towards = -towards;
            const double radius = (i % 3 == 0 ? 1 : i % 3 == 1 ? 5 : 15) * pi / 180;
            const AperturaCapLight light = test::aperturaCapLight(towards, radius);
            const int lightClass = lightClassOf(light.sinRadius);
            sum += std::abs(aperturaIrradianceThrough(model.id, stored, light, lightClass)
                            - aperturaIrradianceThrough(model.id, r.receiver, light, lightClass))
                 / light.area;
            ++count;
        }
    }
    return sum / count;
}

}  // namespace

double error() {
    const Model &two = models()[APERTURA_MODEL_SOFT_2], &quadric = models()[APERTURA_MODEL_SOFT_L2];
    static const std::vector<SceneReceiver> ofTwo = sceneReceivers(two, 40), ofQuadric = sceneReceivers(quadric, 40);
    return (meanError(two, ofTwo) + meanError(quadric, ofQuadric)) / 2;
}
