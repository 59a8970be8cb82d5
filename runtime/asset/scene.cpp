#include "apertura/runtime/asset/scene.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>

#include "apertura/runtime/asset/error.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr float kFarthest = 1e15f;    // metres; squares of longer lengths may overflow float32
constexpr double kSingular = 1e-300;  // transforms with a determinant up to this are singular
constexpr double kPlaneSteps = 4096;  // steps per unit of a normal's component; planes whose normals round to the same are one
// Memory while baking, measured: per vertex the point, the four numbers and a model's parameters; per triangle the tracer, and in each
// instance what its samples are fitted to.
constexpr double kBytesAVertex = 150, kBytesATriangle = 150, kBytesAFace = 450;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

glm::mat3 rotationPart(const glm::mat4& m) {
    glm::dmat3 q(m);
    // Higham's iteration converges quadratically to the orthogonal factor. Eigen's JacobiSVD loses it where axes differ in length by more
    // than 1e10: an axis errs by 0.04 at 1e14, and a reflection may be lost.
    for (int i = 0; i < 60; ++i) {
        const double det = glm::determinant(q);
        if (!(std::abs(det) > kSingular)) return glm::mat3(1);
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
    if (!(std::abs(det) > kSingular)) return rotationPart(m);
    const glm::dmat3 cofactor = glm::transpose(glm::inverse(linear));
    double largest = 0;  // becomes 1, since floats cannot hold the squares of all scales
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

Camera viewOf(const Scene& scene, double aspect) {
    if (!scene.cameras.empty()) return scene.cameras.front();
    constexpr double kFilled = 0.92;  // of the picture, along the side that the scene fills
    Camera camera;
    const glm::dvec3 back = glm::normalize(glm::dvec3(0.45, 0.55, 1));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)), up = glm::cross(back, right);
    const double rise = std::tan(camera.verticalFov / 2.0) * kFilled, run = rise * aspect;
    const auto eachPoint = [&](const auto& visit) {
        for (const Instance& instance : scene.instances)
            for (const glm::vec3& position : scene.surfaces[size_t(instance.surface)].positions) {
                const glm::dvec3 p = worldPosition(instance, position);
                visit(glm::dot(p, right), glm::dot(p, up), glm::dot(p, back));
            }
    };
    // A point is in the picture if |x - x0| <= run (z0 - z), and as much along y, of an eye at (x0, y0, z0): each side is the largest of
    // one sum over all points, and the eye stands where two opposite ones meet.
    double most[4] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, nearest = -HUGE_VAL, farthest = HUGE_VAL;
    eachPoint([&](double x, double y, double z) {
        const double sides[4] = {run * z + x, run * z - x, rise * z + y, rise * z - y};
        for (int k = 0; k < 4; ++k) most[k] = std::max(most[k], sides[k]);
        nearest = std::max(nearest, z), farthest = std::min(farthest, z);
    });
    const double least = std::max(1e-6, 1e-3 * (nearest - farthest));  // metres before the nearest point
    const double z0 = std::max({(most[0] + most[1]) / (2 * run), (most[2] + most[3]) / (2 * rise), nearest + least});
    double place[2] = {(most[0] - most[1]) / 2, (most[2] - most[3]) / 2};
    // That is the middle of the side that is full. Along the other there is room, and the eye goes to where as much is left on either side
    // of the two points that stand out most, for as long as others do not; and no farther than all stays in the picture.
    for (int step = 0; step < 6; ++step) {
        struct Outermost {
            double share, at, depth;
        };
        Outermost ends[2][2] = {{{HUGE_VAL, 0, 1}, {-HUGE_VAL, 0, 1}}, {{HUGE_VAL, 0, 1}, {-HUGE_VAL, 0, 1}}};
        eachPoint([&](double x, double y, double z) {
            const double at[2] = {x, y};
            for (int axis = 0; axis < 2; ++axis) {
                const double share = (at[axis] - place[axis]) / (z0 - z);
                if (share < ends[axis][0].share) ends[axis][0] = {share, at[axis], z0 - z};
                if (share > ends[axis][1].share) ends[axis][1] = {share, at[axis], z0 - z};
            }
        });
        for (int axis = 0; axis < 2; ++axis) {
            const auto& [low, high] = ends[axis];
            const double even = (low.at * high.depth + high.at * low.depth) / (low.depth + high.depth);
            const double reach = (axis == 0 ? run : rise) * z0, least0 = most[2 * axis] - reach, most0 = reach - most[2 * axis + 1];
            place[axis] = least0 < most0 ? std::clamp(even, least0, most0) : 0.5 * (least0 + most0);
        }
    }
    camera.eye = place[0] * right + place[1] * up + z0 * back;
    camera.target = place[0] * right + place[1] * up + 0.5 * (nearest + farthest) * back;
    return camera;
}

std::array<glm::dvec3, 3> cornersOf(const Scene& scene, int instance, int triangle) {
    const Instance& placed = scene.instances[size_t(instance)];
    const Surface& surface = scene.surfaces[size_t(placed.surface)];
    std::array<glm::dvec3, 3> out;
    for (size_t k = 0; k < 3; ++k) out[k] = worldPosition(placed, surface.positions[surface.triangles[size_t(triangle)][k]]);
    return out;
}

