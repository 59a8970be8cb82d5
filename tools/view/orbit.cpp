#include "tools/view/orbit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apertura {
namespace {

// The camera's directions, with +Y up.
struct Frame {
    glm::dvec3 forward, right, up;
};
Frame frameOf(const Camera& camera) {
    const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.target) - glm::dvec3(camera.eye));
    const glm::dvec3 side = glm::cross(forward, glm::dvec3(0, 1, 0));
    const glm::dvec3 right = glm::length(side) > 1e-6 ? glm::normalize(side) : glm::dvec3(1, 0, 0);
    return {forward, right, glm::cross(right, forward)};
}

// A direction turned about +Y and then up or down, never over the poles.
glm::dvec3 turned(const glm::dvec3& direction, double right, double up) {
    const double length = glm::length(direction);
    const double azimuth = std::atan2(direction.x, -direction.z) + right;
    constexpr double kMost = std::numbers::pi / 2 - 0.01;
    const double elevation = std::clamp(std::asin(std::clamp(direction.y / length, -1.0, 1.0)) + up, -kMost, kMost);
    return length * glm::dvec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth));
}

constexpr double kTurn = 3;  // radians for the picture's height

}  // namespace

void Orbit::turn(double right, double down) {
    camera_.up = {0, 1, 0};
    const glm::dvec3 away = glm::dvec3(camera_.eye) - glm::dvec3(camera_.target);
    camera_.eye = glm::dvec3(camera_.target) + turned(away, -kTurn * right, kTurn * down);
}

void Orbit::look(double right, double down) {
    camera_.up = {0, 1, 0};
    const glm::dvec3 towards = glm::dvec3(camera_.target) - glm::dvec3(camera_.eye);
    const double angle = double(camera_.verticalFov);
    camera_.target = glm::dvec3(camera_.eye) + turned(towards, angle * right, -angle * down);
}

void Orbit::pan(double right, double down) {
    camera_.up = {0, 1, 0};
    const Frame f = frameOf(camera_);
    const double distance = glm::distance(camera_.eye, camera_.target), reach = 2 * distance * std::tan(double(camera_.verticalFov) / 2);
    const glm::vec3 by(reach * (-right * f.right + down * f.up));
    camera_.eye += by, camera_.target += by;
}

void Orbit::zoom(double steps) {
    camera_.up = {0, 1, 0};
    const glm::dvec3 away = glm::dvec3(camera_.eye) - glm::dvec3(camera_.target);
    const double least = 1e-5 * size_, wanted = std::clamp(glm::length(away) * std::pow(0.88, steps), least, 100 * size_);
    camera_.eye = glm::dvec3(camera_.target) + wanted * glm::normalize(away);
}

void Orbit::fly(double right, double up, double forward) {
    camera_.up = {0, 1, 0};
    const Frame f = frameOf(camera_);
    const glm::vec3 by(size_ * (right * f.right + up * glm::dvec3(0, 1, 0) + forward * f.forward));
    camera_.eye += by, camera_.target += by;
}

}  // namespace apertura
