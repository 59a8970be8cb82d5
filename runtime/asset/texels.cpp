#include "apertura/runtime/asset/texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <numbers>

namespace apertura {
namespace {

constexpr auto kPi = std::numbers::pi_v<float>;
// Of mapTexels: an image that takes more has triangles that lie over each other. Each reads the texels around it too.
constexpr double kFewSteps = 1e8, kStepsATexel = 4, kStepsATriangle = 24;
constexpr double kBytesATexel = 80;  // that a texel takes while it is read
const char* const kImageName = "_VISIBILITY";
const char* const kEntry = "texels";  // of asset.extras.apertura

using Corners = std::array<glm::dvec2, 3>;

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// The weights of the triangle's point that is nearest to `p`. Defined for triangles without area.
glm::dvec3 nearestTo(const Corners& c, const glm::dvec2& p) {
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    if (area != 0) {
        const glm::dvec3 w{cross(c[2] - c[1], p - c[1]) / area, cross(c[0] - c[2], p - c[2]) / area, cross(c[1] - c[0], p - c[0]) / area};
        if (std::min({w.x, w.y, w.z}) >= 0) return w;
    }
    glm::dvec3 best(1, 0, 0);
    double least = HUGE_VAL;
    for (int e = 0; e < 3; ++e) {
        const glm::dvec2 from = c[size_t(e)], along = c[size_t(e + 1) % 3] - from;
        const double length = glm::dot(along, along);
        const double s = length > 0 ? std::clamp(glm::dot(p - from, along) / length, 0.0, 1.0) : 0;
        const glm::dvec2 off = from + s * along - p;
        if (glm::dot(off, off) >= least) continue;
        least = glm::dot(off, off);
        best = glm::dvec3(0);
        best[e] = 1 - s, best[(e + 1) % 3] = s;
    }
    return best;
}

// Whether the triangle has a point less than 1 from `p` both across and down: an edge's normal or an axis would part the two.
bool isReadAt(const Corners& c, const glm::dvec2& p) {
    for (int axis = 0; axis < 2; ++axis) {
        const auto [low, high] = std::minmax({c[0][axis], c[1][axis], c[2][axis]});
        if (low - p[axis] >= 1 || p[axis] - high >= 1) return false;
    }
    for (size_t e = 0; e < 3; ++e) {
        const glm::dvec2 along = c[(e + 1) % 3] - c[e], normal(-along.y, along.x);
        const double middle = glm::dot(normal, p), reach = std::abs(normal.x) + std::abs(normal.y);
        const double a = glm::dot(normal, c[0]) - middle, b = glm::dot(normal, c[1]) - middle, d = glm::dot(normal, c[2]) - middle;
        if (reach > 0 && (std::min({a, b, d}) >= reach || std::max({a, b, d}) <= -reach)) return false;
    }
    return true;
}

Corners cornersInImage(const Surface& surface, size_t t, int width, int height) {
    Corners out;
    for (size_t c = 0; c < 3; ++c) out[c] = aperturaPlaceInImage(surface.coordinates[surface.triangles[t][c]], float(width), float(height));
    return out;
}

// Calls use(y, left, right) for each row of the image that has texels which the triangle may read, with the first and the last of these.
void forRows(const Corners& c, int width, int height, const auto& use) {
    const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
    for (int y = std::max(0, int(std::ceil(low - 1))); y <= std::min(height - 1, int(std::floor(high + 1))); ++y) {
        double left = HUGE_VAL, right = -HUGE_VAL;
        const auto add = [&](double x) { left = std::min(left, x), right = std::max(right, x); };
        for (size_t e = 0; e < 3; ++e) {
            const glm::dvec2 &a = c[e], &b = c[(e + 1) % 3];
            if (std::abs(a.y - y) <= 1) add(a.x);
            for (const double border : {y - 1.0, y + 1.0})
                if ((a.y < border) != (b.y < border)) add(a.x + (border - a.y) / (b.y - a.y) * (b.x - a.x));
        }
        const int first = int(std::max(0.0, std::ceil(left - 1))), last = int(std::min(double(width - 1), std::floor(right + 1)));
        if (first <= last) use(y, first, last);
    }
}

void fillGutters(TexelMap& map) {
    std::deque<uint32_t> next;
    constexpr uint32_t none = UINT32_MAX;
    map.from.assign(map.texels.size(), none);
    for (uint32_t i = 0; i < map.texels.size(); ++i)
        if (map.isDrawn[i]) map.from[i] = i, next.push_back(i);
    for (; !next.empty(); next.pop_front()) {
        const int x = int(next.front()) % map.width, y = int(next.front()) / map.width;
        for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
            if (x + dx < 0 || x + dx >= map.width || y + dy < 0 || y + dy >= map.height) continue;
            const auto to = uint32_t((y + dy) * map.width + x + dx);
            if (map.from[to] != none) continue;
            map.from[to] = map.from[next.front()];
            next.push_back(to);
        }
    }
    for (size_t i = 0; i < map.texels.size(); ++i)
        if (map.from[i] != none) map.texels[i] = map.texels[map.from[i]];
}

// What an image stores of a point: D / pi and A / pi - 1, each -1..1. They are linear in visibility, so that whatever filters an image
// filters that. (D / A and the root of A, which vertices store, err a quarter more of the sky between texels, and a third more down the
// mips: tools/results/storage.md.)
glm::vec4 storedOf(const Visibility& v) { return {v.direction / kPi, v.area / kPi - 1}; }
Visibility visibilityOf(const glm::vec4& stored) { return clampToPossible({kPi * glm::vec3(stored), kPi * (stored.w + 1)}); }

// Signed codes of `bits` bits, moved to positive ones.
struct Codes {
    explicit Codes(int bits) : middle(1 << (bits - 1)), most(float(middle - 1)) {}
    uint16_t code(float number) const { return uint16_t(middle + int(std::lround(most * std::clamp(number, -1.0f, 1.0f)))); }
    float number(uint16_t code) const { return std::max(float(int(code) - middle) / most, -1.0f); }
    int middle;
    float most;
};

SeenOnTexels seenIn(const PngImage& image, const glm::mat3& toWorld) {
    SeenOnTexels out{image.width, image.height, {}, {}, image.bits};
    const Codes codes(image.bits);
    for (size_t i = 0; i + 3 < image.samples.size(); i += 4) {
        glm::vec4 stored;
        for (int c = 0; c < 4; ++c) stored[c] = codes.number(image.samples[i + size_t(c)]);
        Visibility v = visibilityOf(stored);
        v.direction = toWorld * v.direction;
        out.visibility.push_back(v);
    }
    return out;
}

bool isCalled(const Json& image, const char* name) {
    const auto found = image.is_object() ? image.find("name") : image.end();
    return image.is_object() && found != image.end() && *found == name;
}

// Makes the set of the primitive's texture coordinates that an image lies over those of the surface.
void useCoordinates(const GltfDocument& document, const Json& primitive, size_t set, Surface& surface, const std::string& where) {
    if (!surface.coordinates.empty() && size_t(surface.coordinateSet) == set) return;
    if (!primitive["attributes"].contains("TEXCOORD_" + std::to_string(set))) throw Error(where + " has no texture coordinates any more");
    surface.coordinates = readCoordinates(document, primitive, set, surface);
    surface.coordinateSet = int(set);
}

// All textures that a part of the document refers to.
void addReferred(const Json& part, std::set<size_t>& out) {
    if (!part.is_structured()) return;
    if (const size_t index = indexIn(part, "index"); index != SIZE_MAX) out.insert(index);
    for (const Json& inner : part) addReferred(inner, out);
}

}  // namespace

