#include "apertura/runtime/render/geometry.h"

#include <algorithm>
#include <array>

#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/faces.h"
#include "apertura/runtime/asset/texels.h"
#include "apertura/sh/packing.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr uint32_t kTexels = 15;  // SAMPLES_ARE_TEXELS of scene.glsl

const Surface& surfaceOf(const Asset& asset, const GeometryPiece& piece) {
    return asset.scene.surfaces[size_t(asset.scene.instances[size_t(piece.instance)].surface)];
}

size_t samplesOn(const SeenOnFaces& faces, size_t triangle) {
    const int level = faces.level(triangle);
    return level > 0 ? size_t(aperturaLatticeSize(aperturaLatticeSteps(level))) : 0;
}

// Of an instance's image and its mips.
size_t texelsOf(const SeenByInstance& seen) {
    return seen.texels.visibility.empty() ? 0 : texelsWithMips(seen.texels.width, seen.texels.height);
}

glm::vec3 unitNormal(const glm::mat3& normals, const glm::vec3& normal) {
    const glm::vec3 n = normals * normal;
    const float length = glm::length(n);
    return length > 0 ? n / length : glm::vec3(0, 1, 0);
}

}  // namespace

std::vector<GeometryPart> splitGeometry(const Asset& asset, const PartLimits& limits) {
    std::vector<GeometryPart> parts(1);
    for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
        const Surface& surface = asset.scene.surfaces[size_t(asset.scene.instances[i].surface)];
        const SeenOnFaces& faces = asset.seen[i].faces;
        std::vector<uint32_t> vertexInPart(surface.positions.size(), kNone);
        const size_t texels = texelsOf(asset.seen[i]);
        const auto begin = [&](size_t triangle) {
            parts.back().pieces.push_back({int(i), triangle, {}, {}});
            parts.back().moreSamples += texels;
        };
        if (parts.back().triangles > 0 && parts.back().vertices + parts.back().moreSamples + texels > limits.samples) parts.emplace_back();
        begin(0);
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const std::array<uint32_t, 3>& corners = surface.triangles[t];
            const auto isNew = [&](uint32_t v) { return vertexInPart[v] == kNone; };
            const size_t more = size_t(std::count_if(corners.begin(), corners.end(), isNew)), onFace = texels > 0 ? 0 : samplesOn(faces, t);
            const GeometryPart& now = parts.back();
            // An image is in one part with all triangles that the other limits allow: without it none of them could be drawn.
            const bool isFull = texels == 0 && now.vertices + now.moreSamples + more + onFace > limits.samples;
            if (now.triangles > 0 && (now.triangles + 1 > limits.triangles || now.vertices + more > limits.vertices || isFull)) {
                for (const uint32_t v : now.pieces.back().vertices) vertexInPart[v] = kNone;
                parts.emplace_back();
                begin(t);
            }
            GeometryPart& part = parts.back();
            GeometryPiece& piece = part.pieces.back();
            for (const uint32_t v : corners) {
                if (isNew(v)) {
                    vertexInPart[v] = uint32_t(part.vertices++);
                    piece.vertices.push_back(v);
                }
                piece.corners.push_back(vertexInPart[v]);
            }
            part.moreSamples += onFace;
            ++part.triangles;
        }
    }
    return parts;
}

std::vector<AperturaSceneVertex> verticesOf(const Asset& asset, const GeometryPart& part) {
    std::vector<AperturaSceneVertex> out;
    out.reserve(part.vertices);
    for (const GeometryPiece& piece : part.pieces) {
        const Surface& surface = surfaceOf(asset, piece);
        const glm::mat4& toWorld = asset.scene.instances[size_t(piece.instance)].toWorld;
        const glm::mat3 normals = normalMatrix(toWorld);
        for (const uint32_t v : piece.vertices) {
            const glm::vec2 coordinates = surface.coordinates.empty() ? glm::vec2(0) : surface.coordinates[v];
            out.push_back({glm::vec4(glm::vec3(toWorld * glm::vec4(surface.positions[v], 1)), coordinates.x),
                           vec4(unitNormal(normals, surface.normals[v]), coordinates.y)});
        }
    }
    return out;
}

std::vector<AperturaVertexPaint> paintOf(const Asset& asset, const GeometryPart& part) {
    if (asset.scene.materials.empty()) return {{vec4(0), vec4(1)}};
    std::vector<AperturaVertexPaint> out;
    out.reserve(part.vertices);
    for (const GeometryPiece& piece : part.pieces) {
        const std::vector<VertexPaint>& paint = surfaceOf(asset, piece).paint;
        for (const uint32_t v : piece.vertices) {
            const VertexPaint own = paint.empty() ? VertexPaint() : paint[v];
            out.push_back({vec4(own.base, own.emissive), own.colour});
        }
    }
    return out;
}

