#pragma once
// Visibility in images over texture coordinates: where their texels lie on a surface, and how an asset holds them.
#include <glm/glm.hpp>
#include <set>
#include <vector>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/gltf_writer.h"
#include "apertura/runtime/asset/png.h"
#include "apertura/sh/shading.h"

namespace apertura {

// Throws Error beginning with `where` unless all texture coordinates are finite and within 0..1, and where the triangles lie over each
// other so often that mapping them would take long.
void requireMappable(const Surface& surface, int width, int height, const std::string& where);

// The texture coordinates of a point of a triangle. `barycentrics`: as for surfaceAt.
glm::vec2 coordinatesAt(const Surface& surface, size_t triangle, const glm::vec3& barycentrics);

// The four texels of an image about a point of a triangle.
AperturaTexelCell texelCell(const Surface& surface, size_t triangle, const glm::vec3& barycentrics, int width, int height);

// What of a surface each texel of an image stands for.
struct TexelMap {
    struct Texel {
        int triangle = -1;
        glm::vec3 barycentrics;  // of the triangle's point that is nearest to the texel's middle in the image
        float distance = 0;      // from there to the middle, in texels
    };
    int width, height;
    std::vector<Texel> texels;     // row after row. All have a triangle, unless the surface has none with coordinates
    std::vector<uint8_t> isDrawn;  // bilinear filtering reads it somewhere on the surface; the others are gutters
    std::vector<uint32_t> from;    // the drawn texel that each takes after: itself, or for gutters one close by
    size_t drawn() const;
};

// TEXCOORD_`set` of a primitive that a surface was read from, one per position. The primitive must have it.
std::vector<glm::vec2> readCoordinates(const GltfDocument& document, const Json& primitive, size_t set, const Surface& surface);

// Throws nothing; `surface` must have coordinates, all of them finite and within 0..1.
TexelMap mapTexels(const Surface& surface, int width, int height);

// The next mip: each texel is the mean of what it covers, by area; both sides halved as aperturaMipSize has it. Its normals are unit.
SeenOnTexels halved(const SeenOnTexels& texels);

// How many texels an image has with all its mips.
size_t texelsWithMips(int width, int height);

// Fills `texels.normals` of an instance, from the points of the surface that its texels stand for.
void setTexelNormals(const Scene& scene, size_t instance, const TexelMap& map, SeenOnTexels& texels);

// What an image stores of its texels, four numbers each, -1..1: D / pi in the surface's frame and A / pi - 1. They are linear in
// visibility, so that whatever filters an image filters that.
std::vector<float> texelNumbers(const SeenOnTexels& texels, const glm::mat3& toLocal);
// The same as an asset holds it: RGBA of `bits` bits, round(127 number) + 128 or round(32767 number) + 32768.
PngImage visibilityImage(const SeenOnTexels& texels, const glm::mat3& toLocal, int bits);

// The images of a scene in a document: adds them to it and returns their description, or null where no instance has one.
Json addTexels(GltfWriter& writer, const Scene& scene, const BakedVisibility& visibility, int bits);

// Takes out the textures at the end of the document whose images are called one of `names`, with their images and samplers, as long as
// nothing else uses them. Adds the views that held the images to `views`.
void removeTextures(Json& json, std::initializer_list<const char*> names, std::set<size_t>& views);
// True if there is such a texture, and its image is called so.
bool isImageOf(const Json& json, size_t texture, const char* name);
// The index that `key` names in an entry; SIZE_MAX where there is none.
size_t indexIn(const Json& entry, const char* key);
// A sampler for images of visibility, added to the document: linear, between mips too, without repetition.
size_t addSampler(Json& json);

// Takes out the images that an earlier bake added, but for those behind which others were added, or to which a material refers. Returns the
// views that they held.
std::set<size_t> removeTexels(Json& json);

// Reads the images that `described`, asset.extras.apertura, names into asset.seen, where asset.info.at says that there are some; each lies
// over the set of coordinates that its entry names. Where one is missing it adds a line to the scene's notes. Throws Error naming the scene
// where they are damaged.
void readTexels(Asset& asset, const Json& described);

}  // namespace apertura
