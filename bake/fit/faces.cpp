#include "bake/fit/faces.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "bake/fit/face_baker.h"
#include "bake/fit/face_judge.h"
#include "bake/fit/face_unknowns.h"
#include "bake/sampling/directions.h"
#include "bake/sampling/surface_points.h"
#include "runtime/asset/faces.h"

namespace apertura {
namespace {

constexpr double kNoArea = 1e-10;            // a triangle has no area up to this ratio of its area to its squared longest edge
constexpr float kVertexWeight = 4;           // of what a vertex itself sees, beside a probe: it has four times the rays
constexpr float kTies[] = {0.03f, 0.5f, 8};  // how strongly neighbouring samples may be drawn together, where a probe's weight is 1
constexpr double kFirstGain = 0.5;           // the fraction of its squared error that a triangle is thought to lose by its first refinement
constexpr double kBulk = 0.2;                // the part of the squared error that one round of refinement aims to remove
constexpr double kWorth = 0.4;     // the least fraction of the squared error that must go for a fraction of the bytes spent already: by a
                                   // tenth more bytes, four in a hundred,
constexpr double kLittle = 65536;  // where what so many samples take counts as spent
constexpr int kCoarse = 5;         // lattices up to this level are too coarse, or have too few witnesses, to tell what finer ones will do
constexpr double kShared = 3;      // witnesses that the mean of a level's faces counts as
constexpr double kSpread = 0.28;   // of the squared spread of three samples' lights: what mixing these errs as hard edges move between them
constexpr int kMostRounds = 60;
constexpr int kReportPoints = 3000;  // over the surface, from which what is left of the error is estimated
constexpr size_t kUnseen = 1 << 20;  // number of the first witness of a triangle that took no part in choosing its samples

// Probes that a lattice is fitted to: about three times as many as it has samples of its own; and witnesses that judge it.
size_t probesFor(int level) {
    const int steps = latticeSteps(level);
    return size_t(1.5 * (steps + 1) * (steps + 2));
}
size_t witnessesFor(int level) { return std::max(size_t(8), size_t(latticeSteps(level)) * size_t(latticeSteps(level)) / 2); }
// A face that is refined has a witness for each `mean` square metres, so that none is left as it is because a few err little by chance.
size_t witnessesOn(double area, double mean) { return size_t(std::min(area / mean, 256.0)); }

std::array<Term, 3> termsOf(const LatticeCell& cell) {
    std::array<Term, 3> out;
    for (int c = 0; c < 3; ++c) out[size_t(c)] = {uint32_t(cell.samples[c]), cell.weights[c]};
    return out;
}

// Calls tie(a, b) for the neighbours in a lattice.
void forNeighbours(int steps, const auto& tie) {
    for (int j = 0; j <= steps; ++j)
        for (int i = 0; i <= steps - j; ++i) {
            const int at = latticeRow(j, steps) + i;
            if (i < steps - j) tie(at, at + 1), tie(at, latticeRow(j + 1, steps) + i);
            if (i > 0 && j < steps) tie(at, latticeRow(j + 1, steps) + i - 1);
        }
}

// What is fitted: vertices and samples, or vertices alone, as if no face had samples.
enum class Fitted { All, Vertices };
int levelOf(const Face& face, Fitted what) { return what == Fitted::All ? face.level : 0; }

Unknowns unknownsOf(const Scene& scene, size_t instance, std::span<const Face> faces, Fitted what = Fitted::All) {
    const size_t triangles = scene.surfaces[size_t(scene.instances[instance].surface)].triangles.size();
    std::vector<uint8_t> levels(triangles, 0);
    std::vector<bool> leans(triangles, false);
    for (const Face& face : faces) levels[face.triangle] = uint8_t(levelOf(face, what)), leans[face.triangle] = face.leans;
    return {scene, instance, std::move(levels), std::move(leans)};
}

// `seen`: what the vertices see, each a value more.
LeastSquares equationsOf(const Unknowns& unknowns, std::span<const Face> faces, const Surface& surface, std::span<const Visibility> seen,
                         Fitted what = Fitted::All) {
    LeastSquares out(unknowns.count());
    std::vector<bool> used(seen.size(), false);  // a vertex that no triangle has saw nothing
    for (const Face& face : faces)
        for (const uint32_t v : surface.triangles[face.triangle]) used[v] = true;
    for (size_t v = 0; v < seen.size(); ++v)
        if (used[v]) out.add(std::array{Term(unknowns.vertex(v), 1.0f)}, seen[v], kVertexWeight);
    for (const Face& face : faces) {
        const int level = levelOf(face, what);
        if (level == 0 && face.leans) continue;  // its vertices look elsewhere
        for (const Probe& probe : face.probes)
            if (!probe.buried) out.add(unknowns.point(face.triangle, probe.weights), probe.mean());
        const auto tie = [&](int a, int b) {
            const auto from = unknowns.sample(face.triangle, a), to = unknowns.sample(face.triangle, b);
            if (from.size() == 1 && to.size() == 1 && from[0].first != to[0].first) out.tie(from[0].first, to[0].first, face.tie);
        };
        if (level == 0)
            tie(0, 1), tie(1, 2), tie(2, 0);
        else
            forNeighbours(latticeSteps(level), tie);
    }
    return out;
}

}  // namespace

struct Faces::Impl {
    const Scene& scene;
    const Prober& prober;
    const BakedVisibility& vertices;
    uint32_t seed;
    std::vector<Face> faces;        // by instance and triangle; those without area are left out
    std::vector<size_t> firstFace;  // of each instance, and the end
    FaceReport report;
    Judge judge;
    double skyWeight = 1;
    bool isMixed = true;  // see FaceOptions
    double meanArea = 1;  // of a face, m2

