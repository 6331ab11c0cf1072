// Shared by the indexed vertex stage and the one that fetches indices itself.
layout(location = 0) out vec3 outPosition; // world
layout(location = 1) out vec3 outNormal;   // world, zero where the asset has none
layout(location = 2) out vec4 outColor;    // linear
layout(location = 3) flat out uint outDraw;

vec3 decodeOctahedral(uint packed) {
    const vec2 e = unpackSnorm2x16(packed);
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    const float fold = max(-n.z, 0.0);
    n.xy -= vec2(n.x >= 0.0 ? fold : -fold, n.y >= 0.0 ? fold : -fold);
    return normalize(n);
}

vec4 fetchColor(InstanceRecord instance, uint row) {
    if (isNull(instance.colors)) return vec4(1);
    if (instance.colorFormat == kFormatF32x4) {
        Floats f = Floats(instance.colors);
        return vec4(f.at[4 * row], f.at[4 * row + 1], f.at[4 * row + 2], f.at[4 * row + 3]);
    }
    return unpackUnorm4x8(Words(instance.colors).at[row]);
}

// The cofactors of the placement's linear part turn normals rightly under any scale.
vec3 turnNormal(InstanceRecord instance, vec3 n) {
    const vec3 a = instance.toWorld[0].xyz, b = instance.toWorld[1].xyz, c = instance.toWorld[2].xyz;
    return vec3(dot(cross(b, c), n), dot(cross(c, a), n), dot(cross(a, b), n));
}

void shadeVertex(uint row, uint draw, uint instanceInDraw) {
    const uint id = Words(push.instanceIds).at[Draws(push.draws).at[draw].firstInstance + instanceInDraw];
    const InstanceRecord instance = Instances(push.instances).at[id];
    Floats f = Floats(instance.positions);
    const vec4 local = vec4(f.at[3 * row], f.at[3 * row + 1], f.at[3 * row + 2], 1);
    outPosition = vec3(dot(instance.toWorld[0], local), dot(instance.toWorld[1], local), dot(instance.toWorld[2], local));
    outNormal = isNull(instance.normals)
                    ? vec3(0)
                    : turnNormal(instance, decodeOctahedral(Words(instance.normals).at[row]));
    outColor = fetchColor(instance, row);
    outDraw = draw;
    gl_Position = Views(push.view).at.worldToClip * vec4(outPosition, 1);
}
