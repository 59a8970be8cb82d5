#pragma once
// Hashes that an asset holds of what its stored points belong to, so that what a tool has put in another order is not taken for what was
// baked. FNV-1a by words of 32 bits (Fowler, Noll and Vo, 1991), in hexadecimal.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "apertura/runtime/asset/scene.h"
#include "apertura/sh/packing.h"

namespace apertura {

class Hash {
public:
    void add(uint32_t word) { value_ = (value_ ^ word) * 0x100000001b3ull; }
    void add(uint64_t words) { add(uint32_t(words)), add(uint32_t(words >> 32)); }
    void add(const glm::vec3& place);
    void add(const glm::vec4& number, int bits);     // -1..1, as the integers that are in the file
    void add(std::span<const unsigned char> bytes);  // each a word
    uint64_t value() const { return value_; }
    std::string text() const;

private:
    uint64_t value_ = 0xcbf29ce484222325ull;
};

// By what samples on faces belong to: the corners of triangles; and what numbers at vertices do: the vertices, as they are written or,
// where reading split them (Surface::splitFrom), as they stand in the file.
enum class HashOrder { Corners, Vertices, VerticesInFile };

// Of all instances, in their order: the places and the stored numbers of their vertices; of those that differ in nothing else, where they
// stand, too.
//   atVertices  of each instance, the numbers of _VISIBILITY, -1..1
std::string hashOfPoints(const Scene& scene, std::span<const std::vector<glm::vec4>> atVertices, int bits, HashOrder order);

// What an instance's points are in the file, -1..1. `rotation`: of its world transform.
std::vector<glm::vec4> numbersInFile(std::span<const Visibility> points, const glm::mat3& rotation, int bits);

}  // namespace apertura
