#include "open.h"

#include <algorithm>
#include <cmath>

// What lets joints and blend shapes move the rows of an asset: shaders follow these numbers without a test.

namespace xgc {
namespace {

using namespace format;

bool finite(std::span<const float> values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

/// Numbers of at least 0 that do not fall from one level to the next.
bool neverFalls(float before, float value) {
    return std::isfinite(value) && value >= 0 && value >= before;
}

Status checkPatchJoints(const AssetView& v, uint32_t patch, uint64_t& next) {
    const PatchRecord& p = v.patches[patch];
    if (p.firstJoint != next || p.jointCount == 0 || p.jointCount > v.patchJoints.size() - next)
        return corrupt("patch with a wrong run of joints", patch);
    const std::span<const PatchJoint> run = v.patchJoints.subspan(p.firstJoint, p.jointCount);
    for (size_t i = 0; i < run.size(); ++i) {
        if (run[i].joint >= v.joints.size() || (i > 0 && run[i].joint <= run[i - 1].joint))
            return corrupt("patch with joints out of order or range", patch);
        if (!finite(run[i].center) || !std::isfinite(run[i].radius) || !(run[i].radius >= 0))
            return corrupt("patch with a sphere of a joint that is not finite", patch);
    }
    next += p.jointCount;
    return {};
}

/// Null where there is none.
const VertexStream* streamOf(std::span<const VertexStream> streams, StreamKind kind, uint32_t set) {
    for (const VertexStream& s : streams) {
        if (s.kind == kind && s.set == set) return &s;
    }
    return nullptr;
}

/// Each row names joints that are there, by weights of at least 0 of which some are above it.
Status checkRows(size_t jointCount, std::span<const VertexStream* const> joints,
                 std::span<const VertexStream* const> weights, uint32_t rowCount) {
    for (uint32_t row = 0; row < rowCount; ++row) {
        float sum = 0;
        for (size_t set = 0; set < joints.size() && joints[set]; ++set) {
            const auto* j = reinterpret_cast<const uint16_t*>(joints[set]->bytes.data()) + 4 * size_t(row);
            const auto* w = reinterpret_cast<const float*>(weights[set]->bytes.data()) + 4 * size_t(row);
            for (int k = 0; k < 4; ++k) {
                if (j[k] >= jointCount) return corrupt("vertex row that names a joint that is not there", row);
                if (!std::isfinite(w[k]) || !(w[k] >= 0)) return corrupt("vertex row with a wrong weight", row);
                sum += w[k];
            }
        }
        if (!(sum > 0) || !std::isfinite(sum)) return corrupt("vertex row without a weight", row);
    }
    return {};
}

} // namespace

Status checkSkins(const AssetView& v) {
    if (v.joints.empty()) {
        if (!v.patchJoints.empty() || !v.skinErrors.empty()) return corrupt("joints of patches without section skins");
        return {};
    }
    for (uint32_t i = 0; i < v.joints.size(); ++i) {
        if (v.joints[i].node >= v.nodes.size()) return corrupt("joint of a node that is not there", i);
        if (!finite(v.joints[i].inverseBind)) return corrupt("joint with a transform that is not finite", i);
    }
    uint64_t next = 0;
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        if (Status s = checkPatchJoints(v, p, next); !s.ok()) return s;
    }
    if (next != v.patchJoints.size()) return corrupt("section patchJoints holds more than the patches do");
    const uint32_t levelCount = v.record->levelCount;
    if (v.skinErrors.size() != uint64_t(v.record->patchCount) * levelCount)
        return corrupt("section skinErrors has another count than patches times levels");
    for (size_t i = 0; i < v.skinErrors.size(); ++i) {
        const SkinError before = i % levelCount ? v.skinErrors[i - 1] : SkinError{};
        if (!neverFalls(before.weight, v.skinErrors[i].weight) || !neverFalls(before.moment, v.skinErrors[i].moment))
            return corrupt("patch with a wrong error of its skin", i / levelCount);
    }
    return {};
}

Status checkMorphTargets(const AssetView& v) {
    const size_t targets = v.morphTargets.size();
    if (targets == 0) {
        if (!v.morphRows.empty() || !v.morphDeltas.empty() || !v.morphReach.empty() || !v.morphErrors.empty())
            return corrupt("displacements without section morphTargets");
        return {};
    }
    const uint32_t levelCount = v.record->levelCount;
    if (v.morphRows.size() != uint64_t(v.record->vertexCount) + 1 || v.morphRows.front() != 0 ||
        v.morphRows.back() != v.morphDeltas.size() || !std::is_sorted(v.morphRows.begin(), v.morphRows.end()))
        return corrupt("section morphRows does not cut morphDeltas into rows");
    if (v.morphReach.size() != uint64_t(v.record->patchCount) * targets)
        return corrupt("section morphReach has another count than patches times targets");
    if (v.morphErrors.size() != uint64_t(v.record->patchCount) * levelCount * targets)
        return corrupt("section morphErrors has another count than patches times levels times targets");
    for (uint32_t i = 0; i < targets; ++i) {
        const Text name = v.morphTargets[i].name;
        if (name.offset > v.strings.size() || name.bytes > v.strings.size() - name.offset)
            return corrupt("morph target with a name past the strings", i);
    }
    for (size_t i = 0; i < v.morphDeltas.size(); ++i) {
        const MorphDelta& d = v.morphDeltas[i];
        if (d.target >= targets || !finite(d.position) || !finite(d.normal))
            return corrupt("displacement of a wrong target, or not finite", i);
    }
    for (size_t i = 0; i < v.morphReach.size(); ++i) {
        if (!neverFalls(0, v.morphReach[i])) return corrupt("patch with a wrong reach of a target", i / targets);
    }
    for (size_t i = 0; i < v.morphErrors.size(); ++i) {
        const float before = i / targets % levelCount ? v.morphErrors[i - targets] : 0.0f;
        if (!neverFalls(before, v.morphErrors[i]))
            return corrupt("patch with a wrong error of a target", i / targets / levelCount);
    }
    return {};
}

Status checkSkinRows(const AssetView& v, std::span<const VertexStream> streams, uint32_t rowCount) {
    if (v.joints.empty()) return {};
    const VertexStream* joints[2] = {};
    const VertexStream* weights[2] = {};
    for (uint32_t set = 0; set < 2; ++set) {
        joints[set] = streamOf(streams, StreamKind::joints, set);
        weights[set] = streamOf(streams, StreamKind::weights, set);
        const bool alike = bool(joints[set]) == bool(weights[set]) && (joints[set] || set > 0);
        if (!alike) return corrupt("the asset has skins, but not joints and weights in pairs", set);
        if (!joints[set]) continue;
        if (joints[set]->format != StreamFormat::u16x4 || weights[set]->format != StreamFormat::f32x4 ||
            joints[set]->stride != 8 || weights[set]->stride != 16)
            return unsupported("joints are not u16x4 or weights not f32x4: bake the model with this version", set);
    }
    return checkRows(v.joints.size(), joints, weights, rowCount);
}

} // namespace xgc
