// Directions, lights as spherical caps, and the irradiance of one that nothing blocks. GLSL and C++ (through
// sh/shading.h) both include this text, so that the tests check the number the shader computes.
//
// Conventions of every text in this folder: directions are unit vectors that point away from the
// receiver; E is irradiance for unit radiance (W/m2 per W/m2/sr), never divided by pi.
#ifndef APERTURA_CAP_GLSL
#define APERTURA_CAP_GLSL
#ifndef APERTURA_FN
#define APERTURA_FN
#define APERTURA_STD140  // in C++, structs in buffers are aligned as std140 has them
#endif
#ifndef APERTURA_CPP
#include "precision.glsl"
#endif

const lpfloat PI = lpfloat(3.14159265358979);

// A tangent to `normal`: Duff et al., "Building an Orthonormal Basis, Revisited",
// 2017. The second tangent is cross(normal, tangent).
APERTURA_FN lpvec3 tangentTo(lpvec3 normal) {
    lpfloat side = normal.z < lpfloat(0.0) ? -lpfloat(1.0) : lpfloat(1.0);
    lpfloat a = -lpfloat(1.0) / (side + normal.z);
    return lpvec3(lpfloat(1.0) + side * normal.x * normal.x * a, side * normal.x * normal.y * a, -side * normal.x);
}

// A light of uniform radiance that fills the cap {w : dot(w, axis) >= cos(radius)}, radius <= pi/2, with what
// the formulas need of its size: made once a light by capLight, not once a pixel.
struct APERTURA_STD140 CapLight {
    lpvec3 axis;        // unit, towards the light's centre
    lpfloat sinRadius;  // 0..1
    lpfloat height;     // 1 - cos(radius), 0..1
    lpfloat area;       // pi sinRadius^2: E of a light overhead
    lpfloat rim;        // see horizonCosine
    lpfloat rimSlope;
    lpfloat angle;  // pseudoAngle(height), and 1 over it
    lpfloat inverseAngle;
    lpfloat inverseSin;     // 1 over sinRadius
    lpfloat inverseHeight;  // 1 over height
    lpfloat shrink;         // see lobeOverMedium (soft.glsl)
    lpfloat spread;         // see lobeOverMedium
    lpfloat axialWeight;    // see covariance (edges.glsl)
};

// A cap's height 1 - cos(radius) from sin(radius), for radii up to pi/2, without cancellation.
APERTURA_FN lpfloat heightFromSin(lpfloat sinRadius) {
    return sinRadius * sinRadius / (lpfloat(1.0) + sqrt(max(lpfloat(1.0) - sinRadius * sinRadius, lpfloat(0.0))));
}

// An angle from the height of its cap, without trigonometry. Within 4 %.
// The same law for an aperture, a light and the distance between them, so that its error cancels.
APERTURA_FN lpfloat pseudoAngle(lpfloat height) { return sqrt(height) * (lpfloat(1.3946) + lpfloat(0.233) * height); }

// How far a light of sine radius s laps over the horizon: its rim, which horizonCosine squares, and the rim's
// slope by the cosine of the light's height.
APERTURA_FN lpvec2 rimOf(lpfloat s) {
    lpfloat s2 = s * s;
    lpfloat k = sqrt(s) * (lpfloat(0.4595) + lpfloat(0.0607) * s2 + lpfloat(0.0732) * s2 * s2);
    return lpvec2(k, k * (lpfloat(1.1268) - lpfloat(0.2418) * s2 - lpfloat(0.012) * s2 * s2) / max(s, lpsmall(1e-6)));
}

// `towards`: of any length; of none, the light shines from nowhere.
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

// The light of a sphere of `radius` metres whose centre lies `toCentre` metres from the receiver.
// From inside the sphere it is a half-space of light.
APERTURA_FN CapLight capOfSphere(lpvec3 toCentre, lpfloat radius) {
    lpfloat inverseDistance = inversesqrt(max(dot(toCentre, toCentre), lpsmall(1e-20)));
    return capLight(toCentre * inverseDistance, min(radius * inverseDistance, lpfloat(1.0)));
}

// E / area of an unblocked cap light at cosine z = dot(normal, axis), cut by the receiver's horizon. Within
// 0.001 (0.00025 RMS) of the closed form for radii up to 45 degrees, and never more than 1.006 for larger ones.
APERTURA_FN lpfloat horizonCosine(lpfloat z, lpfloat rim, lpfloat rimSlope) {
    lpfloat below = max(rim - rimSlope * abs(z), lpfloat(0.0));
    return max(z, lpfloat(0.0)) + below * below;
}

// E of an unblocked cap light on a surface with `normal`.
APERTURA_FN lpfloat irradianceAboveHorizon(lpvec3 normal, CapLight light) {
    return light.area * horizonCosine(dot(normal, light.axis), light.rim, light.rimSlope);
}

// What a shader may take for granted of its lights: a specialisation constant, so that each pays only for
// its own.
const int LIGHTS_ANY = 0;     // radii up to 45 degrees
const int LIGHTS_MEDIUM = 1;  // up to 10 degrees: what the horizon leaves of a light does not move its centre
const int LIGHTS_SMALL = 2;   // up to 3 degrees: a flat disc, and a horizon that cuts at its centre
const int LIGHTS_SUN = 3;     // up to 0.6 degrees: edges of lobes are softer than the light is wide

// E of an unblocked cap light, by the cheapest formula that is right for its class.
APERTURA_FN lpfloat unoccludedIrradiance(lpvec3 normal, CapLight light, int lightClass) {
    if (lightClass >= LIGHTS_SMALL) return light.area * max(dot(normal, light.axis), lpfloat(0.0));
    return irradianceAboveHorizon(normal, light);
}

#endif