    std::span<const Face> facesOf(size_t instance) const {
        return std::span(faces).subspan(firstFace[instance], firstFace[instance + 1] - firstFace[instance]);
    }

    double total(const SquaredErrors& e) const { return e.light + skyWeight * e.sky; }

    // The mean squared errors at a face's witnesses of what the renderer makes of `samples`, those of its lattice or its three corners.
    SquaredErrors errorsOf(const Face& face, std::span<const Visibility> samples) const {
        const Model& soft = models()[MODEL_SOFT];
        const Instance& placed = scene.instances[face.instance];
        const Surface& surface = scene.surfaces[size_t(placed.surface)];
        const auto& corners = surface.triangles[face.triangle];
        std::vector<ModelParams> params;
        for (size_t i = 0; i < samples.size(); ++i) {
            const glm::vec3 normal =
                face.level
                    ? surfaceAt(scene, int(face.instance), int(face.triangle), latticePoint(int(i), latticeSteps(face.level))).looking()
                    : normalMatrix(placed.toWorld) * surface.normals[corners[i]];
            params.push_back(toParams(soft, samples[i], nullptr, normal));
        }
        SquaredErrors sum;
        double count = 0;
        for (size_t k = 0; k < face.witnesses.size(); ++k) {
            const Probe& witness = face.witnesses[k];
            if (witness.buried) continue;
            const LatticeCell cell = face.level ? latticeCell(witness.weights, latticeSteps(face.level))
                                                : LatticeCell{{0, 1, 2}, witness.weights};
            Visibility visibility{glm::vec3(0), 0};
            ModelParams mix{};
            for (int c = 0; c < 3; ++c) {
                const auto at = size_t(cell.samples[c]);
                visibility.direction += cell.weights[c] * samples[at].direction, visibility.area += cell.weights[c] * samples[at].area;
                mix[0] += cell.weights[c] * params[at][0];
            }
            const glm::vec3 normal = prober.pointAt(face.instance, face.triangle, witness.weights).normal;
            std::array<Receiver, 3> apertures;
            for (int c = 0; !isMixed && c < 3; ++c) {
                const Visibility& own = samples[size_t(cell.samples[c])];
                apertures[size_t(c)] = toReceiver(own, toParams(models()[MODEL_APERTURE], own, nullptr, normal), normal);
            }
            const double spin = 2 * std::numbers::pi * hashUnit(seed, face.triangle, 17 + k);
            const SquaredErrors here = judge.at(witness, renormalised(MODEL_SOFT, toReceiver(visibility, mix, normal)), normal, spin);
            sum.light += here.light, sum.sky += here.sky;
            if (!isMixed) sum.light += kSpread * judge.spread(apertures, cell.weights, normal, spin);
            ++count;
        }
        if (count > 0) sum.light /= count, sum.sky /= count;
        return sum;
    }

