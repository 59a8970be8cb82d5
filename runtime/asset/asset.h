#pragma once
// The asset: a glTF 2.0 file whose vertices carry visibility (sh/packing.h) in the attribute `_VISIBILITY`.
#include <cstdint>
#include <string>
#include <vector>

#include "apertura/runtime/asset/scene.h"
#include "apertura/sh/models.h"

namespace apertura {

// How the visibility was baked. The file holds it as asset.extras.apertura.
struct BakeInfo {
    std::string version;
    std::string scene;         // source: a file's name without its folder, or builtin:NAME
    std::string model = "sh";  // the recipe (bake/fit/fit.h): sh, rays, sh-fit, or the stored model's name
    double tolerance = 0;      // RMSE that "auto" kept within; 0 for other models
    std::string price;         // what "auto" spent least of: numbers, bytes or cycles; empty for other models
    std::string alone;         // the least model that would keep the tolerance as the scene's only one, or "none"; empty: not known
    int rays = 256;            // per vertex; 0: swept
    int azimuths = 0;          // of a height map that was swept, along which; else 0
    double meshError = 0;      // metres that its texels lie above or below its mesh, at most
    int bits = 8;              // per component, 8 or 16
    int packing = 2;           // that lobes were read from, see runtime/asset/params_stream.h; they are written in today's
    uint32_t seed = 1;
    double maxDistance = 0;  // metres beyond which nothing blocks; 0: no limit
    double rayOffset = 0;    // the most metres that rays start above the surface
    std::string hemisphere = "vertex normal";
    std::string at = "vertices";  // where visibility is stored: vertices, or faces too, or texels too
    int bentNormals = 0;          // instances that have images of bent normals and of occlusion beside it, for engines
    std::string bounce;    // what surfaces reflect is stored: "materials", or the albedo that all of them had, "R,G,B"; empty: it is not
    double unmetArea = 0;  // faces: fraction of the area that errs more than was asked for
};

// Visibility on the faces of one instance, for triangles whose vertices do not suffice: lattices of samples (shaders/lattice.glsl), one
// after another in the order of the triangles.
struct SeenOnFaces {
    std::vector<uint8_t>
        levels;  // of each triangle, 0..APERTURA_MAX_LATTICE_LEVEL: see aperturaLatticeSteps; 0: its vertices suffice. Empty: all are 0
    std::vector<uint32_t> first;          // of each triangle, where its lattice begins
    std::vector<Visibility> visibility;   // one per sample
    std::vector<ModelParams> allParams;   // one per sample if a model is stored beside visibility; else empty
    std::vector<AperturaBounce> bounces;  // one per sample if what surfaces reflect is stored, directions in world space; else empty

    int level(size_t triangle) const { return levels.empty() ? 0 : levels[triangle]; }
    // Sets levels and first, and makes room for the samples.
    void setLevels(std::vector<uint8_t> all, bool withParams);
};

// Visibility of one instance in an image over its texture coordinates, row after row from the top: see shaders/texels.glsl. Its gutters are
// filled.
struct SeenOnTexels {
    int width = 0, height = 0;
    std::vector<Visibility> visibility;  // one per texel; empty: there is no image
    std::vector<glm::vec3> normals;      // unit, world: about which each looks. They are not stored: setTexelNormals
    int bits = 8;                        // of a number in the file that it was read from,
    size_t bytes = 0;                    // and what the image takes there
};

// What engines read instead of visibility, in two images over the texture coordinates of one instance: where light comes from on average,
// and how much. Row after row from the top; gutters are filled.
struct BentNormals {
    int width = 0, height = 0;
    // x, y, z: unit, the cosine-weighted mean of the open directions, in the frame of the surface's tangents (runtime/asset/tangents.h);
    // w: the cosine-weighted open part of the hemisphere, 0..1. Empty: there are no images.
    std::vector<glm::vec4> texels;
    std::vector<glm::vec4> tangents;  // one per position, that the asset is to store; empty: the file has its own
};

// Visibility of one instance, with directions in world space.
struct SeenByInstance {
    std::vector<Visibility> visibility;  // one per position
    std::vector<ModelParams> allParams;  // one per position if a model is stored beside visibility; else empty
    SeenOnFaces faces;
    SeenOnTexels texels;                    // where there are some, they are what is drawn
    BentNormals bent{};                     // written, and not read again
    std::vector<AperturaBounce> bounces{};  // one per position if what surfaces reflect is stored; else empty
};
using BakedVisibility = std::vector<SeenByInstance>;  // one per instance of the scene

struct Asset {
    Scene scene;
    BakedVisibility seen;
    BakeInfo info;
};

// The model whose parameters the asset stores; nullptr if it stores the four numbers alone.
const Model* storedModel(const BakeInfo& info);

bool hasSamplesOnFaces(const Asset& asset);
bool hasTexels(const Asset& asset);

// Mean bytes per vertex, and per sample on a face: the four numbers and what is stored beside them.
double bytesAPoint(const Asset& asset);

// All bytes that visibility takes in the file before compression.
size_t visibilityBytes(const Asset& asset);

// Throws Error naming the scene if `info` holds text that is not UTF-8, which JSON cannot hold. Call it before a bake.
void requireStorable(const BakeInfo& info, const std::string& name);

// Writes a scene with its visibility as .glb, whole or not at all.
//   scene       if it came from a glTF document, all content of that is kept; what an earlier bake added is replaced,
//               and bytes that nothing refers to any more are left out
//   visibility  one element per instance; instances of one mesh get an attribute each and share the rest
//   info        `bits` sets the packing; `model` must be that of the parameters in `visibility`
// Throws Error naming `path` if it cannot be written or would exceed the 4 GiB of a .glb, and as requireStorable does.
void writeAsset(const std::string& path, const Scene& scene, const BakedVisibility& visibility, const BakeInfo& info);

// True if the scene came from a glTF file that holds visibility.
bool hasVisibility(const Scene& scene);

// True if it came from one that was baked and has lost its visibility since, to a program that does not keep what it does not know.
bool lostVisibility(const Scene& scene);

// Takes the visibility out of a scene that was read from a glTF file. Throws Error naming the scene if it has none or if
// what is stored is damaged.
Asset toAsset(Scene scene);

// toAsset(readGltf(path)).
Asset loadAsset(const std::string& path);

}  // namespace apertura
