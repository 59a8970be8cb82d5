// Images for other programs. Bent normals and occlusion: tangents, what an engine makes of the images, and how an asset holds them; and
// files beside the asset.
#include "apertura/runtime/asset/bent_normals.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <glm/gtc/type_ptr.hpp>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/image_files.h"
#include "apertura/runtime/asset/png.h"
#include "apertura/runtime/asset/tangents.h"
#include "apertura/runtime/asset/texels.h"
#include "tests/box_over_seam.h"
#include "tests/changed_gltf.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// On a plane all is linear: the tangent is the derivative of the place by u, the bitangent is against that by v.
TEST(Tangents, GoAlongTheCoordinates) {
    Random random(1);
    for (int trial = 0; trial < 50; ++trial) {
        const glm::dvec3 normal = random.direction();
        const glm::dvec3 u = glm::normalize(glm::cross(normal, random.direction())), across = glm::cross(normal, u);
        const glm::dvec3 v = (trial % 2 ? 1.0 : -1.0) * across;
        Surface surface;
        for (int k = 0; k < 8; ++k) {
            const glm::vec2 c(random(), random());
            surface.coordinates.push_back(c);
            surface.positions.emplace_back(3.0 * (double(c.x) * u + double(c.y) * v));
            surface.normals.emplace_back(normal);
        }
        surface.triangles = {{0, 1, 2}, {2, 3, 4}, {5, 4, 3}, {5, 6, 7}};
        const Tangents tangents = makeTangents(surface, surface.coordinates);
        for (const auto& corners : tangents)
            for (const glm::vec4& t : corners) EXPECT_GT(glm::dot(glm::vec3(t), glm::vec3(u)), 0.9999f);
        const glm::mat3 frame = tangentFrame(surface, tangents, 1, glm::vec3(0.2f, 0.3f, 0.5f));
        EXPECT_GT(glm::dot(frame[1], glm::vec3(-v)), 0.9999f);
        EXPECT_GT(glm::dot(frame[2], glm::vec3(normal)), 0.9999f);
    }
}

TEST(Tangents, AreSmoothWhereVerticesAreSplit) {
    // A cylinder unwrapped, every triangle with vertices of its own: the tangent at an angle is the circle's.
    Surface surface;
    const int n = 24;
    const auto vertex = [&](int i, int j) {
        const double angle = 2 * pi * i / n;
        surface.positions.emplace_back(std::cos(angle), j, std::sin(angle));
        surface.normals.emplace_back(std::cos(angle), 0, std::sin(angle));
        surface.coordinates.emplace_back(float(i) / n, float(j));
        return uint32_t(surface.positions.size() - 1);
    };
    for (int i = 0; i < n; ++i) {
        surface.triangles.push_back({vertex(i, 0), vertex(i, 1), vertex(i + 1, 0)});
        surface.triangles.push_back({vertex(i + 1, 0), vertex(i, 1), vertex(i + 1, 1)});
    }
    const Tangents tangents = makeTangents(surface, surface.coordinates);
    for (size_t k = 0; k < 3 * tangents.size(); ++k) {
        const uint32_t v = surface.triangles[k / 3][k % 3];
        const glm::vec3 normal = surface.normals[v], tangent(tangents[k / 3][k % 3]);
        const bool onRim = surface.coordinates[v].x == 0 || surface.coordinates[v].x == 1;  // one side's triangles alone
        EXPECT_GT(glm::dot(tangent, glm::vec3(-normal.z, 0, normal.x)), onRim ? 0.99f : 0.99999f);
        EXPECT_NEAR(glm::dot(tangent, normal), 0, 1e-6);
    }
}

