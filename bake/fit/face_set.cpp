#include "apertura/bake/fit/face_set.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/neighbours.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/runtime/asset/faces.h"

namespace apertura {
namespace {

constexpr float kTies[] = {0.03f, 0.5f, 8};  // how strongly neighbouring samples may be drawn together
constexpr int kCoarse = 5;        // lattices up to this level are too coarse, or have too few witnesses, to tell what finer ones will do
constexpr double kShared = 3;     // witnesses that the mean of a level's faces counts as
constexpr double kSpread = 0.28;  // of the squared spread of three samples' lights: what mixing these errs as hard edges move between them

constexpr size_t kUnseen = 1 << 20;  // number of the first witness of a triangle that took no part in choosing its samples

// Witnesses that judge a lattice.
size_t witnessesFor(int level) {
    return std::max(size_t(8), size_t(aperturaLatticeSteps(level)) * size_t(aperturaLatticeSteps(level)) / 2);
}
// A face that is refined has a witness for each `mean` square metres, so that none is left as it is because a few err little by chance.
size_t witnessesOn(double area, double mean) { return size_t(std::min(area / mean, 256.0)); }

}  // namespace

SquaredErrors FaceSet::errorsOf(const Face& face, std::span<const Visibility> samples, size_t first) const {
    const Model& soft = models()[APERTURA_MODEL_SOFT];
    const Instance& placed = scene.instances[face.instance];
    const Surface& surface = scene.surfaces[size_t(placed.surface)];
    const auto& corners = surface.triangles[face.triangle];
    std::vector<ModelParams> params;
    for (size_t i = 0; i < samples.size(); ++i) {
        const glm::vec3 normal =
            face.level
                ? surfaceAt(scene, int(face.instance), int(face.triangle), latticePoint(int(i), aperturaLatticeSteps(face.level))).looking()
                : normalMatrix(placed.toWorld) * surface.normals[corners[i]];
        params.push_back(toParams(soft, samples[i], nullptr, normal));
    }
    SquaredErrors sum;
    double count = 0;
    for (size_t k = 0; k < face.witnesses.size(); ++k) {
        const Probe& witness = face.witnesses[k];
        if (witness.buried) continue;
        const AperturaLatticeCell cell = face.level ? aperturaLatticeCell(witness.weights, aperturaLatticeSteps(face.level))
                                                    : AperturaLatticeCell{{0, 1, 2}, witness.weights};
        Visibility visibility{glm::vec3(0), 0};
        ModelParams mix{};
        for (int c = 0; c < 3; ++c) {
            const auto at = size_t(cell.samples[c]);
            visibility.direction += cell.weights[c] * samples[at].direction, visibility.area += cell.weights[c] * samples[at].area;
            mix[0] += cell.weights[c] * params[at][0];
        }
        const glm::vec3 normal = prober.pointAt(face.instance, face.triangle, witness.weights).normal;
        std::array<AperturaReceiver, 3> apertures;
        for (int c = 0; !isMixed && c < 3; ++c) {
            const Visibility& own = samples[size_t(cell.samples[c])];
            apertures[size_t(c)] = toReceiver(own, toParams(models()[APERTURA_MODEL_APERTURE], own, nullptr, normal), normal);
        }
        const double spin = 2 * std::numbers::pi * hashUnit(seed, face.triangle, 17 + first + k);
        const SquaredErrors here = judge.at(witness, aperturaRenormalised(APERTURA_MODEL_SOFT, toReceiver(visibility, mix, normal)), normal,
                                            spin);
        sum.light += here.light, sum.sky += here.sky;
        if (!isMixed) sum.light += kSpread * judge.spread(apertures, cell.weights, normal, spin);
        ++count;
    }
    if (count > 0) sum.light /= count, sum.sky /= count;
    return sum;
}

void FaceSet::addProbes(Face& face, size_t probes, size_t witnesses) const {
    face.probes.reserve(probes), face.witnesses.reserve(witnesses);
    while (face.probes.size() < probes) face.probes.push_back(prober.probe(face.instance, face.triangle, face.probes.size()));
    while (face.witnesses.size() < witnesses) face.witnesses.push_back(prober.witness(face.instance, face.triangle, face.witnesses.size()));
    double seen = 0;
    for (const auto* points : {&face.probes, &face.witnesses})
        for (const Probe& p : *points) seen += !p.buried;
    face.open = seen / double(face.probes.size() + face.witnesses.size());
}

void FaceSet::seekWitness(Face& face) const {
    constexpr size_t most = 8;
    if (face.witnesses.empty() || face.open == 0) return;
    while (face.witnesses.size() < most && isBlind(face)) addProbes(face, 0, face.witnesses.size() + 1);
}

bool FaceSet::isBlind(const Face& face) {
    return std::all_of(face.witnesses.begin(), face.witnesses.end(), [](const Probe& p) { return p.buried; });
}

void FaceSet::fitAlone(Face& face, bool mayTie) const {
    face.error = ownError(face, face.tie = kTies[0]);
    if (!mayTie) return;
    for (const float tie : kTies)
        if (const double error = ownError(face, tie); error < face.error) face.error = error, face.tie = tie;
}

double FaceSet::ownError(const Face& face, float tie) const {
    const int steps = aperturaLatticeSteps(face.level);
    LeastSquares equations(size_t(aperturaLatticeSize(steps)));
    for (const Probe& probe : face.probes)
        if (!probe.buried) equations.add(termsOf(aperturaLatticeCell(probe.weights, steps)), probe.mean());
    forLatticeEdges(steps, [&](int a, int b) { equations.tie(uint32_t(a), uint32_t(b), tie); });
    return total(errorsOf(face, equations.solve()));
}

void FaceSet::measure(std::span<const size_t> refined) {
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

UnseenPoints FaceSet::atUnseenPoints(const BakedVisibility& stored, int count, int batch) const {
    assert(count <= kUnseenPoints);
    const std::vector<SurfaceSample> points = sampleSurface(scene, count, seed + 1 + uint32_t(batch));
    UnseenPoints out;
    out.points.resize(points.size());
    std::vector<SquaredErrors> errors(points.size());
    tbb::parallel_for(size_t(0), points.size(), [&](size_t k) {
        const auto instance = size_t(points[k].instance);
        const auto triangle = uint32_t(points[k].triangle);
        const SeenByInstance& own = stored[instance];
        Face face{uint32_t(instance), triangle, 0, false};
        face.level = own.faces.level(triangle);
        const size_t number = kUnseen + size_t(batch) * kUnseenPoints + k;
        face.witnesses = {prober.witness(instance, triangle, number)};
        std::vector<Visibility> samples;
        samples.reserve(size_t(std::max(samplesOn(face.level), 3)));
        for (int i = 0; i < samplesOn(face.level); ++i) samples.push_back(own.faces.visibility[own.faces.first[triangle] + size_t(i)]);
        if (face.level == 0)
            for (const uint32_t v : surfaceOf(instance).triangles[triangle]) samples.push_back(own.visibility[v]);
        errors[k] = errorsOf(face, samples, number);
        const std::span<const Face> faces = facesOf(instance);
        const auto found = std::lower_bound(faces.begin(), faces.end(), triangle,
                                            [](const Face& other, uint32_t t) { return other.triangle < t; });
        const bool isFace = found != faces.end() && found->triangle == triangle;  // else it has hardly an area
        out.points[k] = {isFace ? firstFace[instance] + size_t(found - faces.begin()) : SIZE_MAX, face.witnesses[0]};
    });
    double seen = 0;
    for (size_t k = 0; k < points.size(); ++k) {
        out.errors.light += errors[k].light, out.errors.sky += errors[k].sky;
        seen += !out.points[k].second.buried;
    }
    out.errors.light /= std::max(seen, 1.0), out.errors.sky /= std::max(seen, 1.0);
    std::erase_if(out.points, [](const auto& p) { return p.first == SIZE_MAX; });
    return out;
}

void FaceSet::addWitnesses(const UnseenPoints& unseen) {
    std::vector<size_t> touched;
    for (const auto& [f, witness] : unseen.points) {
        faces[f].witnesses.push_back(witness);
        addProbes(faces[f], 0, 0);
        touched.push_back(f);
    }
    if (!touched.empty()) measure(touched);
}

void FaceSet::refineFaces(std::span<const size_t> which, bool mayTie) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, which.size(), 1), [&](const tbb::blocked_range<size_t>& range) {
        for (size_t k = range.begin(); k < range.end(); ++k) {
            Face& face = faces[which[k]];
            ++face.level;
            addProbes(face, probesFor(face.level), std::max(witnessesFor(face.level), witnessesOn(face.area, meanArea)));
            const double before = face.error;
            fitAlone(face, mayTie);
            face.gain = std::clamp(1 - face.error / before, face.level <= kCoarse ? 0.3 : 0.1, 0.75);
        }
    });
}

