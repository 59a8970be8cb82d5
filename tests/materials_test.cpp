// The colours of glTF files: what rays pass, what the reference and the renderer draw, against closed forms.
#include "apertura/runtime/asset/materials.h"

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/reference.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/png.h"
#include "apertura/runtime/render/renderer.h"
#include "tests/gltf_text.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

// A floor of 20 m at y = 0 and a pane of 20 m at y = 1, which looks up, with a material each: texture coordinates go 0..1 to the right and
// towards the viewer, vertex colours are white and half transparent.
std::string twoSheets(const std::string& materials, const std::string& textures, bool colours = false) {
    std::vector<float> data;
    for (const float y : {0.0f, 1.0f}) data.insert(data.end(), {-10, y, 10, 10, y, 10, 10, y, -10, -10, y, -10});
    data.insert(data.end(), {0, 1, 1, 1, 1, 0, 0, 0});
    for (int i = 0; i < 4; ++i) data.insert(data.end(), {1, 0.5f, 0.25f, 0.5f});
    const std::string views = R"({"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},
        {"buffer":0,"byteOffset":96,"byteLength":32},{"buffer":0,"byteOffset":128,"byteLength":64})";
    const auto accessor = [](int view, const char* type, const std::string& more = "") {
        return R"({"componentType":5126,"count":4,"bufferView":)" + std::to_string(view) + R"(,"type":")" + type + "\"" + more + "}";
    };
    const std::string accessors = accessor(0, "VEC3", R"(,"min":[-10,0,-10],"max":[10,0,10])") + ","
                                + accessor(1, "VEC3", R"(,"min":[-10,1,-10],"max":[10,1,10])") + "," + accessor(2, "VEC2") + ","
                                + accessor(3, "VEC4");
    const auto primitive = [&](int material) {
        return R"({"mode":6,"material":)" + std::to_string(material) + R"(,"attributes":{"POSITION":)" + std::to_string(material)
             + R"(,"TEXCOORD_0":2)" + (colours && material == 1 ? R"(,"COLOR_0":3)" : "") + "}}";
    };
    return gltf(data, views, accessors, primitive(0) + "," + primitive(1), R"({"mesh":0})",
                R"(,"materials":[)" + materials + "]" + (textures.empty() ? "" : "," + textures));
}

std::string png(int width, int height, const std::vector<uint16_t>& rgba) {
    const std::vector<unsigned char> bytes = encodePng({width, height, 8, rgba, 4});
    return R"({"uri":"data:image/png;base64,)" + base64({bytes.begin(), bytes.end()}) + "\"}";
}

Scene parsed(const std::string& text, TexturesFor use = TexturesFor::Pictures) {
    Scene scene = parseGltf({reinterpret_cast<const unsigned char*>(text.data()), text.size()}, "sheets.gltf", ".");
    loadTextures(scene, use);
    return scene;
}

// The open part of the cosine-weighted hemisphere over the middle of the floor.
double openness(const Scene& scene) {
    constexpr int kRays = 4096;
    const Tracer tracer(scene);
    std::vector<glm::vec3> rays;
    double open = 0, all = 0;
    for (const glm::vec3& w : fibonacciHemisphere(kRays)) rays.push_back(frameFromZ({0, 1, 0}, 0.3) * w);
    std::vector<uint8_t> blocked(rays.size());
    tracer.occluded({0.13, 0.001, 0.21}, rays, kNoLimit, blocked.data());
    for (size_t i = 0; i < rays.size(); ++i) {
        // Through the pane, or past it.
        if (std::abs(rays[i].x) > 9 * rays[i].y || std::abs(rays[i].z) > 9 * rays[i].y) continue;
        all += rays[i].y;
        open += blocked[i] ? 0 : rays[i].y;
    }
    return open / all;
}

const char* const kGrey = R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1]}})";

// A checkerboard of 8 x 8 texels, alpha 255 and 0.
std::string checker() {
    std::vector<uint16_t> texels;
    for (int i = 0; i < 64; ++i)
        for (int c = 0; c < 4; ++c) texels.push_back(c < 3 ? 255 : (i + i / 8) % 2 ? 255 : 0);
    return png(8, 8, texels);
}

