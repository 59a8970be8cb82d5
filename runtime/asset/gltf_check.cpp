// Checks the structure of a glTF document: all JSON that is read has the right type and every index is in range. The rest
// of runtime/ relies on it.
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "apertura/runtime/asset/gltf_document.h"

namespace apertura {
namespace {

constexpr double kLargestWhole = 0x1p53;

class StructureCheck {
public:
    StructureCheck(const Json& json, const std::string& name) : json_(json), name_(name) {}

    void all() {
        if (!json_.is_object()) fail("", "holds no object");
        asset();
        extensions();
        each(json_, "buffers", "buffers", [&](const Json& buffer, const std::string& where) {
            whole(buffer, "byteLength", where, true);
            text(buffer, "uri", where);
        });
        each(json_, "bufferViews", "bufferViews", [&](const Json& view, const std::string& where) { bufferView(view, where); });
        each(json_, "accessors", "accessors", [&](const Json& accessor, const std::string& where) { this->accessor(accessor, where); });
        each(json_, "images", "images", [&](const Json& image, const std::string& where) {
            text(image, "uri", where);
            text(image, "mimeType", where);
            index(image, "bufferView", "bufferViews", where);
        });
        for (const char* list : {"textures", "samplers"}) each(json_, list, list, [](const Json&, const std::string&) {});
        each(json_, "materials", "materials",
             [&](const Json& material, const std::string& where) { boolean(material, "doubleSided", where); });
        each(json_, "cameras", "cameras", [&](const Json& camera, const std::string& where) {
            text(camera, "type", where);
            if (const Json* perspective = object(camera, "perspective", where)) number(*perspective, "yfov", where);
        });
        each(json_, "meshes", "meshes", [&](const Json& mesh, const std::string& where) {
            each(mesh, "primitives", where + ".primitives",
                 [&](const Json& primitive, const std::string& at) { this->primitive(primitive, at); });
        });
        each(json_, "nodes", "nodes", [&](const Json& node, const std::string& where) { this->node(node, where); });
        each(json_, "skins", "skins",
             [&](const Json& skin, const std::string& where) { index(skin, "inverseBindMatrices", "accessors", where); });
        each(json_, "animations", "animations", [&](const Json& animation, const std::string& where) {
            each(animation, "samplers", where + ".samplers", [&](const Json& sampler, const std::string& at) {
                for (const char* key : {"input", "output"}) index(sampler, key, "accessors", at);
            });
        });
        each(json_, "scenes", "scenes", [&](const Json& scene, const std::string& where) { indices(scene, "nodes", "nodes", where); });
        index(json_, "scene", "scenes", "the document");
    }

private:
    [[noreturn]] void fail(const std::string& where, const std::string& what) const {
        throw Error(name_ + ": not a valid glTF file: " + (where.empty() ? "" : where + " ") + what);
    }

    void asset() const {
        const Json* asset = object(json_, "asset", "");
        if (!asset) fail("", "there is no asset entry");
        text(*asset, "version", "asset");
        text(*asset, "minVersion", "asset");
        const std::string version = asset->value("version", ""), least = asset->value("minVersion", "2.0");
        if (version.starts_with("1.")) throw Error(name_ + ": is glTF " + version + "; glTF 2.0 is read");
        if (version != "2.0" && !version.starts_with("2.")) throw Error(name_ + ": is glTF of version '" + version + "'; glTF 2.0 is read");
        if (least != "2.0") throw Error(name_ + ": needs a reader of glTF " + least + "; glTF 2.0 is read");
    }