double FaceSet::costOf(const Face& face, const FaceOptions& options) {
    return options.bytesASample * (samplesOn(face.level + 1) - samplesOn(face.level));
}

bool FaceSet::grade(const FaceOptions& options, double bytes, const Progress& progress) {
    bool full = false;
    for (int round = 0;; ++round) {
        throwIfStopped(progress, round / (1.0 + round));
        std::vector<size_t> chosen;
        for (const size_t f : tooCoarse()) {
            const double cost = costOf(faces[f], options);
            if (options.maxBytes > 0 && bytes + cost > options.maxBytes) {
                full = true;
                continue;
            }
            bytes += cost;
            chosen.push_back(f);
        }
        if (chosen.empty()) return full;
        refineFaces(chosen, options.isFitted);
    }
}

std::vector<size_t> FaceSet::tooCoarse() const {
    std::vector<std::vector<size_t>> found(scene.instances.size());
    tbb::parallel_for(size_t(0), found.size(), [&](size_t i) {
        const Unknowns unknowns = unknownsOf(scene, i, facesOf(i));
        std::vector<double> spacings(surfaceOf(i).triangles.size(), HUGE_VAL);  // m, where samples and not just the mesh made them
        const auto spacing = [](const Face& face) { return std::sqrt(2 * face.area) / aperturaLatticeSteps(std::max(face.level, 1)); };
        std::vector<int> levels(spacings.size(), 0);
        for (const Face& face : facesOf(i)) {
            levels[face.triangle] = face.level;
            if (face.level > 1) spacings[face.triangle] = spacing(face);
        }
        for (size_t f = firstFace[i]; f < firstFace[i + 1]; ++f) {
            const Face& face = faces[f];
            if (face.open == 0 || face.level == APERTURA_MAX_LATTICE_LEVEL) continue;
            for (int e = 0; e < 3; ++e) {
                const int64_t other = unknowns.across(face.triangle, e);
                if (other >= 0 && face.level + 1 < levels[size_t(other)] && spacing(face) > 2 * spacings[size_t(other)]) {
                    found[i].push_back(f);
                    break;
                }
            }
        }
    });
    std::vector<size_t> out;
    for (const auto& own : found) out.insert(out.end(), own.begin(), own.end());
    return out;
}

void FaceSet::shareErrors() {
    double sum[APERTURA_MAX_LATTICE_LEVEL + 1]{}, area[APERTURA_MAX_LATTICE_LEVEL + 1]{};
    for (const Face& face : faces)
        if (!isBlind(face)) sum[face.level] += total(face.measured) * face.area, area[face.level] += face.area;
    for (Face& face : faces) {
        face.error = total(face.measured);
        if (!(area[face.level] > 0)) continue;
        const auto seeing = double(std::count_if(face.witnesses.begin(), face.witnesses.end(), [](const Probe& p) { return !p.buried; }));
        face.error = (seeing * face.error + kShared * sum[face.level] / area[face.level]) / (seeing + kShared);
    }
}

}  // namespace apertura