    void addProbes(Face& face, size_t probes, size_t witnesses) const {
        face.probes.reserve(probes), face.witnesses.reserve(witnesses);
        while (face.probes.size() < probes) face.probes.push_back(prober.probe(face.instance, face.triangle, face.probes.size()));
        while (face.witnesses.size() < witnesses)
            face.witnesses.push_back(prober.witness(face.instance, face.triangle, face.witnesses.size()));
        double seen = 0;
        for (const auto* points : {&face.probes, &face.witnesses})
            for (const Probe& p : *points) seen += !p.buried;
        face.open = seen / double(face.probes.size() + face.witnesses.size());
    }

    // Adds witnesses to a face of which a part is buried until one is not, if it may have one.
    void seekWitness(Face& face) const {
        constexpr size_t most = 8;
        if (face.witnesses.empty() || face.open == 0) return;
        while (face.witnesses.size() < most && isBlind(face)) addProbes(face, 0, face.witnesses.size() + 1);
    }

    static bool isBlind(const Face& face) {
        return std::all_of(face.witnesses.begin(), face.witnesses.end(), [](const Probe& p) { return p.buried; });
    }

    // Sets a face's error and tie as they are if its lattice is fitted alone.
    void fitAlone(Face& face, bool mayTie) const {
        face.error = ownError(face, face.tie = kTies[0]);
        if (!mayTie) return;
        for (const float tie : kTies)
            if (const double error = ownError(face, tie); error < face.error) face.error = error, face.tie = tie;
    }

    double ownError(const Face& face, float tie) const {
        const int steps = latticeSteps(face.level);
        LeastSquares equations(size_t(latticeSize(steps)));
        for (const Probe& probe : face.probes)
            if (!probe.buried) equations.add(termsOf(latticeCell(probe.weights, steps)), probe.mean());
        forNeighbours(steps, [&](int a, int b) { equations.tie(uint32_t(a), uint32_t(b), tie); });
        return total(errorsOf(face, equations.solve()));
    }

    // Fits the faces of an instance together, and calls use(face, samples) for each that isWanted(face).
    void fitTogether(size_t instance, const auto& isWanted, const auto& use, const auto& useVertices) const {
        const Unknowns unknowns = unknownsOf(scene, instance, facesOf(instance));
        const std::vector<Visibility> values =
            equationsOf(unknowns, facesOf(instance), surfaceOf(instance), vertices[instance].visibility).solve();
        tbb::parallel_for(firstFace[instance], firstFace[instance + 1], [&](size_t f) {
            if (!isWanted(f)) return;
            const Face& face = faces[f];
            std::vector<Visibility> samples;
            for (int i = 0; i < (face.level ? samplesOn(face.level) : 3); ++i)
                samples.push_back(sumOf(unknowns.sample(face.triangle, i), values));
            use(f, samples);
        });
        useVertices(unknowns, values);
    }

    // The errors of faces as they stand: of all of them or, where only those in `refined` have changed since they were measured last, of
    // these and of what touches them.
    void measure(std::span<const size_t> refined = {}) {
        std::vector<std::vector<bool>> near(scene.instances.size());  // by instance and vertex; empty: none
        for (const size_t f : refined) {
            const Surface& surface = surfaceOf(faces[f].instance);
            std::vector<bool>& own = near[faces[f].instance];
            own.resize(surface.positions.size());
            for (const uint32_t v : surface.triangles[faces[f].triangle]) own[v] = true;
        }
        const auto isWanted = [&](size_t f) {
            if (refined.empty()) return true;
            const auto& corners = surfaceOf(faces[f].instance).triangles[faces[f].triangle];
            return std::any_of(corners.begin(), corners.end(), [&](uint32_t v) { return near[faces[f].instance][v]; });
        };
        tbb::parallel_for(size_t(0), scene.instances.size(), [&](size_t i) {
            if (!refined.empty() && near[i].empty()) return;
            fitTogether(
                i, isWanted, [&](size_t f, std::span<const Visibility> samples) { faces[f].measured = errorsOf(faces[f], samples); },
                [](const Unknowns&, const std::vector<Visibility>&) {});
        });
        shareErrors();
    }

