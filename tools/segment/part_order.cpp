#include "part_order.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

namespace xgc::bake {

namespace {

/// Labels renumbered by first appearance, so that all that follows is indexed by a dense number.
struct DenseLabels {
    std::vector<uint32_t> ofFace;
    std::vector<uint32_t> label; ///< per dense number
};

DenseLabels makeDense(std::span<const uint32_t> faceLabels) {
    DenseLabels dense;
    dense.ofFace.reserve(faceLabels.size());
    std::unordered_map<uint32_t, uint32_t> numbers; // looked up, never iterated
    for (size_t f = 0; f < faceLabels.size(); ++f) {
        if (f > 0 && faceLabels[f] == faceLabels[f - 1]) { // most are
            dense.ofFace.push_back(dense.ofFace.back());
            continue;
        }
        const auto [at, isNew] = numbers.try_emplace(faceLabels[f], uint32_t(dense.label.size()));
        if (isNew) dense.label.push_back(faceLabels[f]);
        dense.ofFace.push_back(at->second);
    }
    return dense;
}

std::string uniqueName(const std::string& wanted, std::unordered_set<std::string>& taken) {
    std::string name = wanted;
    for (uint32_t n = 2; !taken.insert(name).second; ++n) name = wanted + "-" + std::to_string(n);
    return name;
}

} // namespace

std::vector<double> faceAreas(const Mesh& mesh) {
    std::vector<double> areas(mesh.faces.size());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 c = mesh.facePositions(f);
        const glm::dvec3 a(mesh.positions[c.x]), b(mesh.positions[c.y]), d(mesh.positions[c.z]);
        areas[f] = 0.5 * glm::length(glm::cross(b - a, d - a));
    }
    return areas;
}

Segmentation orderParts(const Mesh& mesh, std::span<const uint32_t> faceLabels, const PartNamer& name) {
    const DenseLabels dense = makeDense(faceLabels);
    const auto count = uint32_t(dense.label.size());
    const std::vector<double> faceArea = faceAreas(mesh);
    std::vector<double> area(count, 0.0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) area[dense.ofFace[f]] += faceArea[f];

    std::vector<uint32_t> order(count); // dense numbers rise with the lowest face: they break ties
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });

    Segmentation parts;
    std::vector<uint32_t> partOf(count);
    std::unordered_set<std::string> taken;
    for (uint32_t part = 0; part < count; ++part) {
        partOf[order[part]] = part;
        parts.partNames.push_back(uniqueName(name(part, dense.label[order[part]]), taken));
    }
    parts.facePart.reserve(mesh.faces.size());
    for (const uint32_t d : dense.ofFace) parts.facePart.push_back(partOf[d]);
    return parts;
}

} // namespace xgc::bake