TEST(Materials, LetThroughWhatTheirAlphaSays) {
    const std::string images = R"("images":[)" + checker() + R"(],"samplers":[{"magFilter":9728}],"textures":[{"source":0,"sampler":0}])";
    const auto with = [&](const std::string& pane, bool colours = false) {
        return openness(parsed(twoSheets(std::string(kGrey) + "," + pane, images, colours), TexturesFor::Rays));
    };
    EXPECT_EQ(with(R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}})"), 0) << "opaque, whatever its alpha";
    EXPECT_NEAR(with(R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}})"), 0.75, 0.02);
    EXPECT_EQ(with(R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0]}})"), 1);
    EXPECT_EQ(with(R"({"alphaMode":"BLEND"})"), 0);
    EXPECT_EQ(with(R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.49]}})"), 1);
    EXPECT_EQ(with(R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.51]}})"), 0);
    EXPECT_NEAR(with(R"({"alphaMode":"BLEND"})", true), 0.5, 0.02) << "by the colour of its vertices";
    // Of two panes each lets its part of the rays pass: a second instance of the first, 10 cm above it.
    {
        Scene two = parsed(
            twoSheets(std::string(kGrey) + R"(,{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5]}})", ""));
        EXPECT_NEAR(openness(two), 0.5, 0.02);
        for (const bool shared : {true, false}) {
            Scene more = two;
            if (!shared) more.surfaces.push_back(more.surfaces[1]);
            more.instances.push_back({shared ? 1 : 2, glm::mat4(1)});
            more.instances.back().toWorld[3].y = 0.1f;
            EXPECT_NEAR(openness(more), 0.25, 0.02) << shared;
        }
    }
    // Half of a fine checkerboard is open.
    const std::string fine = R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":
        {"KHR_texture_transform":{"scale":[20,20]}}}}})";
    EXPECT_NEAR(with(fine), 0.5, 0.05);
    EXPECT_NEAR(
        with(R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"baseColorTexture":{"index":0,"extensions":
        {"KHR_texture_transform":{"scale":[20,20]}}}}})"),
        0.75, 0.05);
    // The bake sees the same, for any number of threads.
    const Scene scene = parsed(
        twoSheets(std::string(kGrey) + R"(,{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}})", ""));
    BakeOptions options;
    options.rays = 1024;
    const BakedVisibility one = bakeVertices(scene, Tracer(scene), options);
    options.threads = 1;
    const BakedVisibility two = bakeVertices(scene, Tracer(scene), options);
    for (size_t v = 0; v < 4; ++v) EXPECT_EQ(one[0].visibility[v].area, two[0].visibility[v].area);
}

TEST(Materials, ATextureIsReadAsItsSamplerSays) {
    // Red, green; blue, white.
    const std::string image = png(2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255});
    const auto textureWith = [&](const std::string& sampler) {
        const Scene scene = parsed(
            twoSheets(std::string(kGrey) + R"(,{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})",
                      R"("images":[)" + image + R"(],"samplers":[{)" + sampler + R"(}],"textures":[{"source":0,"sampler":0}])"));
        return *scene.textures.at(0);
    };
    const glm::vec4 red(1, 0, 0, 1), green(0, 1, 0, 1), blue(0, 0, 1, 1), white(1);
    const Texture nearest = textureWith(R"("magFilter":9728)");
    EXPECT_EQ(nearest.at({0.1, 0.1}), red);
    EXPECT_EQ(nearest.at({0.9, 0.1}), green);
    EXPECT_EQ(nearest.at({-0.9, 1.9}), blue);
    const Texture mirror = textureWith(R"("magFilter":9728,"wrapS":33648,"wrapT":33648)");
    EXPECT_EQ(mirror.at({1.1, 0.1}), green);
    EXPECT_EQ(mirror.at({-0.1, -0.1}), red);
    const Texture clamp = textureWith(R"("magFilter":9728,"wrapS":33071,"wrapT":33071)");
    EXPECT_EQ(clamp.at({7, 9}), white);
    EXPECT_EQ(clamp.at({-7, 9}), blue);
    const Texture smooth = textureWith("");
    EXPECT_LT(glm::length(smooth.at({0.5, 0.25}) - 0.5f * (red + green)), 1e-5f);
    // Mips are means of linear light: one channel of four is full in two of four texels.
    ASSERT_EQ(smooth.mips->size(), 2u);
    EXPECT_NEAR(smooth.at({0.3, 0.7}, 1).r, 0.5, 0.005);
    EXPECT_NEAR(smooth.at({0.5, 0.25}, 0.5f).b, 0.25, 0.005);
    for (const float x : {NAN, INFINITY, 1e30f, -1e30f}) EXPECT_TRUE(std::isfinite(smooth.at({x, 0.5}).r));
}

