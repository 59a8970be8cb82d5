#include "apertura/bake/fit/bounce.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apertura/bake/sampling/neighbours.h"
#include "apertura/bake/sampling/vertices.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/faces.h"
#include "apertura/runtime/asset/receiver.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr int kMostPasses = 24;
constexpr double kLittle = 0.002;    // RMS of the shares, of all further bounces: when none is sought
constexpr double kMostRatio = 0.98;  // of a bounce to the one before it, that is believed
constexpr int kFewRays = 4;          // of the last pass's rays, one in so many finds what the passes before it need
constexpr int kMostReflections = 8;  // of a path that meets backs of surfaces, of which nothing is stored
constexpr float kInside = 0.12f;     // how far a sample on a face looks from inside its triangle, of the way to its middle or of a cell

// A vertex or a sample on a face.
struct Point {
    SurfacePoint at;
    bool isBuried = false;  // nobody sees it, and what it sees is no guide to its neighbours
};

// Where the points of an instance begin: its vertices, then its samples on faces.
struct Numbering {
    std::vector<size_t> vertices, faces;
    size_t count = 0;

    explicit Numbering(const BakedVisibility& seen) {
        for (const SeenByInstance& own : seen) {
            vertices.push_back(count);
            faces.push_back(count += own.visibility.size());
            count += own.faces.visibility.size();
        }
    }
};

class BounceBaker {
public:
    BounceBaker(const Scene& scene, const Tracer& tracer, BakedVisibility& seen, const BounceOptions& options)
        : scene_(scene), tracer_(tracer), seen_(seen), options_(options), numbering_(seen), points_(numbering_.count) {}

    BounceReport bake(const Progress& progress) {
        place(part(progress, 0, 0.1));
        std::vector<AperturaBounce> now(points_.size(), {glm::vec3(0), glm::vec3(0)});
        BounceReport report;
        const int few = std::max(options_.rays / kFewRays, 1);
        // Each bounce is weaker than the one before, in the end by the same factor: what is left after the last is known. All passes but
        // the last one trace the same rays.
        double last = 0, ratio = 0;
        do {
            const double start = 0.1 + 0.4 * report.passes / kMostPasses;
            std::vector<AperturaBounce> next = gather(now, few, part(progress, start, start + 0.4 / kMostPasses));
            fillBuried(next);
            double change = 0;
            for (size_t k = 0; k < next.size(); ++k) {
                const glm::dvec3 more = next[k].share - now[k].share;
                change += glm::dot(more, more) / 3;
            }
            change = std::sqrt(change / double(std::max<size_t>(next.size(), 1)));
            ratio = last > 0 ? std::min(change / last, kMostRatio) : 0;
            last = change;
            report.left = report.passes > 0 ? change * ratio / (1 - ratio) : change;
            report.rays += next.size() * size_t(few);
            ++report.passes;
            if (report.left < kLittle || report.passes == kMostPasses)
                for (size_t k = 0; k < next.size(); ++k)
                    next[k].share = glm::min(next[k].share + float(ratio / (1 - ratio)) * (next[k].share - now[k].share), 1.0f);
            now = std::move(next);
        } while (report.left >= kLittle && report.passes < kMostPasses);
        now = gather(now, options_.rays, part(progress, 0.5, 1));
        fillBuried(now);
        report.rays += now.size() * size_t(options_.rays);
        ++report.passes;
        for (const AperturaBounce& b : now) report.mean += double(b.share.x + b.share.y + b.share.z) / 3 / double(now.size());
        store(now);
        return report;
    }

private:
    void place(const Progress& progress) {
        for (size_t k = 0; k < points_.size(); ++k) points_[k].isBuried = true;  // of vertices that no triangle has
        const VertexPoints vertices = placeVertices(scene_, tracer_, part(progress, 0, 0.5));
        for (size_t k = 0; k < vertices.points.size(); ++k)
            points_[numbering_.vertices[vertices.places[k].first] + vertices.places[k].second] = {vertices.points[k], false};
        for (size_t i = 0; i < seen_.size(); ++i) {
            const SeenOnFaces& faces = seen_[i].faces;
            for (size_t t = 0; t < faces.levels.size(); ++t) {
                if (faces.level(t) == 0) continue;
                const int steps = aperturaLatticeSteps(faces.level(t));
                for (int n = 0; n < aperturaLatticeSize(steps); ++n) {
                    const glm::vec3 weights = glm::mix(latticePoint(n, steps), glm::vec3(1 / 3.0f), kInside / float(steps));
                    const SurfaceAt at = surfaceAt(scene_, int(i), int(t), weights);
                    points_[numbering_.faces[i] + faces.first[t] + size_t(n)] = {{at.position, at.looking(), at.longest}, false};
                }
            }
        }
        const Solids solids(scene_, tracer_);
        const Progress finding = part(progress, 0.5, 1);
        ProgressCounter counter(finding, points_.size());
        tbb::parallel_for(tbb::blocked_range<size_t>(0, points_.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
            if (counter.stopped()) return;
            for (size_t k = range.begin(); k < range.end(); ++k)
                if (!points_[k].isBuried)
                    points_[k].isBuried = solids.backsSeen(points_[k].at, 2 * pi * hashUnit(options_.seed, k, 71)) > Solids::kProbes / 4;
            counter.add(range.size());
        });
        counter.throwIfStopped();
    }