    void extensions() const {
        for (const char* key : {"extensionsUsed", "extensionsRequired"})
            for (const Json& extension : array(json_, key, "the document"))
                if (!extension.is_string()) fail(key, "does not hold names");
        // Required extensions that are supported, or that do not change the geometry.
        static const std::set<std::string> known{"KHR_mesh_quantization",   "KHR_texture_transform", "EXT_meshopt_compression",
                                                 "EXT_mesh_gpu_instancing", "KHR_lights_punctual",   "KHR_texture_basisu",
                                                 "EXT_texture_webp"};
        for (const Json& extension : listOf(json_, "extensionsRequired")) {
            const auto& needed = extension.get_ref<const std::string&>();
            if (!known.contains(needed) && !needed.starts_with("KHR_materials_"))
                throw Error(name_ + ": needs the extension " + needed + ", which is not supported");
        }
    }

    void bufferView(const Json& view, const std::string& where) const {
        requiredIndex(view, "buffer", "buffers", where);
        whole(view, "byteLength", where, true);
        whole(view, "byteOffset", where);
        whole(view, "byteStride", where);
        for (const auto& other : listOf(view, "extensions").items())
            if (!other.key().ends_with("_meshopt_compression") && other.value().is_object() && other.value().contains("buffer"))
                fail(where, "has the extension " + other.key() + ", which is not known and refers to bytes that would move");
        const Json* packed = extension(view, "EXT_meshopt_compression", where);
        if (!packed) return;
        requiredIndex(*packed, "buffer", "buffers", where + "'s compression");
        for (const char* key : {"byteLength", "byteStride", "count"}) whole(*packed, key, where + "'s compression", true);
        whole(*packed, "byteOffset", where + "'s compression");
        for (const char* key : {"mode", "filter"}) text(*packed, key, where + "'s compression");
    }

    void accessor(const Json& accessor, const std::string& where) const {
        static const std::set<std::string> types{"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
        index(accessor, "bufferView", "bufferViews", where);
        whole(accessor, "byteOffset", where);
        whole(accessor, "count", where, true);
        component(accessor, where);
        text(accessor, "type", where);
        if (!types.contains(accessor.value("type", ""))) fail(where, "is of no type that glTF has");
        boolean(accessor, "normalized", where);
        const Json* sparse = object(accessor, "sparse", where);
        if (!sparse) return;
        whole(*sparse, "count", where + ".sparse", true);
        for (const char* key : {"indices", "values"}) {
            const Json* part = object(*sparse, key, where + ".sparse");
            if (!part) fail(where + ".sparse", std::string("has no ") + key);
            requiredIndex(*part, "bufferView", "bufferViews", where + ".sparse");
            whole(*part, "byteOffset", where + ".sparse");
        }
        component(sparse->at("indices"), where + ".sparse");
    }

    void component(const Json& holder, const std::string& where) const {
        whole(holder, "componentType", where, true);
        const size_t type = holder["componentType"].get<size_t>();
        if (type < kByte || type > kFloat || type == 5124) fail(where, "has an unknown component type");
    }

    void primitive(const Json& primitive, const std::string& where) const {
        const Json* attributes = object(primitive, "attributes", where);
        if (!attributes) fail(where, "has no attributes");
        for (const auto& attribute : attributes->items())
            requiredIndex(*attributes, attribute.key().c_str(), "accessors", where + ".attributes");
        index(primitive, "indices", "accessors", where);
        index(primitive, "material", "materials", where);
        whole(primitive, "mode", where);
        if (unsignedOr(primitive, "mode", kTriangles) > kTriangleFan)
            fail(where, "is of mode " + primitive["mode"].dump() + ", which there is none of");
        for (const Json& target : array(primitive, "targets", where)) {
            if (!target.is_object()) fail(where + ".targets", "does not hold objects");
            for (const auto& attribute : target.items()) requiredIndex(target, attribute.key().c_str(), "accessors", where + ".targets");
        }
    }

    void node(const Json& node, const std::string& where) const {
        index(node, "mesh", "meshes", where);
        index(node, "camera", "cameras", where);
        indices(node, "children", "nodes", where);
        const std::pair<const char*, size_t> vectors[] = {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}};
        for (const auto& [key, size] : vectors) {
            if (!node.contains(key)) continue;
            const Json& values = node[key];
            bool good = values.is_array() && values.size() == size;
            for (size_t i = 0; good && i < size; ++i) good = values[i].is_number();
            if (!good) fail(where + "." + key, "is not of " + std::to_string(size) + " numbers");
        }
        const Json* instancing = extension(node, "EXT_mesh_gpu_instancing", where);
        if (!instancing) return;
        const Json* attributes = object(*instancing, "attributes", where + "'s instancing");
        if (!attributes) fail(where + "'s instancing", "has no attributes");
        for (const auto& attribute : attributes->items())
            requiredIndex(*attributes, attribute.key().c_str(), "accessors", where + "'s instancing");
    }