std::vector<uint32_t> indicesOf(const Asset& asset, const GeometryPart& part, bool onFaces, bool onTexels) {
    std::vector<uint32_t> out;
    out.reserve(part.triangles * size_t(3 + (onFaces || onTexels) + onTexels));
    for (const GeometryPiece& piece : part.pieces) out.insert(out.end(), piece.corners.begin(), piece.corners.end());
    auto first = uint32_t(part.vertices);
    for (const GeometryPiece& piece : part.pieces) {
        const SeenOnFaces& faces = asset.seen[size_t(piece.instance)].faces;
        const size_t texels = texelsOf(asset.seen[size_t(piece.instance)]);
        if (texels > 0) {
            out.insert(out.end(), piece.triangles(), first << 4 | kTexels);
            first += uint32_t(texels);
            continue;
        }
        for (size_t t = piece.firstTriangle; (onFaces || onTexels) && t < piece.firstTriangle + piece.triangles(); ++t) {
            const int level = faces.level(t);
            out.push_back(level > 0 ? first << 4 | uint32_t(level) : 0);
            first += uint32_t(samplesOn(faces, t));
        }
    }
    for (const GeometryPiece& piece : part.pieces) {
        const SeenOnTexels& texels = asset.seen[size_t(piece.instance)].texels;
        if (onTexels) out.insert(out.end(), piece.triangles(), uint32_t(texels.width) | uint32_t(texels.height) << 16);
    }
    return out;
}

void forSamples(const Asset& asset, const GeometryPart& part, const UseSample& use) {
    for (const GeometryPiece& piece : part.pieces) {
        const SeenByInstance& seen = asset.seen[size_t(piece.instance)];
        const glm::mat3 normals = normalMatrix(asset.scene.instances[size_t(piece.instance)].toWorld);
        for (const uint32_t v : piece.vertices)
            use(seen.visibility[v], seen.allParams.empty() ? nullptr : &seen.allParams[v],
                [&] { return unitNormal(normals, surfaceOf(asset, piece).normals[v]); });
    }
    for (const GeometryPiece& piece : part.pieces) {
        const SeenOnFaces& faces = asset.seen[size_t(piece.instance)].faces;
        const SeenOnTexels& texels = asset.seen[size_t(piece.instance)].texels;
        SeenOnTexels mip;
        for (const SeenOnTexels* image = &texels; !image->visibility.empty(); image = &mip) {
            for (size_t k = 0; k < image->visibility.size(); ++k) use(image->visibility[k], nullptr, [&] { return image->normals[k]; });
            mip = image->visibility.size() > 1 ? halved(*image) : SeenOnTexels();
        }
        for (size_t t = piece.firstTriangle; texels.visibility.empty() && t < piece.firstTriangle + piece.triangles(); ++t) {
            const int steps = aperturaLatticeSteps(std::max(faces.level(t), 1));
            for (size_t k = 0; k < samplesOn(faces, t); ++k) {
                const size_t at = faces.first[t] + k;
                use(faces.visibility[at], faces.allParams.empty() ? nullptr : &faces.allParams[at],
                    [&] { return surfaceAt(asset.scene, piece.instance, int(t), latticePoint(int(k), steps)).looking(); });
            }
        }
    }
}

std::vector<glm::uvec2> bouncesOf(const Asset& asset, const GeometryPart& part) {
    std::vector<glm::uvec2> out;
    if (!hasBounces(asset)) return {glm::uvec2(0)};
    out.reserve(part.vertices + part.moreSamples);
    const auto add = [&](const AperturaBounce& bounce) {
        const PackedBounce packed = pack(bounce);
        glm::uvec2 words(0);
        for (size_t c = 0; c < 3; ++c) {
            words.x |= uint32_t(packed.share[c]) << (8 * c);
            words.y |= uint32_t(uint8_t(packed.towards[c])) << (8 * c);
        }
        out.push_back(words);
    };
    for (const GeometryPiece& piece : part.pieces)
        for (const uint32_t v : piece.vertices) add(asset.seen[size_t(piece.instance)].bounces[v]);
    for (const GeometryPiece& piece : part.pieces) {
        const SeenOnFaces& faces = asset.seen[size_t(piece.instance)].faces;
        for (size_t t = piece.firstTriangle; t < piece.firstTriangle + piece.triangles(); ++t)
            for (size_t k = 0; k < samplesOn(faces, t); ++k) add(faces.bounces[faces.first[t] + k]);
    }
    return out;
}

}  // namespace apertura
