#include <xgc/skin.h>

#include "largest_scale.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace xgc {
namespace {

using namespace format;

constexpr float kRoundUp = 1 + 1e-5f; // rounding of a few products and sums

glm::mat4 inverseBind(const JointRecord& joint) {
    const float* m = joint.inverseBind;
    return {{m[0], m[1], m[2], 0}, {m[3], m[4], m[5], 0}, {m[6], m[7], m[8], 0}, {m[9], m[10], m[11], 1}};
}

glm::mat3 linearOf(const glm::mat4x3& m) {
    return glm::mat3(m[0], m[1], m[2]);
}

/// At least the largest singular value.
float frobenius(const glm::mat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

const VertexStream* streamOf(const AssetView& asset, StreamKind kind, uint32_t set) {
    for (uint32_t i = 0; i < asset.vertexStreamCount; ++i) {
        const VertexStream& s = asset.vertexStreams[i];
        if (s.kind == kind && s.set == set) return &s;
    }
    return nullptr;
}

/// Displacements of a patch's rows are no longer than this.
float reachOf(const AssetView& asset, uint32_t patch, std::span<const float> weights) {
    float reach = 0;
    for (size_t t = 0; t < weights.size(); ++t) {
        reach += std::fabs(weights[t]) * asset.morphReach[patch * weights.size() + t];
    }
    return reach * kRoundUp;
}

/// A box around spheres, and then a sphere around them.
class SphereHull {
public:
    void add(const glm::vec4& s) {
        low_ = glm::min(low_, glm::vec3(s) - s.w);
        high_ = glm::max(high_, glm::vec3(s) + s.w);
    }
    glm::vec3 center() const { return 0.5f * (low_ + high_); }

private:
    glm::vec3 low_{INFINITY}, high_{-INFINITY};
};

float reaches(const glm::vec3& center, const glm::vec4& sphere) {
    return (glm::distance(center, glm::vec3(sphere)) + sphere.w) * kRoundUp;
}

/// Where a joint takes the sphere of its rows.
glm::vec4 movedSphere(const PatchJoint& joint, const glm::mat4x3& matrix, float reach) {
    const glm::vec3 center(joint.center[0], joint.center[1], joint.center[2]);
    const glm::vec3 moved = matrix * glm::vec4(center, 1);
    const glm::vec3 rounding = glm::abs(moved) + glm::abs(matrix[3]);
    const float slack = (rounding.x + rounding.y + rounding.z) * 1e-6f;
    return {moved, (joint.radius + reach) * largestScale(linearOf(matrix)) * kRoundUp + slack};
}

glm::vec4 sphereOf(const PatchRecord& patch) {
    return {patch.sphereCenter[0], patch.sphereCenter[1], patch.sphereCenter[2], patch.sphereRadius};
}

PosedPatch posePatch(const AssetView& asset, uint32_t patch, const Pose& pose) {
    const glm::vec4 rest = sphereOf(asset.patches[patch]);
    const float reach = reachOf(asset, patch, pose.morphWeights);
    PosedPatch out;
    const std::span<const PatchJoint> joints = asset.jointsOf(patch);
    if (joints.empty() || pose.joints.empty()) {
        out.sphere = {glm::vec3(rest), (rest.w + reach) * kRoundUp};
        return out;
    }
    SphereHull hull;
    const glm::mat4x3& first = pose.joints[joints[0].joint];
    out.stretch = largestScale(linearOf(first));
    for (const PatchJoint& joint : joints) {
        const glm::mat4x3& matrix = pose.joints[joint.joint];
        hull.add(movedSphere(joint, matrix, reach));
        const glm::mat4x3 apart = matrix - first;
        const glm::vec3 offset = apart * glm::vec4(glm::vec3(rest), 1);
        out.offset = std::max(out.offset, glm::length(offset) * kRoundUp);
        out.bend = std::max(out.bend, frobenius(linearOf(apart)) * kRoundUp);
    }
    float radius = 0;
    for (const PatchJoint& joint : joints) {
        radius = std::max(radius, reaches(hull.center(), movedSphere(joint, pose.joints[joint.joint], reach)));
    }
    out.sphere = {hull.center(), radius};
    // Displacements that differ in what their joints do to them.
    out.added = 2 * out.bend * reach;
    return out;
}

} // namespace

void nodesToMesh(const AssetView& asset, std::span<const glm::mat4> toParent, std::span<glm::mat4> toMesh) {
    assert(toParent.size() >= asset.nodes.size() && toMesh.size() >= asset.nodes.size());
    for (size_t i = 0; i < asset.nodes.size(); ++i) {
        const uint32_t parent = asset.nodes[i].parent;
        toMesh[i] = parent == kNone ? toParent[i] : toMesh[parent] * toParent[i];
    }
}

void restNodes(const AssetView& asset, std::span<glm::mat4> toMesh) {
    assert(toMesh.size() >= asset.nodes.size());
    for (size_t i = 0; i < asset.nodes.size(); ++i) {
        for (int k = 0; k < 16; ++k) toMesh[i][k / 4][k % 4] = asset.nodes[i].toMesh[k];
    }
}

void jointMatrices(const AssetView& asset, std::span<const glm::mat4> toMesh, std::span<glm::mat4x3> out) {
    assert(toMesh.size() >= asset.nodes.size() && out.size() >= asset.joints.size());
    for (size_t j = 0; j < asset.joints.size(); ++j) {
        out[j] = glm::mat4x3(toMesh[asset.joints[j].node] * inverseBind(asset.joints[j]));
    }
}

glm::vec3 posedPosition(const AssetView& asset, const Pose& pose, uint32_t row) {
    glm::vec3 p = asset.positions[row];
    if (!pose.morphWeights.empty()) {
        for (uint32_t i = asset.morphRows[row]; i < asset.morphRows[row + 1]; ++i) {
            const MorphDelta& d = asset.morphDeltas[i];
            p += pose.morphWeights[d.target] * glm::vec3(d.position[0], d.position[1], d.position[2]);
        }
    }
    if (pose.joints.empty()) return p;
    glm::mat4x3 sum(0);
    float total = 0;
    for (uint32_t set = 0; set < 2; ++set) {
        const VertexStream* joints = streamOf(asset, StreamKind::joints, set);
        const VertexStream* weights = streamOf(asset, StreamKind::weights, set);
        if (!joints || !weights) break;
        const auto* j = reinterpret_cast<const uint16_t*>(joints->bytes.data()) + 4 * size_t(row);
        const auto* w = reinterpret_cast<const float*>(weights->bytes.data()) + 4 * size_t(row);
        for (int k = 0; k < 4; ++k) {
            sum += w[k] * pose.joints[j[k]];
            total += w[k];
        }
    }
    return sum * glm::vec4(p, 1) / total;
}

glm::vec4 posePatches(const AssetView& asset, const Pose& pose, std::span<PosedPatch> out) {
    assert(out.size() >= asset.patchCount());
    assert(pose.joints.empty() || pose.joints.size() == asset.joints.size());
    assert(pose.morphWeights.empty() || pose.morphWeights.size() == asset.morphTargets.size());
    SphereHull hull;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        out[p] = posePatch(asset, p, pose);
        hull.add(out[p].sphere);
    }
    float radius = 0;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) radius = std::max(radius, reaches(hull.center(), out[p].sphere));
    return {hull.center(), radius};
}

float posedError(const AssetView& asset, uint32_t patch, uint32_t level, const PosedPatch& posed,
                 std::span<const float> morphWeights) {
    const float* errors = asset.patchErrors.data() + size_t(patch) * asset.levelCount();
    const size_t at = size_t(patch) * asset.levelCount() + level;
    float own = errors[level];
    for (size_t t = 0; t < morphWeights.size(); ++t) {
        own += std::fabs(morphWeights[t]) * asset.morphErrors[at * morphWeights.size() + t];
    }
    float error = posed.stretch * own;
    if (posed.bend > 0 || posed.offset > 0) {
        const SkinError& skin = asset.skinErrors[at];
        error += posed.offset * skin.weight + posed.bend * skin.moment;
        // Where nothing changes from level 0, nothing does in a pose.
        if (own > 0 || skin.moment > 0) error += posed.added;
    }
    return error;
}

} // namespace xgc
