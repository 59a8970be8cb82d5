#include "apertura/bake/sampling/tracer.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <vector>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

// What the filters of a surface's hits know: Embree calls them for each triangle that a ray meets.
struct Coloured {
    const Scene* scene;
    const Surface* surface;
};

// Calls passes(alpha, ray) for each hit and lets the ray go on where that is true.
template <typename Passes>
void filter(const RTCFilterFunctionNArguments* hits, const Passes& passes) {
    const auto& of = *static_cast<const Coloured*>(hits->geometryUserPtr);
    for (unsigned i = 0; i < hits->N; ++i) {
        if (hits->valid[i] == 0) continue;
        const float u = RTCHitN_u(hits->hit, hits->N, i), v = RTCHitN_v(hits->hit, hits->N, i);
        const unsigned triangle = RTCHitN_primID(hits->hit, hits->N, i);
        if (passes(baseColourAt(*of.scene, *of.surface, triangle, {1 - u - v, u, v}).a, triangle, i)) hits->valid[i] = 0;
    }
}

// A number of 0..1 that a ray and a triangle of an instance give.
float hashOf(const RTCFilterFunctionNArguments* hits, unsigned i, unsigned triangle) {
    // Each surface that a ray meets stops it or not on its own account.
    const uint64_t instance = uint64_t(RTCHitN_instID(hits->hit, hits->N, i, 0)) << 32 | RTCHitN_geomID(hits->hit, hits->N, i);
    uint64_t hash = (instance + 0x51ED270B27B4F3CFull) * 0x9E3779B97F4A7C15ull + triangle;
    hash ^= hash >> 31;
    for (const float x :
         {RTCRayN_dir_x(hits->ray, hits->N, i), RTCRayN_dir_y(hits->ray, hits->N, i), RTCRayN_dir_z(hits->ray, hits->N, i),
          RTCRayN_org_x(hits->ray, hits->N, i), RTCRayN_org_y(hits->ray, hits->N, i), RTCRayN_org_z(hits->ray, hits->N, i)}) {
        uint32_t bits = 0;
        std::memcpy(&bits, &x, sizeof bits);
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15ull;
        hash ^= hash >> 29;
    }
    return float(hash >> 40) * 0x1p-24f;
}

void letThrough(const RTCFilterFunctionNArguments* hits) {
    filter(hits, [&](float alpha, unsigned triangle, unsigned i) { return alpha < 1 && hashOf(hits, i, triangle) >= alpha; });
}

void skipHoles(const RTCFilterFunctionNArguments* hits) {
    filter(hits, [](float alpha, unsigned, unsigned) { return alpha == 0; });
}

// Attaches the surface's triangles as geometry `id`, each vertex placed by `place`. `coloured`: where rays may pass it, else null.
template <typename Place>
void attach(RTCDevice device, RTCScene to, unsigned id, const Surface& surface, const Coloured* coloured, Place&& place) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surface.positions.size()));
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), surface.triangles.size()));
    if (!vertices || !indices) {
        rtcReleaseGeometry(geometry);
        throw Error("ray tracing: not enough memory for the scene");
    }
    for (const glm::vec3& p : surface.positions) {
        const glm::vec3 placed = place(p);
        for (int c = 0; c < 3; ++c) *vertices++ = placed[c];
    }
    for (const auto& triangle : surface.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
    if (coloured) {
        rtcSetGeometryUserData(geometry, const_cast<Coloured*>(coloured));
        rtcSetGeometryOccludedFilterFunction(geometry, letThrough);
        rtcSetGeometryIntersectFilterFunction(geometry, skipHoles);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(to, geometry, id);
    rtcReleaseGeometry(geometry);
}

glm::vec3 middleOf(const Surface& surface) {
    Box box;
    for (const glm::vec3& p : surface.positions) box.low = glm::min(box.low, p), box.high = glm::max(box.high, p);
    return surface.positions.empty() ? glm::vec3(0) : glm::vec3(0.5 * (glm::dvec3(box.low) + glm::dvec3(box.high)));
}

// True where rays can be transformed to an instance's own frame in float32: it is neither flat nor a speck beside the
// scene. `toRays`: from the instance's own size to that of the rays.
bool isWellConditioned(const glm::dmat3& toRays) {
    auto norm = [](const glm::dmat3& m) { return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2])); };
    const double size = norm(toRays), inverse = norm(glm::inverse(toRays));
    return size > 1e-8 && size * inverse < 1e6;
}

}  // namespace

struct Tracer::Impl {
    const Scene* scene = nullptr;
    RTCDevice device = nullptr;
    RTCScene top = nullptr;
    std::vector<RTCScene> parts;
    std::deque<Coloured> coloured;
    // The rays see a point p of the world at (p - centre) * scale, within -1..1.
    glm::dvec3 centre{0};
    double scale = 1, reach = 1;

    glm::vec3 toRays(const glm::dvec3& world) const { return glm::vec3((world - centre) * scale); }

