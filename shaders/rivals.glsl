// RIVALS: what others make of baked visibility, by the formulas of their own authors. Where an author has no light but a point, the
// light's disc is added in the way that costs him least. GLSL and C++ include this text.
#ifndef APERTURA_RIVALS_GLSL
#define APERTURA_RIVALS_GLSL
#include "harmonics.glsl"
#include "horizon.glsl"

// The cosine-weighted part of the hemisphere that is open, 0..1: what an ambient-occlusion baker writes.
APERTURA_FN lpfloat opennessOf(Receiver receiver) {
    return clamp(dot(receiver.normal, lpvec3(receiver.visibility)) / PI, lpfloat(0.0), lpfloat(1.0));
}

// The mean open direction, unit; the normal where nothing is open.
APERTURA_FN lpvec3 bentNormalOf(Receiver receiver) {
    lpvec3 d = lpvec3(receiver.visibility);
    lpfloat squared = dot(d, d);
    return squared > lpsmall(1e-8) ? d * inversesqrt(squared) : receiver.normal;
}

// The cosine of the radius of the cone about the bent normal that leaves the openness: the whole hemisphere for 1.
APERTURA_FN lpfloat coneCosine(lpfloat openness) { return sqrt(max(lpfloat(1.0) - openness, lpfloat(0.0))); }

// What XeGTAO's sample does to a light without a shadow map: Intel, XeGTAO 1.30, 2021. `margin`: 0.1 there; 0 without.
APERTURA_FN lpfloat xegtaoVisibility(Receiver receiver, CapLight light, lpfloat margin) {
    lpfloat along = dot(bentNormalOf(receiver), light.axis) + margin;
    return clamp(along / max(coneCosine(opennessOf(receiver)), lpsmall(1e-4)), lpfloat(0.0), lpfloat(1.0));
}

// Micro-shadowing as Filament has it: Chan, "Material Advances in Call of Duty: WWII", 2018.
APERTURA_FN lpfloat microShadow(Receiver receiver, CapLight light) {
    lpfloat cosine = max(coneCosine(opennessOf(receiver)), lpfloat(0.01));
    lpfloat v = clamp(dot(receiver.normal, light.axis) / cosine, lpfloat(0.0), lpfloat(1.0));
    return v * v;
}

// The share of a light inside a cone, by the overlap of Oat & Sander, "Ambient Aperture Lighting", 2007.
APERTURA_FN lpfloat shareInCone(lpvec3 axis, lpfloat cosine, CapLight light) {
    lpfloat cone = capRadius(lpfloat(1.0) - cosine);
    lpfloat radius = capRadius(light.height);
    lpfloat apart = capRadius(clamp(lpfloat(1.0) - dot(axis, light.axis), lpfloat(0.0), lpfloat(2.0)));
    lpfloat inside = abs(cone - radius);
    lpfloat t = clamp(lpfloat(1.0) - (apart - inside) / max(cone + radius - inside, lpsmall(1e-6)), lpfloat(0.0), lpfloat(1.0));
    lpfloat smaller = min(lpfloat(1.0) - cosine, light.height);
    return min(smaller * light.inverseHeight, lpfloat(1.0)) * t * t * (lpfloat(3.0) - lpfloat(2.0) * t);
}

// The overlap of the visibility cone with the light's own: Jimenez, Wu, Pesce & Jarabo, "Practical Real-Time Strategies for Accurate
// Indirect Occlusion", 2016. Of a light that the receiver's own plane cuts, only what is above that counts.
APERTURA_FN lpfloat coneVisibility(Receiver receiver, CapLight light) {
    lpfloat share = shareInCone(bentNormalOf(receiver), coneCosine(opennessOf(receiver)), light);
    if (dot(receiver.normal, light.axis) < light.sinRadius) share /= max(shareInCone(receiver.normal, lpfloat(0.0), light), lpsmall(1e-3));
    return min(share, lpfloat(1.0));
}

// Linear SH and a zonal band 2 about the linear band's axis: Roughton, Sloan, Silvennoinen, Iwanicki & Shirley, "ZH3: Quadratic Zonal
// Harmonics", 2024. `zonal`: the coefficient of Y20 about that axis.
APERTURA_FN lpfloat zonalVisibility(Receiver receiver, CapLight light, lpfloat zonal) {
    lpvec4 blur = capBlur(light.height);
    lpvec3 d = lpvec3(receiver.visibility);
    lpfloat z = dot(bentNormalOf(receiver), light.axis);
    lpfloat v = (receiver.visibility.w + lpfloat(3.0) * blur.x * dot(d, light.axis)) / (lpfloat(4.0) * PI);
    v += blur.y * zonal * (lpfloat(0.9461747) * z * z - lpfloat(0.3153916));
    return clamp(v, lpfloat(0.0), lpfloat(1.0));
}

