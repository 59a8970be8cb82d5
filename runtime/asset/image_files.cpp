#include "apertura/runtime/asset/image_files.h"

#include <algorithm>

#include "apertura/runtime/asset/bent_normals.h"
#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/asset/png.h"
#include "apertura/runtime/asset/texels.h"

namespace apertura {
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

std::vector<std::unique_ptr<PendingFile>> pendingImages(const std::string& asset, const Scene& scene, const BakedVisibility& visibility,
                                                        int bits, ImageFormat format) {
    const bool bentNormals = std::any_of(visibility.begin(), visibility.end(), [](const auto& seen) { return !seen.bent.texels.empty(); });
    const std::vector<std::string> names = imageFiles(asset, visibility.size(), bentNormals, format);
    std::vector<std::unique_ptr<PendingFile>> out;
    const auto add = [&](const PngImage& png, const auto& numbers) {
        std::vector<unsigned char> bytes;
        if (format == ImageFormat::Png)
            bytes = encodePng(png);
        else
            bytes = encodeHalves(png.width, png.height, png.channels, numbers());
        out.push_back(std::make_unique<PendingFile>(names[out.size()]));
        out.back()->writeAll({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    };
    for (size_t i = 0; i < visibility.size(); ++i) {
        const SeenOnTexels& seen = visibility[i].texels;
        const BentNormals& bent = visibility[i].bent;
        const glm::mat3 toLocal = glm::transpose(rotationPart(scene.instances[i].toWorld));
        if (!bentNormals) {
            add(visibilityImage(seen, toLocal, bits), [&] { return texelNumbers(seen, toLocal); });
            continue;
        }
        add(bentImage(bent, bits), [&] {
            std::vector<float> numbers;
            for (const glm::vec4& texel : bent.texels)
                for (int c = 0; c < 3; ++c) numbers.push_back(texel[c]);
            return numbers;
        });
        add(occlusionImage(bent, bits), [&] {
            std::vector<float> numbers;
            for (const glm::vec4& texel : bent.texels) numbers.push_back(texel.w);
            return numbers;
        });
    }
    return out;
}

}  // namespace apertura