    const Surface& surfaceOf(size_t instance) const { return scene.surfaces[size_t(scene.instances[instance].surface)]; }

    // What few witnesses say is drawn towards what all faces of the level err: of those that were left as they are, most were so because
    // their witnesses happened to see little. A face without a witness is thought to err as the others do.
    void shareErrors() {
        double sum[MAX_LATTICE_LEVEL + 1]{}, area[MAX_LATTICE_LEVEL + 1]{};
        for (const Face& face : faces)
            if (!isBlind(face)) sum[face.level] += total(face.measured) * face.area, area[face.level] += face.area;
        for (Face& face : faces) {
            face.error = total(face.measured);
            if (!(area[face.level] > 0)) continue;
            const auto seeing = double(
                std::count_if(face.witnesses.begin(), face.witnesses.end(), [](const Probe& p) { return !p.buried; }));
            face.error = (seeing * face.error + kShared * sum[face.level] / area[face.level]) / (seeing + kShared);
        }
    }
};

Faces::Faces(const Scene& scene, const Prober& prober, const BakedVisibility& vertices, At at, uint32_t seed, const Progress& progress)
    : impl_(new Impl{scene, prober, vertices, seed, {}, {}, {}, {}}) {
    Impl& impl = *impl_;
    double total = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        impl.firstFace.push_back(impl.faces.size());
        const size_t triangles = scene.surfaces[size_t(scene.instances[i].surface)].triangles.size();
        for (size_t t = 0; t < triangles; ++t) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene, int(i), int(t));
            const double area = 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
            const double longest = std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
            if (!(area > kNoArea * longest * longest)) continue;
            impl.faces.push_back({uint32_t(i), uint32_t(t), area, surfaceAt(scene, int(i), int(t), glm::vec3(1 / 3.0f)).leans});
            impl.faces.back().tie = kTies[0], impl.faces.back().gain = kFirstGain;
            total += area;
        }
    }
    impl.firstFace.push_back(impl.faces.size());
    impl.meanArea = total / double(std::max<size_t>(impl.faces.size(), 1));
    // Of small faces as many have a witness as there are rays for beside those of the vertices.
    double allVertices = 0;
    for (const SeenByInstance& seen : vertices) allVertices += double(seen.visibility.size());
    const double many = std::min(prober.witnessesASample(), 4.0);
    const double witnessed = 0.8 * many * allVertices / double(std::max<size_t>(impl.faces.size(), 1));
    ProgressCounter counter(progress, impl.faces.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, impl.faces.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
        if (counter.stopped()) return;
        for (size_t f = range.begin(); f < range.end(); ++f) {
            Face& face = impl.faces[f];
            const double size = std::sqrt(face.area / impl.meanArea);
            const bool isSmall = at == At::Vertices || (size < 1.5 && hashUnit(seed, f, 23) > std::max(size - 0.5, witnessed));
            impl.addProbes(face, size_t(std::clamp(at == At::Vertices ? std::ceil(1.5 * size) : std::round(size), 1.0, 24.0)),
                           isSmall ? 0 : size_t(std::clamp(many * (size < 1.5 ? 1 : 2 * size), 1.0, 24.0 * many)));
            impl.seekWitness(face);
            // What its vertices see is of another hemisphere than its own.
            if (at == At::Faces && face.leans && face.open > 0) {
                face.level = 1;
                impl.addProbes(face, probesFor(1), 0);
            }
        }
        counter.add(range.size());
    });
    counter.throwIfStopped();
}

Faces::~Faces() = default;

bool Faces::empty() const { return impl_->faces.empty(); }

const FaceReport& Faces::report() const { return impl_->report; }

