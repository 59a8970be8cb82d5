#include "apertura/runtime/asset/faces.h"

#include <algorithm>
#include <numeric>

#include "apertura/runtime/asset/hashes.h"
#include "apertura/runtime/asset/model_numbers.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/sh/packing.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

const char* const kLevels = "_VISIBILITY_LEVELS";
const char* const kSamples = "_VISIBILITY_SAMPLES";
const char* const kNumbers = "_VISIBILITY_NUMBERS";

// Of the levels, of the samples' numbers in the file, -1..1, and of the bytes of params_stream.h.
std::string hashOfSamples(std::span<const unsigned char> levels, std::span<const glm::vec4> samples, std::span<const unsigned char> numbers,
                          int bits) {
    Hash hash;
    hash.add(levels);
    for (const glm::vec4& sample : samples) hash.add(sample, bits);
    hash.add(numbers);
    return hash.text();
}

void append(Bytes& to, const auto& items) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(items.data());
    to.insert(to.end(), bytes, bytes + items.size() * sizeof(items[0]));
}

size_t samplesIn(const std::vector<uint8_t>& levels) {
    return std::accumulate(levels.begin(), levels.end(), size_t(0), [](size_t sum, uint8_t level) {
        return sum + (level ? size_t(aperturaLatticeSize(aperturaLatticeSteps(level))) : 0);
    });
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
        if (level) next += size_t(aperturaLatticeSize(aperturaLatticeSteps(level)));
    }
    visibility.assign(next, {});
    allParams.assign(withParams ? next : 0, {});
}

Json addFaces(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits) {
    Bytes levels, samples, numbers;
    std::vector<std::vector<glm::vec4>> atVertices;
    std::vector<glm::vec4> onFaces;
    Json lengths = Json::array();
    size_t count = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
        const SeenOnFaces& faces = seen[i].faces;
        count += faces.visibility.size();
        levels.insert(levels.end(), faces.levels.begin(), faces.levels.end());
        levels.resize(levels.size() + scene.surfaces[size_t(scene.instances[i].surface)].triangles.size() - faces.levels.size());
        const glm::mat3 rotation = rotationPart(scene.instances[i].toWorld), toLocal = glm::transpose(rotation);
        atVertices.push_back(numbersInFile(seen[i].visibility, rotation, bits));
        const std::vector<glm::vec4> own = numbersInFile(faces.visibility, rotation, bits);
        onFaces.insert(onFaces.end(), own.begin(), own.end());
        for (const Visibility& v : faces.visibility) {
            const Visibility local{toLocal * v.direction, v.area};
            if (bits == 16)
                append(samples, pack16(local));
            else
                append(samples, pack8(local));
        }
        if (!stored) continue;
        const std::vector<std::byte> params = packAllParams(*stored, faces.allParams, toLocal, bits);
        append(numbers, params);
        lengths.push_back(params.size());
    }
    if (count == 0) return {};
    Json out{{"triangles", hashOfPoints(scene, atVertices, bits, HashOrder::Corners)},
             {"samples", hashOfSamples(levels, onFaces, numbers, bits)}};
    if (stored) out["numbers"] = lengths;
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
    return out;
}

std::set<size_t> removeFaces(Json& json) {
    const char* const names[] = {kLevels, kSamples, kNumbers};
    return takeNames(json, names);
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
    if (said.value("triangles", Json()) != hashOfPoints(scene, atVertices, asset.info.bits, HashOrder::Corners))
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
    Bytes levels;
    for (const float level : readAccessor(document, *levelsAt, 1)) levels.push_back(static_cast<unsigned char>(level));
    const size_t count = accessorCount(document, *samplesAt);
    size_t wanted = 0;
    for (const unsigned char level : levels) {
        if (level > APERTURA_MAX_LATTICE_LEVEL) throw damaged("have a level that is too large");
        wanted += level > 0 ? size_t(aperturaLatticeSize(aperturaLatticeSteps(level))) : 0;
    }
    if (wanted != count) throw damaged(wanted > count ? "end too soon" : "are more than their levels say");
    std::vector<glm::vec4> values(count);
    for (size_t k = 0; const float x : readAccessor(document, *samplesAt, 4)) values[k / 4][int(k % 4)] = x, ++k;

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
    std::vector<size_t> lengths(scene.instances.size(), 0);  // of the instances' numbers, bytes
    if (stored) {
        const Json& list = listOf(said, "numbers");
        if (!list.is_array() || list.size() != lengths.size()) throw damaged("do not say how many numbers each instance has");
        size_t left = numbers.size();
        for (size_t i = 0; i < lengths.size(); ++i) {
            lengths[i] = list[i].is_number_unsigned() ? list[i].get<size_t>() : SIZE_MAX;
            if (lengths[i] > left) throw damaged("have numbers that end too soon");
            left -= lengths[i];
        }
        if (left > 0) throw damaged("have more numbers than samples");
    }
    if (said.value("samples", Json()) != hashOfSamples(levels, values, numbers, bits)) return withoutFaces("are not those that were baked");
    size_t triangle = 0, sample = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const size_t own = scene.surfaces[size_t(scene.instances[i].surface)].triangles.size();
        std::vector<uint8_t> ownLevels(levels.begin() + ptrdiff_t(triangle), levels.begin() + ptrdiff_t(triangle + own));
        triangle += own;
        SeenOnFaces& faces = asset.seen[i].faces;
        if (samplesIn(ownLevels) > 0) faces.setLevels(std::move(ownLevels), stored != nullptr);
        const glm::mat3 rotation = rotationPart(scene.instances[i].toWorld);
        for (Visibility& v : faces.visibility) {
            v = unpack(values[sample++]);
            v.direction = rotation * v.direction;
        }
        if (!stored) continue;
        try {
            faces.allParams = unpackAllParams(*stored, numbers.first(lengths[i]), faces.visibility.size(), rotation, bits,
                                              asset.info.packing);
        } catch (const Error& e) {
            throw Error(scene.name + ": its samples on faces: " + e.what());
        }
        numbers = numbers.subspan(lengths[i]);
    }
}

size_t bytesOfFaces(const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits) {
    size_t out = 0, withSamples = 0;
    for (const SeenByInstance& instance : seen) {
        const SeenOnFaces& faces = instance.faces;
        withSamples += faces.levels.size() - size_t(std::count(faces.levels.begin(), faces.levels.end(), 0));
        out += faces.visibility.size() * size_t(bits / 2);
        out += bytesOfNumbers(stored, faces.allParams, bits, false);
    }
    const size_t triangles = triangleCount(scene);
    return withSamples == 0 ? 0 : out + (isSparse(triangles, withSamples) ? withSamples * kSparseBytes : triangles);
}

glm::vec3 latticePoint(int sample, int steps) {
    int j = 0;
    while (aperturaLatticeRow(j + 1, steps) <= sample) ++j;
    const float y = float(j) / float(steps), x = float(sample - aperturaLatticeRow(j, steps)) / float(steps);
    return {1 - x - y, x, y};
}

}  // namespace apertura
