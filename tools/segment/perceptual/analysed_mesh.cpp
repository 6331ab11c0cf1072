#include "analysed_mesh.h"

#include "../part_order.h"

#include <tbb/parallel_for.h>

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
    std::vector<Piece> pieces;
    std::vector<double> shares;
    for (uint32_t c = 0; c < linked.componentCount(); ++c) {
        const double share = total > 0 ? componentArea[c] / total : 0;
        if (share >= kTinyShare) {
            pieces.push_back(extractPiece(mesh, linked, facesOf(c), areas, componentArea[c], scratch));
            shares.push_back(share);
            analysed.push_back(c);
        } else {
            tiny.push_back(c);
        }
    }
    scratch = {};
    components.resize(pieces.size());
    tbb::parallel_for(size_t(0), pieces.size(),
                      [&](size_t i) { components[i] = analyseComponent(std::move(pieces[i]), shares[i]); });
}

} // namespace xgc::bake
