// Soft apertures: visibility as a smooth step across a plane through the directions,
// V(w) = softStep(offset + dot(slope, w)), softStep(f) = 1/2 + f / (2 sqrt(1 + f^2)), and models made of several. One
// soft aperture holds all four SH coefficients, where a cap holds three. Models of our own.
// GLSL and C++ include this text.
#ifndef APERTURA_SOFT_GLSL
#define APERTURA_SOFT_GLSL
#include "edges.glsl"

// The open directions around a point, soft-edged.
struct SoftAperture {
    lpvec3 slope;  // towards the open side; its length is the sharpness: 0 an even haze, 10 a soft edge, 60 a hard one
    lpfloat offset;
};

// The limit of |slope| + |offset|, so that a lobe stays within what 16-bit floats can square, anywhere on the sphere.
const float LOBE_FARTHEST = 250.0f;

APERTURA_FN lpfloat softStep(lpfloat f) { return lpfloat(0.5) + lpfloat(0.5) * f * inversesqrt(lpfloat(1.0) + f * f); }

// The constants of an average of softStep over a cap light: fitted to the integral, with a penalty on steps that no light
// makes.
struct DiscLaw {
    lpfloat shrink;    // how far the centre moves to the cap's centroid, in heights of the cap
    lpfloat lean;      // how far it moves to the part of a light that the horizon leaves, in sines of its radius,
    lpfloat leanLess;  // minus this, times its cosine to the normal
    lpfloat across;    // squared half width of the line that stands for the disc, in squared sines of the radius,
    lpfloat through;   // plus this for the cap's bulge, in squared heights
    lpfloat ends;      // the line's ends: 1 sharp, less is softer, as a disc's edges are
};
APERTURA_FN DiscLaw wholeDisc(lpfloat across, lpfloat ends) {
    return DiscLaw(lpfloat(0.5084), lpfloat(0.5032), lpfloat(0.1667), across, lpfloat(0.22), ends);
}
APERTURA_FN DiscLaw quarterDisc(lpfloat across, lpfloat ends) {
    return DiscLaw(lpfloat(0.5677), lpfloat(0.3954), lpfloat(0.1008), across, lpfloat(0.2322), ends);
}
// Each law is as sharp as possible while no light that crosses the built-in scenes steps further than its rim sweeps (3 %
// further for three lobes). Lobes and quadrics have laws of their own: edges of several lobes may coincide, and the plane
// of a quadric turns from quarter to quarter.
APERTURA_FN DiscLaw softDisc() { return wholeDisc(lpfloat(0.65), lpfloat(0.87)); }
APERTURA_FN DiscLaw lobeDisc() { return wholeDisc(lpfloat(0.68), lpfloat(0.88)); }
APERTURA_FN DiscLaw lobeQuarter(int count) {
    return count < 4 ? quarterDisc(lpfloat(0.70), lpfloat(0.77)) : quarterDisc(lpfloat(0.79), lpfloat(0.74));
}
APERTURA_FN DiscLaw quadricQuarter() { return quarterDisc(lpfloat(0.89), lpfloat(0.74)); }

// The mean of softStep(f) over a cap light, weighted by the cosine to the normal, 0..1. f is `centre` at the light's axis
// and has the gradient `slope`. The integral of softStep has a closed form along a line, and the disc is close to a line.
APERTURA_FN lpfloat softStepOverLight(lpvec3 normal, lpfloat centre, lpvec3 slope, CapLight light, DiscLaw law) {
    lpfloat z = dot(normal, light.axis);
    lpfloat s = light.sinRadius;
    lpfloat along = dot(slope, light.axis);
    lpfloat lean = max(law.lean * s - law.leanLess * z, lpfloat(0.0));
    lpfloat f = centre - law.shrink * light.height * along + lean * (dot(slope, normal) - along * z);
    lpfloat through = light.height * along;
    lpfloat q2 = law.across * s * s * max(dot(slope, slope) - along * along, lpfloat(0.0)) + law.through * through * through;
    // Along a line of half width q the mean is 1/2 + f / (sqrt(1 + (f + q)^2) + sqrt(1 + (f - q)^2)); here with one root
    // less, and with numbers that 16-bit floats can hold.
    f = clamp(f, -lplarge(1e6), lplarge(1e6));
    q2 = min(q2, lplarge(1e6) * lplarge(1e6));
    lpfloat b = lpfloat(1.0) + f * f + q2;
    lpfloat inverse = lpfloat(1.0) / b;
    lpfloat root = sqrt(max(lpfloat(1.0) - lpfloat(4.0) * law.ends * (f * f * inverse) * (q2 * inverse), lpfloat(0.0)));
    return clamp(lpfloat(0.5) + lpfloat(0.5) * f * inversesqrt(lpfloat(0.5) * b * (lpfloat(1.0) + root)), lpfloat(0.0), lpfloat(1.0));
}

// The visibility of a light so small that it is a point.
APERTURA_FN lpfloat lobeAt(SoftAperture lobe, CapLight light) { return softStep(lobe.offset + dot(lobe.slope, light.axis)); }

// The mean of softStep over a small or medium light, cheaply: the line's width is one more term under the root. It is so
// wide that no edge is steeper than the light's own, whose rim is all that a hard edge can sweep. Half that width would
// be closer to the integral, but would step.
APERTURA_FN lpfloat lobeOverMedium(SoftAperture lobe, CapLight light) {
    lpfloat along = dot(lobe.slope, light.axis);
    lpfloat f = lobe.offset + along * light.shrink;
    lpfloat across = light.spread * max(dot(lobe.slope, lobe.slope) - along * along, lpfloat(0.0));
    return lpfloat(0.5) + lpfloat(0.5) * f * inversesqrt(lpfloat(1.0) + f * f + across);
}

