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

const AperturaFloat APERTURA_PI = AperturaFloat(3.14159265358979);

// A unit tangent to `normal` (unit): Duff et al., "Building an Orthonormal Basis, Revisited", 2017. The second tangent is
// cross(normal, tangent).
APERTURA_FN AperturaVec3 aperturaTangentTo(AperturaVec3 normal) {
    AperturaFloat side = normal.z < AperturaFloat(0.0) ? -AperturaFloat(1.0) : AperturaFloat(1.0);
    AperturaFloat a = -AperturaFloat(1.0) / (side + normal.z);
    return AperturaVec3(AperturaFloat(1.0) + side * normal.x * normal.x * a, side * normal.x * normal.y * a, -side * normal.x);
}

// A light of uniform radiance that fills the cap {w : dot(w, axis) >= cos(radius)}, radius 0..pi/2. aperturaCapLight computes
// what the formulas need of its size once per light, not per pixel.
struct APERTURA_STD140 AperturaCapLight {
    AperturaVec3 axis;            // unit, towards the light's centre
    AperturaFloat sinRadius;      // 0..1
    AperturaFloat height;         // 1 - cos(radius), 0..1
    AperturaFloat area;           // pi sinRadius^2: E of a light overhead
    AperturaFloat rim;            // aperturaRimOf(sinRadius).x, for aperturaHorizonCosine
    AperturaFloat rimSlope;       // aperturaRimOf(sinRadius).y
    AperturaFloat angle;          // aperturaPseudoAngle(height)
    AperturaFloat inverseAngle;   // 1 / angle
    AperturaFloat inverseSin;     // 1 / sinRadius
    AperturaFloat inverseHeight;  // 1 / height
    AperturaFloat shrink;         // for aperturaLobeOverMedium (soft.glsl)
    AperturaFloat spread;         // for aperturaLobeOverMedium
    AperturaFloat axialWeight;    // for aperturaCovariance (edges.glsl)
};

// A cap's height 1 - cos(radius) from sin(radius), for radii up to pi/2, without cancellation.
APERTURA_FN AperturaFloat aperturaHeightFromSin(AperturaFloat sinRadius) {
    return sinRadius * sinRadius / (AperturaFloat(1.0) + sqrt(max(AperturaFloat(1.0) - sinRadius * sinRadius, AperturaFloat(0.0))));
}

// aperturaPseudoAngle over the root of the height. Fitted with the law of overlaps: tools/fit/overlap.cpp.
APERTURA_FN AperturaFloat aperturaPseudoAngleOverRoot(AperturaFloat height) {
    return AperturaFloat(1.4038) + AperturaFloat(0.2180) * height;
}

// The radius of a cap from its height, without trigonometry. Within 4 % for radii up to 145 degrees, 17 % short at 180.
// Apertures, lights and the distance between them use the same law, so that its error cancels.
APERTURA_FN AperturaFloat aperturaPseudoAngle(AperturaFloat height) { return sqrt(height) * aperturaPseudoAngleOverRoot(height); }

// How far a light of sine radius s reaches over the horizon. x: its rim, which aperturaHorizonCosine squares; y: the slope of the
// rim by the cosine between the light's axis and the normal. Fitted: tools/fit/rim.cpp.
APERTURA_FN AperturaVec2 aperturaRimOf(AperturaFloat s) {
    AperturaFloat s2 = s * s;
    AperturaFloat k = sqrt(s) * (AperturaFloat(0.45902) + AperturaFloat(0.06219) * s2 + AperturaFloat(0.07244) * s2 * s2);
    return AperturaVec2(
        k, k * (AperturaFloat(1.12786) - AperturaFloat(0.23844) * s2 - AperturaFloat(0.01434) * s2 * s2) / max(s, aperturaSmall(1e-6)));
}

// `towards`: to the light, any length; zero gives a zero axis. `sinRadius`: 0..1. Shrink and spread are fitted: tools/fit/medium.cpp.
APERTURA_FN AperturaCapLight aperturaCapLight(AperturaVec3 towards, AperturaFloat sinRadius) {
    AperturaVec3 axis = towards * inversesqrt(max(dot(towards, towards), aperturaSmall(1e-30)));
    AperturaFloat height = aperturaHeightFromSin(sinRadius);
    AperturaFloat angle = aperturaPseudoAngle(height);
    AperturaVec2 rim = aperturaRimOf(sinRadius);
    AperturaFloat bulge = height / max(sinRadius, aperturaSmall(1e-9));
    return AperturaCapLight(axis, sinRadius, height, APERTURA_PI * sinRadius * sinRadius, rim.x, rim.y, angle,
                            AperturaFloat(1.0) / max(angle, aperturaSmall(1e-9)), AperturaFloat(1.0) / max(sinRadius, aperturaSmall(1e-9)),
                            AperturaFloat(1.0) / max(height, aperturaSmall(1e-18)), AperturaFloat(1.0) - AperturaFloat(0.5449) * height,
                            AperturaFloat(0.5769) * sinRadius * sinRadius, AperturaFloat(1.0) - AperturaFloat(0.3333) * bulge * bulge);
}

// The cap that a sphere of `radius` metres fills, with its centre at `toCentre`, metres from the receiver. From inside
// the sphere, the light is a hemisphere.
APERTURA_FN AperturaCapLight aperturaCapOfSphere(AperturaVec3 toCentre, AperturaFloat radius) {
    AperturaFloat inverseDistance = inversesqrt(max(dot(toCentre, toCentre), aperturaSmall(1e-20)));
    return aperturaCapLight(toCentre * inverseDistance, min(radius * inverseDistance, AperturaFloat(1.0)));
}

// E / area of an unblocked cap light, cut by the receiver's horizon. `z`: dot(normal, axis). Within 0.001 (0.00025 RMS)
// of the closed form for radii up to 45 degrees, and never more than 1.006 for larger ones.
APERTURA_FN AperturaFloat aperturaHorizonCosine(AperturaFloat z, AperturaFloat rim, AperturaFloat rimSlope) {
    AperturaFloat below = max(rim - rimSlope * abs(z), AperturaFloat(0.0));
    return max(z, AperturaFloat(0.0)) + below * below;
}

// E of an unblocked cap light on a surface with `normal`.
APERTURA_FN AperturaFloat aperturaIrradianceAboveHorizon(AperturaVec3 normal, AperturaCapLight light) {
    return light.area * aperturaHorizonCosine(dot(normal, light.axis), light.rim, light.rimSlope);
}

// Classes of lights by the largest radius. The class is a specialisation constant, so that a shader pays only for the
// lights it has.
const int APERTURA_LIGHTS_ANY = 0;     // radii up to 45 degrees
const int APERTURA_LIGHTS_MEDIUM = 1;  // up to 10 degrees: the horizon may cut a light, but does not move its centre
const int APERTURA_LIGHTS_SMALL = 2;   // up to 3 degrees: a flat disc; the horizon cuts it at its centre
const int APERTURA_LIGHTS_SUN = 3;     // up to 0.6 degrees: a point for lobes, whose edges are wider than the light

// E of an unblocked cap light, by the cheapest formula that is accurate for its class.
APERTURA_FN AperturaFloat aperturaUnoccludedIrradiance(AperturaVec3 normal, AperturaCapLight light, int lightClass) {
    if (lightClass >= APERTURA_LIGHTS_SMALL) return light.area * max(dot(normal, light.axis), AperturaFloat(0.0));
    return aperturaIrradianceAboveHorizon(normal, light);
}

#endif
