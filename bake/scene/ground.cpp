#include "apertura/bake/scene/ground.h"

#include <algorithm>
#include <cmath>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

constexpr int kSquares = 48;     // a side
constexpr float kBelow = 1e-4f;  // of the scene's extent: its own lowest faces are not in the ground's plane

// Where the ground's middle lies, and its side.
struct Place {
    glm::vec3 middle;
    float side;
};

Place placeUnder(const Scene& scene) {
    const Box box = worldBounds(scene);
    const glm::vec3 size = box.high - box.low;
    const float extent = std::max({size.x, size.y, size.z});
    if (!(extent > 0)) throw Error(scene.name + ": has no extent that a ground could be put under");
    const float below = std::min(box.low.y - kBelow * extent, std::nextafter(box.low.y, -HUGE_VALF));
    return {{0.5f * (box.low.x + box.high.x), below, 0.5f * (box.low.z + box.high.z)}, kGroundSize * extent};
}

// About its middle: what stands far from the origin has no digits to spare. Half of the columns and rows lie beneath the scene, where its
// shadow begins.
Surface squareOf(float side) {
    Surface out;
    const auto at = [&](int k) {
        const float t = 2 * float(k) / kSquares - 1;
        return 0.5f * side * t * std::abs(t);
    };
    for (int z = 0; z <= kSquares; ++z)
        for (int x = 0; x <= kSquares; ++x) out.positions.emplace_back(at(x), 0, at(z));
    for (const glm::vec3& p : out.positions) out.coordinates.emplace_back(p.x / side + 0.5f, p.z / side + 0.5f);
    out.normals.assign(out.positions.size(), {0, 1, 0});
    for (uint32_t z = 0; z < kSquares; ++z)
        for (uint32_t x = 0; x < kSquares; ++x) {
            const uint32_t first = z * (kSquares + 1) + x, below = first + kSquares + 1;
            out.triangles.push_back({first, below, below + 1});
            out.triangles.push_back({first, below + 1, first + 1});
        }
    return out;
}

// Adds bytes as a buffer, a view and an accessor, and returns the accessor's index.
size_t addTo(GltfDocument& document, Json accessor, const void* data, size_t length) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    Json& json = document.json;
    accessor["bufferView"] = listOf(json, "bufferViews").size();
    json["bufferViews"].push_back({{"buffer", listOf(json, "buffers").size()}, {"byteLength", length}});
    json["buffers"].push_back({{"byteLength", length}});
    document.buffers.push_back(std::make_shared<const Bytes>(bytes, bytes + length));
    document.fileBytes += length;
    json["accessors"].push_back(std::move(accessor));
    return json["accessors"].size() - 1;
}

GltfDocument withSurface(GltfDocument document, const Surface& surface, const glm::vec3& middle) {
    Json& json = document.json;
    const auto vectors = [&](const std::vector<glm::vec3>& values, Json members) {
        members.update({{"componentType", kFloat}, {"type", "VEC3"}, {"count", values.size()}});
        return addTo(document, std::move(members), values.data(), values.size() * sizeof(glm::vec3));
    };
    const glm::vec3 low = surface.positions.front(), high = surface.positions.back();
    Json primitive;
    primitive["attributes"]["POSITION"] = vectors(surface.positions, {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}});
    primitive["attributes"]["NORMAL"] = vectors(surface.normals, Json::object());
    primitive["attributes"]["TEXCOORD_0"] = addTo(document,
                                                  {{"componentType", kFloat}, {"type", "VEC2"}, {"count", surface.coordinates.size()}},
                                                  surface.coordinates.data(), surface.coordinates.size() * sizeof(glm::vec2));
    // Beside materials it is grey; where there are none, it is as all the rest.
    if (!listOf(json, "materials").empty()) {
        primitive["material"] = json["materials"].size();
        json["materials"].push_back(
            {{"name", "ground"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}}});
    }
    primitive["indices"] = addTo(document, {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", 3 * surface.triangles.size()}},
                                 surface.triangles.data(), surface.triangles.size() * sizeof(surface.triangles[0]));
    addNode(json, {{"name", "ground"}, {"mesh", listOf(json, "meshes").size()}, {"translation", {middle.x, middle.y, middle.z}}});
    json["meshes"].push_back({{"name", "ground"}, {"primitives", Json::array({primitive})}});
    return document;
}

}  // namespace

Scene withGround(Scene scene) {
    const Camera camera = viewOf(scene);
    const Place place = placeUnder(scene);
    Surface ground = squareOf(place.side);
    const bool hasCamera = !scene.cameras.empty();
    if (scene.document) {
        GltfDocument document = withSurface(*scene.document, ground, place.middle);
        if (!hasCamera) addCamera(document.json, camera);
        scene = sceneOf(std::move(document));
        loadTextures(scene, TexturesFor::Rays);
        return scene;
    }
    if (!hasCamera) scene.cameras.push_back(camera);
    glm::mat4 toWorld(1);
    toWorld[3] = glm::vec4(place.middle, 1);
    scene.instances.push_back({int(scene.surfaces.size()), toWorld});
    scene.surfaces.push_back(std::move(ground));
    return scene;
}

}  // namespace apertura
