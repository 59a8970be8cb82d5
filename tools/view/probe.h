#pragma once
// What a point of the scene sees: traced, and as models have it.
#include <optional>
#include <string>
#include <vector>

#include "apertura/bake/sampling/tracer.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {

struct ProbeResult {
    static constexpr int kCells = 40;  // across the disc that the hemisphere is drawn as

    glm::vec3 position{0}, normal{0};  // world, metres
    Visibility visibility;             // the four numbers, interpolated
    std::vector<int8_t> traced;        // kCells^2, row by row from the top: 1 open, 0 blocked, -1 beside the disc
    struct OfModel {
        std::string name;
        double irradiance;  // W/m2, of all lights and the sky, the mean of red, green and blue
    };
    std::vector<OfModel> models;
    double truth = 0;
    std::vector<float> shown;  // what the drawn model makes of it, 0..1; as `traced`
};

// Traces on the thread that asks: about 10 ms.
class Probe {
public:
    Probe(const Asset& asset, const Tracer& tracer) : asset_(asset), tracer_(tracer) {}
    // The point that is seen along a ray from the camera's eye; nullopt: the ray meets nothing. `model`: whose visibility `shown` is.
    std::optional<ProbeResult> at(const View& view, const glm::vec3& ray, const Model& model) const;

private:
    const Asset& asset_;
    const Tracer& tracer_;
};

// The direction, in a frame whose z is the normal, of a cell of the disc; nullopt beside it.
std::optional<glm::vec3> directionOfCell(int x, int y);

}  // namespace apertura
