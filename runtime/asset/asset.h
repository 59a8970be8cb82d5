#pragma once
// The asset: a glTF 2.0 file whose vertices carry visibility (sh/packing.h) as `_VISIBILITY`.
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/asset/scene.h"
#include "sh/models.h"

namespace apertura {

// How the visibility was baked; stands in the file as asset.extras.apertura.
struct BakeInfo {
    std::string version;
    std::string scene;         // what it was baked from: a file's name without its folder, or builtin:NAME
    std::string model = "sh";  // the recipe (bake/fit/fit.h): sh, rays, sh-fit, or the stored model's name
    double tolerance = 0;      // of the model "auto", 0 for others
    int rays = 256;            // a vertex
    int bits = 8;              // a component
    uint32_t seed = 1;
    double maxDistance = 0;  // metres, 0 for no limit
    double rayOffset = 0;    // metres that rays start above the surface, at most
    std::string hemisphere = "vertex normal";
};

// What the positions of one instance see, in world directions.
struct SeenByInstance {
    std::vector<Visibility> visibility;  // one a position
    std::vector<ModelParams> allParams;  // the same, where a model is stored beside it; else empty
};
using BakedVisibility = std::vector<SeenByInstance>;  // one an instance of the scene

struct Asset {
    Scene scene;
    BakedVisibility seen;
    BakeInfo info;
};

// The model whose parameters the asset stores; nullptr where all is made from the four numbers.
const Model* storedModel(const BakeInfo& info);

// Whether a model's parameters may be interpolated: as its entry says, but not those of a model that can also be
// made from the four numbers, which then are of either kind from vertex to vertex.
bool mayMix(const Model& model, bool stored);

// Bytes that a vertex's visibility takes, on average: the four numbers and what is stored beside them.
double bytesAPoint(const Asset& asset);

// Throws Error naming the scene where `info` holds what JSON cannot: to be asked before the work of a bake.
void requireStorable(const BakeInfo& info, const std::string& name);

// Writes `scene` with its visibility as .glb: a document that the scene came from keeps all its content;
// instances of one mesh get an attribute each and share the rest, what an earlier bake left is replaced, and bytes that
// nothing refers to any more are left out. Throws Error naming `path`.
void writeAsset(const std::string& path, const Scene& scene, const BakedVisibility& visibility, const BakeInfo& info);

// Whether the scene came from a glTF file that holds visibility.
bool hasVisibility(const Scene& scene);

// The visibility that `scene`, read from a glTF file, carries. Throws Error naming it where it has none.
Asset toAsset(Scene scene);

// readGltf and toAsset.
Asset readAsset(const std::string& path);

}  // namespace apertura
