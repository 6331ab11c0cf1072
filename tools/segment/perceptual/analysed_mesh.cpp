#include "analysed_mesh.h"

#include "../part_order.h"

namespace xgc::bake {

namespace {

/// Components below this share of the area have no parts of their own.
constexpr double kTinyShare = 0.002;

} // namespace

AnalysedMesh::AnalysedMesh(const Mesh& m, const Topology& t) : mesh(m), topology(t), linked(linkFaces(m, t)) {
    const std::vector<double> areas = faceAreas(mesh);
    std::vector<double> componentArea(linked.componentCount(), 0.0);
    double total = 0;
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        for (const uint32_t f : facesOf(c)) componentArea[c] += areas[f];
        total += componentArea[c];
    }
    PieceScratch scratch = {std::vector<uint32_t>(mesh.positions.size(), kNone),
                            std::vector<uint32_t>(mesh.faces.size(), kNone)};
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        const double share = total > 0 ? componentArea[c] / total : 0;
        if (share >= kTinyShare) {
            Piece piece = extractPiece(mesh, linked, facesOf(c), areas, componentArea[c], scratch);
            components.push_back(analyseComponent(std::move(piece), share));
            analysed.push_back(c);
        } else {
            tiny.push_back(c);
        }
    }
}

} // namespace xgc::bake