    ~Impl() {
        for (RTCScene part : parts) rtcReleaseScene(part);
        if (top) rtcReleaseScene(top);
        if (device) rtcReleaseDevice(device);
    }
    const Coloured* colouredOf(const Surface& surface) {
        if (materialOf(*scene, surface).alpha == Material::Alpha::Opaque) return nullptr;
        return &coloured.emplace_back(Coloured{scene, &surface});
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
                scene, [](void* user, double) { return (*static_cast<const Progress*>(user))(0); }, const_cast<Progress*>(&progress));
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
    glm::dvec3 low(1e300), high(-1e300);
    for (const Instance& instance : scene.instances)
        for (const glm::vec3& p : scene.surfaces[instance.surface].positions) {
            const glm::dvec3 world = worldPosition(instance, p);
            low = glm::min(low, world), high = glm::max(high, world);
        }
    impl.centre = 0.5 * (low + high);
    const glm::dvec3 half = 0.5 * (high - low);
    impl.reach = std::max({half.x, half.y, half.z, 1e-30});
    impl.scale = std::exp2(-std::ceil(std::log2(impl.reach)));
    std::map<int, int> uses;
    for (const Instance& instance : scene.instances) ++uses[instance.surface];
    struct Part {
        RTCScene scene = nullptr;
        glm::vec3 middle{0};  // the origin of its own rays
        double scale = 1;     // brings its size to about 1
    };
    std::map<int, Part> part;
    for (unsigned i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Surface& surface = scene.surfaces[instance.surface];
        if (surface.triangles.empty()) continue;
        const auto attachPlaced = [&] {
            attach(impl.device, impl.top, i, surface, impl.colouredOf(surface),
                   [&](const glm::vec3& p) { return impl.toRays(worldPosition(instance, p)); });
        };
        if (uses[instance.surface] == 1) {
            attachPlaced();
            continue;
        }
        auto [place, isNew] = part.try_emplace(instance.surface);
        Part& shared = place->second;
        if (isNew) {
            shared.middle = middleOf(surface);
            double reach = 1e-300;
            for (const glm::vec3& p : surface.positions) reach = std::max(reach, glm::length(glm::dvec3(p) - glm::dvec3(shared.middle)));
            shared.scale = std::exp2(-std::ceil(std::log2(reach)));
        }
        glm::dmat4 toRays = glm::dmat4(instance.toWorld) * (impl.scale / shared.scale);
        if (!isWellConditioned(glm::dmat3(toRays))) {
            attachPlaced();
            continue;
        }
        if (!shared.scene) {
            shared.scene = impl.newScene();
            impl.parts.push_back(shared.scene);
            attach(impl.device, shared.scene, 0, surface, impl.colouredOf(surface),
                   [&](const glm::vec3& p) { return glm::vec3((glm::dvec3(p) - glm::dvec3(shared.middle)) * shared.scale); });
            impl.commit(shared.scene, progress);
        }
        toRays[3] = glm::dvec4(impl.toRays(worldPosition(instance, shared.middle)), 1);
        const glm::mat4 transform(toRays);
        RTCGeometry geometry = rtcNewGeometry(impl.device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, shared.scene);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &transform[0][0]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(impl.top, geometry, i);
        rtcReleaseGeometry(geometry);
    }
    impl.commit(impl.top, progress);
}

Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

const Scene& Tracer::scene() const { return *impl_->scene; }

double Tracer::offset(const glm::dvec3& position, double longest) const {
    const glm::dvec3 from = glm::abs(position - impl_->centre);
    return 32 * double(std::numeric_limits<float>::epsilon()) * std::min(std::max({from.x, from.y, from.z}) + longest, impl_->reach);
}

double Tracer::offset() const { return offset(impl_->centre); }

void Tracer::occluded(const glm::dvec3& world, std::span<const glm::vec3> directions, float distance, uint8_t* blocked) const {
    occluded(world, directions, {&distance, 1}, blocked);
}

void Tracer::occluded(const glm::dvec3& world, std::span<const glm::vec3> directions, std::span<const float> distances,
                      uint8_t* blocked) const {
    assert(distances.size() == 1 || distances.size() == directions.size());
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
    const glm::vec3 origin = impl_->toRays(world);
    const auto reach = [&](size_t i) {
        const float distance = distances[std::min(i, distances.size() - 1)];
        return distance < kNoLimit ? float(distance * impl_->scale) : kNoLimit;
    };
    constexpr size_t lanes = 16;
    RTCRay16 rays;
    alignas(64) int valid[lanes];
    for (size_t first = 0; first < directions.size(); first += lanes) {
        const size_t count = std::min(lanes, directions.size() - first);
        for (size_t i = 0; i < lanes; ++i) {
            const size_t ray = first + std::min(i, count - 1);
            const glm::vec3& d = directions[ray];
            valid[i] = i < count ? -1 : 0;
            rays.org_x[i] = origin.x, rays.org_y[i] = origin.y, rays.org_z[i] = origin.z;
            rays.dir_x[i] = d.x, rays.dir_y[i] = d.y, rays.dir_z[i] = d.z;
            rays.tnear[i] = 0, rays.tfar[i] = reach(ray);
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

bool Tracer::occluded(const glm::dvec3& origin, const glm::vec3& direction, float distance) const {
    uint8_t blocked = 0;
    occluded(origin, {&direction, 1}, distance, &blocked);
    return blocked != 0;
}

std::optional<Hit> Tracer::nearest(const glm::dvec3& world, const glm::vec3& direction) const {
    const glm::vec3 origin = impl_->toRays(world);
    // From so far away, in units of the scene, nothing of it is seen; Embree takes no larger numbers.
    constexpr float kFarthest = 1e18f;
    if (!(std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)}) < kFarthest)) return std::nullopt;
    RTCRayHit query{};
    query.ray = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, 0, kNoLimit, ~0u, 0, 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(impl_->top, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->top, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const bool instanced = query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
    const int instance = int(instanced ? query.hit.instID[0] : query.hit.geomID), triangle = int(query.hit.primID);
    const float u = query.hit.u, v = query.hit.v;
    const SurfaceAt at = surfaceAt(*impl_->scene, instance, triangle, {1 - u - v, u, v});
    return Hit{at, float(double(query.ray.tfar) / impl_->scale), glm::dot(at.face, direction) > 0, instance, triangle, {1 - u - v, u, v}};
}

}  // namespace apertura
