// A neutral studio: light from the sky, and a key, a fill and a rim light that hang on the camera, so that a shape reads
// the same from every side.
layout(location = 0) in vec3 inPosition;
layout(location = 1) in vec3 inNormal;
layout(location = 2) in vec4 inColor;
layout(location = 3) flat in uint inDraw;
layout(location = 5) flat in vec2 inMarks; // see vertex.glsl

const vec3 kSky = vec3(0.31, 0.345, 0.40);
const vec3 kGround = vec3(0.125, 0.105, 0.09);
const vec3 kKey = vec3(0.90, 0.85, 0.78);
const vec3 kFill = vec3(0.085, 0.11, 0.145);
const vec3 kRim = vec3(0.17, 0.19, 0.22);

// The normal on the side that is seen. The face's own plane decides which side that is, so two-sided surfaces, mirrored
// instances and inconsistent winding are all lit rightly.
vec3 seenNormal(vec3 toEye) {
    vec3 plane = cross(dFdx(inPosition), dFdy(inPosition));
    const float length2 = dot(plane, plane);
    plane = length2 > 0.0 ? plane * inversesqrt(length2) : toEye;
    if (dot(plane, toEye) < 0.0) plane = -plane;
    if (dot(inNormal, inNormal) == 0.0) return plane;
    const vec3 n = normalize(inNormal);
    return dot(n, plane) < 0.0 ? -n : n;
}

float shadowTexel(ViewRecord view, ivec2 at) {
    const ivec2 inside = clamp(at, ivec2(0), ivec2(int(view.shadowSize) - 1));
    return Floats(view.shadow).at[uint(inside.y) * view.shadowSize + uint(inside.x)];
}

// How much of the sun reaches the surface: bilinear comparisons over five by five texels. The point steps off its own
// surface along the normal, by more where light grazes it, so that no texel shadows itself.
float sunlight(ViewRecord view, vec3 n) {
    if (isNull(view.shadow)) return 1.0;
    const float facing = clamp(dot(n, view.sun.xyz), 0.0, 1.0);
    const vec3 off = inPosition + n * (view.sun.w * (1.0 + 3.0 * sqrt(1.0 - facing * facing)));
    const vec4 clip = view.worldToShadow * vec4(off, 1);
    const vec2 texel = (clip.xy / clip.w * 0.5 + 0.5) * float(view.shadowSize) - 0.5;
    if (any(lessThan(texel, vec2(0))) || any(greaterThanEqual(texel, vec2(float(view.shadowSize) - 1.0)))) return 1.0;
    const float depth = clip.z / clip.w;
    const ivec2 first = ivec2(floor(texel));
    const vec2 part = texel - vec2(first);
    float lit = 0.0;
    for (int y = -2; y <= 3; ++y) {
        const float rowWeight = y == -2 ? 1.0 - part.y : y == 3 ? part.y : 1.0;
        for (int x = -2; x <= 3; ++x) {
            const float weight = rowWeight * (x == -2 ? 1.0 - part.x : x == 3 ? part.x : 1.0);
            lit += shadowTexel(view, first + ivec2(x, y)) <= depth ? weight : 0.0;
        }
    }
    return lit / 25.0;
}

struct Surface {
    vec3 albedo;
    vec3 emissive;
    float metallic;
    float roughness;
};

// Out of doors: sky, the ground's glow, and the sun with its shadows.
vec3 lightOutdoors(Surface s, ViewRecord view, vec3 toEye, vec3 n) {
    const float facing = max(dot(n, view.sun.xyz), 0.0);
    const vec3 sun = view.sunColor.xyz * (facing > 0.0 ? sunlight(view, n) : 0.0);
    const float up = dot(n, view.sky.xyz);
    const vec3 ambient = mix(kGround, kSky, 0.5 + 0.5 * up) * 1.15;
    const vec3 halfway = normalize(view.sun.xyz + toEye);
    const float gloss = exp2(10.0 * (1.0 - s.roughness) + 2.0);
    const float sheen = pow(max(dot(n, halfway), 0.0), gloss) * (gloss + 8.0) / 64.0 * facing;
    const vec3 f0 = mix(vec3(0.04), s.albedo, s.metallic);
    return s.albedo * (1.0 - 0.7 * s.metallic) * (ambient + sun * facing) + f0 * sun * sheen + s.emissive;
}

