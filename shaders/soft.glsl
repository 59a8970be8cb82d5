// Soft apertures: visibility as a smooth step across a plane through the directions,
// V(w) = aperturaSoftStep(offset + dot(slope, w)), aperturaSoftStep(f) = 1/2 + f / (2 sqrt(1 + f^2)), and models made of several. One
// soft aperture holds all four SH coefficients, where a cap holds three. Models of our own.
// GLSL and C++ include this text.
#ifndef APERTURA_SOFT_GLSL
#define APERTURA_SOFT_GLSL
#include "edges.glsl"

// The open directions around a point, soft-edged.
struct AperturaSoftAperture {
    AperturaVec3 slope;  // towards the open side; its length is the sharpness: 0 an even haze, 10 a soft edge, 60 a hard one
    AperturaFloat offset;
};

// The limit of |slope| + |offset|, so that a lobe stays within what 16-bit floats can square, anywhere on the sphere.
const float APERTURA_LOBE_FARTHEST = 250.0f;

APERTURA_FN AperturaFloat aperturaSoftStep(AperturaFloat f) {
    return AperturaFloat(0.5) + AperturaFloat(0.5) * f * inversesqrt(AperturaFloat(1.0) + f * f);
}

// The constants of an average of aperturaSoftStep over a cap light, fitted to the integral: tools/fit/disc.cpp, lobe_disc.cpp,
// lobe_quarter.cpp, lobe_quarter_4.cpp, quadric_quarter.cpp.
struct AperturaDiscLaw {
    AperturaFloat shrink;    // how far the centre moves to the cap's centroid, in heights of the cap
    AperturaFloat lean;      // how far it moves to the part of a light that the horizon leaves, in sines of its radius,
    AperturaFloat leanLess;  // minus this, times its cosine to the normal
    AperturaFloat across;    // squared half width of the line that stands for the disc, in squared sines of the radius,
    AperturaFloat through;   // plus this for the cap's bulge, in squared heights
    AperturaFloat ends;      // the line's ends: 1 sharp, less is softer, as a disc's edges are
};
APERTURA_FN AperturaDiscLaw aperturaWholeDisc(AperturaFloat across, AperturaFloat ends) {
    return AperturaDiscLaw(AperturaFloat(0.49846), AperturaFloat(0.46693), AperturaFloat(0.13564), across, AperturaFloat(0.41078), ends);
}
APERTURA_FN AperturaDiscLaw aperturaQuarterDisc(AperturaFloat across, AperturaFloat ends) {
    return AperturaDiscLaw(AperturaFloat(0.5915), AperturaFloat(0.3949), AperturaFloat(0.1018), across, AperturaFloat(0.0699), ends);
}
// Each law is as close to the integral as possible while no light that crosses the built-in scenes steps further than its rim sweeps (3 %
// further for three lobes, 2 % for one). Lobes and quadrics have laws of their own: edges of several lobes may coincide, and the plane
// of a quadric turns from quarter to quarter.
APERTURA_FN AperturaDiscLaw aperturaSoftDisc() { return aperturaWholeDisc(AperturaFloat(0.64280), AperturaFloat(0.93650)); }
APERTURA_FN AperturaDiscLaw aperturaLobeDisc() { return aperturaWholeDisc(AperturaFloat(0.7406), AperturaFloat(0.9765)); }
APERTURA_FN AperturaDiscLaw aperturaLobeQuarter(int count) {
    return count < 4 ? aperturaQuarterDisc(AperturaFloat(0.6977), AperturaFloat(0.7706))
                     : aperturaQuarterDisc(AperturaFloat(0.9429), AperturaFloat(0.9056));
}
APERTURA_FN AperturaDiscLaw aperturaQuadricQuarter() { return aperturaQuarterDisc(AperturaFloat(0.6952), AperturaFloat(0.6296)); }

