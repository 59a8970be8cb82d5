// URIs: runtime/asset/gltf_document.h says what a glTF file can make us read.
#include <algorithm>
#include <array>
#include <cctype>

#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf_document.h"

namespace apertura {
namespace {

namespace fs = std::filesystem;

std::optional<Bytes> decodeBase64(std::string_view text) {
    static const std::array<int8_t, 256> values = [] {
        std::array<int8_t, 256> out;
        out.fill(-1);
        const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (size_t i = 0; i < digits.size(); ++i) out[uint8_t(digits[i])] = int8_t(i);
        return out;
    }();
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    Bytes out;
    out.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int8_t value = values[uint8_t(c)];
        if (value < 0) return {};
        bits = bits << 6 | uint32_t(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            out.push_back(static_cast<unsigned char>(bits >> count & 255));
        }
    }
    return out;
}

std::optional<std::string> decodePercent(std::string_view text) {
    auto digit = [](char c) { return std::isdigit(uint8_t(c)) ? c - '0' : std::isxdigit(uint8_t(c)) ? std::tolower(c) - 'a' + 10 : -1; };
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out += text[i];
            continue;
        }
        if (i + 2 >= text.size() || digit(text[i + 1]) < 0 || digit(text[i + 2]) < 0) return {};
        out += char(digit(text[i + 1]) * 16 + digit(text[i + 2]));
        i += 2;
    }
    return out;
}

// The scheme of a URI (RFC 3986, 3.1); empty for a relative reference.
std::string_view schemeOf(std::string_view uri) {
    const size_t end = std::find_if(uri.begin(), uri.end(),
                                    [](char c) { return !std::isalnum(uint8_t(c)) && c != '+' && c != '-' && c != '.'; })
                     - uri.begin();
    const bool scheme = end > 0 && end < uri.size() && uri[end] == ':' && std::isalpha(uint8_t(uri[0]));
    return scheme ? uri.substr(0, end) : std::string_view();
}

// A long URI, of data, is cut after 100 characters.
Error refusal(const std::string& uri, const std::string& name, const std::string& cause) {
    return Error(name + ": the URI '" + (uri.size() > 120 ? uri.substr(0, 100) + "..." : uri) + "' " + cause);
}

bool isWithin(const fs::path& file, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

UriSource resolveUri(const std::string& uri, const fs::path& folder, const std::string& name) {
    if (uri.starts_with("data:")) return {uri, {}};
    if (!schemeOf(uri).empty()) throw refusal(uri, name, "is not a file in the document's own folder");
    const std::optional<std::string> decoded = decodePercent(uri);
    if (!decoded || decoded->empty() || decoded->find('\0') != std::string::npos) throw refusal(uri, name, "is not a file's name");
    if (fs::path(*decoded).is_absolute()) throw refusal(uri, name, "is not relative to the document's own folder");
    // The place that the path leads to after links are followed decides, not its spelling.
    std::error_code error;
    const fs::path home = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
    if (error) throw refusal(uri, name, "cannot be looked for: " + error.message());
    fs::path file = fs::canonical(home / *decoded, error);
    const bool missing = bool(error);
    if (missing) file = fs::weakly_canonical(home / *decoded, error);
    if (error || !isWithin(file, home)) throw refusal(uri, name, "leads out of the document's own folder");
    return {uri, missing ? fs::path() : file};
}

std::optional<Bytes> readUri(const UriSource& source, std::optional<size_t> length, const std::string& name) {
    Bytes bytes;
    if (source.isData()) {
        const std::string_view uri = source.uri;
        const size_t comma = uri.find(',');
        if (comma == std::string::npos || !uri.substr(0, comma).ends_with(";base64"))
            throw refusal(source.uri, name, "holds no base64 data");
        std::optional<Bytes> decoded = decodeBase64(uri.substr(comma + 1));
        if (!decoded) throw refusal(source.uri, name, "holds damaged base64 data");
        bytes = std::move(*decoded);
    } else {
        if (source.file.empty()) return {};
        try {
            bytes = readFile(source.file.string(), length);
        } catch (const Error& e) {
            throw refusal(source.uri, name, "cannot be read: " + std::string(e.what()).substr(source.file.string().size() + 2));
        }
    }
    if (length && bytes.size() != *length)
        throw refusal(source.uri, name,
                      "holds " + std::to_string(bytes.size()) + " bytes where the document says " + std::to_string(*length));
    return bytes;
}

std::vector<fs::path> filesOf(const GltfDocument& document, const fs::path& folder) {
    std::vector<fs::path> out;
    for (const char* list : {"buffers", "images"})
        for (const Json& entry : listOf(document.json, list))
            if (entry.contains("uri"))
                if (const UriSource source = resolveUri(entry["uri"].get<std::string>(), folder, document.name); !source.file.empty())
                    out.push_back(source.file);
    return out;
}

}  // namespace apertura
