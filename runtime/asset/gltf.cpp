#include "apertura/runtime/asset/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/gltf_materials.h"

namespace apertura {
namespace {

constexpr int kDeepestNode = 1000;
// Limits of the positions and indices that are read and of the instances' vertices: a base, and more per byte of the file.
constexpr double kFewElements = 0x1p24, kElementsAByte = 256;
constexpr double kFewVertices = 0x1p22, kVerticesAByte = 64;
constexpr float kFarthestEye = 1e15f;  // metres
// How far a normal's length may be from 1, as in the Khronos validator.
constexpr float kUnitTolerance = 0.0067f;

template <typename Vector>
Vector vectorOr(const Json& node, const char* key, Vector fallback) {
    const auto found = node.find(key);
    if (found == node.end()) return fallback;
    for (int i = 0; i < Vector::length(); ++i) fallback[i] = (*found)[size_t(i)].get<double>();
    return fallback;
}

glm::dmat4 localTransform(const Json& node) {
    glm::dmat4 m(1);
    if (node.contains("matrix")) {
        for (size_t i = 0; i < 16; ++i) m[int(i / 4)][int(i % 4)] = node["matrix"][i].get<double>();
        return m;
    }
    m[3] = glm::dvec4(vectorOr(node, "translation", glm::dvec3(0)), 1);
    const glm::dvec4 q = vectorOr(node, "rotation", glm::dvec4(0, 0, 0, 1));
    m *= glm::mat4_cast(glm::normalize(glm::dquat(q.w, q.x, q.y, q.z)));
    const glm::dvec3 scale = vectorOr(node, "scale", glm::dvec3(1));
    for (int c = 0; c < 3; ++c) m[c] *= scale[c];
    return m;
}

std::vector<std::array<uint32_t, 3>> triangulate(const std::vector<uint32_t>& indices, size_t mode) {
    std::vector<std::array<uint32_t, 3>> out;
    if (mode == kTriangles)
        for (size_t i = 0; i + 2 < indices.size(); i += 3) out.push_back({indices[i], indices[i + 1], indices[i + 2]});
    else
        for (size_t i = 0; i + 2 < indices.size(); ++i) {
            if (mode == kTriangleFan)
                out.push_back({indices[i + 1], indices[i + 2], indices[0]});
            else
                out.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
        }
    return out;
}

std::vector<glm::vec3> readVectors(const GltfDocument& document, size_t accessor) {
    const std::vector<float> values = readAccessor(document, accessor, 3);
    std::vector<glm::vec3> out(values.size() / 3);
    for (size_t i = 0; i < out.size(); ++i) out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return out;
}

void readNormals(const GltfDocument& document, size_t accessor, Surface& surface) {
    surface.normals = readVectors(document, accessor);
    bool unit = true;
    for (glm::vec3& n : surface.normals) {
        const float length = glm::length(n);
        unit = unit && std::abs(length - 1) < kUnitTolerance;
        n = length > 1e-12f && std::isfinite(length) ? n / length : glm::vec3(0, 1, 0);
    }
    const Json& from = document.json["accessors"][accessor];
    // Normals of a compressed view that are not unit are stored anew: no validator could see them in the source, but in
    // the asset, where they are decoded, it would report them.
    surface.normalsMade = !unit && from.contains("bufferView") && document.decodedViews.contains(from["bufferView"].get<size_t>());
}

// The primitive as a Surface, without triangles if it draws points or lines.
Surface readPrimitive(const Scene& scene, const Json& primitive) {
    const GltfDocument& document = *scene.document;
    Surface surface;
    const size_t mode = unsignedOr(primitive, "mode", kTriangles);
    const Json& attributes = primitive["attributes"];
    if (mode < kTriangles || !attributes.contains("POSITION")) return surface;
    if (primitive.contains("material")) {
        surface.material = int(primitive["material"].get<size_t>());
        surface.twoSided = document.json["materials"][size_t(surface.material)].value("doubleSided", false);
    }
    surface.positions = readVectors(document, attributes["POSITION"].get<size_t>());
    auto checkCounts = [&](const Json& each) {
        for (const auto& attribute : each.items())
            if (accessorCount(document, attribute.value().get<size_t>()) != surface.positions.size())
                throw Error(document.name + ": attribute " + attribute.key() + " does not have one element a vertex");
    };
    checkCounts(attributes);
    for (const Json& target : listOf(primitive, "targets")) checkCounts(target);
    std::vector<uint32_t> indices;
    if (primitive.contains("indices")) {
        indices = readIndices(document, primitive["indices"].get<size_t>());
    } else {
        indices.resize(surface.positions.size());
        for (size_t i = 0; i < indices.size(); ++i) indices[i] = uint32_t(i);
    }
    surface.triangles = triangulate(indices, mode);
    for (const int set : {1, 0}) {
        const auto found = attributes.find("TEXCOORD_" + std::to_string(set));
        if (found == attributes.end() || document.json["accessors"][found->get<size_t>()]["type"] != "VEC2") continue;
        const std::vector<float> values = readAccessor(document, found->get<size_t>(), 2);
        for (size_t v = 0; v + 1 < values.size(); v += 2) surface.coordinates.emplace_back(values[v], values[v + 1]);
        surface.coordinateSet = set;
        break;
    }
    surface.paint = readPaint(scene, primitive, surface.positions.size());
    for (const auto& triangle : surface.triangles)
        for (uint32_t index : triangle)
            if (index >= surface.positions.size())
                throw Error(document.name + ": triangle index " + std::to_string(index) + " is out of range, there are "
                            + std::to_string(surface.positions.size()) + " vertices");
    if (attributes.contains("NORMAL"))
        readNormals(document, attributes["NORMAL"].get<size_t>(), surface);
    else
        makeFlat(surface);
    return surface;
}

// Walks the scene's nodes. glTF forbids cycles, but damaged files have them.
class Walker {
public:
    Walker(Scene& scene, const GltfDocument& document)
        : scene_(scene),
          document_(document),
          nodes_(listOf(document.json, "nodes")),
          open_(nodes_.size()),
          seen_(nodes_.size()),
          first_(listOf(document.json, "meshes").size(), -1),
          elements_(document, "its primitives", kFewElements, kElementsAByte),
          vertices_(document, "its instances", kFewVertices, kVerticesAByte) {}

