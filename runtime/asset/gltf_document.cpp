#include "apertura/runtime/asset/gltf_document.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <map>

#include "apertura/runtime/asset/file.h"

namespace apertura {
namespace {

constexpr int kDeepest = 200;  // nested arrays and objects; functions that walk them recurse
constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

// True if JSON text nests deeper than kDeepest.
bool nestsTooDeep(std::span<const unsigned char> text) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const unsigned char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest) return true;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return false;
}

uint32_t wordAt(std::span<const unsigned char> bytes, size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, &bytes[at], 4);  // little-endian, as glTF is
    return value;
}

Json parseJson(std::span<const unsigned char> text, const std::string& name) {
    if (nestsTooDeep(text)) throw Error(name + ": not a valid glTF file: nested too deep");
    try {
        return Json::parse(text.begin(), text.end());
    } catch (const Json::exception& e) {
        std::string cause = e.what();  // [json.exception.parse_error.101] parse error at ...
        if (const size_t end = cause.find("] "); cause.starts_with("[") && end != std::string::npos) cause.erase(0, end + 2);
        cause.resize(std::min({cause.size(), cause.find("; last read"), size_t(200)}));  // it may quote most of the file
        throw Error(name + ": not a valid glTF file: " + cause);
    }
}

// Reads the files and data that URIs name, each once.
class UriReader {
public:
    UriReader(const std::string& name, const std::filesystem::path& folder) : name_(name), folder_(folder) {}

    size_t fileBytes() const { return fileBytes_; }

    // Null if there is no such file.
    SharedBytes read(const std::string& uri, std::optional<size_t> length) {
        const UriSource source = resolveUri(uri, folder_, name_);
        const auto [found, fresh] = read_.try_emplace(source.file.empty() ? uri : source.file.string());
        if (fresh)
            if (std::optional<Bytes> bytes = readUri(source, length, name_)) {
                fileBytes_ += bytes->size();
                found->second = std::make_shared<const Bytes>(std::move(*bytes));
            }
        const SharedBytes& bytes = found->second;
        if (bytes && length && bytes->size() != *length) throw Error(name_ + ": two buffers of one URI differ in length");
        return bytes;
    }

private:
    const std::string& name_;
    const std::filesystem::path& folder_;
    std::map<std::string, SharedBytes> read_;  // by canonical path, or by URI for data
    size_t fileBytes_ = 0;
};

void readBuffers(GltfDocument& document, const GltfContainer& container, UriReader& reader) {
    const SharedBytes none = std::make_shared<const Bytes>();
    const Json& buffers = listOf(document.json, "buffers");
    for (size_t i = 0; i < buffers.size(); ++i) {
        const Json& buffer = buffers[i];
        const std::string where = document.name + ": buffer " + std::to_string(i);
        const size_t length = buffer["byteLength"].get<size_t>();
        // A fallback buffer, for readers without the compression, is not needed.
        if (listOf(buffer, "extensions").contains("EXT_meshopt_compression")) {
            document.buffers.push_back(none);
        } else if (buffer.contains("uri")) {
            SharedBytes bytes = reader.read(buffer["uri"].get<std::string>(), length);
            if (!bytes) throw Error(where + ": there is no file '" + buffer["uri"].get<std::string>() + "'");
            document.buffers.push_back(std::move(bytes));
        } else if (i == 0 && container.isBinary) {
            if (container.binary.size() < length)
                throw Error(where + " has " + std::to_string(container.binary.size()) + " bytes in the file where it says "
                            + std::to_string(length));
            document.buffers.push_back(
                std::make_shared<const Bytes>(container.binary.begin(), container.binary.begin() + ptrdiff_t(length)));
        } else {
            throw Error(where + " has no data");
        }
    }
}

void readImages(GltfDocument& document, UriReader& reader) {
    for (const Json& image : listOf(document.json, "images")) {
        SharedBytes bytes = std::make_shared<const Bytes>();
        if (image.contains("uri") && !image.contains("bufferView")) {
            const auto& uri = image["uri"].get_ref<const std::string&>();
            if (SharedBytes found = reader.read(uri, {}))
                bytes = std::move(found);
            else
                document.notes.push_back("the image '" + uri + "' is not there: it stays a reference");
        }
        document.images.push_back(std::move(bytes));
    }
}

