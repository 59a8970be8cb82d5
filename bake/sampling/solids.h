#pragma once
// Points of surfaces, and whether they lie inside solids.
#include <vector>

#include "apertura/bake/sampling/tracer.h"

namespace apertura {

// A point of a surface and the hemisphere it looks into.
struct SurfacePoint {
    glm::dvec3 position;     // world, metres
    glm::vec3 normal;        // unit
    double longest = 1e300;  // metres, the longest edge of the triangles that meet here; default: unknown, as long as the scene
};

// Where the rays of a point start, world, metres: above the surface by the tracer's offset.
//   share  of that offset. Rays of planes, turned and shifted, leave them without a hit at .05 of it and more, and not at .02
inline glm::dvec3 rayOrigin(const Tracer& tracer, const SurfacePoint& point, double share = 1) {
    return point.position + share * tracer.offset(point.position, point.longest) * glm::dvec3(point.normal);
}

// For truth: a tenth, so that what is measured against it sees what the offset of a bake costs.
constexpr double kTruthOffset = 0.1;

// Takes faces for the skins of solids: a point that sees the back of one is inside. Triangles with a twin that faces the other way are no
// skins; nor are parts of two-sided materials, but those whose backs see next to nothing but backs: most programs export solids so, too.
// A ground that goes on behind a one-sided wall counts as inside of it.
class Solids {
public:
    // Both must outlive it.
    Solids(const Scene& scene, const Tracer& tracer);

    static constexpr int kProbes = 16;
    // How many of `probes` rays over the point's hemisphere, rotated by `spin` radians, see the back of a face.
    int backsSeen(const SurfacePoint& point, double spin, int probes = kProbes) const;

    // Parts of two-sided materials that are taken for skins.
    size_t closedParts() const { return closed_; }

    // True where the straight way from one point to another leads out through the back of a face.
    bool comesOut(const SurfacePoint& from, const SurfacePoint& to) const;

private:
    bool isBack(const Hit& hit) const {
        const std::vector<bool>& thin = thin_[size_t(hit.instance)];
        return hit.back && !(thin.empty() ? twins_[size_t(scene_.instances[size_t(hit.instance)].surface)] : thin)[size_t(hit.triangle)];
    }
    void findThin(size_t instance);

    const Scene& scene_;
    const Tracer& tracer_;
    std::vector<std::vector<bool>> twins_;  // triangles of each surface
    std::vector<std::vector<bool>>
        thin_;  // triangles of each instance of a two-sided material that have nothing behind them; of others: none
    size_t closed_ = 0;
};

}  // namespace apertura
