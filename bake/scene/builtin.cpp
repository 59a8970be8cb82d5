#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/builtin.h"
#include "apertura/bake/scene/shapes.h"
#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

using glm::dvec3;

// A seeded stream of random numbers in 0..1.
struct Dice {
    uint32_t seed;
    uint64_t count = 0;
    double operator()() { return hashUnit(seed, count++, 7); }
    double operator()(double low, double high) { return low + (high - low) * (*this)(); }
};

void add(BuiltinScene& out, Surface surface, bool receives) {
    out.scene.instances.push_back({int(out.scene.surfaces.size())});
    out.scene.surfaces.push_back(std::move(surface));
    out.receives.push_back(receives);
}

// A level panel at height 0, `width` along x and `depth` along z, about `centre`.
Surface ground(double width, double depth, double cell, const dvec3& centre = dvec3(0)) {
    Surface surface;
    addPanel(surface, centre + dvec3(-width / 2, 0, depth / 2), {width, 0, 0}, {0, 0, -depth}, cell);
    return surface;
}

Box patch(double x, double z, double width, double depth) {
    return {{float(x - width / 2), -1e3f, float(z - depth / 2)}, {float(x + width / 2), 1e3f, float(z + depth / 2)}};
}

Camera look(glm::vec3 eye, glm::vec3 target, float fov = 0.7f) { return {eye, target, fov}; }

void terrain(BuiltinScene& out) {
    constexpr int quads = 256;
    constexpr double size = 24, lattice = 4;
    Surface surface;
    for (int j = 0; j <= quads; ++j)
        for (int i = 0; i <= quads; ++i) {
            const double x = size * (double(i) / quads - 0.5), z = size * (double(j) / quads - 0.5);
            const dvec3 p(x / lattice, 0.5, z / lattice);
            const double ridge = 1 - std::abs(fractal(p * 0.7 + dvec3(31.7, 0, 12.3), 4, 40)) * 2.2;
            surface.positions.emplace_back(float(x), float(2.2 * fractal(p, 6, 11) + 1.5 * ridge * std::max(ridge, 0.0)), float(z));
        }
    for (uint32_t j = 0; j < quads; ++j)
        for (uint32_t i = 0; i < quads; ++i) {
            const uint32_t p = j * (quads + 1) + i, q = p + quads + 1;
            surface.triangles.push_back({p, q, p + 1});
            surface.triangles.push_back({p + 1, q, q + 1});
        }
    makeNormals(surface);
    add(out, surface, true);
    out.receiverBoxes = {patch(0, 0, size * 3 / 5, size * 3 / 5)};
    out.scene.cameras = {look({0, 11, 21}, {0, -0.5f, 1.5f})};
}

void sphereOverPlane(BuiltinScene& out) {
    add(out, ground(56, 24, 0.2), true);
    const double gaps[] = {0.02, 0.5, 1.5};
    for (int i = 0; i < 3; ++i) {
        const double x = 14.0 * (i - 1);
        Surface sphere;
        addBlob(sphere, {x, 1 + gaps[i], 0}, 64, [](const dvec3&) { return 1.0; });
        add(out, sphere, false);
        out.receiverBoxes.push_back(patch(x, 0, 5, 5));
    }
    out.scene.cameras = {look({0, 7, 26}, {0, 0.5f, 0}, 0.65f)};
}

void room(BuiltinScene& out, int windows) {
    constexpr double width = 6, height = 3, depth = 5, cell = 0.125;
    const Rect front{(width - 2.2) / 2, 0.9, (width + 2.2) / 2, 0.9 + 1.3};
    const Rect side{(depth - 1.6) / 2, 0.9, (depth + 1.6) / 2, 0.9 + 1.3};
    const Rect sky{(width - 1.5) / 2, (depth - 1.5) / 2, (width + 1.5) / 2, (depth + 1.5) / 2};
    const std::span<const Rect> none;
    const double x = width / 2, z = depth / 2;
    Surface inside = ground(width, depth, cell), ceiling;
    // The walls face inwards; front at z = -depth/2, the second window at x = width/2.
    addPanel(inside, {-x, 0, -z}, {width, 0, 0}, {0, height, 0}, cell, {&front, 1});
    addPanel(inside, {x, 0, -z}, {0, 0, depth}, {0, height, 0}, cell, windows >= 2 ? std::span(&side, 1) : none);
    addPanel(inside, {x, 0, z}, {-width, 0, 0}, {0, height, 0}, cell);
    addPanel(inside, {-x, 0, z}, {0, 0, -depth}, {0, height, 0}, cell);
    addPanel(ceiling, {-x, height, -z}, {width, 0, 0}, {0, 0, depth}, cell, windows >= 3 ? std::span(&sky, 1) : none);
    add(out, inside, true);
    add(out, ceiling, false);
    // The ground outside, level with the floor: windows show no sky below the horizon.
    Surface outside;
    const Rect house{20 - x, 20 - z, 20 + x, 20 + z};
    addPanel(outside, {-20, 0, 20}, {40, 0, 0}, {0, 0, -40}, 1, {&house, 1});
    add(out, outside, false);
    out.scene.cameras = {look({-2.7f, 1.7f, 2.3f}, {0.6f, 0.9f, -1.2f}, 1.2f)};
}