void Faces::refine(const FaceOptions& options, const Progress& progress) {
    Impl& impl = *impl_;
    impl.skyWeight = options.tolerance * options.tolerance / (options.skyTolerance * options.skyTolerance);
    impl.isMixed = options.isMixed;
    impl.measure();
    double area = 0, whole = 0, bytes = options.bytesElsewhere;
    for (const Face& face : impl.faces) area += face.area * face.open, whole += face.area;
    const double little = kLittle * options.bytesASample;
    const double allowed = options.tolerance * options.tolerance * area;
    for (const Face& face : impl.faces) bytes += options.bytesASample * samplesOn(face.level);
    if (options.maxBytes > 0 && bytes > options.maxBytes) {
        for (Face& face : impl.faces) face.level = 0;
        bytes = options.bytesElsewhere;
        impl.measure();
    }
    bool full = false, settled = false;
    std::vector<size_t> refined;  // since all were judged
    // Faces are refined each by itself, and then judged again as they are when all are fitted together.
    for (int round = 0, since = 0; round < kMostRounds; ++round, ++since) {
        if (progress && !progress(double(round) / kMostRounds)) throw Cancelled{};
        double error = 0;
        for (const Face& face : impl.faces) error += face.area * face.open * face.error;
        if (error <= allowed) {
            if (since == 0) break;
            impl.measure(refined);
            refined.clear();
            since = -1;
            continue;
        }
        struct Step {
            double worth;
            size_t face;
            double gain, cost;
        };
        std::vector<Step> steps;
        for (size_t f = 0; f < impl.faces.size(); ++f) {
            const Face& face = impl.faces[f];
            if (face.level == MAX_LATTICE_LEVEL || face.error <= 0) continue;
            const double gain = face.gain * face.error * face.area * face.open;
            const double cost = options.bytesASample * (samplesOn(face.level + 1) - samplesOn(face.level));
            steps.push_back({gain / cost, f, gain, cost});
        }
        std::stable_sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.worth > b.worth; });
        // A part of the error at a time, so that what is refined further in vain, or need not be, shows before more is spent.
        std::vector<size_t> chosen;
        const double enough = std::max(allowed, (1 - kBulk) * error), least = kWorth * error / std::max(bytes, little);
        for (const Step& step : steps) {
            if (error <= enough) break;
            // Where bytes remove so little, the rest of the error is not one of too few samples.
            if (step.worth < least) break;
            if (options.maxBytes > 0 && bytes + step.cost > options.maxBytes) {
                full = true;
                continue;
            }
            bytes += step.cost;
            error -= step.gain;
            chosen.push_back(step.face);
        }
        if (chosen.empty()) {
            settled = true;
            break;
        }
        refined.insert(refined.end(), chosen.begin(), chosen.end());
        tbb::parallel_for(tbb::blocked_range<size_t>(0, chosen.size(), 1), [&](const tbb::blocked_range<size_t>& range) {
            for (size_t c = range.begin(); c < range.end(); ++c) {
                Face& face = impl.faces[chosen[c]];
                ++face.level;
                impl.addProbes(face, probesFor(face.level), std::max(witnessesFor(face.level), witnessesOn(face.area, impl.meanArea)));
                const double before = face.error;
                impl.fitAlone(face, options.isFitted);
                face.gain = std::clamp(1 - face.error / before, face.level <= kCoarse ? 0.3 : 0.1, 0.75);
            }
        });
    }
    impl.measure();
    FaceReport& report = impl.report;
    report = {};
    report.tolerance = options.tolerance;
    report.skyTolerance = options.skyTolerance;
    report.full = full;
    report.overfull = options.maxBytes > 0 && options.bytesElsewhere > options.maxBytes;
    report.rays = impl.prober.rays();
    area = 0;  // the faces' open parts are better known now
    for (const Face& face : impl.faces) area += face.area * face.open;
    for (const Face& face : impl.faces) {
        if (face.error > options.tolerance * options.tolerance && (settled || face.level == MAX_LATTICE_LEVEL))
            report.unmet += face.area * face.open;
        report.samples += size_t(samplesOn(face.level));
    }
    report.unmet /= std::max(area, 1e-300);
    report.buried = 1 - area / std::max(whole, 1e-300);
}

