#include "runtime/asset/faces.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <numeric>

#include "runtime/asset/params_stream.h"
#include "sh/packing.h"
#include "sh/shading.h"

namespace apertura {
namespace {

const char* const kLevels = "_VISIBILITY_LEVELS";
const char* const kSamples = "_VISIBILITY_SAMPLES";
const char* const kNumbers = "_VISIBILITY_NUMBERS";

// FNV-1a, by words of 32 bits.
struct Hash {
    uint64_t value = 0xcbf29ce484222325ull;
    void add(uint32_t word) { value = (value ^ word) * 0x100000001b3ull; }
};

// `atVertices`: of each instance, the numbers in the file, -1..1.
std::string hashOfTriangles(const Scene& scene, std::span<const std::vector<glm::vec4>> atVertices, int bits) {
    const float top = bits == 16 ? 32767 : 127;
    std::vector<uint64_t> surfaces;
    for (const Surface& surface : scene.surfaces) {
        Hash hash;
        for (const auto& t : surface.triangles)
            for (const uint32_t v : t)
                for (int c = 0; c < 3; ++c) {
                    uint32_t word = 0;
                    const float x = surface.positions[v][c] + 0.0f;  // -0 is 0
                    std::memcpy(&word, &x, sizeof word);
                    hash.add(word);
                }
        surfaces.push_back(hash.value);
    }
    Hash hash;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const auto surface = size_t(scene.instances[i].surface);
        hash.add(uint32_t(surfaces[surface])), hash.add(uint32_t(surfaces[surface] >> 32));
        for (const auto& t : scene.surfaces[surface].triangles)
            for (const uint32_t v : t)
                for (int c = 0; c < 4; ++c) hash.add(uint32_t(std::lround(atVertices[i][v][c] * top)));
    }
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash.value));
    return text;
}

std::optional<size_t> findAccessor(const Json& json, const char* name) {
    const Json& accessors = listOf(json, "accessors");
    for (size_t i = 0; i < accessors.size(); ++i)
        if (accessors[i].value("name", Json()) == name) return i;
    return std::nullopt;
}

void append(Bytes& to, const auto& items) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(items.data());
    to.insert(to.end(), bytes, bytes + items.size() * sizeof(items[0]));
}

size_t samplesIn(const std::vector<uint8_t>& levels) {
    return std::accumulate(levels.begin(), levels.end(), size_t(0),
                           [](size_t sum, uint8_t level) { return sum + (level ? size_t(latticeSize(latticeSteps(level))) : 0); });
}

constexpr size_t kSparseBytes = 5;  // of an element: its index and its level

// Where few triangles have samples, their levels are a sparse accessor.
bool isSparse(size_t triangles, size_t withSamples) { return withSamples * kSparseBytes < triangles; }
bool isSparse(const Bytes& levels) { return isSparse(levels.size(), levels.size() - size_t(std::count(levels.begin(), levels.end(), 0))); }

void addSparseLevels(GltfWriter& writer, const Bytes& levels) {
    Bytes indices, values;
    for (size_t t = 0; t < levels.size(); ++t) {
        if (levels[t] == 0) continue;
        for (int byte = 0; byte < 4; ++byte) indices.push_back(static_cast<unsigned char>(t >> (8 * byte) & 255));
        values.push_back(levels[t]);
    }
    const size_t count = values.size();
    const size_t indexView = writer.addView(std::move(indices)), valueView = writer.addView(std::move(values));
    writer.addAccessor({{"name", kLevels},
                        {"componentType", kUnsignedByte},
                        {"type", "SCALAR"},
                        {"count", levels.size()},
                        {"sparse",
                         {{"count", count},
                          {"indices", {{"bufferView", indexView}, {"componentType", kUnsignedInt}}},
                          {"values", {{"bufferView", valueView}}}}}});
}

}  // namespace

void SeenOnFaces::setLevels(std::vector<uint8_t> all, bool withParams) {
    levels = std::move(all);
    first.clear();
    size_t next = 0;
    for (const uint8_t level : levels) {
        first.push_back(uint32_t(next));
        if (level) next += size_t(latticeSize(latticeSteps(level)));
    }
    visibility.assign(next, {});
    allParams.assign(withParams ? next : 0, {});
}