    void visit(size_t index, const glm::dmat4& parent, int depth = 0) {
        const auto& path = scene_.name;
        if (open_[index]) throw Error(path + ": node " + std::to_string(index) + " is its own ancestor");
        if (seen_[index]) throw Error(path + ": node " + std::to_string(index) + " has two parents");
        seen_[index] = true;
        if (depth > kDeepestNode) throw Error(path + ": nodes are nested more than 1000 deep");
        open_[index] = true;
        const Json& node = nodes_[index];
        const glm::dmat4 world = parent * localTransform(node);
        if (node.contains("mesh")) addMesh(index, node["mesh"].get<size_t>(), world);
        if (node.contains("camera")) addCamera(document_.json["cameras"][node["camera"].get<size_t>()], world);
        addLight(node, world);
        for (const Json& child : listOf(node, "children")) visit(child.get<size_t>(), world, depth + 1);
        open_[index] = false;
    }

private:
    void addMesh(size_t node, size_t mesh, const glm::dmat4& world) {
        const Json& primitives = listOf(document_.json["meshes"][mesh], "primitives");
        if (first_[mesh] < 0) {
            first_[mesh] = int(scene_.surfaces.size());
            for (const Json& primitive : primitives) {
                elements_.spend(elementsOf(primitive));
                scene_.surfaces.push_back(readPrimitive(scene_, primitive));
                surfaceBytes_ += memoryOf(scene_.surfaces.back());
                requireMemory(scene_.name, "its meshes", surfaceBytes_);
            }
        }
        for (size_t p = 0; p < primitives.size(); ++p) {
            const Surface& surface = scene_.surfaces[size_t(first_[mesh]) + p];
            vertices_.spend(double(surface.positions.size()));
            if (!surface.triangles.empty()) scene_.instances.push_back({first_[mesh] + int(p), glm::mat4(world), int(node), int(p)});
        }
    }