void requireMappable(const Surface& surface, int width, int height, const std::string& where) {
    for (const glm::vec2& c : surface.coordinates)
        if (!(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1)) throw Error(where + ": a texture coordinate lies outside 0..1");
    const double most = std::max(kFewSteps,
                                 kStepsATexel * double(width) * double(height) + kStepsATriangle * double(surface.triangles.size()));
    double steps = 0;
    for (size_t t = 0; t < surface.triangles.size() && steps <= most; ++t)
        forRows(cornersInImage(surface, t, width, height), width, height, [&](int, int first, int last) { steps += last - first + 1; });
    if (steps > most) throw Error(where + ": its triangles lie over each other many times");
}

glm::vec2 coordinatesAt(const Surface& surface, size_t triangle, const glm::vec3& barycentrics) {
    glm::vec2 out(0);
    for (int c = 0; c < 3; ++c) out += barycentrics[c] * surface.coordinates[surface.triangles[triangle][size_t(c)]];
    return out;
}

AperturaTexelCell texelCell(const Surface& surface, size_t triangle, const glm::vec3& barycentrics, int width, int height) {
    return aperturaTexelCellAt(aperturaPlaceInImage(coordinatesAt(surface, triangle, barycentrics), float(width), float(height)), width,
                               height);
}

size_t TexelMap::drawn() const { return size_t(std::count(isDrawn.begin(), isDrawn.end(), 1)); }

