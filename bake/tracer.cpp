#include "bake/tracer.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "runtime/error.h"

namespace apertura {
namespace {

void attach(RTCDevice device, RTCScene to, unsigned id, const Surface& surface, const glm::mat4& transform) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), surface.positions.size()));
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(uint32_t), surface.triangles.size()));
    if (!vertices || !indices) {
        rtcReleaseGeometry(geometry);
        throw Error("ray tracing: not enough memory for the scene");
    }
    for (const glm::vec3& p : surface.positions) {
        const glm::vec3 world(transform * glm::vec4(p, 1));
        for (int c = 0; c < 3; ++c) *vertices++ = world[c];
    }
    for (const auto& triangle : surface.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
}

}  // namespace

struct Tracer::Impl {
    const Scene* scene = nullptr;
    RTCDevice device = nullptr;
    RTCScene top = nullptr;
    std::vector<RTCScene> parts;
    float offset = 0;

    ~Impl() {
        for (RTCScene part : parts) rtcReleaseScene(part);
        if (top) rtcReleaseScene(top);
        if (device) rtcReleaseDevice(device);
    }
    RTCScene newScene() const {
        RTCScene scene = rtcNewScene(device);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
        return scene;
    }
    void commit(RTCScene scene, const Progress& progress) const {
        if (progress)
            rtcSetSceneProgressMonitorFunction(
                scene,
                [](void* user, double) { return (*static_cast<const Progress*>(user))(0); },
                const_cast<Progress*>(&progress));
        rtcCommitScene(scene);
        switch (rtcGetDeviceError(device)) {
            case RTC_ERROR_NONE: break;
            case RTC_ERROR_CANCELLED: throw Cancelled{};
            default: throw Error("ray tracing: not enough memory for the scene");
        }
    }
};

Tracer::Tracer(const Scene& scene, const Progress& progress) : impl_(std::make_unique<Impl>()) {
    Impl& impl = *impl_;
    impl.scene = &scene;
    impl.device = rtcNewDevice(nullptr);
    if (!impl.device) throw Error("ray tracing: Embree does not start on this machine");
    impl.top = impl.newScene();
    std::map<int, int> uses;
    for (const Instance& instance : scene.instances) ++uses[instance.surface];
    std::map<int, RTCScene> part;
    for (unsigned i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Surface& surface = scene.surfaces[instance.surface];
        if (uses[instance.surface] == 1) {
            attach(impl.device, impl.top, i, surface, instance.toWorld);
            continue;
        }
        RTCScene& shared = part[instance.surface];
        if (!shared) {
            shared = impl.newScene();
            impl.parts.push_back(shared);
            attach(impl.device, shared, 0, surface, glm::mat4(1));
            impl.commit(shared, progress);
        }
        RTCGeometry geometry = rtcNewGeometry(impl.device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, shared);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instance.toWorld[0][0]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(impl.top, geometry, i);
        rtcReleaseGeometry(geometry);
    }
    impl.commit(impl.top, progress);
    const Box box = worldBounds(scene);
    const glm::vec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
    impl.offset = 32 * std::numeric_limits<float>::epsilon() * std::max({reach.x, reach.y, reach.z});
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

float Tracer::offset() const { return impl_->offset; }

void Tracer::occluded(const glm::vec3& origin, std::span<const glm::vec3> directions, float distance,
                      uint8_t* blocked) const {
#if RTC_VERSION_MAJOR >= 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
    // Not COHERENT: Embree 3.13 then loops for ever on some packets into instances.
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
    constexpr size_t lanes = 16;
    RTCRay16 rays;
    alignas(64) int valid[lanes];
    for (size_t first = 0; first < directions.size(); first += lanes) {
        const size_t count = std::min(lanes, directions.size() - first);
        for (size_t i = 0; i < lanes; ++i) {
            const glm::vec3& d = directions[first + std::min(i, count - 1)];
            valid[i] = i < count ? -1 : 0;
            rays.org_x[i] = origin.x, rays.org_y[i] = origin.y, rays.org_z[i] = origin.z;
            rays.dir_x[i] = d.x, rays.dir_y[i] = d.y, rays.dir_z[i] = d.z;
            rays.tnear[i] = 0, rays.tfar[i] = distance;
            rays.time[i] = 0, rays.mask[i] = ~0u, rays.flags[i] = 0, rays.id[i] = 0;
        }
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded16(valid, impl_->top, &rays, &arguments);
#else
        rtcOccluded16(valid, impl_->top, &context, &rays);
#endif
        for (size_t i = 0; i < count; ++i) blocked[first + i] = rays.tfar[i] < 0;
    }
}

bool Tracer::occluded(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
    uint8_t blocked = 0;
    occluded(origin, {&direction, 1}, distance, &blocked);
    return blocked != 0;
}

std::optional<Hit> Tracer::nearest(const glm::vec3& origin, const glm::vec3& direction) const {
    RTCRayHit query{};
    query.ray = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0,
                 kNoLimit, ~0u, 0, 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(impl_->top, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->top, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const unsigned id = query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? query.hit.instID[0] : query.hit.geomID;
    const Instance& instance = impl_->scene->instances[id];
    const Surface& surface = impl_->scene->surfaces[instance.surface];
    const auto& t = surface.triangles[query.hit.primID];
    const float u = query.hit.u, v = query.hit.v;
    const glm::vec3 n = (1 - u - v) * surface.normals[t[0]] + u * surface.normals[t[1]] + v * surface.normals[t[2]];
    const glm::vec3 world = normalMatrix(instance.toWorld) * n;
    const float length = glm::length(world);
    return Hit{origin + query.ray.tfar * direction, length > 0 ? world / length : -glm::normalize(direction),
               query.ray.tfar};
}

}  // namespace apertura
