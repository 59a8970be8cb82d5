// Soft apertures: visibility as a smooth step across a plane through the directions,
// V(w) = softStep(offset + dot(slope, w)), softStep(f) = 1/2 + f / (2 sqrt(1 + f^2)), and what is made of several.
// One carries all four SH coefficients, where a cap carries three. Models of our own.
// GLSL and C++ include this text.
#ifndef APERTURA_SOFT_GLSL
#define APERTURA_SOFT_GLSL
#include "edges.glsl"

// The open directions around a point, soft-edged.
struct SoftAperture {
    vec3 slope;    // towards the open side; its length is the sharpness: 0 even haze, 10 a hard edge
    float offset;
};

APERTURA_FN float softStep(float f) { return 0.5f + 0.5f * f * inversesqrt(1.0f + f * f); }

// How a plane is averaged over a cap light: constants fitted to the integral, with a price on steps that no light makes.
struct DiscLaw {
    float shrink;    // the centre's way to the cap's centroid, in heights of the cap
    float lean;      // of a light that the horizon cuts, towards the part that is left, in sines of its radius,
    float leanLess;  // and less with each unit of its cosine to the normal
    float across;    // squared half breadth of the line that stands for the disc, in squared sines,
    float through;   // and for the bulge, in squared heights
    float ends;      // of the line: 1 sharp; a disc's edges come in more softly
};
APERTURA_FN DiscLaw wholeDisc(float across, float ends) { return DiscLaw(0.5084f, 0.5032f, 0.1667f, across, 0.22f, ends); }
APERTURA_FN DiscLaw quarterDisc(float across, float ends) { return DiscLaw(0.5677f, 0.3954f, 0.1008f, across, 0.2322f, ends); }
// Each as sharp as lets no light that crosses the built-in scenes step further than its rim sweeps (of three lobes 3 %): of
// several lobes edges may be one, and the plane of a quadric turns from quarter to quarter.
APERTURA_FN DiscLaw softDisc() { return wholeDisc(0.65f, 0.87f); }
APERTURA_FN DiscLaw lobeDisc() { return wholeDisc(0.68f, 0.88f); }
APERTURA_FN DiscLaw lobeQuarter(int count) { return count < 4 ? quarterDisc(0.70f, 0.77f) : quarterDisc(0.79f, 0.74f); }
APERTURA_FN DiscLaw quadricQuarter() { return quarterDisc(0.89f, 0.74f); }

// The mean of softStep(f) over a cap light, weighed by the cosine to the normal: f is `centre` at the light's
// axis and has the gradient `slope`. The integral of softStep has a closed form along a line; the disc is near to one.
APERTURA_FN float softStepOverLight(vec3 normal, float centre, vec3 slope, CapLight light, DiscLaw law) {
    float z = dot(normal, light.axis);
    float s = light.sinRadius;
    float along = dot(slope, light.axis);
    float lean = max(law.lean * s - law.leanLess * z, 0.0f);
    float f = centre - law.shrink * light.height * along + lean * (dot(slope, normal) - along * z);
    float through = light.height * along;
    float q2 = law.across * s * s * max(dot(slope, slope) - along * along, 0.0f) + law.through * through * through;
    // Along a line 1/2 + f / (sqrt(1 + (f + q)^2) + sqrt(1 + (f - q)^2)), with one root less, in numbers that a half holds.
    f = clamp(f, -1e6f, 1e6f);
    q2 = min(q2, 1e6f * 1e6f);
    float b = 1.0f + f * f + q2;
    float inverse = 1.0f / b;
    float root = sqrt(max(1.0f - 4.0f * law.ends * (f * f * inverse) * (q2 * inverse), 0.0f));
    return clamp(0.5f + 0.5f * f * inversesqrt(0.5f * b * (1.0f + root)), 0.0f, 1.0f);
}

// Of a light so small that it is a point.
APERTURA_FN float lobeAt(SoftAperture lobe, CapLight light) { return softStep(lobe.offset + dot(lobe.slope, light.axis)); }

// The mean of softStep over a small light or one of medium size, cheaply: the line's breadth is one more term under
// the root. It is as broad as makes an edge no steeper than the light itself does, whose rim is all that a hard
// edge can sweep: half as broad would be nearer to the integral, and step.
APERTURA_FN float lobeOverMedium(SoftAperture lobe, CapLight light) {
    float along = dot(lobe.slope, light.axis);
    float f = lobe.offset + along * light.shrink;
    float across = light.spread * max(dot(lobe.slope, lobe.slope) - along * along, 0.0f);
    return 0.5f + 0.5f * f * inversesqrt(1.0f + f * f + across);
}

