#include "part_order.h"

#include <algorithm>
#include <functional>
#include <unordered_map>

namespace xgc::bake {

namespace {

/// A label holds a part where it has this share of its area.
constexpr double kHeld = 0.9;

bool areAllAlike(std::span<const uint32_t> labels) {
    return std::adjacent_find(labels.begin(), labels.end(), std::not_equal_to<>()) == labels.end();
}

/// Per part: the label that holds it and no other part, or kNone. Nothing where all faces have the same.
std::vector<uint32_t> holders(const Segmentation& parts, std::span<const uint32_t> faceLabels,
                              std::span<const double> faceAreas) {
    const size_t count = parts.partCount();
    std::vector<uint32_t> holder(count, kNone);
    if (areAllAlike(faceLabels)) return holder;
    // A label of more than half of the area is left over when unequal labels cancel out (Boyer and Moore 1991).
    std::vector<double> left(count, 0.0), area(count, 0.0), held(count, 0.0);
    for (size_t f = 0; f < faceLabels.size(); ++f) {
        const uint32_t part = parts.facePart[f];
        if (faceLabels[f] != holder[part] && faceAreas[f] > left[part]) {
            holder[part] = faceLabels[f];
            left[part] = faceAreas[f] - left[part];
        } else {
            left[part] += faceLabels[f] == holder[part] ? faceAreas[f] : -faceAreas[f];
        }
    }
    for (size_t f = 0; f < faceLabels.size(); ++f) {
        const uint32_t part = parts.facePart[f];
        area[part] += faceAreas[f];
        if (faceLabels[f] == holder[part]) held[part] += faceAreas[f];
    }
    std::unordered_map<uint32_t, uint32_t> partCounts; // looked up, never iterated
    for (size_t p = 0; p < count; ++p) {
        if (!(held[p] >= kHeld * area[p])) holder[p] = kNone;
        if (holder[p] != kNone) ++partCounts[holder[p]];
    }
    for (uint32_t& label : holder) {
        if (label != kNone && partCounts[label] > 1) label = kNone;
    }
    return holder;
}

} // namespace

void nameParts(const Mesh& mesh, Segmentation& parts) {
    if (areAllAlike(mesh.faceNode) && areAllAlike(mesh.faceMaterial)) return; // nothing to name them by
    const std::vector<double> areas = faceAreas(mesh);
    const std::vector<uint32_t> nodes = holders(parts, mesh.faceNode, areas);
    const std::vector<uint32_t> materials = holders(parts, mesh.faceMaterial, areas);
    std::vector<std::string> wanted(parts.partCount());
    std::unordered_map<std::string, uint32_t> uses; // looked up, never iterated
    for (const std::string& name : parts.partNames) ++uses[name];
    for (uint32_t p = 0; p < wanted.size(); ++p) {
        if (nodes[p] != kNone) wanted[p] = mesh.nodes[nodes[p]].name;
        if (wanted[p].empty() && materials[p] != kNone) wanted[p] = mesh.materials[materials[p]].name;
        ++uses[wanted[p]];
    }
    for (uint32_t p = 0; p < wanted.size(); ++p) {
        if (!wanted[p].empty() && uses[wanted[p]] == 1) parts.partNames[p] = wanted[p];
    }
}

} // namespace xgc::bake