// Their guess at that coefficient from the two bands alone.
APERTURA_FN lpfloat guessedZonal(Receiver receiver) {
    lpvec3 d = lpvec3(receiver.visibility);
    lpfloat dc = lpfloat(0.2820948) * receiver.visibility.w;
    lpfloat ratio = lpfloat(1.7320508) * sqrt(dot(d, d)) / max(receiver.visibility.w, lpsmall(1e-6));
    return dc * ratio * (lpfloat(0.08) + lpfloat(0.6) * ratio);
}

// An ambient cube: McTaggart, "Half-Life 2 / Valve Source Shading", 2004. `above`, `below`: along +x, +y, +z and -x, -y, -z.
APERTURA_FN lpvec3 cubeAbove(Receiver receiver) { return lpvec3(receiver.params[0]); }
APERTURA_FN lpvec3 cubeBelow(Receiver receiver) { return lpvec3(receiver.params[0].w, receiver.params[1].x, receiver.params[1].y); }

// The mean over the light: exact in the squares; the change from one side to the other is linear across the light.
APERTURA_FN lpfloat cubeVisibility(Receiver receiver, CapLight light) {
    lpvec3 even = lpfloat(0.5) * (cubeAbove(receiver) + cubeBelow(receiver));
    lpvec3 odd = lpfloat(0.5) * (cubeAbove(receiver) - cubeBelow(receiver));
    lpvec3 third = lpvec3(lpfloat(1.0) / lpfloat(3.0));
    lpvec3 square = third + capBlur(light.height).y * (light.axis * light.axis - third);
    lpvec3 side = clamp(light.axis * light.inverseSin, lpvec3(-lpfloat(1.0)), lpvec3(lpfloat(1.0)));
    return clamp(dot(square, even + side * odd), lpfloat(0.0), lpfloat(1.0));
}

// E of a sky of unit radiance. Exact: of the cube's SH bands, the cosine sees 0, 1 and 2 alone.
APERTURA_FN lpfloat skyThroughCube(Receiver receiver) {
    lpvec3 n = receiver.normal;
    lpvec3 even = lpfloat(0.5) * (cubeAbove(receiver) + cubeBelow(receiver));
    lpvec3 odd = lpfloat(0.5) * (cubeAbove(receiver) - cubeBelow(receiver));
    lpvec3 third = lpvec3(lpfloat(1.0) / lpfloat(3.0));
    return max(PI * dot(even, third) + lpfloat(0.25) * PI * dot(even, n * n - third) + lpfloat(0.5) * PI * dot(n, odd), lpfloat(0.0));
}

// Sectors of the hemisphere as bits: `rings` of equal solid angle about the normal, from it down, with 2 * rings sectors each, counter-
// clockwise from azimuthZero(normal). Seven bits to a component of a slot.
const int SECTOR_BITS = 7;
APERTURA_FN int sectorAt(int rings, lpfloat x, lpfloat y, lpfloat z) {
    int ring = clamp(int((lpfloat(1.0) - z) * lpfloat(rings)), 0, rings - 1);
    lpfloat turn = azimuthOf(x, y) * lpfloat(rings) / PI;
    int sector = int(turn < lpfloat(0.0) ? turn + lpfloat(2 * rings) : turn);
    return ring * 2 * rings + (sector & (2 * rings - 1));
}
APERTURA_FN lpfloat sectorIsOpen(Receiver receiver, int rings, int sector) {
    int place = sector / SECTOR_BITS;
    int bits = int(numberOf(receiver, 2 * rings * rings / SECTOR_BITS + 1, place) + lpfloat(0.5));
    return lpfloat((bits >> (sector - place * SECTOR_BITS)) & 1);
}

// The mean of the sectors over the light's disc: at its centre for a sun, else at eight points.
APERTURA_FN lpfloat sectorVisibility(Receiver receiver, int rings, CapLight light, int lightClass) {
    lpvec3 tangent = azimuthZero(receiver.normal);
    lpvec3 side = cross(receiver.normal, tangent);
    lpvec3 at = lpvec3(dot(tangent, light.axis), dot(side, light.axis), dot(receiver.normal, light.axis));
    if (lightClass == LIGHTS_SUN) return sectorIsOpen(receiver, rings, sectorAt(rings, at.x, at.y, at.z));
    lpvec3 across = tangentTo(at);
    lpvec3 up = cross(at, across);
    lpfloat sum = lpfloat(0.0);
    lpfloat weights = lpfloat(0.0);
    for (int i = 0; i < 8; ++i) {
        lpfloat turn = lpfloat(2.399963) * lpfloat(i);
        lpfloat reach = light.sinRadius * sqrt((lpfloat(i) + lpfloat(0.5)) / lpfloat(8.0));
        lpvec3 w = sqrt(max(lpfloat(1.0) - reach * reach, lpfloat(0.0))) * at + reach * (cos(turn) * across + sin(turn) * up);
        lpfloat weight = max(w.z, lpfloat(0.0));
        sum += weight * sectorIsOpen(receiver, rings, sectorAt(rings, w.x, w.y, w.z));
        weights += weight;
    }
    return sum / max(weights, lpsmall(1e-6));
}

#endif