    double elementsOf(const Json& primitive) const {
        double sum = 0;
        if (primitive["attributes"].contains("POSITION"))
            sum += double(accessorCount(document_, primitive["attributes"]["POSITION"].get<size_t>()));
        if (primitive.contains("indices")) sum += double(accessorCount(document_, primitive["indices"].get<size_t>()));
        return sum;
    }

    void addLight(const Json& node, const glm::dmat4& world) {
        const auto extensions = node.find("extensions");
        if (extensions == node.end() || !extensions->is_object() || !extensions->contains("KHR_lights_punctual")) return;
        const Json& light = (*extensions)["KHR_lights_punctual"];
        if (light.is_object() && light.contains("light") && light["light"].is_number_unsigned())
            scene_.punctual.push_back({light["light"].get<size_t>(), world});
        else
            scene_.notes.push_back("one of its lights cannot be used");
    }

    void addCamera(const Json& camera, const glm::dmat4& world) {
        if (camera.value("type", "") != "perspective" || !camera.contains("perspective")) return;
        const double fov = camera["perspective"].value("yfov", 0.0);
        const glm::dvec3 eye(world[3]), forward = -glm::dvec3(world[2]), up(world[1]);
        const double length = glm::length(forward), height = glm::length(up);
        const double far = glm::length(eye);
        if (!(fov > 0 && fov < std::numbers::pi && length > 0 && height > 0 && far < kFarthestEye) || !std::isfinite(length)
            || !std::isfinite(height)) {
            scene_.notes.push_back("its camera cannot be used");
            return;
        }
        // The target is at least as far from the eye as the eye is from the origin, so that floats can tell them apart.
        scene_.cameras.push_back(
            Camera{glm::vec3(eye), glm::vec3(eye + std::max(1.0, far) * forward / length), float(fov), glm::vec3(up / height)});
    }

    Scene& scene_;
    const GltfDocument& document_;
    const Json& nodes_;
    std::vector<bool> open_, seen_;
    std::vector<int> first_;  // surface of each mesh, or -1
    Budget elements_, vertices_;
    double surfaceBytes_ = 0;
};

Scene readScene(GltfDocument&& given) {
    Scene scene;
    scene.name = given.name;
    scene.document = std::make_shared<GltfDocument>(std::move(given));
    const GltfDocument& document = *scene.document;
    scene.notes = document.notes;
    readMaterials(scene);
    Walker walker(scene, document);
    const Json& scenes = listOf(document.json, "scenes");
    if (!scenes.empty()) {
        for (const Json& node : listOf(scenes[unsignedOr(document.json, "scene", 0)], "nodes"))
            walker.visit(node.get<size_t>(), glm::dmat4(1));
    } else {
        const Json& nodes = listOf(document.json, "nodes");
        std::vector<bool> child(nodes.size());
        for (const Json& node : nodes)
            for (const Json& c : listOf(node, "children")) child[c.get<size_t>()] = true;
        for (size_t n = 0; n < nodes.size(); ++n)
            if (!child[n]) walker.visit(n, glm::dmat4(1));
    }
    validate(scene);
    return scene;
}

}  // namespace

Scene sceneOf(GltfDocument document) { return readScene(std::move(document)); }

void addCamera(Json& json, const Camera& view) {
    json["cameras"].push_back({{"type", "perspective"}, {"perspective", {{"yfov", view.verticalFov}, {"znear", 0.01}}}});
    const glm::dvec3 back = glm::normalize(glm::dvec3(view.eye - view.target));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(view.up), back)), up = glm::cross(back, right);
    addNode(json,
            {{"name", "camera"},
             {"camera", json["cameras"].size() - 1},
             {"matrix",
              {right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0, view.eye.x, view.eye.y, view.eye.z, 1}}});
}

void addNode(Json& json, Json node) {
    if (!listOf(json, "scenes").empty()) json["scenes"][unsignedOr(json, "scene", 0)]["nodes"].push_back(listOf(json, "nodes").size());
    json["nodes"].push_back(std::move(node));
}

Scene readGltf(const std::string& path) { return readScene(readGltfDocument(path)); }

Scene parseGltf(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder) {
    return readScene(parseGltfDocument(bytes, name, folder));
}

}  // namespace apertura
