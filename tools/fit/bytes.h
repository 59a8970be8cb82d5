#pragma once
// What the bytes of an asset add to the light on receivers of the built-in scenes.
#include <map>

#include "scene_lights.h"

namespace apertura::test {

// The mean of what bytes add to the light on receivers of the built-in scenes, for lights of 1, 5 and 15 degrees all over the sky.
inline double meanError(const Model& model, const std::vector<SceneReceiver>& receivers) {
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

// Of several models, by their numbers.
inline double meanErrorOf(std::initializer_list<int> some) {
    static std::map<int, std::vector<SceneReceiver>> receivers;
    double sum = 0;
    for (const int id : some) {
        const auto [own, fresh] = receivers.try_emplace(id);
        if (fresh) own->second = sceneReceivers(models()[size_t(id)], 40);
        sum += meanError(models()[size_t(id)], own->second);
    }
    return sum / double(some.size());
}

}  // namespace apertura::test