void checkViews(const GltfDocument& document) {
    const Json& views = listOf(document.json, "bufferViews");
    for (size_t i = 0; i < views.size(); ++i) {
        // A compressed view may point into an empty fallback buffer: decodeMeshopt checks its source.
        if (listOf(views[i], "extensions").contains("EXT_meshopt_compression")) continue;
        const size_t size = document.buffers[views[i]["buffer"].get<size_t>()]->size(), offset = unsignedOr(views[i], "byteOffset", 0);
        const size_t length = views[i]["byteLength"].get<size_t>();
        if (offset > size || length > size - offset)
            throw Error(document.name + ": buffer view " + std::to_string(i) + " reaches outside its buffer");
    }
}

}  // namespace

GltfContainer splitContainer(std::span<const unsigned char> bytes, const std::string& name) {
    if (bytes.empty()) throw Error(name + ": the file is empty");
    if (bytes.size() > std::numeric_limits<uint32_t>::max()) throw Error(name + ": larger than 4 GiB");
    if (bytes.size() < 4 || wordAt(bytes, 0) != kGlbMagic) {
        // JSON starts with a bracket, perhaps after white space or a byte order mark.
        const auto first = std::find_if(bytes.begin(), bytes.end(), [](unsigned char c) { return !std::isspace(c); });
        if (first == bytes.end() || (*first != '{' && *first != '[' && *first != 0xEF)) throw Error(name + ": not a glTF file");
        return {bytes, {}, false};
    }
    if (bytes.size() < 20 || wordAt(bytes, 8) != bytes.size() || wordAt(bytes, 12) > bytes.size() - 20)
        throw Error(name + ": truncated or damaged: " + std::to_string(bytes.size()) + " bytes where the header says "
                    + std::to_string(bytes.size() >= 12 ? wordAt(bytes, 8) : 12));
    if (wordAt(bytes, 4) != 2)
        throw Error(name + ": is binary glTF of version " + std::to_string(wordAt(bytes, 4)) + "; version 2 is read");
    if (wordAt(bytes, 16) != kJsonChunk) throw Error(name + ": not a valid glTF file: its first chunk is not JSON");
    GltfContainer out{bytes.subspan(20, wordAt(bytes, 12)), {}, true};
    const size_t next = 20 + out.json.size();
    if (next + 8 <= bytes.size() && wordAt(bytes, next + 4) == kBinaryChunk) {
        if (wordAt(bytes, next) > bytes.size() - next - 8)
            throw Error(name + ": truncated or damaged: its binary chunk reaches behind the file's end");
        out.binary = bytes.subspan(next + 8, wordAt(bytes, next));
        out.hasMore = next + 8 + out.binary.size() + 8 <= bytes.size();
    } else {
        out.hasMore = next + 8 <= bytes.size();
    }
    return out;
}

Budget::Budget(const GltfDocument& document, const char* what, double base, double factor)
    : name_(document.name), what_(what), left_(base + factor * double(document.fileBytes)) {}

void Budget::spend(double amount) {
    left_ -= amount;
    if (left_ < 0) throw Error(name_ + ": refers to the same bytes so often that " + what_ + " are more than a file of its size can mean");
}

GltfDocument parseGltfDocument(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder) {
    const GltfContainer container = splitContainer(bytes, name);
    GltfDocument document;
    document.name = name;
    document.json = parseJson(container.json, name);
    checkStructure(document.json, name);
    UriReader reader(name, folder);
    dropAlternatives(document.json);
    readBuffers(document, container, reader);
    checkViews(document);
    decodeMeshopt(document);
    checkAccessors(document);
    readImages(document, reader);
    document.fileBytes = bytes.size() + reader.fileBytes();
    if (container.hasMore) document.notes.push_back("chunks of the .glb behind the binary one are left out");
    expandInstancing(document);
    return document;
}

GltfDocument readGltfDocument(const std::string& path) {
    return parseGltfDocument(readFile(path), path, std::filesystem::path(path).parent_path());
}

double valuesIn(const Json& json) {
    double sum = json.is_string() ? 1 + double(json.get_ref<const std::string&>().size()) / 16 : 1;
    if (json.is_structured())
        for (const Json& value : json) sum += valuesIn(value);
    return sum;
}

}  // namespace apertura
