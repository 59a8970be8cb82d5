// The importer of height maps, in this process: any bytes are heights or an Error.
#include "apertura/bake/scene/height_map.h"

#include <fstream>

#include "apertura/runtime/asset/error.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string path = apertura::fuzz::scratch() / "map";
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), std::streamsize(size));
    try {
        apertura::readHeights(path, {0, 0, 1, size % 2 == 0});  // packed in colours, or not
    } catch (const apertura::Error&) {
    }
    return 0;
}