// E of a cap light through a soft aperture, cut by the receiver's horizon. Error of E / (pi sin^2 r) from the model's own
// integral over the light: 0.010 RMS (0.10 max) for radii 0.27..45 degrees; RMS of the cheaper classes 0.010 (sun), 0.008
// (small) and 0.017 (medium): tests/soft_test.cpp.
APERTURA_FN lpfloat irradianceThroughSoft(lpvec3 normal, SoftAperture soft, CapLight light, int lightClass) {
    lpfloat visible = lpfloat(0.0);
    if (lightClass == LIGHTS_SUN) {
        visible = lobeAt(soft, light);
    } else if (lightClass != LIGHTS_ANY) {
        visible = lobeOverMedium(soft, light);
    } else {
        visible = softStepOverLight(normal, soft.offset + dot(soft.slope, light.axis), soft.slope, light, softDisc());
    }
    return unoccludedIrradiance(normal, light, lightClass) * visible;
}

// 1 over the standard deviation of dot(slope, w) over a light's directions w, in the unit of `covariance`, with a term
// for how soft the edge is compared with the light: fitted to pairs of lobes, tests/soft_test.cpp. `along`: dot(slope,
// light.axis).
APERTURA_FN lpfloat inverseDeviationOfLobe(lpvec3 slope, lpfloat along, CapLight light) {
    lpfloat s = light.sinRadius;
    return s * inversesqrt(lpfloat(3.2) + s * s * max(covariance(dot(slope, slope), along, along, light), lpfloat(0.0)));
}

// A large light as four smaller ones around its centre, for what has no closed form over one disc. `part` has the size of
// each; its axis is to be replaced.
struct FourLights {
    CapLight part;
    lpvec3 axis[4];
    lpfloat weight[4];  // by E above the horizon; sum 1
};

APERTURA_FN FourLights quarters(lpvec3 normal, CapLight light) {
    // The normal's tangent, transported to the light's axis along the great circle: it never turns abruptly, except for a
    // light at the nadir.
    lpvec3 n = normal * inversesqrt(max(dot(normal, normal), lpsmall(1e-30)));
    lpvec3 t = tangentTo(n);
    lpvec3 u = t - dot(t, light.axis) / max(lpfloat(1.0) + dot(n, light.axis), lpfloat(1e-3)) * (light.axis + n);
    lpvec3 v = cross(light.axis, u);
    lpfloat side = lpfloat(0.6188) * light.sinRadius;
    lpvec3 centre = sqrt(lpfloat(1.0) - side * side) * light.axis;
    FourLights four;
    four.part = capLight(light.axis, lpfloat(0.5806) * light.sinRadius);
    four.axis[0] = centre + side * u;
    four.axis[1] = centre - side * u;
    four.axis[2] = centre + side * v;
    four.axis[3] = centre - side * v;
    lpfloat sum = lpfloat(0.0);
    for (int i = 0; i < 4; ++i) {
        four.weight[i] = horizonCosine(dot(n, four.axis[i]), four.part.rim, four.part.rimSlope) + lpsmall(1e-6);
        sum += four.weight[i];
    }
    lpfloat scale = lpfloat(1.0) / sum;
    for (int i = 0; i < 4; ++i) four.weight[i] *= scale;
    return four;
}

// A soft aperture whose step follows a quadric: V(w) = softStep(offset + dot(slope, w) + w Q w), Q symmetric and
// traceless.
struct SoftQuadric {
    lpvec3 slope;
    lpfloat offset;
    lpvec4 bend;  // Qxx, Qyy, Qxy, Qxz
    lpfloat bendYz;
};

APERTURA_FN lpvec3 bendTimes(SoftQuadric q, lpvec3 w) {
    return lpvec3(q.bend.x * w.x + q.bend.z * w.y + q.bend.w * w.z, q.bend.z * w.x + q.bend.y * w.y + q.bendYz * w.z,
                  q.bend.w * w.x + q.bendYz * w.y - (q.bend.x + q.bend.y) * w.z);
}

// E of a cap light through a SoftQuadric. The step's plane is the quadric's tangent at the light's centre or, in
// LIGHTS_ANY, at each of its quarters.
APERTURA_FN lpfloat irradianceThroughQuadric(lpvec3 normal, SoftQuadric soft, CapLight light, int lightClass) {
    lpfloat visible = lpfloat(0.0);
    lpvec3 bend = bendTimes(soft, light.axis);
    lpfloat centre = soft.offset + dot(soft.slope + bend, light.axis);
    if (lightClass == LIGHTS_SUN) {
        visible = softStep(centre);
    } else if (lightClass != LIGHTS_ANY) {
        visible = softStepOverLight(normal, centre, soft.slope + lpfloat(2.0) * bend, light, softDisc());
    } else {
        FourLights four = quarters(normal, light);
        for (int i = 0; i < 4; ++i) {
            CapLight part = four.part;
            part.axis = four.axis[i];
            lpvec3 bent = bendTimes(soft, part.axis);
            lpfloat middle = soft.offset + dot(soft.slope + bent, part.axis);
            visible += four.weight[i] * softStepOverLight(normal, middle, soft.slope + lpfloat(2.0) * bent, part, quadricQuarter());
        }
    }
    return unoccludedIrradiance(normal, light, lightClass) * visible;
}

#endif
