// The light that a vertex of a baked asset receives from a sun, and from a sky of unit radiance.
//   light ASSET MODEL VERTEX X Y Z DEGREES    X Y Z: towards the sun, of any length; DEGREES: its radius
#include <apertura/asset.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

int main(int argc, char** argv) {
    if (argc != 8) {
        std::fputs("light ASSET MODEL VERTEX X Y Z DEGREES\n", stderr);
        return 2;
    }
    try {
        const apertura::Asset asset = apertura::loadAsset(argv[1]);
        const apertura::Model* const model = apertura::findModel(argv[2]);
        if (!model) {
            std::fprintf(stderr, "there is no model '%s'\n", argv[2]);
            return 2;
        }
        const auto vertex = size_t(std::strtoul(argv[3], nullptr, 10));
        const glm::vec3 towards(std::strtof(argv[4], nullptr), std::strtof(argv[5], nullptr), std::strtof(argv[6], nullptr));
        const double radius = std::strtod(argv[7], nullptr) * 3.14159265358979 / 180;
        const apertura::AperturaReceiver receiver = apertura::receiverAtVertex(asset, *model, 0, vertex);
        const apertura::AperturaCapLight sun = apertura::aperturaCapLight(towards, float(std::sin(radius)));
        std::printf("%.9g %.9g\n", double(apertura::evaluateLight(*model, receiver, sun)), double(apertura::evaluateSky(*model, receiver)));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