Json addFaces(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits) {
    Bytes levels, samples, numbers;
    std::vector<std::vector<glm::vec4>> atVertices;
    Json lengths = Json::array();
    size_t count = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
        const SeenOnFaces& faces = seen[i].faces;
        count += faces.visibility.size();
        levels.insert(levels.end(), faces.levels.begin(), faces.levels.end());
        levels.resize(levels.size() + scene.surfaces[size_t(scene.instances[i].surface)].triangles.size() - faces.levels.size());
        const glm::mat3 toLocal = glm::transpose(rotationPart(scene.instances[i].toWorld));
        atVertices.emplace_back();
        for (const Visibility& v : seen[i].visibility) {
            const Visibility local{toLocal * v.direction, v.area};
            atVertices.back().push_back(bits == 16 ? normalised(pack16(local)) : normalised(pack8(local)));
        }
        for (const Visibility& v : faces.visibility) {
            const Visibility local{toLocal * v.direction, v.area};
            if (bits == 16)
                append(samples, pack16(local));
            else
                append(samples, pack8(local));
        }
        if (!stored) continue;
        const std::vector<std::byte> own = packAllParams(*stored, faces.allParams, toLocal, bits);
        append(numbers, own);
        lengths.push_back(own.size());
    }
    if (count == 0) return {};
    const auto bytesAccessor = [&](const char* name, Bytes bytes) {
        const size_t n = bytes.size();
        writer.addAccessor({{"name", name}, {"componentType", kUnsignedByte}, {"type", "SCALAR"}, {"count", n}}, std::move(bytes),
                           kNoTarget);
    };
    if (isSparse(levels))
        addSparseLevels(writer, levels);
    else
        bytesAccessor(kLevels, std::move(levels));
    writer.addAccessor(
        {{"name", kSamples}, {"componentType", bits == 16 ? kShort : kByte}, {"normalized", true}, {"type", "VEC4"}, {"count", count}},
        std::move(samples), kNoTarget);
    if (!numbers.empty()) bytesAccessor(kNumbers, std::move(numbers));
    Json out{{"triangles", hashOfTriangles(scene, atVertices, bits)}};
    if (stored) out["numbers"] = lengths;
    return out;
}

std::set<size_t> removeFaces(Json& json) {
    std::set<size_t> out;
    for (const char* name : {kLevels, kSamples, kNumbers})
        while (const std::optional<size_t> index = findAccessor(json, name)) {
            json["accessors"][*index].erase("name");
            out.insert(*index);
        }
    return out;
}

