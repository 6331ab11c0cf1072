// Shared by the indexed vertex stage and the one that fetches indices itself.
layout(location = 0) out vec3 outPosition; // world
layout(location = 1) out vec3 outNormal;   // world, zero where the asset has none
layout(location = 2) out vec4 outColor;    // linear
layout(location = 3) flat out uint outDraw;
layout(location = 5) flat out vec2 outMarks; // error in world units; 1 where highlighted

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

vec3 fetchPosition(InstanceRecord instance, uint row) {
    Floats f = Floats(instance.positions);
    return vec3(f.at[3 * row], f.at[3 * row + 1], f.at[3 * row + 2]);
}

// Zero where the asset has none.
vec3 fetchNormal(InstanceRecord instance, uint row) {
    return isNull(instance.normals) ? vec3(0) : decodeOctahedral(Words(instance.normals).at[row]);
}

// A vertex in mesh space.
struct Vertex {
    vec3 position;
    vec3 normal;
    vec4 color;
};

void addWeighted(inout Vertex sum, float weight, Vertex v) {
    sum.position += weight * v.position;
    sum.normal += weight * v.normal;
    sum.color += weight * v.color;
}

Vertex fetchVertex(InstanceRecord instance, uint row) {
    return Vertex(fetchPosition(instance, row), fetchNormal(instance, row), fetchColor(instance, row));
}

// A geomorph, as xgc::morph does it on the CPU (xgc/morph.h). All patches that draw a row compute this from the same
// numbers by the same code, so they put it at the same place. `firstLambda`: of the instance's groups.
Vertex fetchMorphed(InstanceRecord instance, uint firstLambda, uint row) {
    Words rows = Words(instance.morphs);
    Floats lambdas = Floats(push.lambdas);
    Vertex sum = Vertex(vec3(0), vec3(0), vec4(0));
    float rest = 1.0;
    uint count = 1;
    for (;;) {
        const uint groupAndLevel = rows.at[2 * row + 1];
        const float lambda = lambdas.at[firstLambda + (groupAndLevel & 0xffffff)];
        const float share = clamp(lambda - (float(groupAndLevel >> 24) - 1.0), 0.0, 1.0);
        if (share <= 0.0 || (share < 1.0 && count == kMorphRows)) break;
        if (share < 1.0) {
            addWeighted(sum, rest * (1.0 - share), fetchVertex(instance, row));
            rest *= share;
            ++count;
        }
        row = rows.at[2 * row]; // its target
    }
    if (count == 1) return fetchVertex(instance, row);
    addWeighted(sum, rest, fetchVertex(instance, row));
    const float length2 = dot(sum.normal, sum.normal);
    if (length2 > 0.0) sum.normal *= inversesqrt(length2);
    return sum;
}

Vertex vertexOf(InstanceRecord instance, uint id, uint row) {
    if (isNull(push.lambdaOffsets)) return fetchVertex(instance, row);
    const uint firstLambda = Words(push.lambdaOffsets).at[id];
    return firstLambda == kNoLambdas ? fetchVertex(instance, row) : fetchMorphed(instance, firstLambda, row);
}

void shadeVertex(uint row, uint draw, uint instanceInDraw) {
    const uint id = Words(push.instanceIds).at[Draws(push.draws).at[draw].firstInstance + instanceInDraw];
    const InstanceRecord instance = Instances(push.instances).at[id];
    const Vertex v = vertexOf(instance, id, row);
    const vec4 local = vec4(v.position, 1);
    outPosition = vec3(dot(instance.toWorld[0], local), dot(instance.toWorld[1], local), dot(instance.toWorld[2], local));
    outNormal = turnNormal(instance, v.normal);
    outColor = v.color;
    outDraw = draw;
    const DrawRecord record = Draws(push.draws).at[draw];
    ViewRecord view = Views(push.view).at;
    const bool highlighted = id == view.highlightInstance && record.part == view.highlightPart;
    outMarks = vec2(record.error * instance.maxScale, highlighted ? 1 : 0);
    gl_Position = view.worldToClip * vec4(outPosition, 1);
}
