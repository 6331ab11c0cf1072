#pragma once

#include "component.h"

namespace xgc::bake {

/// A mesh with all that was found out about its components.
struct AnalysedMesh {
    const Mesh& mesh;
    const Topology& topology;
    LinkedFaces linked;
    std::vector<Component> components; ///< those with parts of their own
    std::vector<uint32_t> analysed;    ///< of linked: these
    std::vector<uint32_t> tiny;        ///< of linked: the rest

    AnalysedMesh(const Mesh& m, const Topology& t);

    /// Of a component of `linked`.
    std::span<const uint32_t> facesOf(uint32_t component) const {
        const uint32_t begin = linked.componentOffsets[component];
        return std::span(linked.componentFaces).subspan(begin, linked.componentOffsets[component + 1] - begin);
    }
};

/// Regions of every analysed component.
using RegionsOfAll = std::vector<CellRegions>;

} // namespace xgc::bake
