// What a stored model adds at vertices: what becomes of it when another program has changed the file.
#include "apertura/runtime/asset/model_numbers.h"

#include "apertura/runtime/asset/gltf.h"

#include "apertura/runtime/asset/params_stream.h"
#include "apertura/runtime/asset/primitive.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/sh/shading.h"
#include "tests/any_asset.h"
#include "tests/changed_gltf.h"

namespace apertura::test {
namespace {

Asset stored(const Folder& folder, const std::string& model, int bits) {
    Scene scene = boxOnFloor();
    scene.instances.push_back({1, glm::mat4(0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 4, 0, 0, 1)});
    Asset asset = anyAsset(scene, model == "auto" ? "sh" : model, 5);
    asset.info.model = model;
    asset.info.bits = bits;
    Random random(6);
    for (SeenByInstance& seen : asset.seen) {
        seen.faces = {};
        if (model != "auto") continue;
        for (size_t v = 0; v < seen.visibility.size(); ++v) {
            const Model& own = *autoModels()[size_t(random(0, double(autoModels().size())))];
            std::vector<float> numbers(size_t(storedNumbers(own)));
            for (float& n : numbers) n = float(random(-1, 1));
            seen.allParams.push_back(numbers.empty() ? ModelParams{} : unpackParams(own, numbers));
            setChoice(seen.allParams.back(), own, false);
        }
    }
    writeAsset(folder / "a.glb", scene, asset.seen, asset.info);
    return asset;
}

// Writes the file again with the vertices of every primitive in the opposite order, as a tool does that sorts them for a GPU.
std::string reversed(const Folder& folder, const std::string& path) {
    const GltfDocument document = readGltfDocument(path);
    GltfWriter writer(document);
    for (Json& mesh : writer.json()["meshes"])
        for (Json& primitive : mesh["primitives"]) {
            const size_t count = accessorCount(document, primitive["attributes"]["POSITION"].get<size_t>());
            std::vector<uint32_t> from(count);
            for (size_t v = 0; v < count; ++v) from[v] = uint32_t(count - 1 - v);
            for (Json& index : primitive["attributes"]) {
                GatheredAccessor gathered = gatherAccessor(document, index.get<size_t>(), from);
                index = writer.addAccessor(std::move(gathered.members), std::move(gathered.bytes), kArrayBuffer, gathered.stride);
            }
            Bytes indices;
            const std::vector<uint32_t> before = readIndices(document, primitive["indices"].get<size_t>());
            for (const uint32_t i : before) {
                const auto n = uint16_t(count - 1 - i);
                indices.push_back(static_cast<unsigned char>(n & 255)), indices.push_back(static_cast<unsigned char>(n >> 8));
            }
            primitive["indices"] = writer.addAccessor({{"componentType", kUnsignedShort}, {"type", "SCALAR"}, {"count", before.size()}},
                                                      std::move(indices), kElementArrayBuffer);
        }
    writer.write(folder / "reversed.glb", folder / "reversed.glb");
    return folder / "reversed.glb";
}

// What the model lets through of a light, as stored and as read, at the same vertices.
void expectSame(const Asset& a, const Asset& b, const Model& model, bool isReversed, float within) {
    const AperturaCapLight light = aperturaCapLight(glm::dvec3(0.6, 0.64, 0.48), 0.3);
    for (size_t i = 0; i < a.seen.size(); ++i) {
        const size_t count = a.seen[i].visibility.size();
        ASSERT_EQ(b.seen[i].allParams.size(), count);
        for (size_t v = 0; v < count; ++v) {
            const auto e = [&](const Asset& of, size_t at) {
                return aperturaIrradianceThrough(model.id, receiverAtVertex(of, model, i, at), light, APERTURA_LIGHTS_ANY) / light.area;
            };
            EXPECT_NEAR(e(a, v), e(b, isReversed ? count - 1 - v : v), within) << model.name << ", vertex " << v;
        }
    }
}

TEST(ModelNumbers, GoWithTheirVertices) {
    const Folder folder;
    for (const Model& model : models()) {
        if (!model.isStored() || model.kind == ModelKind::Choice) continue;
        const Asset asset = stored(folder, std::string(model.name), 16);
        const Asset same = loadAsset(folder / "a.glb"), turned = loadAsset(reversed(folder, folder / "a.glb"));
        EXPECT_TRUE(same.scene.notes.empty() && turned.scene.notes.empty()) << model.name;
        EXPECT_EQ(visibilityBytes(same), visibilityBytes(asset));
        if (!model.baseline) expectSame(asset, same, model, false, 5e-3f);  // bands of random numbers may exceed 1 where they are turned
        expectSame(same, turned, model, true, 1e-6f);
    }
}

TEST(ModelNumbers, OfAutoBelongToTheirOrder) {
    const Folder folder;
    const Asset asset = stored(folder, "auto", 16);
    const Asset same = loadAsset(folder / "a.glb");
    EXPECT_TRUE(same.scene.notes.empty());
    expectSame(asset, same, models()[APERTURA_MODEL_AUTO], false, 5e-3f);
    const Asset turned = loadAsset(reversed(folder, folder / "a.glb"));
    ASSERT_EQ(turned.scene.notes.size(), 1u);
    EXPECT_EQ(turned.scene.notes[0],
              "its numbers of the model auto belong to other vertices, or to these in another order: the four numbers alone are used");
    EXPECT_EQ(storedModel(turned.info), nullptr);
    EXPECT_TRUE(turned.seen[0].allParams.empty());
}

TEST(ModelNumbers, StayWhereNormalsWereRemoved) {
    const Folder folder;
    for (const char* name : {"firm-2", "auto"}) {
        const Asset asset = stored(folder, name, 16);
        const Asset split = loadAsset(changed(folder, folder / "a.glb", [](Json& json) {
            for (Json& mesh : json["meshes"])
                for (Json& primitive : mesh["primitives"]) primitive["attributes"].erase("NORMAL");
        }));
        EXPECT_TRUE(split.scene.notes.empty()) << split.scene.notes[0];
        ASSERT_EQ(split.info.model, name);
        for (size_t i = 0; i < split.seen.size(); ++i) {
            const std::vector<uint32_t>& from = split.scene.surfaces[size_t(split.scene.instances[i].surface)].splitFrom;
            ASSERT_EQ(split.seen[i].allParams.size(), split.seen[i].visibility.size());
            ASSERT_FALSE(from.empty());
        }
    }
}

TEST(ModelNumbers, SayHowTheyArePacked) {
    const Folder folder;
    stored(folder, "firm-2", 8);
    const Asset today = loadAsset(folder / "a.glb");
    const auto repacked = [&](const Json& packing) {
        return loadAsset(changed(folder, folder / "a.glb", [&](Json& json) {
            Json& said = json["asset"]["extras"]["apertura"];
            packing.is_null() ? void(said.erase("packing")) : void(said["packing"] = packing);
        }));
    };
    const Asset of01 = repacked(nullptr);
    EXPECT_EQ(today.info.packing, kPacking);
    EXPECT_EQ(of01.info.packing, 1);
    ASSERT_EQ(of01.seen[1].allParams.size(), today.seen[1].allParams.size());
    EXPECT_NE(of01.seen[1].allParams[0][0].w, today.seen[1].allParams[0][0].w);
    for (const Json& unknown : {Json(0), Json(3), Json(1.5), Json(-1), Json("2"), Json::array({2}), Json(true)})
        EXPECT_THROW(repacked(unknown), Error) << unknown;
    stored(folder, "sh", 8);
    EXPECT_EQ(repacked(nullptr).info.packing, kPacking);  // there is nothing that could be packed otherwise
}

TEST(ModelNumbers, WhereTheyAreGoneTheFourNumbersAreUsed) {
    const Folder folder;
    const auto expectFour = [](const std::string& path, const char* cause) {
        const Asset asset = loadAsset(path);
        ASSERT_EQ(asset.scene.notes.size(), 1u) << cause;
        EXPECT_NE(asset.scene.notes[0].find(cause), std::string::npos) << asset.scene.notes[0];
        EXPECT_EQ(asset.info.model, "sh");
        EXPECT_TRUE(asset.seen[1].allParams.empty());
        EXPECT_FALSE(asset.seen[1].visibility.empty());
    };
    const auto eachPrimitive = [](const std::function<void(Json&, Json&)>& change) {
        return [change](Json& json) {
            for (Json& mesh : json["meshes"])
                for (Json& primitive : mesh["primitives"]) change(json, primitive["attributes"]);
        };
    };
    stored(folder, "firm-2", 8);
    expectFour(changed(folder, folder / "a.glb", eachPrimitive([](Json&, Json& a) { a.erase("_VISIBILITY_NUMBERS_1"); })),
               "not of the kind");
    expectFour(changed(folder, folder / "a.glb", eachPrimitive([](Json&, Json& a) {
                           for (const char* k : {"_VISIBILITY_NUMBERS_0", "_VISIBILITY_NUMBERS_1"}) a.erase(k);
                       })),
               "are gone");
    expectFour(changed(folder, folder / "a.glb", eachPrimitive([](Json& json, Json& a) {
                           json["accessors"][a["_VISIBILITY_NUMBERS_0"].get<size_t>()].erase("normalized");
                       })),
               "not of the kind");
    stored(folder, "auto", 8);
    const auto choices = [](Json& json) -> Json& { return json["accessors"][*findAccessor(json, "_VISIBILITY_CHOICES")]; };
    expectFour(changed(folder, folder / "a.glb", [&](Json& json) { choices(json).erase("name"); }), "are gone");
    expectFour(changed(folder, folder / "a.glb", [&](Json& json) { choices(json)["normalized"] = true; }), "are not bytes");
    expectFour(changed(folder, folder / "a.glb", [&](Json& json) { json["asset"]["extras"]["apertura"]["choices"]["bytes"] = "0"; }),
               "are not those that were baked");
    expectFour(
        changed(folder, folder / "a.glb", [&](Json& json) { json["asset"]["extras"]["apertura"]["choices"]["numbers"][0] = 1000000; }),
        "end too soon");
}

TEST(ModelNumbers, OfVersion01AreRead) {
    const Folder folder;
    for (const char* name : {"firm-2", "auto"}) {
        const Model& model = *findModel(name);
        const Asset asset = stored(folder, name, 16);
        // As 0.1 wrote them: a buffer view of bytes for each primitive.
        const GltfDocument document = readGltfDocument(folder / "a.glb");
        const Scene scene = readGltf(folder / "a.glb");
        GltfWriter writer(document);
        const ReleasedNumbers released = removeNumbers(writer.json());
        writer.release(released.accessors, released.views);
        Json& described = writer.json()["asset"]["extras"]["apertura"];
        described.erase("choices");
        for (size_t i = 0; i < asset.seen.size(); ++i) {
            const Instance& instance = scene.instances[i];
            const std::vector<std::byte> packed = packAllParams(model, asset.seen[i].allParams,
                                                                glm::transpose(rotationPart(instance.toWorld)), 16);
            Bytes bytes;
            for (const std::byte b : packed) bytes.push_back(static_cast<unsigned char>(b));
            const size_t view = writer.addView(std::move(bytes));
            writer.json()["asset"]["extras"]["apertura"]["forms"].push_back(
                {{"mesh", meshOf(document.json, instance)}, {"primitive", instance.primitive}, {"bufferView", view}});
        }
        writer.write(folder / "old.glb", folder / "old.glb");
        const Asset old = loadAsset(folder / "old.glb");
        EXPECT_TRUE(old.scene.notes.empty()) << old.scene.notes[0];
        expectSame(loadAsset(folder / "a.glb"), old, model, false, 1e-6f);
        // A second bake leaves none of them.
        writeAsset(folder / "b.glb", old.scene, asset.seen, asset.info);
        EXPECT_EQ(readGltfDocument(folder / "b.glb").json.dump().find("forms"), std::string::npos);
        EXPECT_EQ(std::filesystem::file_size(folder / "b.glb"), std::filesystem::file_size(folder / "a.glb"));
    }
}

}  // namespace
}  // namespace apertura::test
