#pragma once

#include "builders.h"
#include "toy_hierarchy.h"

#include <xgc/asset.h>

#include <cstring>

namespace xgc::test {

/// A mesh, its hierarchy, and the asset that they became.
struct ToyAsset {
    bake::Mesh mesh;
    bake::Segmentation parts;
    bake::Hierarchy hierarchy;
    std::vector<std::byte> bytes;
    bake::AlignedBytes file;
    AssetView asset;
    std::string error; ///< empty where all went well
};

inline bake::AlignedBytes aligned(std::span<const std::byte> bytes) {
    bake::AlignedBytes copy;
    copy.blocks.resize((bytes.size() + 63) / 64);
    copy.size = bytes.size();
    std::memcpy(copy.blocks.data(), bytes.data(), bytes.size());
    return copy;
}

/// Welds a model, cuts it into slabs, and lays out what `build(mesh, parts)` makes of them.
template <typename Build>
ToyAsset assetOf(const bake::Model& model, uint32_t patches, const Build& build) {
    ToyAsset a;
    bake::WeldReport report;
    bake::Status s = bake::weld(model, {}, a.mesh, report);
    if (s.ok()) {
        a.parts = slabs(a.mesh, patches);
        // The last joins the one before, and so on.
        for (uint32_t i = patches; i-- > 1;) a.parts.merges.push_back({i - 1, i, 0.25f * float(patches - i)});
        a.hierarchy = build(a.mesh, a.parts);
        s = bake::checkHierarchy(a.mesh, a.hierarchy);
    }
    if (s.ok()) {
        s = bake::layOutAsset(a.mesh, a.parts, a.hierarchy, toyErrors(a.hierarchy), report.closed(),
                              R"({"tool":"toy"})", a.bytes);
    }
    a.error = s.message;
    if (!s.ok()) return a;
    a.file = aligned(a.bytes);
    const Status opened = openAll(a.file.span(), a.asset);
    if (!opened.ok()) a.error = opened.message;
    return a;
}

inline ToyAsset toyAsset(const bake::Model& model, uint32_t patches, const ToyOptions& options) {
    return assetOf(model, patches, [&](const bake::Mesh& mesh, const bake::Segmentation& parts) {
        return toyHierarchy(mesh, parts, options);
    });
}

/// The small asset of the attacks: three patches, boundaries that collapse, nodes and, if asked for, made
/// vertices.
inline ToyAsset smallAsset(bool makeVertices) {
    ToyOptions options;
    options.levelCount = 4;
    options.makeVertices = makeVertices;
    bake::Model model = sphere(4);
    model.nodes.push_back({"root", bake::kNone, glm::mat4(1)});
    model.nodes.push_back({"child", 0, glm::mat4(1)});
    return toyAsset(model, 3, options);
}

/// The small asset without made vertices, and with them; made once.
inline const ToyAsset& plain() {
    static const ToyAsset asset = smallAsset(false);
    return asset;
}

inline const ToyAsset& withMadeVertices() {
    static const ToyAsset asset = smallAsset(true);
    return asset;
}

} // namespace xgc::test
