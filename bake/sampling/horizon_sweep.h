#pragma once
// The innermost loop of the sweep: horizons of all texels of a height field along one azimuth and the opposite one.
//
// Parallel lines a texel apart run through the field, and each keeps the convex hull of the heights that it has passed: the horizon of its
// next point is where the hull's tangent touches, in constant time on average (Timonen & Westerholm, "Scalable Height Field
// Self-Shadowing", 2010). A texel lies between two lines and mixes what it sees, from its own height, of the places that are the horizons
// of either. What lies nearer than kNear texels is looked at exactly instead, where the azimuth from the texel itself crosses the edges of
// the surface's triangles: that is where lines beside the texel err most.
#include <cstddef>
#include <vector>

namespace apertura {

// A height field with the across direction contiguous, surrounded by places without height.
struct SweepField {
    static constexpr float kNone = -1e30f;  // metres: no height
    // Of no height on all sides: as far as the lines and the nearest crossings of edges reach out of the map.
    static constexpr int kAround = 8, kBeside = 48;

    int along = 0, across = 0;          // texels in the direction in which lines advance, and in the other
    size_t stride = 0;                  // from one step along to the next
    std::vector<float> heights;         // metres
    std::vector<float> slopes[2];       // of the surface, along and across; empty where horizons alone are wanted
    std::vector<float> area, vertical;  // sums over the azimuths so far: 1 - sin h and cos^2 h / 2,
    std::vector<float> horizontal[2];   // and (acos(sin h) - sin h cos h) / 2 times the azimuth's direction along and across
    size_t at(int a, int b) const { return size_t(a + kAround) * stride + size_t(b + kBeside); }
    size_t size() const { return size_t(along + 2 * kAround) * stride; }
};

// Where the azimuth from any texel crosses an edge of the surface.
struct SweepCrossing {
    std::ptrdiff_t from, to;  // of the edge's ends, relative to the texel
    float weight;             // of `to`
    float inverse;            // 1 / metres from the texel to the crossing
    float drop;               // metres that the ground has fallen by there as the earth is round
};

// One azimuth, and the opposite one.
struct SweepDirection {
    float unit[2];                            // forwards: metres along (> 0) and across, a metre
    double shift;                             // texels across for each one along, -1 .. 1
    float step;                               // metres that lines advance a texel along
    float curvature;                          // metres that the ground falls by, a squared metre
    std::vector<SweepCrossing> crossings[2];  // near a texel, forwards and backwards
};

constexpr int kNear = 2;         // texels along within which edges are crossed exactly
constexpr int kSweepLines = 32;  // that are swept together; the last one belongs to the next group
constexpr float kNoHorizon = -1e20f;

// What to keep of the horizons of all texels.
struct SweepHorizons {
    float* tangents[2] = {nullptr, nullptr};  // forwards and backwards, laid out as the field's heights; both or none: else sums are added
};

// Lines that cross the field, in groups of kSweepLines - 1.
int sweepGroups(const SweepField& field, const SweepDirection& direction);

// Sweeps groups `first` .. `end` - 1. Different groups write different texels. The result is the same to the bit on all processors.
void sweepLines(SweepField& field, const SweepDirection& direction, int first, int end, const SweepHorizons& keep);

}  // namespace apertura
