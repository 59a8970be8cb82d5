// The line that stands for a quarter of a large light, for each of four lobes.
// fits shaders/soft.glsl aperturaLobeQuarter 0.9429 0.9056
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "lobes.h"
#include "scene_lights.h"

using namespace apertura;
using namespace apertura::test;

double error() {
    static const std::vector<LobeCase> four = lobeCases(4, 1500, 10, 45);
    static const std::vector<SceneReceiver> inScenes = sceneReceivers(models()[APERTURA_MODEL_FIRM_4]);
    const double steps = steepestInScenes(inScenes, APERTURA_MODEL_FIRM_4, APERTURA_LIGHTS_ANY, {15, 30});
    return rmsOf(four, APERTURA_MODEL_FIRM_4, APERTURA_LIGHTS_ANY) + 3 * std::max(steps - 1, 0.0);
}
