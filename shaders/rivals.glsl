// RIVALS: what others make of baked visibility, by the formulas of their own authors. Where an author has no light but a point, the
// light's disc is added in the way that costs him least. GLSL and C++ include this text.
#ifndef APERTURA_RIVALS_GLSL
#define APERTURA_RIVALS_GLSL
#include "harmonics.glsl"
#include "horizon.glsl"

// The cosine-weighted part of the hemisphere that is open, 0..1: what an ambient-occlusion baker writes.
APERTURA_FN AperturaFloat aperturaOpennessOf(AperturaReceiver receiver) {
    return clamp(dot(receiver.normal, AperturaVec3(receiver.visibility)) / APERTURA_PI, AperturaFloat(0.0), AperturaFloat(1.0));
}

// The mean open direction, unit; the normal where nothing is open.
APERTURA_FN AperturaVec3 aperturaBentNormalOf(AperturaReceiver receiver) {
    AperturaVec3 d = AperturaVec3(receiver.visibility);
    AperturaFloat squared = dot(d, d);
    return squared > aperturaSmall(1e-8) ? d * inversesqrt(squared) : receiver.normal;
}

// The cosine of the radius of the cone about the bent normal that leaves the openness: the whole hemisphere for 1.
APERTURA_FN AperturaFloat aperturaConeCosine(AperturaFloat openness) {
    return sqrt(max(AperturaFloat(1.0) - openness, AperturaFloat(0.0)));
}

// What XeGTAO's sample does to a light without a shadow map: Intel, XeGTAO 1.30, 2021. `margin`: 0.1 there; 0 without.
APERTURA_FN AperturaFloat aperturaXegtaoVisibility(AperturaReceiver receiver, AperturaCapLight light, AperturaFloat margin) {
    AperturaFloat along = dot(aperturaBentNormalOf(receiver), light.axis) + margin;
    return clamp(along / max(aperturaConeCosine(aperturaOpennessOf(receiver)), aperturaSmall(1e-4)), AperturaFloat(0.0),
                 AperturaFloat(1.0));
}

// Micro-shadowing as Filament has it: Chan, "Material Advances in Call of Duty: WWII", 2018.
APERTURA_FN AperturaFloat aperturaMicroShadow(AperturaReceiver receiver, AperturaCapLight light) {
    AperturaFloat cosine = max(aperturaConeCosine(aperturaOpennessOf(receiver)), AperturaFloat(0.01));
    AperturaFloat v = clamp(dot(receiver.normal, light.axis) / cosine, AperturaFloat(0.0), AperturaFloat(1.0));
    return v * v;
}

// The share of a light inside a cone, by the overlap of Oat & Sander, "Ambient Aperture Lighting", 2007.
APERTURA_FN AperturaFloat aperturaShareInCone(AperturaVec3 axis, AperturaFloat cosine, AperturaCapLight light) {
    AperturaFloat cone = aperturaCapRadius(AperturaFloat(1.0) - cosine);
    AperturaFloat radius = aperturaCapRadius(light.height);
    AperturaFloat apart = aperturaCapRadius(clamp(AperturaFloat(1.0) - dot(axis, light.axis), AperturaFloat(0.0), AperturaFloat(2.0)));
    AperturaFloat inside = abs(cone - radius);
    AperturaFloat t = clamp(AperturaFloat(1.0) - (apart - inside) / max(cone + radius - inside, aperturaSmall(1e-6)), AperturaFloat(0.0),
                            AperturaFloat(1.0));
    AperturaFloat smaller = min(AperturaFloat(1.0) - cosine, light.height);
    return min(smaller * light.inverseHeight, AperturaFloat(1.0)) * t * t * (AperturaFloat(3.0) - AperturaFloat(2.0) * t);
}