    // What one more bounce gives, after `before`.
    std::vector<AperturaBounce> gather(const std::vector<AperturaBounce>& before, int rays, const Progress& progress) const {
        std::vector<AperturaBounce> out(points_.size(), {glm::vec3(0), glm::vec3(0)});
        const std::vector<glm::vec3> lattice = fibonacciCosine(rays);
        ProgressCounter counter(progress, points_.size());
        tbb::parallel_for(tbb::blocked_range<size_t>(0, points_.size(), 32), [&](const tbb::blocked_range<size_t>& range) {
            if (counter.stopped()) return;
            for (size_t k = range.begin(); k < range.end(); ++k)
                if (!points_[k].isBuried) out[k] = gatherAt(k, before, lattice);
            counter.add(range.size());
        });
        counter.throwIfStopped();
        return out;
    }

    // Sums what comes along paths: light that leaves a surface by what is known of it, and the sky behind backs.
    struct Gathered {
        const BounceBaker& baker;
        const std::vector<AperturaBounce>& before;
        glm::dvec3 share{0}, towards{0};
        double weight = 0;  // of `towards`
        int met = 0;

        void add(const glm::vec3& light, const glm::vec3& from) {
            const double grey = double(light.x + light.y + light.z) / 3;
            share += light;
            towards += grey * glm::dvec3(from);
            weight += grey;
        }
        bool ends(const glm::dvec3&, const glm::vec3&, float) { return false; }
        bool reflects(const Hit& hit, const SurfacePoint&, const glm::vec3& throughput) {
            ++met;
            if (hit.back) return true;  // another ray of the path finds out
            const auto instance = size_t(hit.instance);
            const SeenByInstance& own = baker.seen_[instance];
            const SamplesAbout about = samplesAbout(baker.scene_.surfaces[size_t(baker.scene_.instances[instance].surface)], own,
                                                    size_t(hit.triangle), hit.barycentrics);
            Visibility visible;
            glm::vec3 reflected(0), from(0);
            for (size_t c = 0; c < 3; ++c) {
                const float weight3 = about.weights[int(c)];
                const Visibility& v = about.onFace ? own.faces.visibility[about.at[c]] : own.visibility[about.at[c]];
                const AperturaBounce& b =
                    before[(about.onFace ? baker.numbering_.faces : baker.numbering_.vertices)[instance] + about.at[c]];
                visible.direction += weight3 * v.direction;
                visible.area += weight3 * v.area;
                reflected += weight3 * b.share;
                from += weight3 * b.towards;
            }
            const glm::vec3 normal = hit.at.looking();
            const float open = std::clamp(glm::dot(normal, visible.direction) / float(pi), 0.0f, 1.0f);
            add(throughput * open, aperturaOpeningCentroid(normal, visible.direction, visible.area));
            add(throughput * reflected, from);
            return false;
        }
        void escapes(const glm::vec3& direction, const glm::vec3& throughput) {
            if (met > 0) add(throughput, direction);
        }
    };

