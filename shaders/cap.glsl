// Directions, lights as spherical caps, and the irradiance of a cap light that nothing blocks. GLSL and C++ (through
// sh/shading.h) both include this text, so the tests check the numbers that a shader computes.
//
// Conventions of all files in this folder: directions are unit vectors that point away from the receiver; E is irradiance
// for unit radiance (W/m2 per W/m2/sr), never divided by pi; r is a light's radius.
#ifndef APERTURA_CAP_GLSL
#define APERTURA_CAP_GLSL
#ifndef APERTURA_FN
#define APERTURA_FN
#define APERTURA_STD140  // in C++: the alignment of structs in buffers, as in std140
#endif
#ifndef APERTURA_CPP
#include "precision.glsl"
#endif

const lpfloat PI = lpfloat(3.14159265358979);

// A unit tangent to `normal` (unit): Duff et al., "Building an Orthonormal Basis, Revisited", 2017. The second tangent is
// cross(normal, tangent).
APERTURA_FN lpvec3 tangentTo(lpvec3 normal) {
    lpfloat side = normal.z < lpfloat(0.0) ? -lpfloat(1.0) : lpfloat(1.0);
    lpfloat a = -lpfloat(1.0) / (side + normal.z);
    return lpvec3(lpfloat(1.0) + side * normal.x * normal.x * a, side * normal.x * normal.y * a, -side * normal.x);
}

// A light of uniform radiance that fills the cap {w : dot(w, axis) >= cos(radius)}, radius 0..pi/2. capLight computes
// what the formulas need of its size once per light, not per pixel.
struct APERTURA_STD140 CapLight {
    lpvec3 axis;            // unit, towards the light's centre
    lpfloat sinRadius;      // 0..1
    lpfloat height;         // 1 - cos(radius), 0..1
    lpfloat area;           // pi sinRadius^2: E of a light overhead
    lpfloat rim;            // rimOf(sinRadius).x, for horizonCosine
    lpfloat rimSlope;       // rimOf(sinRadius).y
    lpfloat angle;          // pseudoAngle(height)
    lpfloat inverseAngle;   // 1 / angle
    lpfloat inverseSin;     // 1 / sinRadius
    lpfloat inverseHeight;  // 1 / height
    lpfloat shrink;         // for lobeOverMedium (soft.glsl)
    lpfloat spread;         // for lobeOverMedium
    lpfloat axialWeight;    // for covariance (edges.glsl)
};

// A cap's height 1 - cos(radius) from sin(radius), for radii up to pi/2, without cancellation.
APERTURA_FN lpfloat heightFromSin(lpfloat sinRadius) {
    return sinRadius * sinRadius / (lpfloat(1.0) + sqrt(max(lpfloat(1.0) - sinRadius * sinRadius, lpfloat(0.0))));
}

// The radius of a cap from its height, without trigonometry. Within 4 % for radii up to 148 degrees, 16 % short at 180.
// Apertures, lights and the distance between them use the same law, so that its error cancels.
APERTURA_FN lpfloat pseudoAngle(lpfloat height) { return sqrt(height) * (lpfloat(1.3946) + lpfloat(0.233) * height); }

// How far a light of sine radius s reaches over the horizon. x: its rim, which horizonCosine squares; y: the slope of the
// rim by the cosine between the light's axis and the normal.
APERTURA_FN lpvec2 rimOf(lpfloat s) {
    lpfloat s2 = s * s;
    lpfloat k = sqrt(s) * (lpfloat(0.4595) + lpfloat(0.0607) * s2 + lpfloat(0.0732) * s2 * s2);
    return lpvec2(k, k * (lpfloat(1.1268) - lpfloat(0.2418) * s2 - lpfloat(0.012) * s2 * s2) / max(s, lpsmall(1e-6)));
}

// `towards`: to the light, any length; zero gives a zero axis. `sinRadius`: 0..1.
APERTURA_FN CapLight capLight(lpvec3 towards, lpfloat sinRadius) {
    lpvec3 axis = towards * inversesqrt(max(dot(towards, towards), lpsmall(1e-30)));
    lpfloat height = heightFromSin(sinRadius);
    lpfloat angle = pseudoAngle(height);
    lpvec2 rim = rimOf(sinRadius);
    lpfloat bulge = height / max(sinRadius, lpsmall(1e-9));
    return CapLight(axis, sinRadius, height, PI * sinRadius * sinRadius, rim.x, rim.y, angle, lpfloat(1.0) / max(angle, lpsmall(1e-9)),
                    lpfloat(1.0) / max(sinRadius, lpsmall(1e-9)), lpfloat(1.0) / max(height, lpsmall(1e-18)),
                    lpfloat(1.0) - lpfloat(0.346) * height, lpfloat(0.62) * sinRadius * sinRadius,
                    lpfloat(1.0) - lpfloat(0.3333) * bulge * bulge);
}

// The cap that a sphere of `radius` metres fills, with its centre at `toCentre`, metres from the receiver. From inside
// the sphere, the light is a hemisphere.
APERTURA_FN CapLight capOfSphere(lpvec3 toCentre, lpfloat radius) {
    lpfloat inverseDistance = inversesqrt(max(dot(toCentre, toCentre), lpsmall(1e-20)));
    return capLight(toCentre * inverseDistance, min(radius * inverseDistance, lpfloat(1.0)));
}

// E / area of an unblocked cap light, cut by the receiver's horizon. `z`: dot(normal, axis). Within 0.001 (0.00025 RMS)
// of the closed form for radii up to 45 degrees, and never more than 1.006 for larger ones.
APERTURA_FN lpfloat horizonCosine(lpfloat z, lpfloat rim, lpfloat rimSlope) {
    lpfloat below = max(rim - rimSlope * abs(z), lpfloat(0.0));
    return max(z, lpfloat(0.0)) + below * below;
}

// E of an unblocked cap light on a surface with `normal`.
APERTURA_FN lpfloat irradianceAboveHorizon(lpvec3 normal, CapLight light) {
    return light.area * horizonCosine(dot(normal, light.axis), light.rim, light.rimSlope);
}

// Classes of lights by the largest radius. The class is a specialisation constant, so that a shader pays only for the
// lights it has.
const int LIGHTS_ANY = 0;     // radii up to 45 degrees
const int LIGHTS_MEDIUM = 1;  // up to 10 degrees: the horizon may cut a light, but does not move its centre
const int LIGHTS_SMALL = 2;   // up to 3 degrees: a flat disc; the horizon cuts it at its centre
const int LIGHTS_SUN = 3;     // up to 0.6 degrees: a point for lobes, whose edges are wider than the light

// E of an unblocked cap light, by the cheapest formula that is accurate for its class.
APERTURA_FN lpfloat unoccludedIrradiance(lpvec3 normal, CapLight light, int lightClass) {
    if (lightClass >= LIGHTS_SMALL) return light.area * max(dot(normal, light.axis), lpfloat(0.0));
    return irradianceAboveHorizon(normal, light);
}

#endif