// E of a cap light through a soft aperture, cut by the receiver's horizon. Of the model's own integral over
// the light it is within 0.010 RMS (0.10 max) for radii 0.27..45 degrees, and in the cheaper classes within
// 0.008 (small) and 0.017 (medium): tests/soft_test.cpp.
APERTURA_FN float irradianceThroughSoft(vec3 normal, SoftAperture soft, CapLight light, int lightClass) {
    float visible = 0.0f;
    if (lightClass == LIGHTS_SUN) {
        visible = lobeAt(soft, light);
    } else if (lightClass != LIGHTS_ANY) {
        visible = lobeOverMedium(soft, light);
    } else {
        visible = softStepOverLight(normal, soft.offset + dot(soft.slope, light.axis), soft.slope, light, softDisc());
    }
    return unoccludedIrradiance(normal, light, lightClass) * visible;
}

// 1 over the deviation of a lobe's plane across a light, in sines of its radius, with a term for how soft its edge is beside
// the light: fitted to pairs of lobes, tests/soft_test.cpp. `along`: dot(slope, light.axis).
APERTURA_FN float inverseDeviationOfLobe(vec3 slope, float along, CapLight light) {
    float s = light.sinRadius;
    return s * inversesqrt(3.2f + s * s * max(covariance(dot(slope, slope), along, along, light), 0.0f));
}

// A large light as four smaller ones around its centre: what has no closed form over one disc is summed
// over them. Each has the size of the light in `part`.
struct FourLights {
    CapLight part;
    vec3 axis[4];
    float weight[4];  // by their light above the horizon; sum 1
};

APERTURA_FN FourLights quarters(vec3 normal, CapLight light) {
    // The normal's tangent carried along to the light: it never turns at once, but for a light at the nadir.
    vec3 n = normal * inversesqrt(max(dot(normal, normal), 1e-30f));
    vec3 t = tangentTo(n);
    vec3 u = t - dot(t, light.axis) / max(1.0f + dot(n, light.axis), 1e-3f) * (light.axis + n);
    vec3 v = cross(light.axis, u);
    float side = 0.6188f * light.sinRadius;
    vec3 centre = sqrt(1.0f - side * side) * light.axis;
    FourLights four;
    four.part = capLight(light.axis, 0.5806f * light.sinRadius);
    four.axis[0] = centre + side * u;
    four.axis[1] = centre - side * u;
    four.axis[2] = centre + side * v;
    four.axis[3] = centre - side * v;
    float sum = 0.0f;
    for (int i = 0; i < 4; ++i) {
        four.weight[i] = horizonCosine(dot(n, four.axis[i]), four.part.rim, four.part.rimSlope) + 1e-6f;
        sum += four.weight[i];
    }
    float scale = 1.0f / sum;
    for (int i = 0; i < 4; ++i) four.weight[i] *= scale;
    return four;
}

// A soft aperture whose step follows a quadric: softStep(offset + dot(slope, w) + w Q w), Q symmetric and
// without trace.
struct SoftQuadric {
    vec3 slope;
    float offset;
    vec4 bend;      // Qxx, Qyy, Qxy, Qxz
    float bendYz;
};

APERTURA_FN vec3 bendTimes(SoftQuadric q, vec3 w) {
    return vec3(q.bend.x * w.x + q.bend.z * w.y + q.bend.w * w.z, q.bend.z * w.x + q.bend.y * w.y + q.bendYz * w.z,
                q.bend.w * w.x + q.bendYz * w.y - (q.bend.x + q.bend.y) * w.z);
}

// E of a cap light through it: the step's plane is the quadric's tangent at the light's quarters.
APERTURA_FN float irradianceThroughQuadric(vec3 normal, SoftQuadric soft, CapLight light, int lightClass) {
    float visible = 0.0f;
    vec3 bend = bendTimes(soft, light.axis);
    float centre = soft.offset + dot(soft.slope + bend, light.axis);
    if (lightClass == LIGHTS_SUN) {
        visible = softStep(centre);
    } else if (lightClass != LIGHTS_ANY) {
        visible = softStepOverLight(normal, centre, soft.slope + 2.0f * bend, light, softDisc());
    } else {
        FourLights four = quarters(normal, light);
        for (int i = 0; i < 4; ++i) {
            CapLight part = four.part;
            part.axis = four.axis[i];
            vec3 bent = bendTimes(soft, part.axis);
            float middle = soft.offset + dot(soft.slope + bent, part.axis);
            visible += four.weight[i] * softStepOverLight(normal, middle, soft.slope + 2.0f * bent, part, quadricQuarter());
        }
    }
    return unoccludedIrradiance(normal, light, lightClass) * visible;
}

#endif
