#include "apertura/runtime/asset/lights.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr size_t kMostLights = APERTURA_MAX_LIGHTS - 1;  // beside the sun
constexpr double kFarthest = 1e9;                        // metres
constexpr double kBrightest = 1e12;                      // W/m2/sr: 50 000 times the sun

glm::dvec3 vectorOf(const Json& light, const char* key, double most, const std::string& name) {
    const Json& value = light.at(key);
    glm::dvec3 out(0);
    const bool listed = value.is_array() && value.size() == 3;
    for (size_t c = 0; listed && c < 3; ++c)
        if (value[c].is_number())
            out[int(c)] = value[c].get<double>();
        else
            throw Error(name + ": \"" + key + "\" is not three numbers");
    if (!listed) throw Error(name + ": \"" + key + "\" is not three numbers");
    for (int c = 0; c < 3; ++c)
        if (!(std::abs(out[c]) <= most)) throw Error(name + ": \"" + key + "\" holds a number that is too large");
    return out;
}

AperturaLight lightOf(const Json& light, const std::string& name) {
    if (!light.is_object()) throw Error(name + " is not an object");
    const auto refuse = [&](const std::string& key) {
        throw Error(name + ": there is no \"" + key + "\" (there are \"towards\", \"at\", \"radius\" and \"radiance\")");
    };
    for (const auto& [key, value] : light.items())
        if (key != "towards" && key != "at" && key != "radius" && key != "radiance") refuse(key);
    const bool isLamp = light.contains("at");
    if (isLamp == light.contains("towards")) throw Error(name + " has neither \"towards\" nor \"at\", or both");
    for (const char* const key : {"radius", "radiance"})
        if (!light.contains(key)) throw Error(name + " has no \"" + key + "\"");
    const glm::dvec3 radiance = vectorOf(light, "radiance", kBrightest, name);
    for (int c = 0; c < 3; ++c)
        if (radiance[c] < 0) throw Error(name + ": its radiance is negative");
    const double radius = light["radius"].is_number() ? light["radius"].get<double>() : -1;
    if (isLamp) {
        if (!(radius >= 1e-6 && radius <= kFarthest)) throw Error(name + ": \"radius\" is not 1e-6 to 1e9 metres");
        return sphereLight(vectorOf(light, "at", kFarthest, name), radius, radiance);
    }
    const glm::dvec3 towards = vectorOf(light, "towards", 1e30, name);
    if (!(glm::length(towards) > 1e-30)) throw Error(name + ": \"towards\" has no direction");
    if (!(radius >= 0.01 && radius <= 45)) throw Error(name + ": \"radius\" is not 0.01 to 45 degrees");
    return directionalLight(glm::normalize(towards), radius * pi / 180, radiance);
}

double numberOr(const Json& object, const char* key, double fallback, const std::string& name) {
    const auto found = object.find(key);
    if (found == object.end()) return fallback;
    const double value = found->is_number() ? found->get<double>() : -1;
    if (!(value >= 0 && value <= kBrightest)) throw Error(name + ": \"" + key + "\" is not a number of at least 0");
    return value;
}

}  // namespace

std::vector<AperturaLight> readLights(const std::string& path) {
    const std::vector<unsigned char> bytes = readFile(path);
    Json json;
    try {
        json = Json::parse(bytes.begin(), bytes.end());
    } catch (const Json::exception& e) {
        throw Error(path + ": is not JSON: " + e.what());
    }
    if (!json.is_array()) throw Error(path + ": is not a list of lights");
    if (json.size() > kMostLights)
        throw Error(path + ": has " + std::to_string(json.size()) + " lights, and at most " + std::to_string(kMostLights)
                    + " shine beside the sun");
    std::vector<AperturaLight> out;
    for (const Json& light : json) out.push_back(lightOf(light, path + ": light " + std::to_string(out.size() + 1)));
    return out;
}

std::vector<AperturaLight> punctualLights(const Scene& scene, double radius, double angle, std::vector<std::string>& notes) {
    constexpr double kLumensAWatt = 683;
    const std::vector<PunctualLight>& placed = scene.punctual;
    if (placed.empty() || !scene.document) throw Error(scene.name + ": has no lights of its own (KHR_lights_punctual)");
    if (placed.size() > kMostLights)
        throw Error(scene.name + ": has " + std::to_string(placed.size()) + " lights of its own, and at most " + std::to_string(kMostLights)
                    + " shine beside the sun");
    // Members of wrong types count as missing.
    const auto memberOf = [](const Json& object, const char* key) {
        return object.is_object() && object.contains(key) ? object.at(key) : Json();
    };
    const Json all = memberOf(memberOf(memberOf(scene.document->json, "extensions"), "KHR_lights_punctual"), "lights");
    std::vector<AperturaLight> out;
    size_t spots = 0;
    for (const auto& [index, toWorld] : placed) {
        const std::string name = scene.name + ": its light " + std::to_string(index);
        if (!all.is_array() || index >= all.size() || !all[index].is_object()) throw Error(name + " does not exist");
        if (!(glm::length(glm::dvec3(toWorld[3])) <= kFarthest)) throw Error(name + " stands nowhere");
        const Json& light = all[index];
        const glm::dvec3 colour = light.contains("color") ? vectorOf(light, "color", 1e6, name) : glm::dvec3(1);
        const glm::dvec3 power = glm::max(colour, 0.0) * (numberOr(light, "intensity", 1, name) / kLumensAWatt);
        const std::string type = light.value("type", Json()).is_string() ? light["type"].get<std::string>() : "";
        if (type == "directional") {
            const glm::dvec3 towards(toWorld[2]);  // it shines along -Z
            if (!(glm::length(towards) > 1e-30)) throw Error(name + " has no direction");
            out.push_back(directionalLight(glm::normalize(towards), angle, power / (pi * std::sin(angle) * std::sin(angle))));
        } else if (type == "point" || type == "spot") {
            spots += type == "spot";
            out.push_back(sphereLight(glm::dvec3(toWorld[3]), radius, power / (pi * radius * radius)));
        } else {
            throw Error(name + " is of an unknown type");
        }
    }
    if (spots > 0) notes.push_back(std::to_string(spots) + " spot lights shine in all directions here");
    return out;
}

}  // namespace apertura
