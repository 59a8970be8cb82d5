#include "apertura/runtime/asset/hashes.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <map>

namespace apertura {

void Hash::add(const glm::vec3& place) {
    for (int c = 0; c < 3; ++c) add(std::bit_cast<uint32_t>(place[c] + 0.0f));  // -0 is 0
}

void Hash::add(const glm::vec4& number, int bits) {
    const float top = bits == 16 ? 32767 : 127;
    for (int c = 0; c < 4; ++c) add(uint32_t(std::lround(number[c] * top)));
}

void Hash::add(std::span<const unsigned char> bytes) {
    for (const unsigned char byte : bytes) add(uint32_t(byte));
}

std::string Hash::text() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value_));
    return text;
}

std::string hashOfPoints(const Scene& scene, std::span<const std::vector<glm::vec4>> atVertices, int bits, HashOrder order) {
    const auto addAll = [order](Hash& hash, const Surface& surface, const auto& addVertex) {
        if (order == HashOrder::VerticesInFile && !surface.splitFrom.empty()) {
            std::map<uint32_t, size_t> parts;  // of each vertex in the file, the first of those that it became
            for (size_t v = 0; v < surface.splitFrom.size(); ++v) parts.try_emplace(surface.splitFrom[v], v);
            for (const auto& [inFile, v] : parts) addVertex(hash, v);
            return;
        }
        if (order != HashOrder::Corners) {
            for (size_t v = 0; v < surface.positions.size(); ++v) addVertex(hash, v);
            return;
        }
        for (const auto& t : surface.triangles)
            for (const uint32_t v : t) addVertex(hash, v);
    };
    std::vector<uint64_t> surfaces;
    for (const Surface& surface : scene.surfaces) {
        Hash hash;
        addAll(hash, surface, [&](Hash& all, size_t v) { all.add(surface.positions[v]); });
        surfaces.push_back(hash.value());
    }
    std::vector<uint64_t> instances;
    std::map<uint64_t, int> alike;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const auto surface = size_t(scene.instances[i].surface);
        Hash hash;
        hash.add(surfaces[surface]);
        addAll(hash, scene.surfaces[surface], [&](Hash& all, size_t v) { all.add(atVertices[i][v], bits); });
        instances.push_back(hash.value());
        ++alike[hash.value()];
    }
    Hash hash;
    for (size_t i = 0; i < instances.size(); ++i) {
        hash.add(instances[i]);
        // Nothing but their places tells these apart.
        if (alike[instances[i]] > 1) hash.add(glm::vec3(scene.instances[i].toWorld[3]));
    }
    return hash.text();
}

std::vector<glm::vec4> numbersInFile(std::span<const Visibility> points, const glm::mat3& rotation, int bits) {
    std::vector<glm::vec4> out;
    out.reserve(points.size());
    const glm::mat3 toLocal = glm::transpose(rotation);
    for (const Visibility& v : points) {
        const Visibility local{toLocal * v.direction, v.area};
        out.push_back(bits == 16 ? normalised(pack16(local)) : normalised(pack8(local)));
    }
    return out;
}

}  // namespace apertura
