#pragma once
// What is unknown on the faces of a scene, for LeastSquares.
#include "apertura/bake/fit/least_squares.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// The unknowns of one instance: its vertices, and the samples on its faces. Where faces meet smoothly, they share the samples of the edge;
// where one has more of them there than the other, those lie on the line between the fewer ones. So nothing jumps across the edge.
class Unknowns {
public:
    // For each triangle of the instance, the level of its lattice (shaders/lattice.glsl) and whether it leans (SurfaceAt). Must not outlive
    // the scene.
    Unknowns(const Scene& scene, size_t instance, std::vector<uint8_t> levels, std::vector<bool> leans);

    size_t count() const { return count_; }
    uint32_t vertex(size_t v) const { return vertexUnknowns_[v]; }

    // The triangle that one meets smoothly across its edge from corner e to the next, or -1.
    int64_t across(size_t t, int e) const;

    // A sample of a triangle's lattice as a sum of unknowns; of level 0, a corner.
    std::vector<Term> sample(size_t t, int at) const;

    // A point of a triangle as a sum of unknowns.
    std::vector<Term> point(size_t t, const glm::vec3& weights) const;

private:
    struct Edge {
        uint32_t first;  // unknown of its first inner sample
        int steps;       // it has steps - 1 inner samples
        bool forwards;   // they lead from corner e to the next one, as they do for the triangle that numbered them
    };

    uint32_t group(size_t t, int corner) const { return welded_[surface_.triangles[t][size_t(corner % 3)]]; }
    void weldVertices();
    void pairEdges();
    void joinCorners();
    void numberSamples();
    std::vector<Term> alongEdge(size_t t, int e, int s) const;

    static constexpr uint32_t kNone = UINT32_MAX;
    const Surface& surface_;
    std::vector<uint8_t> levels_;
    std::vector<bool> leans_;
    std::vector<glm::vec3> normals_;  // of the triangles, world
    std::vector<uint32_t> welded_;    // vertices of one place and normal are one
    uint32_t groups_ = 0;
    std::vector<uint32_t> across_;  // of edge 3 t + e, from corner e of triangle t to the next: the edge that it meets smoothly
    std::vector<uint32_t> vertexUnknowns_, cornerUnknowns_, firstInside_;
    std::vector<Edge> edges_;
    size_t count_ = 0;
};

}  // namespace apertura