vec3 light(Surface s, ViewRecord view) {
    const vec3 toEye = normalize(view.eye.xyz - inPosition);
    const vec3 n = seenNormal(toEye);
    if (view.sunColor.w != 0.0) return lightOutdoors(s, view, toEye, n);
    const vec3 key = normalize(-0.55 * view.right.xyz + 0.75 * view.up.xyz - 0.70 * view.forward.xyz);
    const vec3 fill = normalize(0.85 * view.right.xyz - 0.10 * view.up.xyz - 0.50 * view.forward.xyz);
    const vec3 rim = normalize(0.35 * view.right.xyz + 0.55 * view.up.xyz + 0.75 * view.forward.xyz);

    const vec3 ambient = mix(kGround, kSky, 0.5 + 0.5 * dot(n, view.sky.xyz));
    // Wrapped a little: no hard terminator.
    const float keyDiffuse = max((dot(n, key) + 0.12) / 1.12, 0.0);
    const vec3 diffuse =
        ambient + kKey * keyDiffuse + kFill * max(dot(n, fill), 0.0) + kRim * max(dot(n, rim), 0.0);

    const vec3 halfway = normalize(key + toEye);
    const float gloss = exp2(10.0 * (1.0 - s.roughness) + 2.0);
    const float sheen = pow(max(dot(n, halfway), 0.0), gloss) * (gloss + 8.0) / 64.0 * keyDiffuse;
    const vec3 f0 = mix(vec3(0.04), s.albedo, s.metallic);
    const float edge = pow(1.0 - max(dot(n, toEye), 0.0), 5.0);
    const vec3 mirror = (f0 + (1.0 - f0) * edge * (1.0 - s.roughness)) * ambient;
    return s.albedo * (1.0 - 0.7 * s.metallic) * diffuse + f0 * kKey * sheen + 0.5 * mirror * (1.0 - 0.8 * s.roughness) +
           s.emissive;
}

vec3 fromSrgb(uint hex) {
    const vec3 c = vec3((hex >> 16) & 255u, (hex >> 8) & 255u, hex & 255u) / 255.0;
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

// Twelve hues of about one lightness, neighbours in the list far apart on the wheel.
vec3 partColor(uint i) {
    const uint colors[kPartColorCount] =
        uint[](0xE6A15Au, 0x5B8FCBu, 0x8DBF67u, 0xC9705Fu, 0x9A7FC4u, 0x4FB3A9u, 0xE3C75Fu, 0xD487AFu, 0x7FA6A0u,
               0xB08A68u, 0x6FB5DCu, 0xB7C48Au);
    return fromSrgb(colors[i % kPartColorCount]);
}

// Fine is blue, coarse is pale yellow; lightness rises evenly, so the order shows in grey too. The root spreads the fine
// levels, where most patches are.
vec3 levelColor(float levelFraction) {
    const uint stops[9] = uint[](0x5560C4u, 0x4378CCu, 0x3A8DC4u, 0x37A6BAu, 0x4BBBA0u, 0x79CC7Fu, 0xADD864u, 0xDDE05Eu,
                                 0xFFEFA0u);
    const float x = sqrt(clamp(levelFraction, 0.0, 1.0)) * 8.0;
    const uint i = min(uint(x), 7u);
    return mix(fromSrgb(stops[i]), fromSrgb(stops[i + 1]), x - float(i));
}

// Of how much of the error that is allowed is there: indigo has room, amber has none left, and what is past it is white.
vec3 heatColor(float budgets) {
    const uint stops[6] = uint[](0x2C3566u, 0x5A4A94u, 0x9D4F95u, 0xD6617Au, 0xF28A55u, 0xF9BF4Au);
    if (budgets > 1.001) return vec3(1.0);
    const float x = clamp(budgets, 0.0, 1.0) * 5.0;
    const uint i = min(uint(x), 4u);
    return mix(fromSrgb(stops[i]), fromSrgb(stops[i + 1]), x - float(i));
}

// Projected error of the patch as it is seen at this fragment.
float budgetsSpent(ViewRecord view) {
    return inMarks.x * view.measure.w / max(distance(view.measure.xyz, inPosition), 1e-20);
}

Surface surfaceOf(DrawRecord draw, ViewRecord view) {
    const uint mode = view.mode;
    if (mode == kModeError) return Surface(heatColor(budgetsSpent(view)), vec3(0), 0.0, 0.85);
    if (mode == kModeParts) {
        const vec3 color = draw.partColor < kPartColorCount ? partColor(draw.partColor) : vec3(0.45);
        return Surface(color, vec3(0), 0.0, 0.7);
    }
    if (mode == kModeLevels) return Surface(levelColor(draw.levelFraction), vec3(0), 0.0, 0.8);
    if (mode == kModeWire) return Surface(vec3(0.56), vec3(0), 0.0, 0.9);
    const MaterialRecord m = Materials(push.materials).at[draw.material];
    // White is what most models without a material have: short of full reflection it keeps its shading.
    return Surface(0.80 * m.baseColor.rgb * inColor.rgb, m.emissive.rgb, m.metallic, m.roughness);
}

// What a host points at: warm, still lit, and aglow where it turns away, so that it shows among warm neighbours, too.
Surface highlight(Surface s, ViewRecord view) {
    const vec3 warm = fromSrgb(0xFF8A1Fu);
    const vec3 toEye = normalize(view.eye.xyz - inPosition);
    const float edge = 1.0 - max(dot(seenNormal(toEye), toEye), 0.0);
    const float glow = inMarks.y * (0.08 + 0.9 * edge * edge);
    return Surface(mix(s.albedo, warm, 0.50 * inMarks.y), s.emissive + glow * warm, s.metallic, s.roughness);
}
