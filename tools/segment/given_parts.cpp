#include "part_order.h"

#include <cassert>

namespace xgc::bake {

Segmentation segmentNone(const Mesh& mesh) {
    const std::vector<uint32_t> labels(mesh.faces.size(), 0);
    return orderParts(mesh, labels, [](uint32_t, uint32_t) { return std::string("all"); });
}

Segmentation segmentByMaterial(const Mesh& mesh) {
    return orderParts(mesh, mesh.faceMaterial, [&](uint32_t, uint32_t material) {
        const std::string& name = mesh.materials[material].name;
        return name.empty() ? "material-" + std::to_string(material) : name;
    });
}

Segmentation segmentByComponent(const Mesh& mesh, const Topology& topology) {
    return orderParts(mesh, topology.faceComponent,
                      [](uint32_t part, uint32_t) { return "component-" + std::to_string(part); });
}

Segmentation segmentByLabels(const Mesh& mesh, std::span<const uint32_t> inputLabels) {
    assert(inputLabels.size() == mesh.inputFaceCount);
    std::vector<uint32_t> labels;
    labels.reserve(mesh.faces.size());
    for (const uint32_t input : mesh.faceInput) labels.push_back(inputLabels[input]);
    return orderParts(mesh, labels, [](uint32_t, uint32_t label) { return "label-" + std::to_string(label); });
}

std::vector<uint32_t> inputLabels(const Mesh& mesh, const Segmentation& parts) {
    std::vector<uint32_t> labels(mesh.inputFaceCount, 0);
    if (mesh.faces.empty()) return labels;
    uint32_t next = 0; // first kept face at or behind the input face
    for (uint32_t i = 0; i < mesh.inputFaceCount; ++i) {
        while (next < mesh.faceCount() && mesh.faceInput[next] < i) ++next;
        uint32_t nearest = next;
        if (next == mesh.faceCount()) {
            nearest = next - 1;
        } else if (next > 0 && mesh.faceInput[next] > i && i - mesh.faceInput[next - 1] <= mesh.faceInput[next] - i) {
            nearest = next - 1;
        }
        labels[i] = parts.facePart[nearest];
    }
    return labels;
}

} // namespace xgc::bake