void canyon(BuiltinScene& out) {
    constexpr double street = 12, length = 6, depth = 10, end = 45;
    add(out, ground(60, 2 * end + 20, 0.5), true);
    Surface buildings;
    Dice dice{21};
    for (double side : {-1.0, 1.0})
        for (double z = -end; z < end; z += length) {
            const double near = side * street / 2, far = side * (street / 2 + depth);
            addBox(buildings, {std::min(near, far), 0, z}, {std::max(near, far), dice(4, 14), z + length}, 0.5, false);
            if (dice() < 0.25) z += 2;
        }
    add(out, buildings, true);
    Box box = patch(0, 0, street + 0.01, 30);
    out.receiverBoxes = {box};
    out.scene.cameras = {look({-2.5f, 7, 27}, {0.8f, 2.5f, 0}, 0.85f)};
}

void colonnade(BuiltinScene& out) {
    add(out, ground(44, 24, 0.2), true);
    Surface roof, columns;
    addBox(roof, {-14, 4, -2.6}, {14, 4.5, 2.6}, 0.25);
    for (int i = 0; i < 15; ++i)
        for (double z : {-2.0, 2.0}) addFrustum(columns, {2.0 * (i - 7), 0, z}, 0.3, 0.3, 4, 24, 16);
    add(out, roof, false);
    add(out, columns, false);
    out.receiverBoxes = {patch(0, 0, 20, 5)};
    out.scene.cameras = {look({11, 5.5f, 16}, {0.5f, 1.4f, 0}, 0.7f)};
}

void forest(BuiltinScene& out) {
    add(out, ground(36, 36, 0.15), true);
    Surface trees;
    Dice dice{33};
    for (int i = 0; i < 180; ++i) {
        const dvec3 foot(dice(-14, 14), 0, dice(-14, 14));
        const double trunk = dice(0.6, 1.6);
        if (dice() < 0.5) {
            const double radius = dice(0.6, 1.2), height = dice(2.5, 5.5);
            addFrustum(trees, foot, 0.1, 0.1, trunk, 12, 4);
            addFrustum(trees, foot + dvec3(0, trunk, 0), radius, 0, height, 24, 12);
        } else {
            const double radius = dice(0.5, 1.0);
            addFrustum(trees, foot, 0.1, 0.1, trunk + radius, 12, 6);
            addBlob(trees, foot + dvec3(0, trunk + 1.9 * radius, 0), 24, [&](const dvec3&) { return radius; });
        }
    }
    add(out, trees, false);
    out.receiverBoxes = {patch(0, 0, 12, 12)};
    out.scene.cameras = {look({0, 15, 25}, {0, 0, 1}, 0.75f)};
}

void statue(BuiltinScene& out) {
    Surface surface;
    addBlob(surface, dvec3(0), 320, [](const dvec3& w) {
        const double waves = std::sin(5 * w.x) * std::sin(4 * w.y + 1) * std::sin(6 * w.z + 2);
        return 1 + 0.28 * fractal(w * 2.0 + 17.0, 5, 55) + 0.12 * waves;
    });
    add(out, surface, true);
    out.skyAboveGround = false;
    out.scene.cameras = {look({1.7f, 1.6f, 4.1f}, {0, 0.05f, 0}, 0.65f)};
}

struct Builtin {
    const char* name;
    void (*make)(BuiltinScene&);
};
const Builtin kBuiltins[] = {
    {"terrain", terrain},
    {"sphere-over-plane", sphereOverPlane},
    {"room-1", [](BuiltinScene& s) { room(s, 1); }},
    {"room-2", [](BuiltinScene& s) { room(s, 2); }},
    {"room-3", [](BuiltinScene& s) { room(s, 3); }},
    {"canyon", canyon},
    {"colonnade", colonnade},
    {"forest", forest},
    {"statue", statue},
    {"arcade", makeArcade},
};

}  // namespace

const std::vector<std::string>& builtinNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> out;
        for (const Builtin& b : kBuiltins) out.push_back(b.name);
        return out;
    }();
    return names;
}

Scene makeBuiltin(const std::string& name) {
    if (std::optional<BuiltinScene> found = findBuiltin("builtin:" + name)) return std::move(found->scene);
    std::string known;
    for (const Builtin& b : kBuiltins) known += std::string(" ") + b.name;
    throw Error("builtin:" + name + ": there is no such scene; there are" + known);
}

std::optional<BuiltinScene> findBuiltin(const std::string& name) {
    const auto found = std::find_if(std::begin(kBuiltins), std::end(kBuiltins),
                                    [&](const Builtin& b) { return name == std::string("builtin:") + b.name; });
    if (found == std::end(kBuiltins)) return std::nullopt;
    BuiltinScene out;
    out.scene.name = name;
    out.scene.isTerrain = name == "builtin:terrain";
    found->make(out);
    validate(out.scene);
    return out;
}

}  // namespace apertura
