#pragma once
// Builds small glTF files as text.
#include <cstdint>
#include <string>
#include <vector>

namespace apertura::test {

inline std::string base64(const std::string& bytes) {
    static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t v = 0;
        for (size_t k = 0; k < 3; ++k) v = v << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
        for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[v >> (18 - 6 * k) & 63];
    }
    return out;
}

// A glTF file with one buffer of floats and one mesh. Views, accessors, the primitive and nodes are JSON without the
// brackets of their arrays; `extra` is appended to the document's members.
inline std::string gltf(const std::vector<float>& data, const std::string& views, const std::string& accessors,
                        const std::string& primitive, const std::string& nodes = R"({"mesh":0})", const std::string& extra = "") {
    const std::string bytes(reinterpret_cast<const char*>(data.data()), data.size() * 4);
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"buffers":[{"byteLength":)" + std::to_string(bytes.size())
         + R"(,"uri":"data:application/octet-stream;base64,)" + base64(bytes) + R"("}],"bufferViews":[)" + views + R"(],"accessors":[)"
         + accessors + R"(],"meshes":[{"primitives":[)" + primitive + R"(]}],"nodes":[)" + nodes + "]" + extra + "}";
}

inline const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
inline const char* const kView = R"({"buffer":0,"byteLength":48})";
inline const char* const kVec3 = R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":4,"min":[0,0,0],"max":[1,1,0]})";
inline const char* const kFan = R"({"attributes":{"POSITION":0},"mode":6})";  // the square; needs kSquare, kView and kVec3

}  // namespace apertura::test
