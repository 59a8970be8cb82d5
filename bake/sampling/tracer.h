#pragma once
// Occlusion rays through a scene, by Embree.
#include <array>
#include <memory>
#include <optional>
#include <span>

#include "bake/sampling/progress.h"
#include "runtime/asset/scene.h"

namespace apertura {

struct Hit {
    SurfaceAt at;
    float distance;  // in lengths of the ray's direction
    bool back;       // the ray came from behind: from where the triangle's vertex normals point away
    int instance, triangle;
};

// Rays are traced about the scene's middle and in its own size, so that a scene is the same to the last bit wherever
// it lies and, for powers of two, however large it is.
class Tracer {
public:
    // Builds the acceleration structure; surfaces used more than once are instanced, not copied.
    explicit Tracer(const Scene& scene, const Progress& progress = {});
    ~Tracer();
    Tracer(Tracer&&) noexcept;

    // Whether rays from `origin` along `directions` (any length) hit something within `distance` lengths, or within
    // a distance of its own each. blocked[i] is 1 or 0; as many as directions. Safe from any number of threads.
    void occluded(const glm::dvec3& origin, std::span<const glm::vec3> directions, std::span<const float> distances,
                  uint8_t* blocked) const;
    void occluded(const glm::dvec3& origin, std::span<const glm::vec3> directions, float distance, uint8_t* blocked) const;
    bool occluded(const glm::dvec3& origin, const glm::vec3& direction, float distance) const;
    std::optional<Hit> nearest(const glm::dvec3& origin, const glm::vec3& direction) const;

    // Metres that a ray should start above the surface at `position`, so that it does not hit what it leaves: 32
    // rounding steps of the largest number that an intersection there meets. `longest`: metres, the longest edge of
    // the triangles that meet there; where it is not known, as long as the scene.
    double offset(const glm::dvec3& position, double longest = 1e300) const;
    double offset() const;  // the largest

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

constexpr float kNoLimit = 1e30f;  // a distance that reaches everything

}  // namespace apertura