TexelMap mapTexels(const Surface& surface, int width, int height) {
    TexelMap map{width, height, {}, {}, {}};
    map.texels.resize(size_t(width) * size_t(height));
    map.isDrawn.assign(map.texels.size(), 0);
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        const Corners corners = cornersInImage(surface, t, width, height);
        forRows(corners, width, height, [&](int y, int first, int last) {
            for (int x = first; x <= last; ++x) {
                const glm::dvec2 middle(x, y);
                if (!isReadAt(corners, middle)) continue;
                const glm::dvec3 w = nearestTo(corners, middle);
                const auto distance = float(glm::distance(w.x * corners[0] + w.y * corners[1] + w.z * corners[2], middle));
                const size_t at = size_t(y) * size_t(width) + size_t(x);
                TexelMap::Texel& texel = map.texels[at];
                map.isDrawn[at] = 1;
                if (texel.triangle < 0 || distance < texel.distance) texel = {int(t), glm::vec3(w), distance};
            }
        });
    }
    fillGutters(map);
    return map;
}

SeenOnTexels halved(const SeenOnTexels& texels) {
    SeenOnTexels out{aperturaMipSize(texels.width, 1), aperturaMipSize(texels.height, 1), {}, {}, texels.bits};
    // Of each texel of the mip, the first and last one that it covers, and the weight of either end.
    struct Covered {
        int first, last;
        float atFirst, atLast;
    };
    const auto coveredBy = [](int from, int to) {
        std::vector<Covered> all;
        for (int64_t i = 0; i < to; ++i) {
            const int64_t begin = i * from, end = (i + 1) * from;  // in texels times `to`
            const auto first = int(begin / to), last = int((end - 1) / to);
            all.push_back({first, last, float(to - begin % to) / float(to), first == last ? 1.0f : float((end - 1) % to + 1) / float(to)});
        }
        return all;
    };
    const std::vector<Covered> columns = coveredBy(texels.width, out.width), rows = coveredBy(texels.height, out.height);
    const auto weight = [](const Covered& c, int i) { return i == c.first ? c.atFirst : i == c.last ? c.atLast : 1.0f; };
    for (const Covered& row : rows)
        for (const Covered& column : columns) {
            Visibility seen;
            glm::vec3 normal(0);
            float all = 0;
            for (int y = row.first; y <= row.last; ++y)
                for (int x = column.first; x <= column.last; ++x) {
                    const float w = weight(row, y) * weight(column, x);
                    const size_t at = size_t(y) * size_t(texels.width) + size_t(x);
                    seen.direction += w * texels.visibility[at].direction, seen.area += w * texels.visibility[at].area;
                    normal += w * texels.normals[at];
                    all += w;
                }
            out.visibility.push_back({seen.direction / all, seen.area / all});
            const float length = glm::length(normal);
            out.normals.push_back(length > 0 ? normal / length
                                             : texels.normals[size_t(row.first) * size_t(texels.width) + size_t(column.first)]);
        }
    return out;
}

