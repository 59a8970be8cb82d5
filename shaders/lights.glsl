// Several lights: one in front of another hides it. GLSL and C++ include this text. In GLSL, define aperturaLightAt(APERTURA_LIGHT_LIST,
// int) before, which returns a light of the frame.
#ifndef APERTURA_LIGHTS_GLSL
#define APERTURA_LIGHTS_GLSL
#include "frame.glsl"
#include "visible.glsl"
#ifndef APERTURA_CPP
#define APERTURA_LIGHT_LIST int  // nothing: a shader has one frame
#endif

// True if `a` stands in front of `b` wherever both are seen in one direction: a lamp before a light at infinity, of two lamps the one of
// smaller power (the squared distance less the squared radius), which for balls that do not meet is the one that a ray meets first.
APERTURA_FN bool aperturaStandsBefore(AperturaLight a, AperturaLight b, vec3 position) {
    if (!aperturaIsSphere(b)) return aperturaIsSphere(a);
    vec3 toA = vec3(a.sphere) - position;
    vec3 toB = vec3(b.sphere) - position;
    return aperturaIsSphere(a) && dot(toA, toA) - a.sphere.w * a.sphere.w < dot(toB, toB) - b.sphere.w * b.sphere.w;
}

// True if two lights may share directions, by the cosine of the sum of their radii.
APERTURA_FN bool aperturaMayOverlap(AperturaCapLight a, AperturaCapLight b) {
    return dot(a.axis, b.axis) > (1.0f - a.height) * (1.0f - b.height) - a.sinRadius * b.sinRadius;
}

// E of light `index` by a model, less what lights in front of it hide. Lights that overlap then give what their union does: each direction
// counts once, with the radiance of the nearest.
//   position  of the receiver, world, metres
APERTURA_FN float aperturaIrradianceBeside(int model, AperturaReceiver receiver, vec3 position, APERTURA_LIGHT_LIST lights, int index,
                                           int lightClass) {
    AperturaLight light = aperturaLightAt(lights, index);
    AperturaCapLight cap = aperturaCapSeenFrom(position, light, lightClass);
    float e = aperturaIrradianceThrough(model, receiver, cap, lightClass);
    int others = light.before.x;
    if (others == 0) return e;
    bool isBeside = false;
    AperturaLightVisibility visible;
    visible.mean = 0.0f;
    visible.slope = vec3(0.0f);
    float open = aperturaUnoccludedIrradiance(receiver.normal, cap, lightClass);
    for (int k = 0; others != 0; ++k) {
        bool listed = (others & 1) != 0;
        others = others >> 1;
        if (!listed) continue;
        AperturaLight other = aperturaLightAt(lights, k);
        AperturaCapLight nearer = aperturaCapSeenFrom(position, other, lightClass);
        bool ordered = aperturaIsSphere(light) && !aperturaStandsBefore(other, light, position);
        if (ordered || !aperturaMayOverlap(nearer, cap)) continue;
        if (!isBeside) {
            visible.mean = clamp(e / max(open, 1e-12f), 0.0f, 1.0f);
            visible.slope = aperturaSlopeOfVisibility(model, receiver, cap, visible.mean);
            isBeside = true;
        }
        visible = aperturaBoth(visible, aperturaLeftBy(receiver.normal, nearer, cap, lightClass), cap);
    }
    return isBeside ? open * visible.mean : e;
}

// The mean radiance of the sky that a model lets through, rgb: what its aperturaSkyIrradiance is multiplied with.
//   visibility  D, A, sr
APERTURA_FN vec3 aperturaSkyThrough(int model, vec3 normal, vec4 visibility, AperturaSky sky) {
    vec3 middle = aperturaOpeningCentroid(normal, vec3(visibility), visibility.w);
    if (model == APERTURA_MODEL_UNSHADOWED) middle = 2.0f / 3.0f * normal;
    return aperturaSkyMean(sky, middle);
}

// What a receiver gets from all lights and the sky together.
struct AperturaIrradiance {
    vec3 lights;  // rgb, W/m2
    vec3 hidden;  // rgb: what the sky would give from where the lights are
    float sky;    // E of a sky of unit radiance
};

// Adds a light with the E that reaches the receiver.
APERTURA_FN AperturaIrradiance aperturaWithLight(AperturaIrradiance sum, AperturaLight light, AperturaCapLight cap, float e,
                                                 AperturaSky sky) {
    sum.lights += e * vec3(light.radiance);
    sum.hidden += e * aperturaSkyBehind(light, cap, sky);
    return sum;
}

// What the sky gives, less what lights hide of it. `fromSky`: all that it gives, rgb, W/m2: aperturaSkyIrradiance times aperturaSkyThrough,
// or aperturaSkyBounced.
APERTURA_FN vec3 aperturaSkyBeside(AperturaIrradiance sum, vec3 fromSky) { return max(fromSky - sum.hidden, vec3(0.0f)); }

// rgb, W/m2, of several lights and the sky. Lights give no more than the whole opening with the largest radiance of any, `brightest`.
APERTURA_FN vec3 aperturaSumOf(AperturaIrradiance sum, vec3 fromSky, vec3 brightest) {
    return min(sum.lights, sum.sky * brightest) + aperturaSkyBeside(sum, fromSky);
}

// What the sky gives with what surfaces reflect of it, rgb, W/m2.
//   sky   E of a sky of unit radiance
//   mean  aperturaSkyThrough: what is reflected has entered by the same opening
APERTURA_FN vec3 aperturaSkyBounced(float sky, vec3 mean, AperturaBounce bounce) {
    return (float(APERTURA_PI) * bounce.share + vec3(sky)) * mean;
}

// What surfaces reflect of the frame's first lights, those at infinity, rgb, W/m2. What a lamp gives to surfaces near it depends on where
// they are, which nothing stored says. Lights that hide each other are all reflected.
APERTURA_FN vec3 aperturaBouncedLights(AperturaBounce bounce, APERTURA_LIGHT_LIST lights, int count, int lightClass) {
    vec3 sum = vec3(0.0f);
    for (int i = 0; i < count; ++i) {
        AperturaLight light = aperturaLightAt(lights, i);
        if (lightClass == APERTURA_LIGHTS_ANY && aperturaIsSphere(light)) continue;
        sum += vec3(light.radiance) * aperturaBouncedLight(bounce, light.cap);
    }
    return sum;
}

#endif