// Two squares whose coordinates are mirrored about the edge that they share, and its vertices: each side has its own.
TEST(Tangents, PartWhereCoordinatesAreMirrored) {
    Surface surface;
    for (const auto& [x, z] : {std::pair(-1, 0), {0, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
        surface.positions.emplace_back(x, 0, z);
        surface.normals.emplace_back(0, 1, 0);
        surface.coordinates.emplace_back(std::abs(x), z);
    }
    surface.triangles = {{0, 3, 1}, {1, 3, 4}, {1, 4, 2}, {2, 4, 5}};
    const Tangents tangents = makeTangents(surface, surface.coordinates);
    for (size_t t = 0; t < 4; ++t)
        for (const glm::vec4& tangent : tangents[t]) {
            EXPECT_EQ(tangent.x, t < 2 ? -1 : 1);
            // Up in the image is -z on both sides: cross((0, 1, 0), (1, 0, 0)) is (0, 0, -1).
            EXPECT_EQ(tangent.w, t < 2 ? -1 : 1);
        }
}

// What an engine has of a file: the texels of one of its images, between 0 and 1.
struct EngineImage {
    EngineImage(const GltfDocument& document, size_t texture) {
        const Json& image = document.json["images"][document.json["textures"][texture]["source"].get<size_t>()];
        png = decodePng(viewBytes(document, image["bufferView"].get<size_t>()), "image");
    }
    glm::vec3 at(const glm::vec2& coordinates) const {
        const AperturaTexelCell cell = aperturaTexelCellAt(aperturaPlaceInImage(coordinates, float(png.width), float(png.height)),
                                                           png.width, png.height);
        glm::vec3 out(0);
        for (int c = 0; c < 4; ++c)
            for (int k = 0; k < 3; ++k)
                out[k] += cell.weights[c] * float(png.samples[size_t(cell.texels[c] * png.channels + std::min(k, png.channels - 1))])
                        / float((1 << png.bits) - 1);
        return out;
    }
    PngImage png;
};

TEST(BentNormals, AreWhatTheirDefinitionsSay) {
    const Folder folder;
    Scene scene = boxOverSeam();
    // The box is turned and mirrored in the world: what an image holds is in its own frame.
    scene.instances[1].toWorld = glm::mat4(0, 0, -1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1);
    BakeOptions options = optionsFor(kSanitized ? 64 : 256);
    options.rays = kSanitized ? 128 : 1024;
    options.as = As::BentNormals;
    writeAsset(folder / "a.glb", scene, bakeScene(scene, Tracer(scene), options), {});
    const Scene back = readGltf(folder / "a.glb");
    const GltfDocument& document = *back.document;
    const Json& entries = document.json["asset"]["extras"]["apertura"]["bentNormals"];
    ASSERT_EQ(entries.size(), 2u);
    const Tracer tracer(back);
    const std::vector<glm::vec3> around = fibonacciHemisphere(8192);
    double angles = 0, occlusions = 0;
    int count = 0;
    for (const SurfaceSample& sample : sampleSurface(back, kSanitized ? 100 : 1500, 3)) {
        const auto i = size_t(sample.instance);
        const Json& primitive = document.json["meshes"][entries[i]["mesh"].get<size_t>()]["primitives"][0];
        ASSERT_TRUE(primitive["attributes"].contains("TANGENT"));
        const Surface& surface = back.surfaces[size_t(back.instances[i].surface)];
        const auto t = size_t(sample.triangle);
        const std::vector<float> numbers = readAccessor(document, primitive["attributes"]["TANGENT"].get<size_t>(), 4);
        Tangents tangents(surface.triangles.size());
        for (size_t c = 0; c < 3; ++c) tangents[t][c] = glm::make_vec4(&numbers[4 * surface.triangles[t][c]]);
        const glm::vec2 coordinates = coordinatesAt(surface, t, sample.weights);
        const glm::vec3 stored = 2.0f * EngineImage(document, entries[i]["texture"].get<size_t>()).at(coordinates) - 1.0f;
        // Red and green suffice.
        const glm::vec3 own(stored.x, stored.y, std::sqrt(std::max(0.0f, 1 - stored.x * stored.x - stored.y * stored.y)));
        const glm::vec3 bent = glm::normalize(rotationPart(back.instances[i].toWorld) * tangentFrame(surface, tangents, t, sample.weights)
                                              * own);
        const Json& material = document.json["materials"][primitive["material"].get<size_t>()];
        const EngineImage occlusion(document, material["occlusionTexture"]["index"].get<size_t>());
        EXPECT_EQ(material["occlusionTexture"]["texCoord"].get<int>(), surface.coordinateSet);
        // By definition.
        glm::dvec3 sum(0);
        double open = 0, all = 0;
        const glm::mat3 frame = frameFromZ(sample.at.normal, 1);
        std::vector<glm::vec3> directions;
        for (const glm::vec3& w : around) directions.push_back(frame * w);
        std::vector<uint8_t> blocked(directions.size());
        RayOcclusion(tracer).occluded(sample.at, directions, blocked.data());
        for (size_t k = 0; k < directions.size(); ++k) {
            all += around[k].z;
            if (blocked[k]) continue;
            sum += double(around[k].z) * glm::dvec3(directions[k]);
            open += around[k].z;
        }
        if (open < 0.02 * all) continue;  // a mean of next to nothing
        const double angle = std::acos(std::clamp(glm::dot(glm::normalize(sum), glm::dvec3(bent)), -1.0, 1.0)) * 180 / pi;
        const double error = occlusion.at(coordinates).x - open / all;
        angles += angle * angle, occlusions += error * error, ++count;
    }
    std::printf("bent normals err by %.2f degrees RMS, occlusion by %.2f / 255, at %d points\n", std::sqrt(angles / count),
                255 * std::sqrt(occlusions / count), count);
    EXPECT_GT(count, kSanitized ? 80 : 1200);
    EXPECT_LT(std::sqrt(angles / count), kSanitized ? 4 : 1);
    EXPECT_LT(std::sqrt(occlusions / count), (kSanitized ? 8.0 : 1.0) / 255);
}

TEST(BentNormals, ComeIntoTheFileAndOutOfItAgain) {
    const Folder folder;
    Scene scene = boxOverSeam();
    BakedVisibility plain, bent;
    for (const Surface& surface : scene.surfaces) {
        plain.push_back({std::vector<Visibility>(surface.positions.size()), {}, {}, {}});
        bent.push_back(plain.back());
        bent.back().bent = {4, 4, std::vector<glm::vec4>(16, {0, 0.6f, 0.8f, 0.25f}),
                            std::vector<glm::vec4>(surface.positions.size(), {1, 0, 0, 1})};
    }
    writeAsset(folder / "plain.glb", scene, plain, {});
    // One material for both, which has a texture of its own and occlusion of somebody else's.
    const std::string given = changed(folder, folder / "plain.glb", [](Json& json) {
        json["images"] = Json::array({{{"uri", "data:image/png;base64,AAAA"}}});
        json["textures"] = Json::array({{{"source", 0}}});
        json["materials"] = Json::array({{{"name", "stone"}, {"occlusionTexture", {{"index", 0}}}}});
        for (Json& mesh : json["meshes"]) mesh["primitives"][0]["material"] = 0;
    });
    const Scene own = readGltf(given);
    BakeInfo info;
    info.bits = 16;
    writeAsset(folder / "a.glb", own, bent, info);
    const Asset asset = loadAsset(folder / "a.glb");
    EXPECT_EQ(asset.info.bentNormals, 2);
    EXPECT_FALSE(hasTexels(asset));
    const Json& json = asset.scene.document->json;
    EXPECT_EQ(json["materials"].size(), 3u);
    EXPECT_EQ(json["materials"][0]["occlusionTexture"]["index"], 0);
    for (const Json& mesh : json["meshes"]) {
        const Json& material = json["materials"][mesh["primitives"][0]["material"].get<size_t>()];
        EXPECT_EQ(material["name"], "stone");
        const EngineImage occlusion(*asset.scene.document, material["occlusionTexture"]["index"].get<size_t>());
        EXPECT_EQ(occlusion.png.channels, 1);
        EXPECT_NEAR(occlusion.at({0.4f, 0.4f}).x, 0.25, 1e-5);
    }
    const EngineImage stored(*asset.scene.document, json["asset"]["extras"]["apertura"]["bentNormals"][0]["texture"].get<size_t>());
    EXPECT_LT(glm::distance(stored.at({0.4f, 0.4f}), glm::vec3(0.5f, 0.8f, 0.9f)), 1e-4f);
    // Again the same, and then none.
    writeAsset(folder / "b.glb", asset.scene, bent, info);
    EXPECT_EQ(readGltf(folder / "b.glb").document->json["materials"].size(), 3u);
    EXPECT_EQ(readGltf(folder / "b.glb").document->json["images"].size(), 5u);
    writeAsset(folder / "c.glb", asset.scene, plain, {});
    const Json last = readGltf(folder / "c.glb").document->json;
    EXPECT_EQ(last["materials"], own.document->json["materials"]);
    EXPECT_EQ(last["images"].size(), 1u);
    for (const Json& mesh : last["meshes"]) EXPECT_EQ(mesh["primitives"][0]["material"], 0);
    // Without materials none is left.
    writeAsset(folder / "d.glb", scene, bent, info);
    writeAsset(folder / "e.glb", readGltf(folder / "d.glb"), plain, {});
    const Json none = readGltf(folder / "e.glb").document->json;
    for (const char* list : {"materials", "textures", "images", "samplers"}) EXPECT_FALSE(none.contains(list)) << list;
    EXPECT_FALSE(none["meshes"][0]["primitives"][0].contains("material"));
    EXPECT_FALSE(none["meshes"][0]["primitives"][0]["attributes"].contains("TANGENT"));
    // A program that drops what nothing uses leaves the copies alone: they stay, without occlusion.
    const std::string dropped = changed(folder, folder / "a.glb", [](Json& all) {
        all["materials"].erase(0);
        for (Json& mesh : all["meshes"]) mesh["primitives"][0]["material"] = mesh["primitives"][0]["material"].get<size_t>() - 1;
    });
    writeAsset(folder / "f.glb", readGltf(dropped), plain, {});
    const Json left = readGltf(folder / "f.glb").document->json;
    for (const Json& mesh : left["meshes"]) {
        const Json& material = left["materials"][mesh["primitives"][0]["material"].get<size_t>()];
        EXPECT_EQ(material["name"], "stone");
        EXPECT_FALSE(material.contains("occlusionTexture"));
    }
    EXPECT_EQ(left["images"].size(), 1u);
}

// Whatever others left of them, the file is baked over, and what is not surely ours stays.
TEST(BentNormals, ThatWereDamagedAreBakedOver) {
    const Folder folder;
    const Scene scene = boxOverSeam();
    BakedVisibility plain, bent;
    for (const Surface& surface : scene.surfaces) {
        plain.push_back({std::vector<Visibility>(surface.positions.size()), {}, {}, {}});
        bent.push_back(plain.back());
        bent.back().bent = {2, 2, std::vector<glm::vec4>(4, {0, 0, 1, 1}), {}};
    }
    writeAsset(folder / "a.glb", scene, bent, {});
    const auto bakedOver = [&](const std::function<void(Json&)>& change) {
        writeAsset(folder / "b.glb", readGltf(changed(folder, folder / "a.glb", change)), plain, {});
        return readGltf(folder / "b.glb").document->json;
    };
    const auto entries = [](Json& json) -> Json& { return json["asset"]["extras"]["apertura"]["bentNormals"]; };
    for (const Json& wrong : {Json(7), Json::object(), Json::array({nullptr}), Json::array({{{"mesh", -1}}}),
                              Json::array({{{"mesh", 0}, {"primitive", 9}, {"occlusion", 1}}})})
        EXPECT_FALSE(bakedOver([&](Json& json) { entries(json) = wrong; }).contains("textures"));
    const Json lost = bakedOver([&](Json& json) { entries(json)[0]["material"] = 77; });
    EXPECT_FALSE(lost["materials"][lost["meshes"][0]["primitives"][0]["material"].get<size_t>()].contains("occlusionTexture"));
    EXPECT_FALSE(lost["meshes"][1]["primitives"][0].contains("material"));
    // The second mesh's material was given another image: it stays, and all that stands before it.
    const Json kept = bakedOver([](Json& json) { json["materials"][1]["occlusionTexture"]["index"] = 0; });
    EXPECT_EQ(kept["materials"].size(), 2u);
    EXPECT_EQ(kept["textures"].size(), 2u);
    EXPECT_TRUE(kept["meshes"][1]["primitives"][0].contains("material"));
}

// Files beside an asset hold what it holds; in half floats, what it was made of.
TEST(TexelImages, LieBesideTheAssetToo) {
    const Folder folder;
    const Scene scene = boxOverSeam();
    BakedVisibility seen;
    Random random(8);
    for (const Surface& surface : scene.surfaces) {
        seen.push_back({std::vector<Visibility>(surface.positions.size()), {}, {}, {}});
        seen.back().texels = {3, 2, {}, {}, 8};
        for (int k = 0; k < 6; ++k) seen.back().texels.visibility.push_back({glm::vec3(random.direction()), float(random(2, 4))});
    }
    for (const ImageFormat format : {ImageFormat::Png, ImageFormat::Exr})
        for (const auto& file : pendingImages(folder / "a.glb", scene, seen, 16, format)) file->commit();
    const std::vector<std::string> png = imageFiles(folder / "a.glb", 2, false, ImageFormat::Png),
                                   exr = imageFiles(folder / "a.glb", 2, false, ImageFormat::Exr);
    ASSERT_EQ(png.size(), 2u);
    EXPECT_EQ(png[1], folder / "a.visibility.1.png");
    for (size_t i = 0; i < 2; ++i) {
        const std::vector<float> numbers = texelNumbers(seen[i].texels, glm::mat3(1));
        const PngImage image = decodePng(readFile(png[i]), png[i]);
        const auto input = OIIO::ImageInput::open(exr[i]);
        ASSERT_TRUE(input);
        ASSERT_EQ(input->spec().nchannels, 4);
        std::vector<float> halves(24);
        ASSERT_TRUE(input->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, halves.data()));
        for (size_t k = 0; k < 24; ++k) {
            EXPECT_NEAR(numbers[k], (int(image.samples[k]) - 32768) / 32767.0, 2e-5);
            EXPECT_NEAR(numbers[k], halves[k], 5e-4);
        }
        const Visibility& first = seen[i].texels.visibility[0];
        EXPECT_NEAR(numbers[1], first.direction.y / pi, 1e-6);
        EXPECT_NEAR(numbers[3], first.area / pi - 1, 1e-6);
    }
}

}  // namespace
}  // namespace apertura::test