size_t texelsWithMips(int width, int height) { return size_t(aperturaFirstOfMip(width, height, aperturaMipCount(width, height))); }

void setTexelNormals(const Scene& scene, size_t instance, const TexelMap& map, SeenOnTexels& texels) {
    texels.normals.clear();
    for (const TexelMap::Texel& texel : map.texels)
        texels.normals.push_back(texel.triangle < 0 ? glm::vec3(0, 1, 0)
                                                    : surfaceAt(scene, int(instance), texel.triangle, texel.barycentrics).looking());
}

std::vector<glm::vec2> readCoordinates(const GltfDocument& document, const Json& primitive, size_t set, const Surface& surface) {
    const std::vector<float> values = readAccessor(document, primitive["attributes"]["TEXCOORD_" + std::to_string(set)].get<size_t>(), 2);
    std::vector<glm::vec2> out;
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const size_t from = surface.splitFrom.empty() ? v : surface.splitFrom[v];
        out.emplace_back(values.at(2 * from), values.at(2 * from + 1));
    }
    return out;
}

size_t indexIn(const Json& entry, const char* key) {
    const auto found = entry.is_object() ? entry.find(key) : entry.end();
    return entry.is_object() && found != entry.end() && found->is_number_unsigned() ? found->get<size_t>() : SIZE_MAX;
}

size_t addSampler(Json& json) {
    json["samplers"].push_back({{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33071}});
    return json["samplers"].size() - 1;
}

std::vector<float> texelNumbers(const SeenOnTexels& texels, const glm::mat3& toLocal) {
    std::vector<float> out;
    out.reserve(4 * texels.visibility.size());
    for (const Visibility& v : texels.visibility) {
        const glm::vec4 stored = storedOf({toLocal * v.direction, v.area});
        for (int c = 0; c < 4; ++c) out.push_back(stored[c]);
    }
    return out;
}

PngImage visibilityImage(const SeenOnTexels& texels, const glm::mat3& toLocal, int bits) {
    PngImage out{texels.width, texels.height, bits, {}, 4};
    const Codes codes(bits);
    for (const float number : texelNumbers(texels, toLocal)) out.samples.push_back(codes.code(number));
    return out;
}

Json addTexels(GltfWriter& writer, const Scene& scene, const BakedVisibility& visibility, int bits) {
    Json out;
    Json& json = writer.json();
    size_t sampler = SIZE_MAX;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const SeenOnTexels& seen = visibility[i].texels;
        if (seen.visibility.empty()) continue;
        const Instance& instance = scene.instances[i];
        if (sampler == SIZE_MAX) sampler = addSampler(json);
        const PngImage image = visibilityImage(seen, glm::transpose(rotationPart(instance.toWorld)), bits);
        const size_t view = writer.addView(encodePng(image)), texture = listOf(json, "textures").size();
        json["textures"].push_back({{"sampler", sampler}, {"source", listOf(json, "images").size()}});
        json["images"].push_back({{"name", kImageName}, {"mimeType", "image/png"}, {"bufferView", view}});
        out.push_back({{"mesh", json["nodes"][size_t(instance.node)]["mesh"]},
                       {"primitive", instance.primitive},
                       {"texture", texture},
                       {"texCoord", scene.surfaces[size_t(instance.surface)].coordinateSet}});
    }
    return out;
}

std::set<size_t> removeTexels(Json& json) {
    json["asset"]["extras"]["apertura"].erase(kEntry);
    std::set<size_t> views;
    removeTextures(json, {kImageName}, views);
    return views;
}

bool isImageOf(const Json& json, size_t texture, const char* name) {
    if (texture >= listOf(json, "textures").size()) return false;
    const size_t source = indexIn(json["textures"][texture], "source");
    return source < listOf(json, "images").size() && isCalled(json["images"][source], name);
}

