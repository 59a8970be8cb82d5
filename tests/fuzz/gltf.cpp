// The importer of glTF: any bytes are a scene or an Error.
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/error.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    try {
        apertura::parseGltf(apertura::fuzz::withLength(data, size), "input", apertura::fuzz::scratch());
    } catch (const apertura::Error&) {
    }
    return 0;
}
