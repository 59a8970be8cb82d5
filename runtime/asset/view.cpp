#include "runtime/asset/view.h"

#include <cmath>

namespace apertura {
namespace {

// Columns: right, up, back.
glm::dmat3 cameraFrame(const Camera& camera) {
    const glm::dvec3 back = glm::normalize(glm::dvec3(camera.eye) - glm::dvec3(camera.target));
    // camera.up, unless it lies along the view: then +Y, or else -Z.
    glm::dvec3 pole(0, 0, -1);
    for (const glm::dvec3& up : {glm::dvec3(0, 1, 0), glm::dvec3(camera.up)})
        if (glm::length(glm::cross(up, back)) > 0.01 * glm::length(up)) pole = up;
    const glm::dvec3 right = glm::normalize(glm::cross(pole, back));
    return {right, glm::cross(back, right), back};
}

}  // namespace

Light directionalLight(const glm::vec3& direction, double radius, const glm::vec3& radiance) {
    return {capLight(glm::normalize(direction), float(std::sin(radius))), vec4(0), vec4(radiance, 0)};
}

Light sphereLight(const glm::vec3& centre, double radius, const glm::vec3& radiance) {
    return {capLight({0, 1, 0}, 0), vec4(centre, radius), vec4(radiance, 0)};
}

glm::mat4 clipTransform(const Camera& camera, double aspect, double nearest) {
    const glm::dmat3 frame = cameraFrame(camera);
    glm::dmat4 view(glm::transpose(frame));
    view[3] = glm::dvec4(-(glm::transpose(frame) * glm::dvec3(camera.eye)), 1);
    const double f = 1 / std::tan(camera.verticalFov / 2);
    glm::dmat4 projection(0);
    projection[0][0] = f / aspect;
    projection[1][1] = -f;
    projection[2][3] = -1;
    projection[3][2] = nearest;
    return glm::mat4(projection * view);
}

glm::vec3 rayThrough(const Camera& camera, double aspect, double u, double v) {
    const double t = std::tan(camera.verticalFov / 2);
    return glm::vec3(cameraFrame(camera) * glm::dvec3((2 * u - 1) * t * aspect, (1 - 2 * v) * t, -1));
}

}  // namespace apertura
