// The reader and the writer of assets: any bytes are an asset or an Error, and what is written can be read.
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace apertura;
    Asset asset;
    const std::string path = fuzz::scratch() / "out.glb";
    try {
        asset = toAsset(parseGltf(fuzz::withLength(data, size), "input", fuzz::scratch()));
        writeAsset(path, asset.scene, asset.seen, asset.info);
    } catch (const Error&) {
        return 0;
    }
    const Asset back = loadAsset(path);
    if (back.seen.size() != asset.seen.size() || back.scene.instances.size() != asset.scene.instances.size()) std::abort();
    return 0;
}
