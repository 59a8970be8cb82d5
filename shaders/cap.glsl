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

const float PI = 3.14159265358979f;

// A tangent to `normal`: Duff et al., "Building an Orthonormal Basis, Revisited",
// 2017. The second tangent is cross(normal, tangent).
APERTURA_FN vec3 tangentTo(vec3 normal) {
    float side = normal.z < 0.0f ? -1.0f : 1.0f;
    float a = -1.0f / (side + normal.z);
    return vec3(1.0f + side * normal.x * normal.x * a, side * normal.x * normal.y * a, -side * normal.x);
}

// A light of uniform radiance that fills the cap {w : dot(w, axis) >= cos(radius)}, radius <= pi/2, with what
// the formulas need of its size: made once a light by capLight, not once a pixel.
struct APERTURA_STD140 CapLight {
    vec3 axis;            // unit, towards the light's centre
    float sinRadius;      // 0..1
    float height;         // 1 - cos(radius), 0..1
    float area;           // pi sinRadius^2: E of a light overhead
    float rim;            // see horizonCosine
    float rimSlope;
    float angle;          // pseudoAngle(height), and 1 over it
    float inverseAngle;
    float inverseSin;     // 1 over sinRadius
    float inverseHeight;  // 1 over height
    float shrink;         // see lobeOverMedium (soft.glsl)
    float spread;         // see lobeOverMedium
    float axialWeight;    // see covariance (edges.glsl)
};

// A cap's height 1 - cos(radius) from sin(radius), for radii up to pi/2, without cancellation.
APERTURA_FN float heightFromSin(float sinRadius) {
    return sinRadius * sinRadius / (1.0f + sqrt(max(1.0f - sinRadius * sinRadius, 0.0f)));
}

// An angle from the height of its cap, without trigonometry. Within 4 %.
// The same law for an aperture, a light and the distance between them, so that its error cancels.
APERTURA_FN float pseudoAngle(float height) { return sqrt(height) * (1.3946f + 0.233f * height); }

// How far a light of sine radius s laps over the horizon: its rim, which horizonCosine squares, and the rim's
// slope by the cosine of the light's height.
APERTURA_FN vec2 rimOf(float s) {
    float s2 = s * s;
    float k = sqrt(s) * (0.4595f + 0.0607f * s2 + 0.0732f * s2 * s2);
    return vec2(k, k * (1.1268f - 0.2418f * s2 - 0.012f * s2 * s2) / max(s, 1e-6f));
}

// `towards`: of any length; of none, the light shines from nowhere.
APERTURA_FN CapLight capLight(vec3 towards, float sinRadius) {
    vec3 axis = towards * inversesqrt(max(dot(towards, towards), 1e-30f));
    float height = heightFromSin(sinRadius);
    float angle = pseudoAngle(height);
    vec2 rim = rimOf(sinRadius);
    float bulge = height / max(sinRadius, 1e-9f);
    return CapLight(axis, sinRadius, height, PI * sinRadius * sinRadius, rim.x, rim.y, angle, 1.0f / max(angle, 1e-9f),
                    1.0f / max(sinRadius, 1e-9f), 1.0f / max(height, 1e-18f), 1.0f - 0.346f * height, 0.62f * sinRadius * sinRadius,
                    1.0f - 0.3333f * bulge * bulge);
}

// The light of a sphere of `radius` metres whose centre lies `toCentre` metres from the receiver.
// From inside the sphere it is a half-space of light.
APERTURA_FN CapLight capOfSphere(vec3 toCentre, float radius) {
    float inverseDistance = inversesqrt(max(dot(toCentre, toCentre), 1e-20f));
    return capLight(toCentre * inverseDistance, min(radius * inverseDistance, 1.0f));
}

// E / area of an unblocked cap light at cosine z = dot(normal, axis), cut by the receiver's horizon. Within
// 0.001 (0.00025 RMS) of the closed form for radii up to 45 degrees, and never more than 1.006 for larger ones.
APERTURA_FN float horizonCosine(float z, float rim, float rimSlope) {
    float below = max(rim - rimSlope * abs(z), 0.0f);
    return max(z, 0.0f) + below * below;
}

// E of an unblocked cap light on a surface with `normal`.
APERTURA_FN float irradianceAboveHorizon(vec3 normal, CapLight light) {
    return light.area * horizonCosine(dot(normal, light.axis), light.rim, light.rimSlope);
}

// What a shader may take for granted of its lights: a specialisation constant, so that each pays only for
// its own.
const int LIGHTS_ANY = 0;     // radii up to 45 degrees
const int LIGHTS_MEDIUM = 1;  // up to 10 degrees: what the horizon leaves of a light does not move its centre
const int LIGHTS_SMALL = 2;   // up to 3 degrees: a flat disc, and a horizon that cuts at its centre
const int LIGHTS_SUN = 3;     // up to 0.6 degrees: edges of lobes are softer than the light is wide

// E of an unblocked cap light, by the cheapest formula that is right for its class.
APERTURA_FN float unoccludedIrradiance(vec3 normal, CapLight light, int lightClass) {
    if (lightClass >= LIGHTS_SMALL) return light.area * max(dot(normal, light.axis), 0.0f);
    return irradianceAboveHorizon(normal, light);
}

#endif
