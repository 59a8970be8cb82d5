#pragma once
#include <array>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/scene/shapes.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura::test {

// A floor of two halves, each a chart, and a box over where they meet. Across x = 0 the image has a seam.
inline Scene boxOverSeam() {
    Scene scene;
    scene.name = "box over a seam";
    Surface floor, box;
    for (const float side : {-1.0f, 1.0f}) {
        const auto first = uint32_t(floor.positions.size());
        for (const auto& [x, z] : {std::pair(0, -5), {5, -5}, {5, 5}, {0, 5}}) {
            floor.positions.emplace_back(side * float(x), 0, z);
            floor.normals.emplace_back(0, 1, 0);
            // The right half is turned by a right angle.
            const float u = 0.05f + 0.4f * float(x) / 5, v = 0.1f + 0.08f * float(z + 5);
            floor.coordinates.push_back(side < 0 ? glm::vec2(u, v) : glm::vec2(0.55f + 0.4f * float(z + 5) / 10, 0.1f + 0.16f * float(x)));
        }
        for (const auto& [a, b, c] : {std::array{0u, 2u, 1u}, {0u, 3u, 2u}})
            floor.triangles.push_back(side > 0 ? std::array{first + a, first + b, first + c} : std::array{first + a, first + c, first + b});
    }
    addBox(box, {-1, 0.5, -1}, {1, 1.5, 1}, 2);
    for (size_t v = 0; v < box.positions.size(); ++v) {
        const size_t face = v / 4;
        const glm::vec3 n = box.normals[v], p = box.positions[v];
        const glm::vec2 flat = std::abs(n.x) > 0.5f ? glm::vec2(p.y - 1, p.z / 2)
                             : std::abs(n.y) > 0.5f ? glm::vec2(p.x, p.z) / 2.0f
                                                    : glm::vec2(p.x / 2, p.y - 1);
        box.coordinates.push_back((glm::vec2(face % 3, face / 3) + 0.5f + 0.7f * flat) / 3.0f);
    }
    scene.surfaces = {floor, box};
    scene.instances = {{0}, {1}};
    return scene;
}

inline BakeOptions optionsFor(int texels, int threads = 0) {
    BakeOptions options;
    options.at = At::Texels;
    options.texels = texels;
    options.threads = threads;
    return options;
}

}  // namespace apertura::test
