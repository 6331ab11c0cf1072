#include <import/model_builder.h>

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {

Status ModelBuilder::beginRows(uint64_t count, uint32_t& first) {
    const uint64_t rows = model_.positions.size() + count;
    if (rows > limits_.maxVertices)
        return badInput(fmt::format("{}: more than {} vertices with all instances; split the model", model_.file,
                                    limits_.maxVertices));
    first = first_ = uint32_t(model_.positions.size());
    model_.positions.resize(rows);
    return {};
}

void ModelBuilder::endRows() {
    Attributes& a = model_.attributes;
    if (!a.normals.empty()) normals();
    if (!a.tangents.empty()) tangents();
    for (size_t i = 0; i < a.uvs.size(); ++i) {
        if (!a.uvs[i].empty()) uvs(i);
    }
    for (size_t i = 0; i < a.colors.size(); ++i) {
        if (!a.colors[i].empty()) colors(i);
    }
    for (size_t i = 0; i < a.joints.size(); ++i) {
        if (!a.joints[i].empty()) joints(i);
        if (!a.weights[i].empty()) weights(i);
    }
    for (MorphTarget& t : a.morphTargets) {
        for (std::vector<glm::vec3>* c : {&t.positions, &t.normals, &t.tangents}) {
            if (!c->empty()) column(*c, glm::vec3(0));
        }
    }
}

Status ModelBuilder::checkFaces(uint64_t more) const {
    if (model_.inputFaceCount + more <= limits_.maxFaces && model_.triangles.size() + more <= limits_.maxFaces)
        return {};
    return badInput(
        fmt::format("{}: more than {} faces with all instances; split the model", model_.file, limits_.maxFaces));
}

void ModelBuilder::addTriangle(const glm::uvec3& rows, uint32_t face, uint32_t material, uint32_t node) {
    model_.triangles.push_back(rows);
    model_.triangleFace.push_back(face);
    model_.triangleMaterial.push_back(material);
    model_.triangleNode.push_back(node);
}

Model ModelBuilder::finish() {
    const auto unnamed = uint32_t(model_.materials.size());
    bool needed = model_.materials.empty();
    for (uint32_t& m : model_.triangleMaterial) {
        needed = needed || m == kNone;
        m = std::min(m, unnamed);
    }
    if (needed) model_.materials.emplace_back().name = "default";
    return std::move(model_);
}

} // namespace xgc::bake
