#pragma once
// Occlusion rays through a scene, by Embree.
#include <array>
#include <memory>
#include <optional>
#include <span>

#include "apertura/bake/sampling/progress.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {

struct Hit {
    SurfaceAt at;
    float distance;  // in lengths of the ray's direction
    bool back;       // the ray came from behind: the side that the vertex normals point away from
    int instance, triangle;
    glm::vec3 barycentrics;
};

// What a material lets through does not block: where a mask has holes, and, of a surface that blends, as large a part of all rays as is
// transparent, chosen by a hash of the ray. `nearest` finds surfaces that blend as they are.
//
// Traces rays about the scene's middle and in units of its size, so that the results are the same to the last bit
// wherever the scene lies and, for powers of two, however large it is.
class Tracer {
public:
    // Builds the acceleration structure; surfaces used more than once are instanced, not copied. `scene` must outlive the
    // tracer. Throws Cancelled, and Error where Embree fails or memory runs out.
    explicit Tracer(const Scene& scene, const Progress& progress = {});
    ~Tracer();
    Tracer(Tracer&&) noexcept;
    const Scene& scene() const;

    // Finds whether rays hit anything: blocked[i] becomes 1 or 0. Safe from any number of threads.
    //   origin      world, metres
    //   directions  any length
    //   distance    how far each ray reaches, in lengths of its direction; `distances`: one for each ray, or one for all
    //   blocked     as many elements as directions
    void occluded(const glm::dvec3& origin, std::span<const glm::vec3> directions, std::span<const float> distances,
                  uint8_t* blocked) const;
    void occluded(const glm::dvec3& origin, std::span<const glm::vec3> directions, float distance, uint8_t* blocked) const;
    bool occluded(const glm::dvec3& origin, const glm::vec3& direction, float distance) const;
    // The nearest hit at any distance.
    std::optional<Hit> nearest(const glm::dvec3& origin, const glm::vec3& direction) const;

    // How far, in metres, a ray should start above the surface at `position` so that it does not hit what it leaves: 32
    // rounding steps of the largest number that an intersection there meets. `longest`: the longest edge, in metres, of
    // the triangles that meet there; default: unknown, as long as the scene.
    double offset(const glm::dvec3& position, double longest = 1e300) const;
    double offset() const;  // the largest anywhere

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

constexpr float kNoLimit = 1e30f;  // a distance beyond everything

}  // namespace apertura