// The mean of aperturaSoftStep(f) over a cap light, weighted by the cosine to the normal, 0..1. f is `centre` at the light's axis
// and has the gradient `slope`. The integral of aperturaSoftStep has a closed form along a line, and the disc is close to a line.
APERTURA_FN AperturaFloat aperturaSoftStepOverLight(AperturaVec3 normal, AperturaFloat centre, AperturaVec3 slope, AperturaCapLight light,
                                                    AperturaDiscLaw law) {
    AperturaFloat z = dot(normal, light.axis);
    AperturaFloat s = light.sinRadius;
    AperturaFloat along = dot(slope, light.axis);
    AperturaFloat lean = max(law.lean * s - law.leanLess * z, AperturaFloat(0.0));
    AperturaFloat f = centre - law.shrink * light.height * along + lean * (dot(slope, normal) - along * z);
    AperturaFloat through = light.height * along;
    AperturaFloat q2 = law.across * s * s * max(dot(slope, slope) - along * along, AperturaFloat(0.0)) + law.through * through * through;
    // Along a line of half width q the mean is 1/2 + f / (sqrt(1 + (f + q)^2) + sqrt(1 + (f - q)^2)); here with one root
    // less, and with numbers that 16-bit floats can hold.
    f = clamp(f, -aperturaLarge(1e6), aperturaLarge(1e6));
    q2 = min(q2, aperturaLarge(1e6) * aperturaLarge(1e6));
    AperturaFloat b = AperturaFloat(1.0) + f * f + q2;
    AperturaFloat inverse = AperturaFloat(1.0) / b;
    AperturaFloat root = sqrt(
        max(AperturaFloat(1.0) - AperturaFloat(4.0) * law.ends * (f * f * inverse) * (q2 * inverse), AperturaFloat(0.0)));
    return clamp(AperturaFloat(0.5) + AperturaFloat(0.5) * f * inversesqrt(AperturaFloat(0.5) * b * (AperturaFloat(1.0) + root)),
                 AperturaFloat(0.0), AperturaFloat(1.0));
}

// The visibility of a light so small that it is a point.
APERTURA_FN AperturaFloat aperturaLobeAt(AperturaSoftAperture lobe, AperturaCapLight light) {
    return aperturaSoftStep(lobe.offset + dot(lobe.slope, light.axis));
}

// The mean of aperturaSoftStep over a small or medium light, cheaply: the line's width is one more term under the root. It is so
// wide that no edge is steeper than the light's own, whose rim is all that a hard edge can sweep. Half that width would
// be closer to the integral, but would step.
APERTURA_FN AperturaFloat aperturaLobeOverMedium(AperturaSoftAperture lobe, AperturaCapLight light) {
    AperturaFloat along = dot(lobe.slope, light.axis);
    AperturaFloat f = lobe.offset + along * light.shrink;
    AperturaFloat across = light.spread * max(dot(lobe.slope, lobe.slope) - along * along, AperturaFloat(0.0));
    return AperturaFloat(0.5) + AperturaFloat(0.5) * f * inversesqrt(AperturaFloat(1.0) + f * f + across);
}

// E of a cap light through a soft aperture, cut by the receiver's horizon. Error of E / (pi sin^2 r) from the model's own
// integral over the light: 0.009 RMS (0.09 max) for radii 0.27..45 degrees; RMS of the cheaper classes 0.002 (sun), 0.005
// (small) and 0.015 (medium): tests/soft_test.cpp.
APERTURA_FN AperturaFloat aperturaIrradianceThroughSoft(AperturaVec3 normal, AperturaSoftAperture soft, AperturaCapLight light,
                                                        int lightClass) {
    AperturaFloat visible = AperturaFloat(0.0);
    if (lightClass == APERTURA_LIGHTS_SUN) {
        visible = aperturaLobeAt(soft, light);
    } else if (lightClass != APERTURA_LIGHTS_ANY) {
        visible = aperturaLobeOverMedium(soft, light);
    } else {
        visible = aperturaSoftStepOverLight(normal, soft.offset + dot(soft.slope, light.axis), soft.slope, light, aperturaSoftDisc());
    }
    return aperturaUnoccludedIrradiance(normal, light, lightClass) * visible;
}

// 1 over the standard deviation of dot(slope, w) over a light's directions w, in the unit of aperturaCovariance, with a term
// for how soft the edge is compared with the light: fitted to pairs of lobes, tools/fit/edges.cpp. `along`: dot(slope,
// light.axis).
APERTURA_FN AperturaFloat aperturaInverseDeviationOfLobe(AperturaVec3 slope, AperturaFloat along, AperturaCapLight light) {
    AperturaFloat s = light.sinRadius;
    return s
         * inversesqrt(AperturaFloat(3.2) + s * s * max(aperturaCovariance(dot(slope, slope), along, along, light), AperturaFloat(0.0)));
}

