// RIVAL: horizon maps, after Max, "Horizon Mapping: Shadows for Bump-Mapped Surfaces", 1988: the elevation of the horizon at
// 4 to 32 azimuths about a pole. With 4 azimuths it is what Stellarium draws the Moon with. GLSL and C++ include this text.
#ifndef APERTURA_HORIZON_GLSL
#define APERTURA_HORIZON_GLSL
#include "receiver.glsl"

// The pole is the receiver's normal, or the vertical, +Y, for terrain. Azimuths are counter-clockwise about it from azimuthZero(pole).
const lpfloat ABOUT_VERTICAL = -lpfloat(2.0);  // is added to the heights where the pole is the vertical

// A unit tangent that turns slowly with the pole, so that neighbouring vertices' azimuths agree; but for poles near the one direction
// that it is perpendicular to, and its opposite. (The tangents of tangentTo jump all along a plane.)
APERTURA_FN lpvec3 azimuthZero(lpvec3 pole) {
    lpvec3 t = cross(lpvec3(lpfloat(0.36), lpfloat(0.48), lpfloat(0.8)), pole);
    lpfloat squared = dot(t, t);
    return squared > lpsmall(1e-6) ? t * inversesqrt(squared) : tangentTo(pole);
}

// The azimuth of a direction, -pi..pi; 0 at the pole.
APERTURA_FN lpfloat azimuthOf(lpfloat x, lpfloat y) { return atan(y, abs(x) + abs(y) > lpsmall(1e-6) ? x : lpfloat(1.0)); }

APERTURA_FN bool isAboutVertical(Receiver receiver) { return receiver.params[0].x < -lpfloat(0.5); }

// Number i of the first `count` of a receiver's slots, by selection: a driver may put an array that is indexed into slow memory.
APERTURA_FN lpfloat numberOf(Receiver receiver, int count, int i) {
    lpvec4 slot = receiver.params[0];
    int last = (count - 1) >> 2;
    for (int k = 1; k <= last; ++k) slot = (i >> 2) == k ? receiver.params[k] : slot;
    lpvec2 pair = (i & 2) == 0 ? lpvec2(slot.x, slot.y) : lpvec2(slot.z, slot.w);
    return (i & 1) == 0 ? pair.x : pair.y;
}

// The sine of the horizon's elevation at azimuth i, -1..1.
APERTURA_FN lpfloat horizonHeight(Receiver receiver, int azimuths, int i) {
    lpfloat stored = numberOf(receiver, azimuths, i);
    return isAboutVertical(receiver) ? stored - ABOUT_VERTICAL : stored;
}

// The part of a light's disc above a line. `above`: the sine of the angle of its centre above the line.
APERTURA_FN lpfloat discAbove(lpfloat above, CapLight light) {
    return discFraction(clamp(lpfloat(0.5) + lpfloat(0.5) * above * light.inverseSin, lpfloat(0.0), lpfloat(1.0)));
}

// E of a cap light over a horizon of `azimuths` sines of elevation, linear in between: the light's disc is cut by the line that the
// horizon is at the light's azimuth.
APERTURA_FN lpfloat irradianceOverHorizon(Receiver receiver, int azimuths, CapLight light, int lightClass) {
    lpvec3 pole = isAboutVertical(receiver) ? lpvec3(lpfloat(0.0), lpfloat(1.0), lpfloat(0.0)) : receiver.normal;
    lpvec3 tangent = azimuthZero(pole);
    lpfloat z = dot(pole, light.axis);
    lpfloat perStep = lpfloat(2.0) * PI / lpfloat(azimuths);  // radians
    lpfloat turn = azimuthOf(dot(tangent, light.axis), dot(cross(pole, tangent), light.axis)) / perStep;
    lpfloat at = turn < lpfloat(0.0) ? turn + lpfloat(azimuths) : turn;
    int i = int(at) & (azimuths - 1);
    lpfloat a = horizonHeight(receiver, azimuths, i);
    lpfloat b = horizonHeight(receiver, azimuths, (i + 1) & (azimuths - 1));
    lpfloat height = clamp(mix(a, b, at - floor(at)), -lpfloat(1.0), lpfloat(1.0));
    lpfloat cosine = sqrt(max(lpfloat(1.0) - height * height, lpsmall(1e-4)));
    // How steeply the horizon rises, by the azimuth's arc at its own elevation.
    lpfloat rise = (b - a) / (perStep * cosine * cosine);
    // The sine of how far the light's centre stands above that line.
    lpfloat above = (z * cosine - height * sqrt(max(lpfloat(1.0) - z * z, lpfloat(0.0)))) * inversesqrt(lpfloat(1.0) + rise * rise);
    // The light without blockers is cut by the receiver's own plane already: what is left of it above the horizon.
    lpfloat visible = discAbove(above, light) / max(discAbove(dot(receiver.normal, light.axis), light), lpsmall(1e-3));
    return unoccludedIrradiance(receiver.normal, light, lightClass) * min(visible, lpfloat(1.0));
}

#endif
