#pragma once
// The triangles of a scene while it is decided how finely each is sampled.
#include <oneapi/tbb/parallel_for.h>

#include "apertura/bake/fit/face_equations.h"
#include "apertura/bake/fit/faces.h"

namespace apertura {

constexpr int kUnseenPoints = 3000;  // over the surface, from which what is left of the error is estimated

// Points that took no part in choosing samples.
struct UnseenPoints {
    std::vector<std::pair<size_t, Probe>> points;  // the face of each, of FaceSet::faces
    SquaredErrors errors;                          // the means over those that are not buried
};

struct FaceSet {  // must not outlive what it refers to
    const Scene& scene;
    const Prober& prober;
    const BakedVisibility& vertices;  // what these see
    uint32_t seed;
    std::vector<Face> faces;        // by instance and triangle; those without area are left out
    std::vector<size_t> firstFace;  // of each instance, and the end
    FaceReport report;
    Judge judge;
    double skyWeight = 1;
    bool isMixed = true;  // see FaceOptions
    double meanArea = 1;  // of a face, m2

    const Surface& surfaceOf(size_t instance) const { return scene.surfaces[size_t(scene.instances[instance].surface)]; }
    std::span<const Face> facesOf(size_t instance) const {
        return std::span(faces).subspan(firstFace[instance], firstFace[instance + 1] - firstFace[instance]);
    }
    double total(const SquaredErrors& e) const { return e.light + skyWeight * e.sky; }
    bool isWithin(const SquaredErrors& e, double tolerance) const {  // as means over many points are, whose noise may outweigh either
        return std::max(e.light, 0.0) + skyWeight * std::max(e.sky, 0.0) <= tolerance * tolerance;
    }

    // The mean squared errors at a face's witnesses of what the renderer makes of `samples`, those of its lattice or its three corners.
    // `first`: the number of the first of them, by which lights are turned about it.
    SquaredErrors errorsOf(const Face& face, std::span<const Visibility> samples, size_t first = 0) const;

    // Adds probes and witnesses until the face has so many.
    void addProbes(Face& face, size_t probes, size_t witnesses) const;

    // Adds witnesses to a face of which a part is buried until one is not, if it may have one.
    void seekWitness(Face& face) const;

    // No witness of the face can see.
    static bool isBlind(const Face& face);

    // Sets a face's error and tie as they are if its lattice is fitted alone.
    void fitAlone(Face& face, bool mayTie) const;

    // The errors of faces as they stand: of all of them or, where only those in `refined` have changed since they were measured last, of
    // these and of what touches them.
    void measure(std::span<const size_t> refined = {});

    // New points over the surface, and what is stored errs there.
    //   stored  as Faces::fit returns it
    //   count   at most kUnseenPoints
    //   batch   of points: each number has its own
    UnseenPoints atUnseenPoints(const BakedVisibility& stored, int count, int batch) const;

    // Makes such points witnesses of the faces that they lie on, and measures these again.
    void addWitnesses(const UnseenPoints& unseen);

    // Refines each of the faces, by their numbers, by one level, and fits each alone. `mayTie`: see FaceOptions::isFitted.
    void refineFaces(std::span<const size_t> which, bool mayTie);

    // Bytes that a face takes more when it is refined.
    static double costOf(const Face& face, const FaceOptions& options);

    // Refines faces that have less than half the steps of those they meet smoothly, on the edge and by area: where fine samples end at
    // coarse ones, the straight edge between them shows, and few witnesses may have made light of a face that is like its neighbours.
    // Returns whether bytes kept one from it.
    bool grade(const FaceOptions& options, double bytes, const Progress& progress);

    // Fits the faces of an instance together, and calls use(face, samples) for each that isWanted(face).
    void fitTogether(size_t instance, const auto& isWanted, const auto& use, const auto& useVertices) const {
        const Unknowns unknowns = unknownsOf(scene, instance, facesOf(instance));
        const std::vector<Visibility> values =
            equationsOf(unknowns, facesOf(instance), surfaceOf(instance), vertices[instance].visibility).solve();
        tbb::parallel_for(firstFace[instance], firstFace[instance + 1], [&](size_t f) {
            if (!isWanted(f)) return;
            const Face& face = faces[f];
            std::vector<Visibility> samples;
            const int count = face.level ? samplesOn(face.level) : 3;
            samples.reserve(size_t(count));
            for (int i = 0; i < count; ++i) samples.push_back(sumOf(unknowns.sample(face.triangle, i), values));
            use(f, samples);
        });
        useVertices(unknowns, values);
    }

private:
    // A face's error with its lattice fitted alone, neighbours drawn together by `tie`.
    double ownError(const Face& face, float tie) const;
    // The faces that grade() refines next.
    std::vector<size_t> tooCoarse() const;
    // What few witnesses say is drawn towards what all faces of the level err: of those that were left as they are, most were so because
    // their witnesses happened to see little. A face without a witness is thought to err as the others do.
    void shareErrors();
};

}  // namespace apertura
