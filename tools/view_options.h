#pragma once
// What a picture shows, from the command line: for the verbs that draw.
#include <string>
#include <vector>

#include "apertura/runtime/asset/view.h"
#include "tools/commands.h"

namespace apertura {

constexpr int kBounces = 8;  // where nothing says how many

struct ViewOptions {
    std::string camera, sky, background, lights, tone, albedo, around;
    int bounces = 0;
    double azimuth = 135, elevation = 40, radius = 0.27;  // degrees, of the sun
    bool noSun = false, plain = false;
    double punctualRadius = 0;  // metres; 0: the file's own lights are not used
    double exposure = 0;        // stops
    double width = 960, height = 540;

    void addTo(CLI::App& command);
    // Throws CLI::ValidationError for what can be told without the scene.
    void check() const;
    // The view of a scene. Reads the files that it names; see readSky. Throws Error, and adds to `notes`.
    View viewOf(const Scene& scene, std::vector<std::string>& notes) const;
};

// Unit, towards the sun. Azimuth from north (-Z) towards east (+X), elevation above the horizon, degrees.
glm::vec3 sunDirection(double azimuth, double elevation);

// The sun that shines beside the default sky: a surface that faces it gets 2.4 W/m2 times (1, 0.93, 0.82) whatever its radius.
AperturaLight sunLight(double azimuth, double elevation, double radius);

// A picture as a display shows it: with an exposure in stops, and with the neutral tone curve or clamped.
Picture shown(Picture picture, double exposure, bool toned);

}  // namespace apertura
