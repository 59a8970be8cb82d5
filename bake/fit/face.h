#pragma once
// A triangle while it is decided how finely it is sampled.
#include <vector>

#include "apertura/bake/fit/face_judge.h"
#include "apertura/bake/sampling/probes.h"
#include "apertura/sh/shading.h"

namespace apertura {

struct Face {
    uint32_t instance, triangle;
    double area;  // m2
    bool leans;   // see SurfaceAt
    int level = 0;
    float tie = 0.03f;  // how strongly its neighbouring samples are drawn together, where a probe's weight is 1
    std::vector<Probe> probes, witnesses;
    SquaredErrors measured;  // the means at the witnesses that are not buried
    double error = 0;        // of both, with what its level errs taken into account
    double gain = 0;         // of its squared error, what a refinement is thought to take away
    double open = 1;         // the fraction of its probes that are not buried
};

// Samples that a face of a level has of its own.
inline int samplesOn(int level) { return level ? aperturaLatticeSize(aperturaLatticeSteps(level)) : 0; }

// Probes that a lattice is fitted to: about three times as many as it has samples of its own.
inline size_t probesFor(int level) {
    const int steps = aperturaLatticeSteps(level);
    return size_t(1.5 * (steps + 1) * (steps + 2));
}

}  // namespace apertura
