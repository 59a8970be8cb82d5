#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>

#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

using Instances = std::vector<std::pair<int, glm::mat4>>;  // surface, transform

void addNode(Instances& out, const aiNode* node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 m = parent * node->mTransformation;  // row-major
    const glm::mat4 world(m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4);
    for (unsigned i = 0; i < node->mNumMeshes; ++i) out.emplace_back(int(node->mMeshes[i]), world);
    for (unsigned i = 0; i < node->mNumChildren; ++i) addNode(out, node->mChildren[i], m);
}

// Lets assimp open the file itself and no other: an OBJ names material libraries, which can be any path and are not needed.
class OneFile : public Assimp::DefaultIOSystem {
public:
    explicit OneFile(std::string path) : path_(std::move(path)) {}
    bool Exists(const char* file) const override { return file == path_ && DefaultIOSystem::Exists(file); }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        return file == path_ ? DefaultIOSystem::Open(file, mode) : nullptr;
    }

private:
    std::string path_;
};

// Sends the instances, then the positions, normals and triangles of each surface.
void read(const std::string& path, Coordinates coordinates, PipeWriter& pipe) {
    Assimp::Importer importer;
    importer.SetIOHandler(new OneFile(path));  // the importer deletes it
    // Degrees. If the file has no normals, vertices are split at edges that bend by more than this.
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 60.0f);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, (coordinates == Coordinates::Read ? 0u : unsigned(aiComponent_TEXCOORDS))
                                                            | aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS
                                                            | aiComponent_MATERIALS | aiComponent_TEXTURES);
    // Positions are checked before post-processing, which could merge or drop the broken ones.
    const aiScene* scene = importer.ReadFile(path, 0);
    auto fail = [&] {
        const std::string cause = importer.GetErrorString();
        throw Error("cannot be read: " + (cause.empty() ? "holds no mesh" : cause));
    };
    if (!scene || !scene->mRootNode) fail();
    for (unsigned m = 0; m < scene->mNumMeshes; ++m)
        for (unsigned v = 0; v < scene->mMeshes[m]->mNumVertices; ++v) {
            const aiVector3D& p = scene->mMeshes[m]->mVertices[v];
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) throw Error("a vertex position is not a finite number");
        }
    scene = importer.ApplyPostProcessing(aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_SortByPType
                                         | aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices);
    if (!scene || !scene->mRootNode) fail();

    Instances instances;
    addNode(instances, scene->mRootNode, aiMatrix4x4());
    pipe.put(instances);
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& mesh = *scene->mMeshes[m];
        Surface surface;
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            surface.positions.emplace_back(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
            glm::vec3 n(0);
            if (mesh.mNormals) n = {mesh.mNormals[v].x, mesh.mNormals[v].y, mesh.mNormals[v].z};
            const float length = glm::length(n);
            if (coordinates == Coordinates::Read && mesh.HasTextureCoords(0))
                surface.coordinates.emplace_back(mesh.mTextureCoords[0][v].x, 1 - mesh.mTextureCoords[0][v].y);
            surface.normals.push_back(length > 1e-12f && std::isfinite(length) ? n / length : glm::vec3(0, 1, 0));
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices == 3) surface.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
        }
        pipe.put(surface.positions);
        pipe.put(surface.normals);
        pipe.put(surface.triangles);
        pipe.put(surface.coordinates);
    }
}

}  // namespace

Scene loadMeshFile(const std::string& path, Coordinates coordinates) {
    Scene scene;
    scene.name = path;
    const auto receive = [&](PipeReader& pipe) {
        int surfaces = 0;
        for (const auto& [surface, world] : pipe.take<Instances::value_type>()) {
            scene.instances.push_back({surface, world});
            surfaces = std::max(surfaces, surface + 1);
        }
        for (int i = 0; i < surfaces; ++i) {
            Surface surface;
            surface.positions = pipe.take<glm::vec3>();
            surface.normals = pipe.take<glm::vec3>();
            surface.triangles = pipe.take<std::array<uint32_t, 3>>();
            surface.coordinates = pipe.take<glm::vec2>();
            scene.surfaces.push_back(std::move(surface));
        }
    };
    runIsolated(
        path, limitsFor(path, 5), [&](PipeWriter& out) { read(path, coordinates, out); }, receive);
    validate(scene);
    return scene;
}

}  // namespace apertura
