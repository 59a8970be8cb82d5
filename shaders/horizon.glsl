// RIVAL: horizon maps, after Max, "Horizon Mapping: Shadows for Bump-Mapped Surfaces", 1988: the elevation of the horizon at
// 4 to 32 azimuths about a pole. With 4 azimuths it is what Stellarium draws the Moon with. GLSL and C++ include this text.
#ifndef APERTURA_HORIZON_GLSL
#define APERTURA_HORIZON_GLSL
#include "receiver.glsl"

// The pole is the receiver's normal, or the vertical, +Y, for terrain. Azimuths are counter-clockwise about it from
// aperturaAzimuthZero(pole).
const AperturaFloat APERTURA_ABOUT_VERTICAL = -AperturaFloat(2.0);  // is added to the heights where the pole is the vertical

// A unit tangent that turns slowly with the pole, so that neighbouring vertices' azimuths agree; but for poles near the one direction
// that it is perpendicular to, and its opposite. (The tangents of aperturaTangentTo jump all along a plane.)
APERTURA_FN AperturaVec3 aperturaAzimuthZero(AperturaVec3 pole) {
    AperturaVec3 t = cross(AperturaVec3(AperturaFloat(0.36), AperturaFloat(0.48), AperturaFloat(0.8)), pole);
    AperturaFloat squared = dot(t, t);
    return squared > aperturaSmall(1e-6) ? t * inversesqrt(squared) : aperturaTangentTo(pole);
}

// The azimuth of a direction, -pi..pi; 0 at the pole.
APERTURA_FN AperturaFloat aperturaAzimuthOf(AperturaFloat x, AperturaFloat y) {
    return atan(y, abs(x) + abs(y) > aperturaSmall(1e-6) ? x : AperturaFloat(1.0));
}

APERTURA_FN bool aperturaIsAboutVertical(AperturaReceiver receiver) { return receiver.params[0].x < -AperturaFloat(0.5); }

// Number i of the first `count` of a receiver's slots, by selection: a driver may put an array that is indexed into slow memory.
APERTURA_FN AperturaFloat aperturaNumberOf(AperturaReceiver receiver, int count, int i) {
    AperturaVec4 slot = receiver.params[0];
    int last = (count - 1) >> 2;
    for (int k = 1; k <= last; ++k) slot = (i >> 2) == k ? receiver.params[k] : slot;
    AperturaVec2 pair = (i & 2) == 0 ? AperturaVec2(slot.x, slot.y) : AperturaVec2(slot.z, slot.w);
    return (i & 1) == 0 ? pair.x : pair.y;
}

// The sine of the horizon's elevation at azimuth i, -1..1.
APERTURA_FN AperturaFloat aperturaHorizonHeight(AperturaReceiver receiver, int azimuths, int i) {
    AperturaFloat stored = aperturaNumberOf(receiver, azimuths, i);
    return aperturaIsAboutVertical(receiver) ? stored - APERTURA_ABOUT_VERTICAL : stored;
}

// The part of a light's disc above a line. `above`: the sine of the angle of its centre above the line.
APERTURA_FN AperturaFloat aperturaDiscAbove(AperturaFloat above, AperturaCapLight light) {
    return aperturaDiscFraction(
        clamp(AperturaFloat(0.5) + AperturaFloat(0.5) * above * light.inverseSin, AperturaFloat(0.0), AperturaFloat(1.0)));
}

// E of a cap light over a horizon of `azimuths` sines of elevation, linear in between: the light's disc is cut by the line that the
// horizon is at the light's azimuth.
APERTURA_FN AperturaFloat aperturaIrradianceOverHorizon(AperturaReceiver receiver, int azimuths, AperturaCapLight light, int lightClass) {
    AperturaVec3 pole = aperturaIsAboutVertical(receiver) ? AperturaVec3(AperturaFloat(0.0), AperturaFloat(1.0), AperturaFloat(0.0))
                                                          : receiver.normal;
    AperturaVec3 tangent = aperturaAzimuthZero(pole);
    AperturaFloat z = dot(pole, light.axis);
    AperturaFloat perStep = AperturaFloat(2.0) * APERTURA_PI / AperturaFloat(azimuths);  // radians
    AperturaFloat turn = aperturaAzimuthOf(dot(tangent, light.axis), dot(cross(pole, tangent), light.axis)) / perStep;
    AperturaFloat at = turn < AperturaFloat(0.0) ? turn + AperturaFloat(azimuths) : turn;
    int i = int(at) & (azimuths - 1);
    AperturaFloat a = aperturaHorizonHeight(receiver, azimuths, i);
    AperturaFloat b = aperturaHorizonHeight(receiver, azimuths, (i + 1) & (azimuths - 1));
    AperturaFloat height = clamp(mix(a, b, at - floor(at)), -AperturaFloat(1.0), AperturaFloat(1.0));
    AperturaFloat cosine = sqrt(max(AperturaFloat(1.0) - height * height, aperturaSmall(1e-4)));
    // How steeply the horizon rises, by the azimuth's arc at its own elevation.
    AperturaFloat rise = (b - a) / (perStep * cosine * cosine);
    // The sine of how far the light's centre stands above that line.
    AperturaFloat above = (z * cosine - height * sqrt(max(AperturaFloat(1.0) - z * z, AperturaFloat(0.0))))
                        * inversesqrt(AperturaFloat(1.0) + rise * rise);
    // The light without blockers is cut by the receiver's own plane already: what is left of it above the horizon.
    AperturaFloat visible = aperturaDiscAbove(above, light)
                          / max(aperturaDiscAbove(dot(receiver.normal, light.axis), light), aperturaSmall(1e-3));
    return aperturaUnoccludedIrradiance(receiver.normal, light, lightClass) * min(visible, AperturaFloat(1.0));
}

#endif
