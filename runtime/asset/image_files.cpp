#include "runtime/asset/image_files.h"

#include <algorithm>

#include "runtime/asset/bent_normals.h"
#include "runtime/asset/file.h"
#include "runtime/asset/picture.h"
#include "runtime/asset/png.h"
#include "runtime/asset/texels.h"

namespace apertura {
namespace {

void writePng(const std::string& path, const PngImage& image) {
    PendingFile file(path);
    const std::vector<unsigned char> bytes = encodePng(image);
    file.writeAll({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

}  // namespace

std::vector<std::string> imageFiles(const std::string& asset, size_t instances, bool bentNormals, ImageFormat format) {
    std::vector<std::string> out;
    const std::string stem = asset.ends_with(".glb") ? asset.substr(0, asset.size() - 4) : asset;
    const std::vector<std::string> kinds = bentNormals ? std::vector<std::string>{".bent-normal", ".occlusion"}
                                                       : std::vector<std::string>{".visibility"};
    for (size_t i = 0; i < instances; ++i)
        for (const std::string& kind : kinds)
            out.push_back(stem + kind + (instances > 1 ? "." + std::to_string(i) : "") + (format == ImageFormat::Png ? ".png" : ".exr"));
    return out;
}

void writeImages(const std::string& asset, const Scene& scene, const BakedVisibility& visibility, int bits, ImageFormat format) {
    const bool bentNormals = std::any_of(visibility.begin(), visibility.end(), [](const auto& seen) { return !seen.bent.texels.empty(); });
    const std::vector<std::string> names = imageFiles(asset, visibility.size(), bentNormals, format);
    auto name = names.begin();
    for (size_t i = 0; i < visibility.size(); ++i) {
        const SeenOnTexels& seen = visibility[i].texels;
        const BentNormals& bent = visibility[i].bent;
        const glm::mat3 toLocal = glm::transpose(rotationPart(scene.instances[i].toWorld));
        if (bentNormals && format == ImageFormat::Png) {
            writePng(*name++, bentImage(bent, bits));
            writePng(*name++, occlusionImage(bent, bits));
        } else if (bentNormals) {
            std::vector<float> normals, open;
            for (const glm::vec4& texel : bent.texels) {
                for (int c = 0; c < 3; ++c) normals.push_back(0.5f + 0.5f * texel[c]);
                open.push_back(texel.w);
            }
            writeHalves(*name++, bent.width, bent.height, 3, normals);
            writeHalves(*name++, bent.width, bent.height, 1, open);
        } else if (format == ImageFormat::Png) {
            writePng(*name++, visibilityImage(seen, toLocal, bits));
        } else {
            writeHalves(*name++, seen.width, seen.height, 4, texelNumbers(seen, toLocal));
        }
    }
}

}  // namespace apertura
