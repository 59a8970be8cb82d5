#include "apertura/bake/fit/faces.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "apertura/bake/fit/face_baker.h"
#include "apertura/bake/fit/face_set.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/runtime/asset/faces.h"

namespace apertura {
namespace {

constexpr double kNoArea = 1e-10;   // a triangle has no area up to this ratio of its area to its squared longest edge
constexpr double kFirstGain = 0.5;  // the fraction of its squared error that a triangle is thought to lose by its first refinement
constexpr double kBulk = 0.2;       // the part of the squared error that one round of refinement aims to remove
constexpr double kWorth = 0.4;      // the least fraction of the squared error that must go for a fraction of the bytes spent already: by a
                                    // tenth more bytes, four in a hundred,
constexpr double kLittle = 65536;   // where what so many samples take counts as spent
constexpr int kMostRounds = 60;
constexpr double kGrading = 0.9;  // of the progress, where grading begins
// How often what witnesses say is held against points that are new to all; where finer samples are hardly worth their bytes, once.
constexpr int kMostChecks = 3, kReportBatch = kMostChecks;

}  // namespace

Faces::Faces(const Scene& scene, const Prober& prober, const BakedVisibility& vertices, At at, uint32_t seed, const Progress& progress)
    : set_(new FaceSet{scene, prober, vertices, seed, {}, {}, {}, {}}) {
    FaceSet& set = *set_;
    double total = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        set.firstFace.push_back(set.faces.size());
        const size_t triangles = scene.surfaces[size_t(scene.instances[i].surface)].triangles.size();
        for (size_t t = 0; t < triangles; ++t) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene, int(i), int(t));
            const double area = 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
            const double longest = std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
            if (!(area > kNoArea * longest * longest)) continue;
            set.faces.push_back({uint32_t(i), uint32_t(t), area, surfaceAt(scene, int(i), int(t), glm::vec3(1 / 3.0f)).leans});
            set.faces.back().gain = kFirstGain;
            total += area;
        }
    }
    set.firstFace.push_back(set.faces.size());
    set.meanArea = total / double(std::max<size_t>(set.faces.size(), 1));
    // Of small faces as many have a witness as there are rays for beside those of the vertices.
    double allVertices = 0;
    for (const SeenByInstance& seen : vertices) allVertices += double(seen.visibility.size());
    const double many = std::min(prober.witnessesASample(), 4.0);
    const double witnessed = 0.7 * many * allVertices / double(std::max<size_t>(set.faces.size(), 1));
    ProgressCounter counter(progress, set.faces.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, set.faces.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
        if (counter.stopped()) return;
        for (size_t f = range.begin(); f < range.end(); ++f) {
            Face& face = set.faces[f];
            const double size = std::sqrt(face.area / set.meanArea);
            const bool isSmall = at == At::Vertices || (size < 1.5 && hashUnit(seed, f, 23) > std::max(size - 0.5, witnessed));
            set.addProbes(face, size_t(std::clamp(at == At::Vertices ? std::ceil(1.5 * size) : std::round(size), 1.0, 24.0)),
                          isSmall ? 0 : size_t(std::clamp(many * (size < 1.5 ? 1 : 2 * size), 1.0, 24.0 * many)));
            set.seekWitness(face);
            // What its vertices see is of another hemisphere than its own.
            if (at == At::Faces && face.leans && face.open > 0) {
                face.level = 1;
                set.addProbes(face, probesFor(1), 0);
            }
        }
        counter.add(range.size());
    });
    counter.throwIfStopped();
}

Faces::~Faces() = default;

bool Faces::empty() const { return set_->faces.empty(); }

const FaceReport& Faces::report() const { return set_->report; }