void readFaces(Asset& asset, const Json& described, std::span<const std::vector<glm::vec4>> atVertices) {
    const Scene& scene = asset.scene;
    const GltfDocument& document = *scene.document;
    const std::optional<size_t> levelsAt = findAccessor(document.json, kLevels), samplesAt = findAccessor(document.json, kSamples);
    const Json& said = listOf(described, "faces");
    const auto withoutFaces = [&](const char* why) {
        asset.info.at = "vertices";
        asset.scene.notes.push_back(std::string("its samples on faces ") + why + ": its vertices' visibility alone is used");
    };
    if (!said.is_object() || said.empty()) {
        if (levelsAt || samplesAt) withoutFaces("lack what they belong to");
        return;
    }
    if (!levelsAt || !samplesAt) return withoutFaces("are gone");
    if (said.value("triangles", Json()) != hashOfTriangles(scene, atVertices, asset.info.bits))
        return withoutFaces("belong to other triangles, or to these in another order");

    const auto damaged = [&](const char* how) { return Error(scene.name + ": its samples on faces " + how); };
    const Json& samples = document.json["accessors"][*samplesAt];
    const int bits = samples["componentType"] == kShort ? 16 : 8;
    if (!samples.value("normalized", false) || (bits == 8 && samples["componentType"] != kByte))
        throw damaged("are not of normalised bytes or shorts");
    const auto isPlainBytes = [&](size_t accessor) {
        const Json& json = document.json["accessors"][accessor];
        return json["componentType"] == kUnsignedByte && !json.value("normalized", false);
    };
    if (!isPlainBytes(*levelsAt)) throw damaged("have levels that are not bytes");
    if (accessorCount(document, *levelsAt) != triangleCount(scene)) throw damaged("have not one level for each triangle");
    const std::vector<float> levels = readAccessor(document, *levelsAt, 1);
    const size_t count = accessorCount(document, *samplesAt);
    size_t wanted = 0;
    for (const float level : levels) {
        if (!(level >= 0 && level <= float(MAX_LATTICE_LEVEL))) throw damaged("have a level that is too large");
        wanted += level > 0 ? size_t(latticeSize(latticeSteps(int(level)))) : 0;
    }
    if (wanted != count) throw damaged(wanted > count ? "end too soon" : "are more than their levels say");
    const std::vector<float> values = readAccessor(document, *samplesAt, 4);

    const Model* stored = storedModel(asset.info);
    std::span<const unsigned char> numbers;
    std::vector<unsigned char> numberBytes;
    if (stored) {
        const std::optional<size_t> at = findAccessor(document.json, kNumbers);
        if (!at && stored->stored[0] != Field::None) return withoutFaces("are gone");
        if (at) {
            if (!isPlainBytes(*at)) throw damaged("have numbers that are not bytes");
            for (const float byte : readAccessor(document, *at, 1)) numberBytes.push_back(static_cast<unsigned char>(byte));
        }
        numbers = numberBytes;
    }
    const Json& lengths = listOf(said, "numbers");
    if (stored && (!lengths.is_array() || lengths.size() != scene.instances.size()))
        throw damaged("do not say how many numbers each instance has");
    size_t triangle = 0, sample = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const size_t own = scene.surfaces[size_t(scene.instances[i].surface)].triangles.size();
        std::vector<uint8_t> ownLevels(levels.begin() + ptrdiff_t(triangle), levels.begin() + ptrdiff_t(triangle + own));
        triangle += own;
        SeenOnFaces& faces = asset.seen[i].faces;
        if (samplesIn(ownLevels) > 0) faces.setLevels(std::move(ownLevels), stored != nullptr);
        const glm::mat3 rotation = rotationPart(scene.instances[i].toWorld);
        for (Visibility& v : faces.visibility) {
            const float* at = &values[4 * sample++];
            v = unpack(glm::vec4(at[0], at[1], at[2], at[3]));
            v.direction = rotation * v.direction;
        }
        if (!stored) continue;
        const size_t bytes = lengths[i].is_number_unsigned() ? lengths[i].get<size_t>() : SIZE_MAX;
        if (bytes > numbers.size()) throw damaged("have numbers that end too soon");
        try {
            faces.allParams = unpackAllParams(*stored, numbers.first(bytes), faces.visibility.size(), rotation, bits);
        } catch (const Error& e) {
            throw Error(scene.name + ": its samples on faces: " + e.what());
        }
        numbers = numbers.subspan(bytes);
    }
    if (!numbers.empty()) throw damaged("have more numbers than samples");
}

size_t bytesOfFaces(const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits) {
    size_t out = 0, withSamples = 0;
    for (const SeenByInstance& instance : seen) {
        const SeenOnFaces& faces = instance.faces;
        withSamples += faces.levels.size() - size_t(std::count(faces.levels.begin(), faces.levels.end(), 0));
        out += faces.visibility.size() * size_t(bits / 2);
        for (const ModelParams& params : faces.allParams)
            out += size_t(storedNumbers(chosenModel(*stored, params)) * bits / 8 + (stored->kind == ModelKind::Choice));
    }
    const size_t triangles = triangleCount(scene);
    return withSamples == 0 ? 0 : out + (isSparse(triangles, withSamples) ? withSamples * kSparseBytes : triangles);
}

glm::vec3 latticePoint(int sample, int steps) {
    int j = 0;
    while (latticeRow(j + 1, steps) <= sample) ++j;
    const float y = float(j) / float(steps), x = float(sample - latticeRow(j, steps)) / float(steps);
    return {1 - x - y, x, y};
}

}  // namespace apertura
