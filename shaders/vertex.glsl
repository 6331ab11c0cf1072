// Where a vertex stands: shared by all vertex stages, so that a depth-only pass and a shaded one put it at the same
// place to the last bit. What a stage does not use of it, the compiler drops: a depth pass reads positions alone.
invariant gl_Position;

// Whether a draw's asset can be posed: others do not pay for it.
layout(constant_id = 0) const bool kPosable = false;

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

// What the targets of a pose add to a row.
void displace(InstanceRecord instance, uint row, inout vec3 position, inout vec3 normal) {
    Words deltas = Words(instance.morphDeltas);
    Floats weights = Floats(instance.morphWeights);
    const uint end = Words(instance.morphRows).at[row + 1];
    for (uint i = Words(instance.morphRows).at[row]; i < end; ++i) {
        const uint first = 7 * i;
        const float weight = weights.at[deltas.at[first]];
        position += weight * vec3(uintBitsToFloat(deltas.at[first + 1]), uintBitsToFloat(deltas.at[first + 2]),
                                  uintBitsToFloat(deltas.at[first + 3]));
        normal += weight * vec3(uintBitsToFloat(deltas.at[first + 4]), uintBitsToFloat(deltas.at[first + 5]),
                                uintBitsToFloat(deltas.at[first + 6]));
    }
}

// The mean of the matrices of a row's joints, as rows.
struct JointMean {
    vec4 x, y, z;
    float weight;
};

void addJoints(InstanceRecord instance, uint set, uint row, inout JointMean mean) {
    if (isNull(instance.joints[set])) return;
    Words joints = Words(instance.joints[set]);
    Vectors pose = Vectors(instance.pose);
    const vec4 weights = Vectors(instance.weights[set]).at[row];
    const uint low = joints.at[2 * row], high = joints.at[2 * row + 1];
    const uvec4 at = 3 * uvec4(low & 0xffff, low >> 16, high & 0xffff, high >> 16);
    for (uint k = 0; k < 4; ++k) {
        if (weights[k] == 0.0) continue;
        mean.x += weights[k] * pose.at[at[k]];
        mean.y += weights[k] * pose.at[at[k] + 1];
        mean.z += weights[k] * pose.at[at[k] + 2];
        mean.weight += weights[k];
    }
}

void skin(InstanceRecord instance, uint row, inout vec3 position, inout vec3 normal) {
    JointMean mean = JointMean(vec4(0), vec4(0), vec4(0), 0.0);
    addJoints(instance, 0, row, mean);
    addJoints(instance, 1, row, mean);
    const vec4 p = vec4(position, 1);
    position = vec3(dot(mean.x, p), dot(mean.y, p), dot(mean.z, p)) / mean.weight;
    const vec3 a = mean.x.xyz, b = mean.y.xyz, c = mean.z.xyz;
    normal = vec3(dot(cross(b, c), normal), dot(cross(c, a), normal), dot(cross(a, b), normal));
}

// A row where its pose puts it: xgc::posedPosition.
Vertex fetchVertex(InstanceRecord instance, uint row) {
    Vertex v = Vertex(fetchPosition(instance, row), fetchNormal(instance, row), fetchColor(instance, row));
    const bool moved = kPosable && !isNull(instance.morphWeights), skinned = kPosable && !isNull(instance.pose);
    if (moved) displace(instance, row, v.position, v.normal);
    if (skinned) skin(instance, row, v.position, v.normal);
    const float length2 = dot(v.normal, v.normal);
    if ((moved || skinned) && length2 > 0.0) v.normal *= inversesqrt(length2);
    return v;
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
        const bool last = share <= 0.0 || (share < 1.0 && count == kMorphRows);
        if (share < 1.0) addWeighted(sum, last ? rest : rest * (1.0 - share), fetchVertex(instance, row));
        if (last) break;
        if (share < 1.0) {
            rest *= share;
            ++count;
        }
        row = rows.at[2 * row]; // its target
    }
    if (count == 1) return sum;
    const float length2 = dot(sum.normal, sum.normal);
    if (length2 > 0.0) sum.normal *= inversesqrt(length2);
    return sum;
}

Vertex vertexOf(InstanceRecord instance, uint id, uint row) {
    if (isNull(push.lambdaOffsets)) return fetchVertex(instance, row);
    const uint firstLambda = Words(push.lambdaOffsets).at[id];
    return firstLambda == kNoLambdas ? fetchVertex(instance, row) : fetchMorphed(instance, firstLambda, row);
}

uint instanceOf(uint draw, uint instanceInDraw) {
    return Words(push.instanceIds).at[Draws(push.draws).at[draw].firstInstance + instanceInDraw];
}

// The vertex of an instance in the world; writes gl_Position.
Vertex placeVertex(uint row, uint id) {
    const InstanceRecord instance = Instances(push.instances).at[id];
    Vertex v = vertexOf(instance, id, row);
    const vec4 local = vec4(v.position, 1);
    precise const vec3 world =
        vec3(dot(instance.toWorld[0], local), dot(instance.toWorld[1], local), dot(instance.toWorld[2], local));
    precise const vec4 clip = Views(push.view).at.worldToClip * vec4(world, 1);
    gl_Position = clip;
    v.position = world;
    v.normal = turnNormal(instance, v.normal);
    return v;
}
