#pragma once
// What is drawn, as the shaders read it, in parts none of whose buffers is too large to be bound.
#include <functional>
#include <vector>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {

// Triangles of one instance, one after another.
struct GeometryPiece {
    int instance;
    size_t firstTriangle;
    std::vector<uint32_t> vertices;  // of the surface, each that the triangles have
    std::vector<uint32_t> corners;   // three per triangle: vertices of the part
    size_t triangles() const { return corners.size() / 3; }
};

// Its samples are numbered: the vertices of all pieces, then the samples on their faces, or in their images with all mips.
struct GeometryPart {
    std::vector<GeometryPiece> pieces;
    size_t vertices = 0, moreSamples = 0, triangles = 0;
};

// What a part holds at most.
struct PartLimits {
    size_t vertices, samples, triangles;
};

// The scene's triangles in their order. An image is in each part that has a triangle of its mesh. A triangle that alone exceeds the limits
// has a part of its own.
std::vector<GeometryPart> splitGeometry(const Asset& asset, const PartLimits& limits);

// The buffers of a part.
std::vector<AperturaSceneVertex> verticesOf(const Asset& asset, const GeometryPart& part);
// Its paint, or one element where the scene has no materials.
std::vector<AperturaVertexPaint> paintOf(const Asset& asset, const GeometryPart& part);
// The corners of all triangles; behind them one or two numbers for each triangle that say where its samples are, where there are some
// beside the vertices: see scene.glsl.
std::vector<uint32_t> indicesOf(const Asset& asset, const GeometryPart& part, bool onFaces, bool onTexels);

// Calls use(visibility, params, normal) for each sample of a part in turn. `params` is null where the asset stores none; normal() makes the
// normal about which the sample looks, unit, world.
using UseSample = std::function<void(const Visibility&, const ModelParams*, const std::function<glm::vec3()>&)>;
void forSamples(const Asset& asset, const GeometryPart& part, const UseSample& use);

// What surfaces reflect to each sample, in the same order, as bytes: x: PackedBounce::share, y: its `towards`, world. One element where the
// asset holds nothing of the kind.
std::vector<glm::uvec2> bouncesOf(const Asset& asset, const GeometryPart& part);

}  // namespace apertura