void removeTextures(Json& json, std::initializer_list<const char*> names, std::set<size_t>& views) {
    std::set<size_t> referred;
    addReferred(listOf(json, "materials"), referred);
    std::map<size_t, size_t> sourceUses, samplerUses;
    for (const Json& texture : listOf(json, "textures"))
        ++sourceUses[indexIn(texture, "source")], ++samplerUses[indexIn(texture, "sampler")];
    // The last first: what was added behind them would change its place, and what materials refer to is theirs now.
    for (size_t t = listOf(json, "textures").size(); t-- > 0;) {
        const size_t source = indexIn(json["textures"][t], "source"), sampler = indexIn(json["textures"][t], "sampler");
        const bool isOurs = std::any_of(names.begin(), names.end(), [&](const char* name) { return isImageOf(json, t, name); });
        if (!isOurs || referred.contains(t) || sourceUses[source] > 1 || source + 1 != json["images"].size()) break;
        if (const size_t view = indexIn(json["images"][source], "bufferView"); view != SIZE_MAX) views.insert(view);
        json["textures"].erase(t), json["images"].erase(source);
        if (--samplerUses[sampler] == 0 && sampler != SIZE_MAX && sampler + 1 == listOf(json, "samplers").size())
            json["samplers"].erase(sampler);
    }
    for (const char* list : {"textures", "images", "samplers"})
        if (json.contains(list) && json[list].empty()) json.erase(list);
}

void readTexels(Asset& asset, const Json& described) {
    Scene& scene = asset.scene;
    const Json& entries = listOf(described, kEntry);
    if (asset.info.at != "texels") return;
    const GltfDocument& document = *scene.document;
    std::map<std::pair<size_t, size_t>, const Json*> byPrimitive;
    for (const Json& entry : entries) byPrimitive[{indexIn(entry, "mesh"), indexIn(entry, "primitive")}] = &entry;
    double bytes = 0;
    size_t without = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const size_t mesh = document.json["nodes"][size_t(instance.node)]["mesh"].get<size_t>();
        const auto found = byPrimitive.find({mesh, size_t(instance.primitive)});
        if (found == byPrimitive.end()) {
            ++without;
            continue;
        }
        const Json& entry = *found->second;
        const std::string where = scene.name + ": the image of mesh " + std::to_string(mesh);
        Surface& surface = scene.surfaces[size_t(instance.surface)];
        useCoordinates(document, document.json["meshes"][mesh]["primitives"][size_t(instance.primitive)], indexIn(entry, "texCoord"),
                       surface, where);
        const size_t texture = indexIn(entry, "texture");
        const size_t source = texture < listOf(document.json, "textures").size() ? indexIn(document.json["textures"][texture], "source")
                                                                                 : SIZE_MAX;
        if (source >= listOf(document.json, "images").size() || !isCalled(document.json["images"][source], kImageName))
            throw Error(where + " is not there any more");
        const size_t view = indexIn(document.json["images"][source], "bufferView");
        const std::span<const unsigned char> png = view == SIZE_MAX ? std::span(*document.images[source]) : viewBytes(document, view);
        const glm::ivec2 size = sizeOfPng(png, where);
        bytes += kBytesATexel * double(size.x) * double(size.y);
        requireMemory(scene.name, "its images", bytes);
        requireMappable(surface, size.x, size.y, where);
        SeenOnTexels& texels = asset.seen[i].texels;
        const PngImage image = decodePng(png, where);
        if (image.channels != 4) throw Error(where + " is no PNG of four channels");
        texels = seenIn(image, rotationPart(instance.toWorld));
        texels.bytes = png.size();
        setTexelNormals(scene, i, mapTexels(surface, size.x, size.y), texels);
    }
    if (without > 0)
        scene.notes.push_back(std::to_string(without) + " of its meshes have no image any more: what their vertices store is drawn");
}

}  // namespace apertura