void Faces::judge(const BakedVisibility& stored) {
    const Impl& impl = *impl_;
    const std::vector<SurfaceSample> points = sampleSurface(impl.scene, kReportPoints, impl.seed + 1);
    std::vector<SquaredErrors> errors(points.size());
    std::vector<uint8_t> seen(points.size());
    tbb::parallel_for(size_t(0), points.size(), [&](size_t k) {
        const SeenByInstance& own = stored[size_t(points[k].instance)];
        Face face{uint32_t(points[k].instance), uint32_t(points[k].triangle), 0, false};
        face.level = own.faces.level(face.triangle);
        face.witnesses = {impl.prober.witness(face.instance, face.triangle, kUnseen + k)};
        std::vector<Visibility> samples;
        for (int i = 0; i < samplesOn(face.level); ++i) samples.push_back(own.faces.visibility[own.faces.first[face.triangle] + size_t(i)]);
        if (face.level == 0)
            for (const uint32_t v : impl.surfaceOf(face.instance).triangles[face.triangle]) samples.push_back(own.visibility[v]);
        seen[k] = !face.witnesses[0].buried;
        errors[k] = impl.errorsOf(face, samples);
    });
    SquaredErrors sum;
    double count = 0;
    for (size_t k = 0; k < points.size(); ++k) sum.light += errors[k].light, sum.sky += errors[k].sky, count += seen[k];
    impl_->report.error = std::sqrt(std::max(sum.light, 0.0) / std::max(count, 1.0));
    impl_->report.skyError = std::sqrt(std::max(sum.sky, 0.0) / std::max(count, 1.0));
}

BakedVisibility Faces::fit() const {
    const Impl& impl = *impl_;
    BakedVisibility out(impl.scene.instances.size());
    tbb::parallel_for(size_t(0), out.size(), [&](size_t i) {
        const Surface& surface = impl.scene.surfaces[size_t(impl.scene.instances[i].surface)];
        std::vector<uint8_t> levels(surface.triangles.size(), 0);
        bool any = false;
        for (const Face& face : impl.facesOf(i)) levels[face.triangle] = uint8_t(face.level), any |= face.level > 0;
        SeenOnFaces& faces = out[i].faces;
        if (any) faces.setLevels(std::move(levels), false);
        impl.fitTogether(
            i, [](size_t) { return true; },
            [&](size_t f, std::span<const Visibility> samples) {
                const Face& face = impl.faces[f];
                if (face.level) std::copy(samples.begin(), samples.end(), faces.visibility.begin() + faces.first[face.triangle]);
            },
            [&](const Unknowns& unknowns, const std::vector<Visibility>& values) {
                for (size_t v = 0; v < surface.positions.size(); ++v) out[i].visibility.push_back(values[unknowns.vertex(v)]);
            });
        if (!any) return;
        // Vertices that no face goes by are for programs that lose the samples: they are as if there were none.
        std::vector<bool> used(surface.positions.size(), false);
        for (const Face& face : impl.facesOf(i))
            for (const uint32_t v : surface.triangles[face.triangle]) used[v] = used[v] || face.level == 0;
        const Unknowns unknowns = unknownsOf(impl.scene, i, impl.facesOf(i), Fitted::Vertices);
        const std::vector<Visibility> values =
            equationsOf(unknowns, impl.facesOf(i), surface, impl.vertices[i].visibility, Fitted::Vertices).solve();
        for (size_t v = 0; v < surface.positions.size(); ++v)
            if (!used[v]) out[i].visibility[v] = values[unknowns.vertex(v)];
    });
    return out;
}

void Faces::bakeSamples(BakedVisibility& out, const OcclusionSource& source, const BakeOptions& options, const Progress& progress) const {
    const FaceBaker baker(impl_->scene, impl_->prober, source, options);
    ProgressCounter counter(progress, std::max<size_t>(impl_->report.samples, 1));
    for (size_t i = 0; i < out.size(); ++i) {
        if (out[i].faces.visibility.empty()) continue;
        impl_->report.rays += baker.bake(i, impl_->facesOf(i), unknownsOf(impl_->scene, i, impl_->facesOf(i)), out[i].faces, counter);
    }
}

}  // namespace apertura
