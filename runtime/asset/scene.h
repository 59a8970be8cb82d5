#pragma once
// A scene as triangles: what the baker traces, the asset stores and the renderer draws.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace apertura {

struct GltfDocument;  // runtime/asset/gltf_document.h

// Triangles in a frame of their own; shared by instances.
struct Surface {
    std::vector<glm::vec3> positions;  // metres
    std::vector<glm::vec3> normals;    // unit, one a position
    std::vector<std::array<uint32_t, 3>> triangles;
    bool normalsMade = false;         // not as the file has them: it has none, or none that are unit
    std::vector<uint32_t> splitFrom;  // where vertices were split: the file's vertex that each came from; else empty
    bool twoSided = false;            // its material is seen from both sides: nothing is inside of it
};

struct Instance {
    int surface = 0;
    glm::mat4 toWorld{1};
    int node = -1, primitive = -1;  // where it stands in the glTF document, where there is one
};

// A pinhole camera, right-handed.
struct Camera {
    glm::vec3 eye{0}, target{0, 0, -1};  // metres
    float verticalFov = 0.7f;            // radians
    glm::vec3 up{0, 1, 0};               // what is up in the picture; need not be perpendicular to the view
};

struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
};

struct Scene {
    std::string name;  // the file as it was given, or builtin:NAME: errors begin with it
    std::vector<Surface> surfaces;
    std::vector<Instance> instances;
    std::optional<Camera> camera;
    std::vector<std::string> notes;          // what is amiss in the file but can be worked with, a line each
    std::shared_ptr<GltfDocument> document;  // the glTF that it came from, content untouched
};

// The orthogonal part of a transform's 3 x 3 (polar decomposition; a reflection stays one): it takes
// directions between a surface's frame and the world. Identity for a singular transform.
glm::mat3 rotationPart(const glm::mat4& m);

// What takes normals to the world, up to length. For a singular transform, its rotation part.
glm::mat3 normalMatrix(const glm::mat4& m);

// Where a point of the instance's surface lies: in double, as a small thing far from the origin needs.
inline glm::dvec3 worldPosition(const Instance& instance, const glm::vec3& p) { return glm::dmat4(instance.toWorld) * glm::dvec4(p, 1); }

// A point of a triangle in the world: what baking, truth and measuring mean by it.
struct SurfaceAt {
    glm::dvec3 position;  // metres
    glm::vec3 face;       // unit: the triangle's own normal, on the side of its vertices' normals
    glm::vec3 normal;     // unit: the vertices' normals, interpolated; `face` where they cancel
    double longest;       // metres, the longest edge of the triangle
};

// `barycentrics`: weights of the triangle's corners, 0..1, their sum 1. A triangle of no area has a `face` of no length.
SurfaceAt surfaceAt(const Scene& scene, int instance, int triangle, const glm::vec3& barycentrics);

// The corners of a triangle, in metres in the world.
std::array<glm::dvec3, 3> cornersOf(const Scene& scene, int instance, int triangle);

Box worldBounds(const Scene& scene);
size_t triangleCount(const Scene& scene);  // instances counted

// The scene's own camera, or one that sees all of it from a little above.
Camera viewOf(const Scene& scene);

// Angle-weighted vertex normals; +Y where a vertex has no triangle of any area.
void makeNormals(Surface& surface);

// Gives each triangle its own normal: splits vertices whose triangles lie in several planes, and notes where they came
// from in `splitFrom`. A triangle of no area takes the plane of its neighbours.
void makeFlat(Surface& surface);

// Bytes that a surface takes, about.
double memoryOf(const Surface& surface);

// Throws Error "NAME: WHAT would take ..." where that is more than half of this machine's memory.
void requireMemory(const std::string& name, const std::string& what, double bytes);

// Throws Error, naming `scene.name`, unless there is a triangle, everything is finite and in range, and what the
// instances see fits into this machine's memory.
void validate(const Scene& scene);

}  // namespace apertura