// The overlap of the visibility cone with the light's own: Jimenez, Wu, Pesce & Jarabo, "Practical Real-Time Strategies for Accurate
// Indirect Occlusion", 2016. Of a light that the receiver's own plane cuts, only what is above that counts.
APERTURA_FN AperturaFloat aperturaConeVisibility(AperturaReceiver receiver, AperturaCapLight light) {
    AperturaFloat share = aperturaShareInCone(aperturaBentNormalOf(receiver), aperturaConeCosine(aperturaOpennessOf(receiver)), light);
    if (dot(receiver.normal, light.axis) < light.sinRadius)
        share /= max(aperturaShareInCone(receiver.normal, AperturaFloat(0.0), light), aperturaSmall(1e-3));
    return min(share, AperturaFloat(1.0));
}

// Linear SH and a zonal band 2 about the linear band's axis: Roughton, Sloan, Silvennoinen, Iwanicki & Shirley, "ZH3: Quadratic Zonal
// Harmonics", 2024. `zonal`: the coefficient of Y20 about that axis.
APERTURA_FN AperturaFloat aperturaZonalVisibility(AperturaReceiver receiver, AperturaCapLight light, AperturaFloat zonal) {
    AperturaVec4 blur = aperturaCapBlur(light.height);
    AperturaVec3 d = AperturaVec3(receiver.visibility);
    AperturaFloat z = dot(aperturaBentNormalOf(receiver), light.axis);
    AperturaFloat v = (receiver.visibility.w + AperturaFloat(3.0) * blur.x * dot(d, light.axis)) / (AperturaFloat(4.0) * APERTURA_PI);
    v += blur.y * zonal * (AperturaFloat(0.9461747) * z * z - AperturaFloat(0.3153916));
    return clamp(v, AperturaFloat(0.0), AperturaFloat(1.0));
}

// Their guess at that coefficient from the two bands alone.
APERTURA_FN AperturaFloat aperturaGuessedZonal(AperturaReceiver receiver) {
    AperturaVec3 d = AperturaVec3(receiver.visibility);
    AperturaFloat dc = AperturaFloat(0.2820948) * receiver.visibility.w;
    AperturaFloat ratio = AperturaFloat(1.7320508) * sqrt(dot(d, d)) / max(receiver.visibility.w, aperturaSmall(1e-6));
    return dc * ratio * (AperturaFloat(0.08) + AperturaFloat(0.6) * ratio);
}

// An ambient cube: McTaggart, "Half-Life 2 / Valve Source Shading", 2004. `above`, `below`: along +x, +y, +z and -x, -y, -z.
APERTURA_FN AperturaVec3 aperturaCubeAbove(AperturaReceiver receiver) { return AperturaVec3(receiver.params[0]); }
APERTURA_FN AperturaVec3 aperturaCubeBelow(AperturaReceiver receiver) {
    return AperturaVec3(receiver.params[0].w, receiver.params[1].x, receiver.params[1].y);
}

// The mean over the light: exact in the squares; the change from one side to the other is linear across the light.
APERTURA_FN AperturaFloat aperturaCubeVisibility(AperturaReceiver receiver, AperturaCapLight light) {
    AperturaVec3 even = AperturaFloat(0.5) * (aperturaCubeAbove(receiver) + aperturaCubeBelow(receiver));
    AperturaVec3 odd = AperturaFloat(0.5) * (aperturaCubeAbove(receiver) - aperturaCubeBelow(receiver));
    AperturaVec3 third = AperturaVec3(AperturaFloat(1.0) / AperturaFloat(3.0));
    AperturaVec3 square = third + aperturaCapBlur(light.height).y * (light.axis * light.axis - third);
    AperturaVec3 side = clamp(light.axis * light.inverseSin, AperturaVec3(-AperturaFloat(1.0)), AperturaVec3(AperturaFloat(1.0)));
    return clamp(dot(square, even + side * odd), AperturaFloat(0.0), AperturaFloat(1.0));
}

