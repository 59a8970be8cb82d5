#pragma once
// Assets of random numbers, on small scenes.
#include "apertura/runtime/asset/asset.h"
#include "tests/support.h"

namespace apertura::test {

inline Visibility anyVisibility(Random& random) {
    const double area = random(0.1, 6);
    return {glm::vec3(random.direction() * random(0, 0.9) * area * (1 - area / (4 * pi))), float(area)};
}

// A square floor of two triangles, and a box that stands in its middle.
inline Scene boxOnFloor() {
    Scene scene;
    scene.name = "box on a floor";
    Surface floor;
    floor.positions = {{-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}};
    floor.normals.assign(4, {0, 1, 0});
    floor.triangles = {{0, 1, 2}, {0, 2, 3}};
    Surface box;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            if (axis == 1 && side < 0) continue;
            const auto first = uint32_t(box.positions.size());
            glm::vec3 n(0), u(0), v(0);
            n[axis] = side, u[(axis + 1) % 3] = 1, v[(axis + 2) % 3] = side;
            for (const auto& [a, b] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
                box.positions.push_back(n + float(a) * u + float(b) * v + glm::vec3(0, 1, 0));
                box.normals.push_back(n);
            }
            box.triangles.push_back({first, first + 1, first + 2});
            box.triangles.push_back({first, first + 2, first + 3});
        }
    scene.surfaces = {floor, box};
    scene.instances = {{0}, {1}};
    return scene;
}

// Two instances, the second one turned, with samples of every kind on their faces.
inline Asset anyAsset(const Scene& scene, const std::string& model, uint64_t seed) {
    Random random(seed);
    Asset out{scene, {}, {}};
    out.info.model = model;
    const Model* stored = storedModel(out.info);
    const auto params = [&] {
        std::vector<float> numbers(size_t(storedNumbers(*stored)));
        for (float& n : numbers) n = float(random(-1, 1));
        return unpackParams(*stored, numbers);
    };
    for (const Instance& instance : scene.instances) {
        const Surface& surface = scene.surfaces[size_t(instance.surface)];
        SeenByInstance seen;
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            seen.visibility.push_back(anyVisibility(random));
            if (stored) seen.allParams.push_back(params());
        }
        std::vector<uint8_t> levels;
        for (size_t t = 0; t < surface.triangles.size(); ++t) levels.push_back(uint8_t(random(0, 5)));
        seen.faces.setLevels(levels, stored != nullptr);
        for (Visibility& v : seen.faces.visibility) v = anyVisibility(random);
        for (ModelParams& p : seen.faces.allParams) p = params();
        out.seen.push_back(std::move(seen));
    }
    return out;
}

}  // namespace apertura::test
