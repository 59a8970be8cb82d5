// The line that stands for a medium light's disc, for each of several lobes.
// fits shaders/soft.glsl aperturaLobeDisc 0.7406 0.9765
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
    static const std::vector<LobeCase> two = lobeCases(2, 1500, 3, 10), three = lobeCases(3, 1500, 3, 10);
    const double rms = std::hypot(rmsOf(two, APERTURA_MODEL_FIRM_2, APERTURA_LIGHTS_MEDIUM),
                                  rmsOf(three, APERTURA_MODEL_FIRM_3, APERTURA_LIGHTS_MEDIUM))
                     / std::sqrt(2);
    static const std::vector<SceneReceiver> inScenes = sceneReceivers(models()[APERTURA_MODEL_FIRM_2]);
    const double steps = std::max(steepestInScenes(inScenes, APERTURA_MODEL_FIRM_2, APERTURA_LIGHTS_MEDIUM, {5, 10}),
                                  steepestOfLobes(2, APERTURA_MODEL_FIRM_2, APERTURA_LIGHTS_MEDIUM, {0.06, 0.12, 0.17}));
    return rms + 3 * std::max(steps - 1, 0.0);
}