    AperturaBounce gatherAt(size_t k, const std::vector<AperturaBounce>& before, const std::vector<glm::vec3>& lattice) const {
        const SurfacePoint& point = points_[k].at;
        const glm::mat3 frame = frameFromZ(point.normal, 2 * pi * hashUnit(options_.seed, k, 73));
        const glm::dvec3 origin = rayOrigin(tracer_, point);
        Gathered sum{*this, before};
        uint64_t path = k * lattice.size();
        for (const glm::vec3& w : lattice) {
            sum.met = 0;
            followPath(tracer_, options_.albedo, origin, frame * w, kMostReflections, options_.seed, path++, sum);
        }
        const glm::vec3 towards = sum.weight > 0 ? glm::vec3(sum.towards / sum.weight) : glm::vec3(0);
        return {glm::min(glm::vec3(sum.share / double(lattice.size())), 1.0f), towards / std::max(glm::length(towards), 1.0f)};
    }

    // Gives buried points the mean of those that share a triangle or an edge of a lattice's cell with them, from the border inwards.
    void fillBuried(std::vector<AperturaBounce>& values) const {
        std::vector<uint8_t> known(points_.size());
        for (size_t k = 0; k < points_.size(); ++k) known[k] = !points_[k].isBuried;
        for (size_t i = 0; i < seen_.size(); ++i) {
            const Surface& surface = scene_.surfaces[size_t(scene_.instances[i].surface)];
            const SeenOnFaces& faces = seen_[i].faces;
            std::vector<std::pair<size_t, size_t>> edges;
            for (size_t t = 0; t < surface.triangles.size(); ++t) {
                const size_t first = faces.level(t) > 0 ? numbering_.faces[i] + faces.first[t] : 0;
                if (faces.level(t) > 0)
                    forLatticeEdges(aperturaLatticeSteps(faces.level(t)),
                                    [&](int a, int b) { edges.emplace_back(first + size_t(a), first + size_t(b)); });
                for (size_t c = 0; c < 3; ++c)
                    edges.emplace_back(numbering_.vertices[i] + surface.triangles[t][c],
                                       numbering_.vertices[i] + surface.triangles[t][(c + 1) % 3]);
            }
            std::erase_if(edges, [&](const auto& e) { return known[e.first] && known[e.second]; });
            for (bool any = true; any;) {
                std::map<size_t, std::pair<AperturaBounce, float>> found;
                const auto lend = [&](size_t to, size_t from) {
                    if (known[to] || !known[from]) return;
                    auto& [sum, count] = found.try_emplace(to, AperturaBounce{glm::vec3(0), glm::vec3(0)}, 0.0f).first->second;
                    sum.share += values[from].share;
                    sum.towards += values[from].towards;
                    ++count;
                };
                for (const auto& [a, b] : edges) lend(a, b), lend(b, a);
                for (const auto& [k, sum] : found) values[k] = {sum.first.share / sum.second, sum.first.towards / sum.second}, known[k] = 1;
                any = !found.empty();
                std::erase_if(edges, [&](const auto& e) { return known[e.first] && known[e.second]; });
            }
        }
    }

    void store(const std::vector<AperturaBounce>& values) {
        const auto all = [&](size_t first, size_t count) {
            return std::vector<AperturaBounce>(values.begin() + ptrdiff_t(first), values.begin() + ptrdiff_t(first + count));
        };
        for (size_t i = 0; i < seen_.size(); ++i) {
            seen_[i].bounces = all(numbering_.vertices[i], seen_[i].visibility.size());
            seen_[i].faces.bounces = all(numbering_.faces[i], seen_[i].faces.visibility.size());
        }
    }

    const Scene& scene_;
    const Tracer& tracer_;
    BakedVisibility& seen_;
    const BounceOptions& options_;
    Numbering numbering_;
    std::vector<Point> points_;
};

}  // namespace

BounceReport bakeBounces(const Scene& scene, const Tracer& tracer, BakedVisibility& seen, const BounceOptions& options,
                         const Progress& progress) {
    for (const SeenByInstance& own : seen)
        if (!own.texels.visibility.empty() || !own.bent.texels.empty())
            throw Error(scene.name + ": what surfaces reflect is stored at vertices and on faces, not in images");
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    return BounceBaker(scene, tracer, seen, options).bake(progress);
}

}  // namespace apertura
