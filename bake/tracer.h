#pragma once
// Occlusion rays through a scene, by Embree.
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "runtime/scene.h"

namespace apertura {

// Called now and then with the share done, 0..1; false stops the work. May be empty.
using Progress = std::function<bool(double)>;

// The work was stopped by its Progress.
struct Cancelled {};

struct Hit {
    glm::vec3 position, normal;  // world; the interpolated vertex normal, unit
    float distance;              // in lengths of the ray's direction
};

class Tracer {
public:
    // Builds the acceleration structure; surfaces used more than once are instanced, not copied.
    explicit Tracer(const Scene& scene, const Progress& progress = {});
    ~Tracer();
    Tracer(Tracer&&) noexcept;

    // Whether rays from `origin` along `directions` (any length) hit something within `distance` lengths.
    // blocked[i] is 1 or 0; as many as directions. Safe from any number of threads.
    void occluded(const glm::vec3& origin, std::span<const glm::vec3> directions, float distance,
                  uint8_t* blocked) const;
    bool occluded(const glm::vec3& origin, const glm::vec3& direction, float distance) const;
    std::optional<Hit> nearest(const glm::vec3& origin, const glm::vec3& direction) const;

    // Metres that a ray should start above the surface, so that it does not hit what it leaves: a few
    // rounding steps of the scene's largest coordinate.
    float offset() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

constexpr float kNoLimit = 1e30f;  // a distance that reaches everything

}  // namespace apertura
