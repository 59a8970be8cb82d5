// The body of tinygltf, compiled with our own options (CMakeLists.txt): images stay the bytes they are, so
// that no decoder is linked, and the sanitizers see what it does with a damaged file.
#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