// A large light as four smaller ones around its centre, for what has no closed form over one disc. `part` has the size of
// each; its axis is to be replaced. Their offset and size are fitted: tools/fit/lobe_quarter.cpp.
struct AperturaFourLights {
    AperturaCapLight part;
    AperturaVec3 axis[4];
    AperturaFloat weight[4];  // by E above the horizon; sum 1
};

APERTURA_FN AperturaFourLights aperturaQuarters(AperturaVec3 normal, AperturaCapLight light) {
    // The normal's tangent, transported to the light's axis along the great circle: it never turns abruptly, except for a
    // light at the nadir.
    AperturaVec3 n = normal * inversesqrt(max(dot(normal, normal), aperturaSmall(1e-30)));
    AperturaVec3 t = aperturaTangentTo(n);
    AperturaVec3 u = t - dot(t, light.axis) / max(AperturaFloat(1.0) + dot(n, light.axis), AperturaFloat(1e-3)) * (light.axis + n);
    AperturaVec3 v = cross(light.axis, u);
    AperturaFloat side = AperturaFloat(0.6149) * light.sinRadius;
    AperturaVec3 centre = sqrt(AperturaFloat(1.0) - side * side) * light.axis;
    AperturaFourLights four;
    four.part = aperturaCapLight(light.axis, AperturaFloat(0.5802) * light.sinRadius);
    four.axis[0] = centre + side * u;
    four.axis[1] = centre - side * u;
    four.axis[2] = centre + side * v;
    four.axis[3] = centre - side * v;
    AperturaFloat sum = AperturaFloat(0.0);
    for (int i = 0; i < 4; ++i) {
        four.weight[i] = aperturaHorizonCosine(dot(n, four.axis[i]), four.part.rim, four.part.rimSlope) + aperturaSmall(1e-6);
        sum += four.weight[i];
    }
    AperturaFloat scale = AperturaFloat(1.0) / sum;
    for (int i = 0; i < 4; ++i) four.weight[i] *= scale;
    return four;
}

// A soft aperture whose step follows a quadric: V(w) = aperturaSoftStep(offset + dot(slope, w) + w Q w), Q symmetric and
// traceless.
struct AperturaSoftQuadric {
    AperturaVec3 slope;
    AperturaFloat offset;
    AperturaVec4 bend;  // Qxx, Qyy, Qxy, Qxz
    AperturaFloat bendYz;
};

APERTURA_FN AperturaVec3 aperturaBendTimes(AperturaSoftQuadric q, AperturaVec3 w) {
    return AperturaVec3(q.bend.x * w.x + q.bend.z * w.y + q.bend.w * w.z, q.bend.z * w.x + q.bend.y * w.y + q.bendYz * w.z,
                        q.bend.w * w.x + q.bendYz * w.y - (q.bend.x + q.bend.y) * w.z);
}

// E of a cap light through an AperturaSoftQuadric. The step's plane is the quadric's tangent at the light's centre or, in
// APERTURA_LIGHTS_ANY, at each of its quarters.
APERTURA_FN AperturaFloat aperturaIrradianceThroughQuadric(AperturaVec3 normal, AperturaSoftQuadric soft, AperturaCapLight light,
                                                           int lightClass) {
    AperturaFloat visible = AperturaFloat(0.0);
    AperturaVec3 bend = aperturaBendTimes(soft, light.axis);
    AperturaFloat centre = soft.offset + dot(soft.slope + bend, light.axis);
    if (lightClass == APERTURA_LIGHTS_SUN) {
        visible = aperturaSoftStep(centre);
    } else if (lightClass != APERTURA_LIGHTS_ANY) {
        visible = aperturaSoftStepOverLight(normal, centre, soft.slope + AperturaFloat(2.0) * bend, light, aperturaSoftDisc());
    } else {
        AperturaFourLights four = aperturaQuarters(normal, light);
        for (int i = 0; i < 4; ++i) {
            AperturaCapLight part = four.part;
            part.axis = four.axis[i];
            AperturaVec3 bent = aperturaBendTimes(soft, part.axis);
            AperturaFloat middle = soft.offset + dot(soft.slope + bent, part.axis);
            visible += four.weight[i]
                     * aperturaSoftStepOverLight(normal, middle, soft.slope + AperturaFloat(2.0) * bent, part, aperturaQuadricQuarter());
        }
    }
    return aperturaUnoccludedIrradiance(normal, light, lightClass) * visible;
}

#endif
