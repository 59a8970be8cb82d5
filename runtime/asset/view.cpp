#include "apertura/runtime/asset/view.h"

#include <algorithm>
#include <cmath>

namespace apertura {
namespace {

// Columns: right, up, back.
glm::dmat3 cameraFrame(const Camera& camera) {
    const glm::dvec3 back = glm::normalize(glm::dvec3(camera.eye) - glm::dvec3(camera.target));
    // camera.up, unless it lies along the view: then +Y, or else -Z.
    glm::dvec3 pole(0, 0, -1);
    for (const glm::dvec3& up : {glm::dvec3(0, 1, 0), glm::dvec3(camera.up)})
        if (glm::length(glm::cross(up, back)) > 0.01 * glm::length(up)) pole = up;
    const glm::dvec3 right = glm::normalize(glm::cross(pole, back));
    return {right, glm::cross(back, right), back};
}

}  // namespace

AperturaLight directionalLight(const glm::vec3& direction, double radius, const glm::vec3& radiance) {
    return {aperturaCapLight(glm::normalize(direction), float(std::sin(radius))), vec4(0), vec4(radiance, 0), vec4(0), ivec4(0)};
}

AperturaLight sphereLight(const glm::vec3& centre, double radius, const glm::vec3& radiance) {
    return {aperturaCapLight({0, 1, 0}, 0), vec4(centre, radius), vec4(radiance, 0), vec4(0), ivec4(0)};
}

std::vector<AperturaLight> arrangedLights(const View& view) {
    std::vector<AperturaLight> out = view.lights;
    for (size_t i = 0; i < out.size(); ++i) {
        AperturaLight& light = out[i];
        light.before = ivec4(0);
        if (!aperturaIsSphere(light)) light.behind = vec4(view.sky.meanOver(light.cap), 0);
        for (size_t k = 0; k < out.size(); ++k) {
            // A lamp hides what is farther, which is another from each place.
            const bool mayHide = aperturaIsSphere(out[k]) ? k != i
                                                          : !aperturaIsSphere(light) && k < i && aperturaMayOverlap(out[k].cap, light.cap);
            if (mayHide) light.before.x |= 1 << k;
        }
    }
    return out;
}

glm::mat4 clipTransform(const Camera& camera, double aspect, double nearest) {
    const glm::dmat3 frame = cameraFrame(camera);
    glm::dmat4 view(glm::transpose(frame));
    view[3] = glm::dvec4(-(glm::transpose(frame) * glm::dvec3(camera.eye)), 1);
    const double f = 1 / std::tan(camera.verticalFov / 2);
    glm::dmat4 projection(0);
    projection[0][0] = f / aspect;
    projection[1][1] = -f;
    projection[2][3] = -1;
    projection[3][2] = nearest;
    return glm::mat4(projection * view);
}

std::array<vec4, 3> raysOf(const Camera& camera, double aspect) {
    const double t = std::tan(camera.verticalFov / 2);
    const glm::dmat3 frame = cameraFrame(camera);
    return {vec4(-frame[2], 0), vec4(t * aspect * frame[0], 0), vec4(-t * frame[1], 0)};
}

glm::vec3 rayThrough(const Camera& camera, double aspect, double u, double v) {
    const std::array<vec4, 3> rays = raysOf(camera, aspect);
    return vec3(rays[0] + float(2 * u - 1) * rays[1] + float(2 * v - 1) * rays[2]);
}

AperturaShadowView shadowViewOf(const AperturaLight& light, const Box& bounds) {
    const vec3 towards(light.cap.axis), right = aperturaTangentTo(towards), up = cross(towards, right);
    vec3 low(1e30f), high(-1e30f);
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 p(corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
                     corner & 4 ? bounds.high.z : bounds.low.z);
        const vec3 seen(dot(p, right), dot(p, up), dot(p, towards));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const vec3 size = glm::max(high - low, vec3(1e-6f)) * 1.02f, centre = 0.5f * (low + high);
    // Rows of the matrix: x and y cover the extent, z is 0 at the far end and 1 at the near one.
    auto row = [](const vec3& axis, float scale, float shift) { return vec4(axis * scale, shift); };
    AperturaShadowView view;
    view.toLight = transpose(mat4(row(right, 2 / size.x, -2 * centre.x / size.x), row(up, -2 / size.y, 2 * centre.y / size.y),
                                  row(towards, 1 / size.z, 0.5f - centre.z / size.z), vec4(0, 0, 0, 1)));
    view.right = vec4(right, 1 / size.x);
    view.up = vec4(up, 1 / size.y);
    view.towards = vec4(towards, 1 / size.z);
    const float s = light.cap.sinRadius;
    view.shape = vec4(s / std::sqrt(std::max(1 - s * s, 1e-6f)), kShadowTexels, std::max(size.x, size.y) / kShadowTexels, 0);
    return view;
}

}  // namespace apertura
