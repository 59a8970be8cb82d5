#pragma once
// What the light between samples errs, at points that are looked at by rays.
#include <array>
#include <vector>

#include "apertura/bake/sampling/probes.h"
#include "apertura/sh/shading.h"

namespace apertura {

// Of a light's E / (L pi sin^2 r), and of the sky's E over pi.
struct SquaredErrors {
    double light = 0, sky = 0;
};

// Judges what is made of samples through the `soft` aperture. Nearly unbiased, since the two halves of a witness have noises of their own.
class Judge {
public:
    Judge();
    //   fitted  what the renderer makes of the samples about the witness
    //   normal  there, unit, world
    //   spin    of the lights about it, radians
    SquaredErrors at(const Probe& witness, const AperturaReceiver& fitted, const glm::vec3& normal, double spin) const;

    // The mean squared deviation of the lights of three samples, weighed by `shares`, from their mean, of apertures with hard edges.
    double spread(const std::array<AperturaReceiver, 3>& samples, const glm::vec3& shares, const glm::vec3& normal, double spin) const;

private:
    std::vector<glm::vec3> lights_;
};

}  // namespace apertura
