#include "apertura/runtime/asset/gltf_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>

namespace apertura {
namespace {

constexpr size_t kAlignment = 16;  // bytes; views keep their offset modulo this

using Visit = std::function<void(Json&)>;  // called for an index, or for JSON that holds indices

void visitMember(Json& holder, const char* key, const Visit& visit) {
    if (const auto found = holder.find(key); found != holder.end()) visit(*found);
}

void visitEach(Json& holder, const char* key, const Visit& visit) {
    if (holder.contains(key))
        for (Json& element : holder[key]) visit(element);
}

void visitAccessors(Json& json, const Visit& visit) {
    visitEach(json, "meshes", [&](Json& mesh) {
        visitEach(mesh, "primitives", [&](Json& primitive) {
            visitEach(primitive, "attributes", visit);
            visitMember(primitive, "indices", visit);
            visitEach(primitive, "targets", [&](Json& target) {
                for (Json& index : target) visit(index);
            });
        });
    });
    visitEach(json, "skins", [&](Json& skin) { visitMember(skin, "inverseBindMatrices", visit); });
    visitEach(json, "animations", [&](Json& animation) {
        visitEach(animation, "samplers", [&](Json& sampler) {
            for (const char* key : {"input", "output"}) visitMember(sampler, key, visit);
        });
    });
}

// Visits all indices of buffer views, but not those in the accessors of `except`.
void visitViews(Json& json, const std::set<size_t>& except, const Visit& visit) {
    if (json.contains("accessors"))
        for (size_t i = 0; i < json["accessors"].size(); ++i) {
            Json& accessor = json["accessors"][i];
            if (except.contains(i)) continue;
            visitMember(accessor, "bufferView", visit);
            if (accessor.contains("sparse"))
                for (const char* key : {"indices", "values"}) visitMember(accessor["sparse"][key], "bufferView", visit);
        }
    if (json.contains("images"))
        for (Json& image : json["images"]) visitMember(image, "bufferView", visit);
    const Json::json_pointer allParams("/asset/extras/apertura/forms");
    if (json.contains(allParams) && json[allParams].is_array())
        for (Json& params : json[allParams])
            if (params.is_object()) visitMember(params, "bufferView", visit);
}

std::set<size_t> unused(std::set<size_t> candidates, const std::function<void(const Visit&)>& visitAll) {
    visitAll([&](Json& index) { candidates.erase(index.get<size_t>()); });
    return candidates;
}

// Removes elements from an array of the document and renumbers the indices of those that stay.
void removeElements(Json& list, const std::set<size_t>& indices, const std::function<void(const Visit&)>& visitAll) {
    if (indices.empty()) return;
    std::vector<size_t> place(list.size());  // new index of each that stays
    for (size_t i = 0, next = 0; i < place.size(); ++i) place[i] = indices.contains(i) ? next : next++;
    visitAll([&](Json& index) { index = place[index.get<size_t>()]; });
    Json kept = Json::array();
    for (size_t i = 0; i < list.size(); ++i)
        if (!indices.contains(i)) kept.push_back(std::move(list[i]));
    list = std::move(kept);
}

// True if all used extensions are known not to refer to accessors or views by index in places of their own.
bool onlyKnownExtensions(const Json& json) {
    for (const Json& extension : listOf(json, "extensionsUsed")) {
        const auto& name = extension.get_ref<const std::string&>();
        static const std::set<std::string> harmless{"KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual",
                                                    "KHR_texture_basisu",    "EXT_texture_webp",      "MSFT_texture_dds",
                                                    "KHR_xmp_json_ld"};
        if (!harmless.contains(name) && !name.starts_with("KHR_materials_")) return false;
    }
    return true;
}

// The MIME type that a data URI states or the first bytes of the file show, by each format's specification; else empty.
std::string mimeTypeOf(const std::string& uri, const Bytes& bytes) {
    if (uri.starts_with("data:image/")) return uri.substr(5, uri.find_first_of(";,") - 5);
    const std::string head(bytes.begin(), bytes.begin() + ptrdiff_t(std::min<size_t>(bytes.size(), 12)));
    if (head.starts_with("\x89PNG")) return "image/png";
    if (head.starts_with("\xFF\xD8")) return "image/jpeg";
    if (head.starts_with("\xABKTX 20")) return "image/ktx2";
    if (head.starts_with("RIFF") && head.substr(8) == "WEBP") return "image/webp";
    if (head.starts_with("DDS ")) return "image/vnd-ms.dds";
    if (head.size() == 12 && head.substr(4) == "ftypavif") return "image/avif";
    return {};
}

void putWord(std::string& out, size_t value) {
    for (int i = 0; i < 4; ++i) out += char(value >> (8 * i) & 255);
}

}  // namespace

GltfWriter::GltfWriter(const GltfDocument& document) : json_(document.json), buffers_(document.buffers), images_(document.images) {}

size_t GltfWriter::addView(Bytes bytes, GltfTarget target, size_t stride) {
    return addView(std::make_shared<const Bytes>(std::move(bytes)), target, stride);
}

size_t GltfWriter::addView(SharedBytes bytes, GltfTarget target, size_t stride) {
    Json view{{"buffer", buffers_.size()}, {"byteLength", bytes->size()}};
    if (target != kNoTarget) view["target"] = int(target);
    if (stride) view["byteStride"] = stride;
    json_["buffers"].push_back({{"byteLength", bytes->size()}});
    buffers_.push_back(std::move(bytes));
    if (freeViews_.empty()) {
        json_["bufferViews"].push_back(std::move(view));
        return json_["bufferViews"].size() - 1;
    }
    const size_t place = *freeViews_.begin();
    freeViews_.erase(place);
    json_["bufferViews"][place] = std::move(view);
    return place;
}

size_t GltfWriter::addAccessor(Json members, Bytes bytes, GltfTarget target, size_t stride) {
    members["bufferView"] = addView(std::move(bytes), target, stride);
    return addAccessor(std::move(members));
}

size_t GltfWriter::addAccessor(Json members) {
    if (freeAccessors_.empty()) {
        json_["accessors"].push_back(std::move(members));
        return json_["accessors"].size() - 1;
    }
    const size_t place = *freeAccessors_.begin();
    freeAccessors_.erase(place);
    json_["accessors"][place] = std::move(members);
    return place;
}

void GltfWriter::release(const std::set<size_t>& accessors, const std::set<size_t>& views) {
    const std::set<size_t> gone = unused(accessors, [&](const Visit& visit) { visitAccessors(json_, visit); });
    std::set<size_t> held = views;
    for (const size_t accessor : gone) {
        Json& entry = json_["accessors"][accessor];
        visitMember(entry, "bufferView", [&](Json& index) { held.insert(index.get<size_t>()); });
        if (entry.contains("sparse"))
            for (const char* key : {"indices", "values"}) held.insert(entry["sparse"][key]["bufferView"].get<size_t>());
    }
    freeAccessors_.insert(gone.begin(), gone.end());
    const std::set<size_t> emptied = unused(held, [&](const Visit& visit) { visitViews(json_, freeAccessors_, visit); });
    freeViews_.insert(emptied.begin(), emptied.end());
}

void GltfWriter::removeReleased() {
    if (onlyKnownExtensions(json_)) {
        removeElements(json_["accessors"], freeAccessors_, [&](const Visit& visit) { visitAccessors(json_, visit); });
        removeElements(json_["bufferViews"], freeViews_, [&](const Visit& visit) { visitViews(json_, {}, visit); });
        return;
    }
    // An unknown extension may refer to accessors by index, so none may move: unused ones stay in place and shrink.
    for (const size_t accessor : freeAccessors_)
        for (const char* key : {"bufferView", "byteOffset", "sparse", "min", "max"}) json_["accessors"][accessor].erase(key);
    if (freeViews_.empty()) return;
    const std::set<size_t> shrunk = std::exchange(freeViews_, {});
    json_["buffers"].push_back({{"byteLength", 4}});
    buffers_.push_back(std::make_shared<const Bytes>(4));
    for (const size_t view : shrunk) json_["bufferViews"][view] = {{"buffer", buffers_.size() - 1}, {"byteLength", 4}};
}

void GltfWriter::embedImages() {
    std::map<const Bytes*, size_t> views;
    for (size_t i = 0; i < std::min(images_.size(), listOf(json_, "images").size()); ++i) {
        Json& image = json_["images"][i];
        if (images_[i]->empty() || !image.contains("uri")) continue;  // others may have been put in a place that became free
        if (!image.contains("mimeType")) {
            const std::string type = mimeTypeOf(image["uri"].get_ref<const std::string&>(), *images_[i]);
            if (type.empty()) continue;  // a reader of the file could not tell its format: it stays a reference
            image["mimeType"] = type;
        }
        const auto [view, fresh] = views.try_emplace(images_[i].get());
        if (fresh) view->second = addView(images_[i]);
        image["bufferView"] = view->second;
        image.erase("uri");
    }
}

// Points all views into one merged buffer and returns the runs of bytes, padding included, that it consists of.
std::vector<std::span<const unsigned char>> GltfWriter::packBuffers() {
    static const unsigned char zeros[kAlignment] = {};
    struct Use {
        size_t buffer, begin, end, view;
    };
    std::vector<Use> uses;
    std::map<const Bytes*, size_t> first;  // entries that share their bytes are one buffer
    Json& views = json_["bufferViews"];
    for (size_t i = 0; i < views.size(); ++i) {
        const size_t given = views[i]["buffer"].get<size_t>(), begin = unsignedOr(views[i], "byteOffset", 0);
        const size_t buffer = first.try_emplace(buffers_[given].get(), given).first->second;
        uses.push_back({buffer, begin, begin + views[i]["byteLength"].get<size_t>(), i});
    }
    std::stable_sort(uses.begin(), uses.end(),
                     [](const Use& a, const Use& b) { return std::tie(a.buffer, a.begin) < std::tie(b.buffer, b.begin); });
    // Views that overlap, or are apart by padding alone, stay together as a group. Groups are in the order of their first view.
    std::map<size_t, std::vector<Use>> groups;
    for (size_t i = 0; i < uses.size();) {
        std::vector<Use> group{uses[i]};
        size_t end = uses[i].end, foremost = uses[i].view;
        for (++i; i < uses.size() && uses[i].buffer == group[0].buffer && uses[i].begin < end + 4; ++i) {
            end = std::max(end, uses[i].end);
            foremost = std::min(foremost, uses[i].view);
            group.push_back(uses[i]);
        }
        groups[foremost] = std::move(group);
    }
    std::vector<std::span<const unsigned char>> runs;
    size_t size = 0;
    auto append = [&](std::span<const unsigned char> bytes) {
        runs.push_back(bytes);
        size += bytes.size();
    };
    for (const auto& [view, group] : groups) {
        const size_t begin = group[0].begin / kAlignment * kAlignment;
        size_t end = 0;
        append({zeros, (kAlignment - size % kAlignment) % kAlignment});
        for (const Use& use : group) {
            views[use.view]["buffer"] = 0;
            views[use.view]["byteOffset"] = size + use.begin - begin;
            end = std::max(end, use.end);
        }
        append(std::span(*buffers_[group[0].buffer]).subspan(begin, end - begin));
    }
    append({zeros, (4 - size % 4) % 4});
    // Other members of the buffers' JSON: those of the first buffer stay, those of others move to a list.
    Json merged = json_["buffers"].empty() ? Json::object() : json_["buffers"][0], others = Json::array();
    merged.erase("uri");
    merged["byteLength"] = size;
    for (size_t i = 1; i < json_["buffers"].size(); ++i) {
        Json rest = json_["buffers"][i];
        for (const char* key : {"uri", "byteLength"}) rest.erase(key);
        if (!rest.empty()) others.push_back({{"buffer", i}, {"content", rest}});
    }
    if (!others.empty()) {
        Json& list = json_["asset"]["extras"]["apertura"]["mergedBuffers"];
        if (!list.is_array()) list = Json::array();
        list.insert(list.end(), others.begin(), others.end());
    }
    json_["buffers"] = Json::array({merged});
    return runs;
}

void GltfWriter::write(const std::string& path, const std::string& temporary) {
    embedImages();
    removeReleased();
    const std::vector<std::span<const unsigned char>> runs = packBuffers();
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t binary = json_["buffers"][0]["byteLength"].get<size_t>(), total = 12 + 8 + text.size() + 8 + binary;
    if (total > std::numeric_limits<uint32_t>::max()) throw Error(path + ": the asset would be larger than the 4 GiB of a .glb");
    std::string head = "glTF";
    for (const size_t word : {size_t(2), total, text.size()}) putWord(head, word);
    head += "JSON" + text;
    putWord(head, binary);
    head += std::string("BIN\0", 4);
    std::ofstream out(temporary, std::ios::binary);
    out.write(head.data(), std::streamsize(head.size()));
    for (const auto& run : runs) out.write(reinterpret_cast<const char*>(run.data()), std::streamsize(run.size()));
    out.close();
    if (!out) throw Error(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace apertura