View over(const glm::vec3& eye) {
    View view;
    view.width = view.height = 32;
    view.camera = {eye, {0, 0, 0}, 0.5f};
    view.lights = {directionalLight({0.2f, 1, 0.1f}, 0.05, vec3(100))};
    return view;
}

Asset baked(Scene scene) {
    Asset asset;
    asset.scene = std::move(scene);
    BakeOptions options;
    options.rays = 256;
    asset.seen = bakeVertices(asset.scene, Tracer(asset.scene), options);
    return asset;
}

double differenceOf(const Picture& a, const Picture& b) {
    double sum = 0, size = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        sum += double(glm::dot(a.pixels[i] - b.pixels[i], a.pixels[i] - b.pixels[i]));
        size += double(glm::dot(b.pixels[i], b.pixels[i]));
    }
    return std::sqrt(sum / size);
}

TEST(Materials, AreDrawnAsTheReferenceDrawsThem) {
    const Gpu gpu({.validate = true});
    const Model& soft = *findModel("soft");
    const std::string stripes = png(2, 1, {200, 100, 50, 255, 50, 100, 200, 255});
    const std::string images = R"("images":[)" + stripes + "," + checker()
                             + R"(],"samplers":[{"magFilter":9728}],"textures":[{"source":0},{"source":1,"sampler":0}])";
    // The floor glows and reflects nothing, so that what the models make of its visibility does not count; nothing is above the pane.
    const std::string floor = R"({"pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]},"emissiveFactor":[1,1,1],"emissiveTexture":
        {"index":0,"extensions":{"KHR_texture_transform":{"scale":[8,1]}}}})";
    const struct {
        const char* name;
        std::string pane;
        bool colours = false;
    } cases[] = {
        {"colour", R"({"pbrMetallicRoughness":{"baseColorFactor":[0.9,0.2,0.1,1]}})"},
        {"texture", R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
                     {"scale":[5,3],"rotation":0.5,"offset":[0.1,0.2]}}}}})"},
        {"mask", R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":1,"extensions":{"KHR_texture_transform":
                     {"scale":[2,2]}}}}})"},
        {"blend", R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.2,0.9,0.3,0.4]}})"},
        {"emissive", R"({"emissiveFactor":[1,0.5,0],"emissiveTexture":{"index":0},"extensions":
                     {"KHR_materials_emissive_strength":{"emissiveStrength":3}}})"},
        {"vertex colours", R"({"alphaMode":"BLEND"})", true}};
    std::vector<Picture> all;
    for (const auto& c : cases) {
        const Asset asset = baked(parsed(twoSheets(floor + "," + c.pane, images, c.colours)));
        Renderer renderer(gpu, asset);
        View view = over({0.1f, 9, 4});
        ReferenceOptions options;
        options.skyRays = 256;
        const Picture drawn = renderer.draw(view, soft), truth = traceReference(Tracer(asset.scene), view, options);
        std::printf("%s: %.4f from the reference\n", c.name, differenceOf(drawn, truth));
        EXPECT_LT(differenceOf(drawn, truth), 0.06) << c.name;
        for (const Picture& other : all) EXPECT_GT(differenceOf(drawn, other), 0.05) << c.name;
        all.push_back(drawn);
        EXPECT_LT(differenceOf(renderer.draw(view, soft, LightAt::Vertices), truth), 0.06) << c.name << ", lit at the vertices";
        view.plain = true;
        const Picture plain = renderer.draw(view, soft);
        const bool opaque = materialOf(asset.scene, asset.scene.surfaces[1]).alpha == Material::Alpha::Opaque;
        if (opaque) {
            EXPECT_LT(differenceOf(plain, traceReference(Tracer(asset.scene), view, options)), 0.06) << c.name << ", plain";
        }
        view.plain = false;
        EXPECT_GT(differenceOf(renderer.drawShadowMapped(view), plain), 0.05) << c.name;
    }
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
}

