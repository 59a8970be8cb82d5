// A picture of a baked asset under a sun.
//   draw ASSET MODEL PICTURE.png
#include <apertura/renderer.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
    const apertura::Model* const model = argc == 4 ? apertura::findModel(argv[2]) : nullptr;
    if (!model) {
        std::fputs("draw ASSET MODEL PICTURE.png\n", stderr);
        return 2;
    }
    try {
        const apertura::Asset asset = apertura::loadAsset(argv[1]);
        const apertura::Gpu gpu;
        apertura::Renderer renderer(gpu, asset);
        apertura::View view;
        view.camera = apertura::viewOf(asset.scene);
        view.width = 64;
        view.height = 36;
        view.lights.push_back(apertura::directionalLight({0.3f, 0.8f, 0.5f}, 0.02, {700, 650, 570}));
        apertura::writePicture(argv[3], renderer.draw(view, *model));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
