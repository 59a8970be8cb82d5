#pragma once
// Where visibility is stored: at vertices, and on the faces that they do not suffice for as finely as each one needs.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/sampling/probes.h"

namespace apertura {

struct FaceOptions {
    double tolerance = 0;  // RMSE of E / (L pi sin^2 r), a light of 5 degrees, by which interpolation may differ from what the model has at
                           // the point itself
    double skyTolerance = 0;                      // and RMSE of the sky's E over pi
    double maxBytes = 0;                          // of all visibility; 0: no limit
    bool isMixed = true;                          // the model's numbers are mixed between samples; else the light of three samples is
    bool isFitted = true;                         // fit() makes the samples, and may draw neighbours together as strongly as it helps
    double bytesASample = 4, bytesElsewhere = 0;  // what a sample takes, and all that is stored beside samples
};

// What was decided, and at what cost.
struct FaceReport {
    double tolerance = 0;     // what was to be met: RMSE of E / (L pi sin^2 r), a light of 5 degrees,
    double skyTolerance = 0;  // and RMSE of the sky's E over pi
    double error = 0;         // what is left of the two: 0 where it is too little to tell
    double skyError = 0;
    double unmet = 0;       // fraction of the area, buried parts left out, of triangles that err more than the tolerance and are refined no
                            // further
    bool full = false;      // maxBytes kept some faces as they are
    bool overfull = false;  // the vertices alone take more than that
    double buried = 0;      // fraction of the area inside solids
    size_t samples = 0;     // on faces
    size_t rays = 0;        // traced to decide and to bake them; not those of the vertices
};

struct FaceSet;

// The triangles of a scene with their probes, and how finely each is to be sampled.
class Faces {
public:
    // Traces the first probes. `vertices`: what these see. All must outlive it. Of At::Vertices, no face is to have samples. Throws
    // Cancelled.
    Faces(const Scene& scene, const Prober& prober, const BakedVisibility& vertices, At at, uint32_t seed, const Progress& progress);
    ~Faces();

    bool empty() const;  // no triangle has an area

    // Refines triangles, those first where it lowers the error times the area most for a byte, until the options are met. Throws
    // Cancelled.
    void refine(const FaceOptions& options, const Progress& progress);

    // Sets the errors of the report, at new points over the surface: those that samples were chosen by think too well of them.
    //   stored  what `fit` returned, or what was baked in its place
    void judge(const BakedVisibility& stored);

    // Fits the four numbers of all vertices and samples, together over all faces that meet smoothly.
    BakedVisibility fit() const;

    // Bakes samples on faces by a recipe, each from rays that start all around it. `out` has levels and room.
    void bakeSamples(BakedVisibility& out, const OcclusionSource& source, const BakeOptions& options, const Progress& progress) const;

    const FaceReport& report() const;

private:
    std::unique_ptr<FaceSet> set_;
};

}  // namespace apertura
