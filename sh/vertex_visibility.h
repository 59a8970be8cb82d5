#pragma once
#include "sh/aperture.h"
#include "sh/soft.h"

namespace apertura {

// What a vertex buffer holds: all the forms of one point's visibility that the models read, made once at
// load. The rasteriser interpolates it; interpolatedReceiver (shaders/models.glsl) reads it. 48 bytes.
struct VertexVisibility {
    vec4 visibility;  // D (sr), A (sr)
    vec4 aperture;    // axis, height
    vec4 soft;        // slope, offset
};

inline VertexVisibility toVertex(const Visibility& v, const vec3& normal) {
    const Aperture a = toAperture(v, normal);
    const SoftAperture s = toSoft(v, normal);
    return {vec4(v.direction, v.area), vec4(a.axis, a.height), vec4(s.slope, s.offset)};
}

inline Receiver toReceiver(const VertexVisibility& v, const vec3& normal) {
    return interpolatedReceiver(normal, v.visibility, v.aperture, v.soft);
}

}  // namespace apertura
