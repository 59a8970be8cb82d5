#include "runtime/scene.h"

#include <cmath>

#include "runtime/error.h"

namespace apertura {
namespace {

constexpr float kFarthest = 1e15f;  // metres; beyond, squares of lengths leave float32

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

glm::mat3 rotationPart(const glm::mat4& m) {
    glm::dmat3 q(m);
    // Higham's iteration converges quadratically to the orthogonal factor.
    for (int i = 0; i < 60; ++i) {
        const double det = glm::determinant(q);
        if (!(std::abs(det) > 1e-300)) return glm::mat3(1);
        const double scale = i == 0 ? 1 / std::cbrt(std::abs(det)) : 1;
        const glm::dmat3 s = q * scale, next = 0.5 * (s + glm::transpose(glm::inverse(s)));
        double change = 0;
        for (int c = 0; c < 3; ++c) change += glm::length(next[c] - q[c]);
        q = next;
        if (change < 1e-14) break;
    }
    return glm::mat3(q);
}

glm::mat3 normalMatrix(const glm::mat4& m) {
    const glm::dmat3 linear(m);
    const double det = glm::determinant(linear);
    if (!(std::abs(det) > 1e-300)) return rotationPart(m);
    const glm::dmat3 cofactor = glm::transpose(glm::inverse(linear));
    double largest = 0;  // made 1: floats do not hold the squares of all scales
    for (int c = 0; c < 3; ++c) largest = std::max(largest, glm::length(cofactor[c]));
    return glm::mat3(cofactor / largest);
}

Box worldBounds(const Scene& scene) {
    Box box;
    for (const Instance& instance : scene.instances)
        for (const glm::vec3& p : scene.surfaces[instance.surface].positions) {
            const glm::vec3 world(worldPosition(instance, p));
            box.low = glm::min(box.low, world);
            box.high = glm::max(box.high, world);
        }
    return box;
}

size_t triangleCount(const Scene& scene) {
    size_t n = 0;
    for (const Instance& instance : scene.instances) n += scene.surfaces[instance.surface].triangles.size();
    return n;
}

Camera viewOf(const Scene& scene) {
    if (scene.camera) return *scene.camera;
    const Box box = worldBounds(scene);
    Camera camera;
    camera.target = 0.5f * (box.low + box.high);
    const glm::vec3 back = glm::normalize(glm::vec3(0.45f, 0.55f, 1.0f));
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back)), up = glm::cross(back, right);
    // As near as keeps every corner of the box in a picture of 3 : 2, with a little air.
    const float tangent = std::tan(camera.verticalFov / 2) * 0.92f;
    float distance = 1e-6f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p = glm::vec3(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                      corner & 4 ? box.high.z : box.low.z) - camera.target;
        const float needed = std::max(std::abs(glm::dot(p, up)), std::abs(glm::dot(p, right)) / 1.5f) / tangent;
        distance = std::max(distance, glm::dot(p, back) + needed);
    }
    camera.eye = camera.target + distance * back;
    return camera;
}

void makeNormals(Surface& surface) {
    std::vector<glm::dvec3> sums(surface.positions.size(), glm::dvec3(0));
    for (const auto& triangle : surface.triangles)
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 p = surface.positions[triangle[k]];
            const glm::dvec3 a = glm::dvec3(surface.positions[triangle[(k + 1) % 3]]) - p;
            const glm::dvec3 b = glm::dvec3(surface.positions[triangle[(k + 2) % 3]]) - p;
            const glm::dvec3 n = glm::cross(a, b);
            const double length = glm::length(n);
            if (length > 0) sums[triangle[k]] += n / length * std::atan2(length, glm::dot(a, b));
        }
    surface.normals.resize(sums.size());
    for (size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        surface.normals[i] = length > 1e-12 ? glm::vec3(sums[i] / length) : glm::vec3(0, 1, 0);
    }
    surface.normalsMade = true;
}

void validate(const Scene& scene) {
    if (triangleCount(scene) == 0) throw Error(scene.name + ": no triangles");
    for (const Surface& surface : scene.surfaces) {
        for (const glm::vec3& p : surface.positions)
            if (!finite(p)) throw Error(scene.name + ": a vertex position is not a finite number");
        for (const auto& triangle : surface.triangles)
            for (uint32_t index : triangle)
                if (index >= surface.positions.size())
                    throw Error(scene.name + ": triangle index " + std::to_string(index)
                                + " is out of range, there are " + std::to_string(surface.positions.size())
                                + " vertices");
    }
    for (const Instance& instance : scene.instances)
        for (int c = 0; c < 4; ++c)
            if (!finite(glm::vec3(instance.toWorld[c])))
                throw Error(scene.name + ": a node transform is not finite");
    const Box box = worldBounds(scene);
    const float reach = std::max(glm::length(box.low), glm::length(box.high));
    if (!(reach < kFarthest)) throw Error(scene.name + ": a vertex lies farther than 1e15 m from the origin");
}

}  // namespace apertura