    void each(const Json& holder, const char* key, const std::string& where,
              const std::function<void(const Json&, const std::string&)>& check) const {
        const Json& entries = array(holder, key, where);
        for (size_t i = 0; i < entries.size(); ++i) {
            const std::string at = where + "[" + std::to_string(i) + "]";
            if (!entries[i].is_object()) fail(at, "is not an object");
            object(entries[i], "extensions", at);
            check(entries[i], at);
        }
    }

    const Json& array(const Json& holder, const char* key, const std::string& where) const {
        const Json& list = listOf(holder, key);
        if (!list.is_array()) fail(where + "." + key, "is not an array");
        return list;
    }

    const Json* object(const Json& holder, const char* key, const std::string& where) const {
        const auto found = holder.find(key);
        if (found == holder.end()) return nullptr;
        if (!found->is_object()) fail(where + "." + key, "is not an object");
        return &*found;
    }

    const Json* extension(const Json& holder, const char* name, const std::string& where) const {
        const Json* all = object(holder, "extensions", where);
        return all ? object(*all, name, where) : nullptr;
    }

    void text(const Json& holder, const char* key, const std::string& where) const {
        if (holder.contains(key) && !holder[key].is_string()) fail(where + "." + key, "is not text");
    }

    void boolean(const Json& holder, const char* key, const std::string& where) const {
        if (holder.contains(key) && !holder[key].is_boolean()) fail(where + "." + key, "is neither true nor false");
    }

    void number(const Json& holder, const char* key, const std::string& where) const {
        if (holder.contains(key) && !holder[key].is_number()) fail(where + "." + key, "is not a number");
    }

    // JSON may also write an integer as 1.0.
    void whole(const Json& holder, const char* key, const std::string& where, bool required = false) const {
        const auto found = holder.find(key);
        if (found == holder.end()) {
            if (required) fail(where, std::string("has no ") + key);
            return;
        }
        const double value = found->is_number() ? found->get<double>() : -1;
        if (!(value >= 0 && value <= kLargestWhole && value == std::floor(value)))
            fail(where + "." + key, "is not a whole number from 0 on");
    }

    void index(const Json& holder, const char* key, const char* list, const std::string& where) const {
        if (holder.contains(key)) requiredIndex(holder, key, list, where);
    }

    void requiredIndex(const Json& holder, const char* key, const char* list, const std::string& where) const {
        whole(holder, key, where, true);
        requireElement(holder[key], list, where + "." + key);
    }

    void indices(const Json& holder, const char* key, const char* list, const std::string& where) const {
        for (const Json& entry : array(holder, key, where)) {
            const double value = entry.is_number() ? entry.get<double>() : -1;
            if (!(value >= 0 && value <= kLargestWhole && value == std::floor(value)))
                fail(where + "." + key, "does not hold whole numbers");
            requireElement(entry, list, where + "." + key);
        }
    }

    void requireElement(const Json& value, const char* list, const std::string& where) const {
        const size_t count = array(json_, list, "the document").size();
        if (value.get<size_t>() >= count) fail(where, "is " + value.dump() + ", but there are " + std::to_string(count) + " " + list);
    }

    const Json& json_;
    const std::string& name_;
};

}  // namespace

void checkStructure(const Json& json, const std::string& name) { StructureCheck(json, name).all(); }

}  // namespace apertura
