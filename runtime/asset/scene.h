#pragma once
// A scene as triangles, which the baker traces, the asset stores and the renderer draws.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace apertura {

struct GltfDocument;  // runtime/asset/gltf_document.h
struct Texture;       // runtime/asset/materials.h

// How a surface looks: the part of a glTF material that has a meaning for diffuse light.
struct Material {
    glm::vec4 baseColour{1};                     // linear, with alpha
    glm::vec3 emissive{0};                       // linear radiance, W/m2/sr
    int baseTexture = -1, emissiveTexture = -1;  // of the scene's; -1: none
    enum class Alpha { Opaque, Mask, Blend } alpha = Alpha::Opaque;
    float cutoff = 0.5f;  // below which a mask has holes
};

// Of a vertex: where it lies in the textures of its material, and a colour that multiplies theirs. AperturaVertexPaint has the same layout.
struct VertexPaint {
    glm::vec2 base{0}, emissive{0};
    glm::vec4 colour{1};  // linear, with alpha
};

// Triangles in a local frame; several instances may share one.
struct Surface {
    std::vector<glm::vec3> positions;  // metres
    std::vector<glm::vec3> normals;    // unit, one per position
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<glm::vec2> coordinates;  // of textures, one per position, v downwards, as the file has them; empty: it has none
    glm::ivec2 grid{0};                  // texels of the height map that it was made of, over which its coordinates lie; 0: of none
    int coordinateSet = 0;               // which of the file's: TEXCOORD_1 where there is one, else TEXCOORD_0
    bool normalsMade = false;            // computed here: the file has no normals, or its compressed ones are not unit
    std::vector<uint32_t> splitFrom;     // if vertices were split: the file's vertex that each came from; else empty
    bool twoSided = false;               // its material is visible from both sides
    int material = -1;                   // of the scene's; -1: none
    std::vector<VertexPaint> paint;      // one per position; empty: the same everywhere
};

struct Instance {
    int surface = 0;
    glm::mat4 toWorld{1};
    int node = -1, primitive = -1;  // its place in the glTF document, if there is one
};

// A pinhole camera, right-handed.
struct Camera {
    glm::vec3 eye{0}, target{0, 0, -1};  // metres
    float verticalFov = 0.7f;            // radians
    glm::vec3 up{0, 1, 0};               // towards the top of the picture; need not be perpendicular to the view
};

// A light of a glTF file: its place in the file's list, and where it stands.
struct PunctualLight {
    size_t index;
    glm::dmat4 toWorld;
};

// Axis-aligned; the default is empty.
struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
};

struct Scene {
    std::string name;  // the path as given, or builtin:NAME; errors begin with it
    std::vector<Surface> surfaces;
    std::vector<Instance> instances;
    std::vector<Material> materials;                 // empty: the file has none, and everything has one colour
    std::vector<std::shared_ptr<Texture>> textures;  // those of the file, loaded or not
    std::vector<Camera> cameras;                     // the file's own, in the order of its nodes
    std::vector<PunctualLight> punctual;             // its lights (KHR_lights_punctual): see punctualLights
    bool isTerrain = false;                          // made from heights over a plane: from a height map, or builtin:terrain
    std::vector<std::string> notes;                  // faults of the file that the reader works around, a line each
    std::shared_ptr<GltfDocument> document;          // the glTF file that it came from, unchanged; else null
};

// The orthogonal part of a transform's 3 x 3 (polar decomposition; a reflection stays one). It takes directions from a
// surface's frame to the world. Identity for a singular transform.
glm::mat3 rotationPart(const glm::mat4& m);

// Takes normals to the world, up to their length. The rotation part for a singular transform.
glm::mat3 normalMatrix(const glm::mat4& m);

// World position of a point of the instance's surface, in double for small things far from the origin.
inline glm::dvec3 worldPosition(const Instance& instance, const glm::vec3& p) { return glm::dmat4(instance.toWorld) * glm::dvec4(p, 1); }

// A point of a triangle in the world, as baking and measuring use it.
struct SurfaceAt {
    glm::dvec3 position;  // metres
    glm::vec3 face;       // unit: the triangle's geometric normal, on the side of its vertices' normals; 0 for a triangle of no area
    glm::vec3 normal;     // unit: the vertices' normals, interpolated; `face` where they cancel
    double longest;       // metres, the longest edge of the triangle
    bool leans;           // the normal of one of the vertices leans far from `face`, by more than 37 degrees

    // About what a sample on the face looks.
    const glm::vec3& looking() const { return leans ? face : normal; }
};

// `barycentrics`: weights of the triangle's corners, 0..1, with the sum 1.
SurfaceAt surfaceAt(const Scene& scene, int instance, int triangle, const glm::vec3& barycentrics);

// The corners of a triangle, in metres in the world.
std::array<glm::dvec3, 3> cornersOf(const Scene& scene, int instance, int triangle);

Box worldBounds(const Scene& scene);       // metres
size_t triangleCount(const Scene& scene);  // each instance counts

// The scene's own camera, or one from a little above that the whole scene fills the picture of. `aspect`: width over height, of the
// picture.
Camera viewOf(const Scene& scene, double aspect = 16.0 / 9);

// Computes angle-weighted vertex normals; +Y for a vertex whose triangles all have no area.
void makeNormals(Surface& surface);

// Gives each triangle its own normal: splits vertices whose triangles lie in different planes and records their origin in
// `splitFrom`. A triangle of no area takes vertices of its neighbours.
void makeFlat(Surface& surface);

// Approximate bytes that a surface takes.
double memoryOf(const Surface& surface);

// Throws Error "NAME: WHAT would take ..." if `bytes` are more than half of this machine's memory.
void requireMemory(const std::string& name, const std::string& what, double bytes);

// Throws Error naming `scene.name` unless there is a triangle, all positions and transforms are finite, indices are in
// range, all vertices lie within 1e15 m of the origin, and baking all instances takes at most half of this machine's memory.
void validate(const Scene& scene);

}  // namespace apertura