SurfaceAt surfaceAt(const Scene& scene, int instance, int triangle, const glm::vec3& barycentrics) {
    const Instance& placed = scene.instances[size_t(instance)];
    const Surface& surface = scene.surfaces[size_t(placed.surface)];
    const std::array<glm::dvec3, 3> c = cornersOf(scene, instance, triangle);
    glm::vec3 sum(0), mean(0);
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& normal = surface.normals[surface.triangles[size_t(triangle)][size_t(k)]];
        sum += normal;
        mean += barycentrics[k] * normal;
    }
    const glm::mat3 normals = normalMatrix(placed.toWorld);
    SurfaceAt out{};
    for (int k = 0; k < 3; ++k) out.position += double(barycentrics[k]) * c[size_t(k)];
    out.longest = std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
    const glm::dvec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
    const glm::vec3 side = normals * sum;
    const double area = glm::length(cross);
    if (area > 0) {
        out.face = glm::vec3(cross / area);
        out.face *= aperturaSideOfFace(out.face, side);
    }
    for (const uint32_t v : surface.triangles[size_t(triangle)]) {
        const glm::vec3 n = normals * surface.normals[v];
        out.leans |= area > 0 && !(glm::dot(n, out.face) > APERTURA_LEANING * glm::length(n));
    }
    const glm::vec3 turned = normals * mean;
    const float length = glm::length(turned);
    out.normal = length > 0 ? turned / length : out.face;
    return out;
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

void makeFlat(Surface& surface) {
    // A vertex and a rounded face normal: triangles at the vertex with the same rounded normal share this part of it.
    struct Part {
        uint32_t vertex;
        int16_t x, y, z;
        bool operator==(const Part&) const = default;
    };
    const auto hash = [](const Part& p) {
        return size_t((((p.vertex * 31ull + uint16_t(p.x)) * 0x9E3779B97F4A7C15ull + uint16_t(p.y)) * 31 + uint16_t(p.z))
                          * 0x9E3779B97F4A7C15ull
                      >> 8);
    };
    std::unordered_map<Part, uint32_t, decltype(hash)> parts(surface.positions.size(), hash);
    const std::vector<glm::vec3> given = std::move(surface.positions);
    const std::vector<glm::vec2> coordinates = std::move(surface.coordinates);
    surface.coordinates.clear();
    const std::vector<VertexPaint> paint = std::move(surface.paint);
    surface.paint.clear();
    std::vector<uint32_t> any(given.size(), UINT32_MAX);
    surface.positions.clear();
    surface.normals.clear();
    surface.splitFrom.clear();
    auto split = [&](uint32_t from, const glm::dvec3& normal) {
        const auto round = [](double x) { return int16_t(std::lround(x * kPlaneSteps)); };
        const auto [part, fresh] = parts.try_emplace({from, round(normal.x), round(normal.y), round(normal.z)},
                                                     uint32_t(surface.positions.size()));
        if (fresh) {
            surface.positions.push_back(given[from]);
            if (!coordinates.empty()) surface.coordinates.push_back(coordinates[from]);
            if (!paint.empty()) surface.paint.push_back(paint[from]);
            surface.normals.emplace_back(normal);
            surface.splitFrom.push_back(from);
        }
        return any[from] = part->second;
    };
    std::vector<size_t> flatless;
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        auto& triangle = surface.triangles[t];
        const glm::dvec3 p(given[triangle[0]]), n = glm::cross(glm::dvec3(given[triangle[1]]) - p, glm::dvec3(given[triangle[2]]) - p);
        const double length = glm::length(n);
        if (length > 0 && std::isfinite(length))
            for (uint32_t& vertex : triangle) vertex = split(vertex, n / length);
        else
            flatless.push_back(t);
    }
    for (const size_t t : flatless)
        for (uint32_t& vertex : surface.triangles[t]) vertex = any[vertex] != UINT32_MAX ? any[vertex] : split(vertex, {0, 1, 0});
    surface.normalsMade = true;
}

double memoryOf(const Surface& surface) {
    return double(surface.positions.size()) * sizeof(glm::vec3) * 2 + double(surface.coordinates.size()) * sizeof(glm::vec2)
         + double(surface.paint.size()) * sizeof(VertexPaint) + double(surface.triangles.size()) * sizeof(surface.triangles[0]);
}

void requireMemory(const std::string& name, const std::string& what, double bytes) {
    static const double machine = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
    if (bytes <= machine / 2) return;
    char text[128];
    std::snprintf(text, sizeof text, " would take %.3g GiB, more than half of this machine's %.3g", bytes / 0x1p30, machine / 0x1p30);
    throw Error(name + ": " + what + text);
}

void validate(const Scene& scene) {
    if (triangleCount(scene) == 0) throw Error(scene.name + ": no triangles");
    double vertices = 0;
    for (const Instance& instance : scene.instances) vertices += double(scene.surfaces[size_t(instance.surface)].positions.size());
    double triangles = 0;
    for (const Surface& surface : scene.surfaces) triangles += double(surface.triangles.size());
    requireMemory(scene.name, "its " + std::to_string(scene.instances.size()) + " instances",
                  vertices * kBytesAVertex + triangles * kBytesATriangle + double(triangleCount(scene)) * kBytesAFace);
    for (const Surface& surface : scene.surfaces) {
        for (const glm::vec3& p : surface.positions)
            if (!finite(p)) throw Error(scene.name + ": a vertex position is not a finite number");
        for (const auto& triangle : surface.triangles)
            for (uint32_t index : triangle)
                if (index >= surface.positions.size())
                    throw Error(scene.name + ": triangle index " + std::to_string(index) + " is out of range, there are "
                                + std::to_string(surface.positions.size()) + " vertices");
    }
    for (const Instance& instance : scene.instances)
        for (int c = 0; c < 4; ++c)
            if (!finite(glm::vec3(instance.toWorld[c]))) throw Error(scene.name + ": a node transform is not finite");
    const Box box = worldBounds(scene);
    const float reach = std::max(glm::length(box.low), glm::length(box.high));
    if (!(reach < kFarthest)) throw Error(scene.name + ": a vertex lies farther than 1e15 m from the origin");
}

}  // namespace apertura