// E of a sky of unit radiance. Exact: of the cube's SH bands, the cosine sees 0, 1 and 2 alone.
APERTURA_FN AperturaFloat aperturaSkyThroughCube(AperturaReceiver receiver) {
    AperturaVec3 n = receiver.normal;
    AperturaVec3 even = AperturaFloat(0.5) * (aperturaCubeAbove(receiver) + aperturaCubeBelow(receiver));
    AperturaVec3 odd = AperturaFloat(0.5) * (aperturaCubeAbove(receiver) - aperturaCubeBelow(receiver));
    AperturaVec3 third = AperturaVec3(AperturaFloat(1.0) / AperturaFloat(3.0));
    return max(APERTURA_PI * dot(even, third) + AperturaFloat(0.25) * APERTURA_PI * dot(even, n * n - third)
                   + AperturaFloat(0.5) * APERTURA_PI * dot(n, odd),
               AperturaFloat(0.0));
}

// Sectors of the hemisphere as bits: `rings` of equal solid angle about the normal, from it down, with 2 * rings sectors each, counter-
// clockwise from aperturaAzimuthZero(normal). Seven bits to a component of a slot.
const int APERTURA_SECTOR_BITS = 7;
APERTURA_FN int aperturaSectorAt(int rings, AperturaFloat x, AperturaFloat y, AperturaFloat z) {
    int ring = clamp(int((AperturaFloat(1.0) - z) * AperturaFloat(rings)), 0, rings - 1);
    AperturaFloat turn = aperturaAzimuthOf(x, y) * AperturaFloat(rings) / APERTURA_PI;
    int sector = int(turn < AperturaFloat(0.0) ? turn + AperturaFloat(2 * rings) : turn);
    return ring * 2 * rings + (sector & (2 * rings - 1));
}
APERTURA_FN AperturaFloat aperturaSectorIsOpen(AperturaReceiver receiver, int rings, int sector) {
    int place = sector / APERTURA_SECTOR_BITS;
    int bits = int(aperturaNumberOf(receiver, 2 * rings * rings / APERTURA_SECTOR_BITS + 1, place) + AperturaFloat(0.5));
    return AperturaFloat((bits >> (sector - place * APERTURA_SECTOR_BITS)) & 1);
}

// The mean of the sectors over the light's disc: at its centre for a sun, else at eight points.
APERTURA_FN AperturaFloat aperturaSectorVisibility(AperturaReceiver receiver, int rings, AperturaCapLight light, int lightClass) {
    AperturaVec3 tangent = aperturaAzimuthZero(receiver.normal);
    AperturaVec3 side = cross(receiver.normal, tangent);
    AperturaVec3 at = AperturaVec3(dot(tangent, light.axis), dot(side, light.axis), dot(receiver.normal, light.axis));
    if (lightClass == APERTURA_LIGHTS_SUN) return aperturaSectorIsOpen(receiver, rings, aperturaSectorAt(rings, at.x, at.y, at.z));
    AperturaVec3 across = aperturaTangentTo(at);
    AperturaVec3 up = cross(at, across);
    AperturaFloat sum = AperturaFloat(0.0);
    AperturaFloat weights = AperturaFloat(0.0);
    for (int i = 0; i < 8; ++i) {
        AperturaFloat turn = AperturaFloat(2.399963) * AperturaFloat(i);
        AperturaFloat reach = light.sinRadius * sqrt((AperturaFloat(i) + AperturaFloat(0.5)) / AperturaFloat(8.0));
        AperturaVec3 w = sqrt(max(AperturaFloat(1.0) - reach * reach, AperturaFloat(0.0))) * at
                       + reach * (cos(turn) * across + sin(turn) * up);
        AperturaFloat weight = max(w.z, AperturaFloat(0.0));
        sum += weight * aperturaSectorIsOpen(receiver, rings, aperturaSectorAt(rings, w.x, w.y, w.z));
        weights += weight;
    }
    return sum / max(weights, aperturaSmall(1e-6));
}

#endif
