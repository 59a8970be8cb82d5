#pragma once
// Which of the points that visibility is stored at lie beside each other.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "apertura/runtime/asset/asset.h"
#include "apertura/sh/shading.h"

namespace apertura {

// The neighbours of each of a number of points.
class Neighbours {
public:
    Neighbours() = default;
    // `edges`: in any order, as often as they like; those from a point to itself are left out. BothWays: the two points are each other's
    // neighbours; OneWay: the second is one of the first.
    enum class Edges { BothWays, OneWay };
    Neighbours(size_t points, std::vector<std::pair<uint32_t, uint32_t>> edges, Edges kind = Edges::BothWays);
    std::span<const uint32_t> of(size_t point) const { return {all_.data() + first_[point], first_[point + 1] - first_[point]}; }
    // Its neighbours and theirs, without itself, in rising order.
    std::vector<uint32_t> withinTwo(size_t point) const;

private:
    std::vector<uint32_t> first_{0}, all_;
};

// Calls use(a, b) once for each edge between the cells of a lattice, with its two samples.
template <typename Use>
void forLatticeEdges(int steps, Use&& use) {
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i + j < steps; ++i) {
            const int at = aperturaLatticeRow(j, steps) + i, above = aperturaLatticeRow(j + 1, steps) + i;
            use(at, at + 1);
            use(at, above);
            use(at + 1, above);
        }
}

// The points of an instance that visibility is stored at: its vertices, then the samples of its faces in their order. Two of them are
// twins where they lie at one place and look as the first one there does within 30 degrees: vertices that are split for texture
// coordinates, triangles that share no vertices, corners and edges of two faces' lattices. The first of all twins stands for them;
// neighbours are ends of the edges of cells (of whole triangles where the vertices suffice), each by its first twin.
class StoredPoints {
public:
    // A place on a triangle. Barycentrics are weights of its corners.
    struct Place {
        int triangle = -1;  // -1: no cell that is drawn has the point
        glm::vec3 barycentrics;
    };
    // `faces`: null for the vertices alone.
    StoredPoints(const Scene& scene, size_t instance, const SeenOnFaces* faces = nullptr);
    size_t size() const { return twin_.size(); }
    const Place& place(size_t point) const { return places_[point]; }
    uint32_t firstTwin(size_t point) const { return twin_[point]; }
    std::span<const uint32_t> neighbours(size_t point) const { return neighbours_.of(twin_[point]); }
    std::vector<uint32_t> withinTwo(size_t point) const { return neighbours_.withinTwo(twin_[point]); }

private:
    std::vector<Place> places_;
    std::vector<uint32_t> twin_;
    Neighbours neighbours_;
};

}  // namespace apertura