TEST(Materials, ThatBlendAddUpInTheirOrder) {
    // A black pane of alpha 0.4 over a floor that glows, without any light: 0.6 of the glow. Above both lies the eye.
    const Gpu gpu({.validate = true});
    const std::string glow = R"({"emissiveFactor":[1,0.5,0.25]})";
    const Asset asset = baked(
        parsed(twoSheets(glow + R"(,{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0,0,0,0.4]}})", "")));
    View view = over({0.1f, 9, 4});
    view.lights.clear();
    view.sky = glm::vec3(0);
    Renderer renderer(gpu, asset);
    const Picture drawn = renderer.draw(view, *findModel("soft")), truth = traceReference(Tracer(asset.scene), view, {});
    for (const Picture* p : {&drawn, &truth})
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(p->pixels[16 * 32 + 16][c], 0.6 / (1 << c), 1e-4);
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
}

TEST(Materials, MasksHaveHolesInTheShadowMapToo) {
    const Gpu gpu({.validate = true});
    const auto shadowOn = [&](const char* pane) {
        const Asset asset = baked(parsed(twoSheets(std::string(kGrey) + "," + pane, "")));
        View view = over({0.05f, 0.5f, 0.1f});  // below the pane
        view.sky = glm::vec3(0);
        Renderer renderer(gpu, asset);
        return renderer.drawShadowMapped(view).pixels[16 * 32 + 16].r;
    };
    EXPECT_LT(shadowOn(R"({})"), 1e-3);
    EXPECT_GT(shadowOn(R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.1]}})"), 0.1);
    for (const std::string& message : gpu.messages()) ADD_FAILURE() << message;
}

TEST(Materials, ThatAreBrokenAreWhiteWithALine) {
    const std::string textured = std::string(kGrey) + R"(,{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})";
    for (const char* const image : {R"({"uri":"missing.png"})", R"({"uri":"data:image/png;base64,iVBORw0KGgoAAAAA"})",
                                    R"({"uri":"data:image/png;base64,AAAA"})", R"({"uri":"data:image/jpeg;base64,/9j/2wBD"})"}) {
        const Scene scene = parsed(twoSheets(textured, R"("images":[)" + std::string(image) + R"(],"textures":[{"source":0}])"));
        ASSERT_FALSE(scene.notes.empty()) << image;
        EXPECT_NE(scene.notes.back().find("1 texture is missing"), std::string::npos) << scene.notes.back();
        EXPECT_EQ(baseColourAt(scene, scene.surfaces[1], 0, glm::vec3(1.0f / 3)), glm::vec4(1)) << image;
    }
    // Members of wrong types, and numbers that are none, count as missing.
    for (const char* const material :
         {R"({"pbrMetallicRoughness":7})", R"({"pbrMetallicRoughness":{"baseColorFactor":[1,2]}})", R"({"alphaMode":3,"alphaCutoff":"x"})",
          R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":77}}})", R"({"emissiveFactor":"red","emissiveTexture":[]})",
          R"({"extensions":{"KHR_materials_emissive_strength":[]}})", R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1e300]}})"}) {
        const Scene scene = parsed(twoSheets(std::string(kGrey) + "," + material, ""));
        EXPECT_EQ(baseColourAt(scene, scene.surfaces[1], 0, glm::vec3(1.0f / 3)), glm::vec4(1)) << material;
        EXPECT_EQ(emissionAt(scene, scene.surfaces[1], 0, glm::vec3(1.0f / 3)), glm::vec3(0)) << material;
    }
}

}  // namespace
}  // namespace apertura::test