void Faces::refine(const FaceOptions& options, const Progress& progress) {
    FaceSet& set = *set_;
    set.skyWeight = options.tolerance * options.tolerance / (options.skyTolerance * options.skyTolerance);
    set.isMixed = options.isMixed;
    set.measure();
    double area = 0, whole = 0, bytes = options.bytesElsewhere;
    for (const Face& face : set.faces) area += face.area * face.open, whole += face.area;
    const double little = kLittle * options.bytesASample;
    for (const Face& face : set.faces) bytes += options.bytesASample * samplesOn(face.level);
    if (options.maxBytes > 0 && bytes > options.maxBytes) {
        for (Face& face : set.faces) face.level = 0;
        bytes = options.bytesElsewhere;
        set.measure();
    }
    bool full = false, settled = false;
    int checks = 0;
    const auto samples = [&] { return int(std::min((bytes - options.bytesElsewhere) / options.bytesASample, 1e9)); };
    // Faces are left as they are because their witnesses see little, and few of these may have seen too little. So what they say is held
    // against new points; where these say otherwise they become witnesses, too.
    const auto holds = [&] {
        if (full) return true;
        const UnseenPoints unseen = set.atUnseenPoints(fit(), std::clamp(samples() / 10, 300, kUnseenPoints), checks++);
        if (set.isWithin(unseen.errors, options.tolerance)) return true;
        set.addWitnesses(unseen);
        return false;
    };
    std::vector<size_t> refined;  // since all were judged
    // Faces are refined each by itself, and then judged again as they are when all are fitted together.
    for (int round = 0, since = 0; round < kMostRounds; ++round, ++since) {
        throwIfStopped(progress, kGrading * double(round) / kMostRounds);
        double error = 0, allowed = 0;
        for (const Face& face : set.faces) {
            error += face.area * face.open * face.error;
            allowed += face.area * face.open * options.tolerance * options.tolerance;
        }
        if (error <= allowed) {
            if (since == 0 && (checks == kMostChecks || holds())) break;
            if (since > 0) set.measure(refined);
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
        for (size_t f = 0; f < set.faces.size(); ++f) {
            const Face& face = set.faces[f];
            if (face.level == APERTURA_MAX_LATTICE_LEVEL || face.error <= 0) continue;
            const double gain = face.gain * face.error * face.area * face.open;
            const double cost = FaceSet::costOf(face, options);
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
            if (checks == 0 && !holds()) continue;
            settled = true;
            break;
        }
        refined.insert(refined.end(), chosen.begin(), chosen.end());
        set.refineFaces(chosen, options.isFitted);
    }
    full |= set.grade(options, bytes, part(progress, kGrading, 1));
    set.measure();
    FaceReport& report = set.report;
    report = {};
    report.tolerance = options.tolerance;
    report.skyTolerance = options.skyTolerance;
    report.full = full;
    report.overfull = options.maxBytes > 0 && options.bytesElsewhere > options.maxBytes;
    report.rays = set.prober.rays();
    area = 0;  // the faces' open parts are better known now
    for (const Face& face : set.faces) area += face.area * face.open;
    for (const Face& face : set.faces) {
        if (face.error > options.tolerance * options.tolerance && (settled || face.level == APERTURA_MAX_LATTICE_LEVEL))
            report.unmet += face.area * face.open;
        report.samples += size_t(samplesOn(face.level));
    }
    report.unmet /= std::max(area, 1e-300);
    report.buried = 1 - area / std::max(whole, 1e-300);
}

void Faces::judge(const BakedVisibility& stored) {
    const SquaredErrors left = set_->atUnseenPoints(stored, kUnseenPoints, kReportBatch).errors;
    set_->report.error = std::sqrt(std::max(left.light, 0.0));
    set_->report.skyError = std::sqrt(std::max(left.sky, 0.0));
}

BakedVisibility Faces::fit() const {
    const FaceSet& set = *set_;
    BakedVisibility out(set.scene.instances.size());
    tbb::parallel_for(size_t(0), out.size(), [&](size_t i) {
        const Surface& surface = set.scene.surfaces[size_t(set.scene.instances[i].surface)];
        std::vector<uint8_t> levels(surface.triangles.size(), 0);
        bool any = false;
        for (const Face& face : set.facesOf(i)) levels[face.triangle] = uint8_t(face.level), any |= face.level > 0;
        SeenOnFaces& faces = out[i].faces;
        if (any) faces.setLevels(std::move(levels), false);
        set.fitTogether(
            i, [](size_t) { return true; },
            [&](size_t f, std::span<const Visibility> samples) {
                const Face& face = set.faces[f];
                if (face.level) std::copy(samples.begin(), samples.end(), faces.visibility.begin() + faces.first[face.triangle]);
            },
            [&](const Unknowns& unknowns, const std::vector<Visibility>& values) {
                for (size_t v = 0; v < surface.positions.size(); ++v) out[i].visibility.push_back(values[unknowns.vertex(v)]);
            });
        if (!any) return;
        // Vertices that no face goes by are for programs that lose the samples: they are as if there were none.
        std::vector<bool> used(surface.positions.size(), false);
        for (const Face& face : set.facesOf(i))
            for (const uint32_t v : surface.triangles[face.triangle]) used[v] = used[v] || face.level == 0;
        const Unknowns unknowns = unknownsOf(set.scene, i, set.facesOf(i), Fitted::Vertices);
        const std::vector<Visibility> values =
            equationsOf(unknowns, set.facesOf(i), surface, set.vertices[i].visibility, Fitted::Vertices).solve();
        for (size_t v = 0; v < surface.positions.size(); ++v)
            if (!used[v]) out[i].visibility[v] = values[unknowns.vertex(v)];
    });
    return out;
}

void Faces::bakeSamples(BakedVisibility& out, const OcclusionSource& source, const BakeOptions& options, const Progress& progress) const {
    const FaceBaker baker(set_->scene, set_->prober, source, options);
    ProgressCounter counter(progress, std::max<size_t>(2 * set_->report.samples, 1));  // made, and brought to agree
    for (size_t i = 0; i < out.size(); ++i) {
        if (out[i].faces.visibility.empty()) continue;
        set_->report.rays += baker.bake(i, set_->facesOf(i), unknownsOf(set_->scene, i, set_->facesOf(i)), out[i].faces, counter);
    }
}

}  // namespace apertura
