#include "hierarchy/surface_state.h"

#include "hierarchy/first_domains.h"

#include <glm/common.hpp>

#include <numeric>

namespace xgc::bake {

namespace {

std::vector<std::vector<uint32_t>> firstSets(const Mesh& mesh, const PatchAssignment& assignment,
                                             std::vector<uint32_t>& domain) {
    Hierarchy h;
    h.patches = assignment.patches;
    h.facePatch = assignment.facePatch;
    h.domain.resize(mesh.positions.size());
    assignFirstDomains(mesh, h);
    domain = std::move(h.domain);
    return std::move(h.domainPatches);
}

/// True where two faces run along their edge in the same direction.
bool isInconsistent(const Mesh& mesh, const Topology& topology, uint32_t edge) {
    const std::span<const uint32_t> faces = topology.facesOfEdge(edge);
    const auto upwards = [&](uint32_t f) {
        const glm::uvec3 e = topology.faceEdges[f];
        const int k = e.x == edge ? 0 : e.y == edge ? 1 : 2;
        return mesh.facePositions(f)[k] == topology.edges[edge].x;
    };
    return faces.size() == 2 && upwards(faces[0]) == upwards(faces[1]);
}

} // namespace

SurfaceState::SurfaceState(const Mesh& m, const Topology& topology, const PatchAssignment& assignment)
    : mesh(m), domains(firstSets(m, assignment, domain)) {
    const size_t n = mesh.positions.size();
    isBoundary.assign(n, 0);
    collapseLevel.assign(n, kNeverCollapses);
    parent.assign(n, kNone);
    representative.resize(n);
    std::iota(representative.begin(), representative.end(), 0u);
    groupNext = representative;
    costScale.assign(n, 1);
    wedgeParent.assign(mesh.wedgePosition.size(), kNone);
    wedgeRepresentative.resize(mesh.wedgePosition.size());
    std::iota(wedgeRepresentative.begin(), wedgeRepresentative.end(), 0u);

    glm::dvec3 low(mesh.positions.front()), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    origin = (low + high) / 2.0;
    diagonal = glm::length(high - low);
    buildPatches(assignment);
    listWedges();
    classify(topology);
}

void SurfaceState::buildPatches(const PatchAssignment& assignment) {
    std::vector<uint32_t> start(assignment.patches.size() + 1, 0), faces(mesh.faces.size());
    for (const uint32_t p : assignment.facePatch) ++start[p + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<uint32_t> at(start.begin(), start.end() - 1);
    for (uint32_t f = 0; f < faces.size(); ++f) faces[at[assignment.facePatch[f]]++] = f;

    std::vector<uint32_t> localOf(mesh.positions.size(), kNone);
    firstOccurrence.assign(mesh.positions.size() + 1, 0);
    patches.reserve(assignment.patches.size());
    for (uint32_t p = 0; p < assignment.patches.size(); ++p) {
        patches.emplace_back(mesh, std::span(faces).subspan(start[p], start[p + 1] - start[p]), localOf);
        for (const uint32_t v : patches.back().position) ++firstOccurrence[v + 1];
    }
    std::partial_sum(firstOccurrence.begin(), firstOccurrence.end(), firstOccurrence.begin());
    occurrences.resize(firstOccurrence.back());
    std::vector<uint32_t> slot(firstOccurrence.begin(), firstOccurrence.end() - 1);
    for (uint32_t p = 0; p < patches.size(); ++p) {
        for (uint32_t v = 0; v < patches[p].vertexCount(); ++v) {
            occurrences[slot[patches[p].position[v]]++] = {p, v};
        }
    }
}

void SurfaceState::listWedges() {
    firstWedge.assign(mesh.positions.size() + 1, 0);
    for (const uint32_t p : mesh.wedgePosition) ++firstWedge[p + 1];
    std::partial_sum(firstWedge.begin(), firstWedge.end(), firstWedge.begin());
    positionWedges.resize(mesh.wedgePosition.size());
    std::vector<uint32_t> slot(firstWedge.begin(), firstWedge.end() - 1);
    for (uint32_t w = 0; w < mesh.wedgePosition.size(); ++w) positionWedges[slot[mesh.wedgePosition[w]]++] = w;
}

/// Boundary vertices: those of several patches, on open borders, on edges that are no manifold's. (Vertices where two
/// fans touch need nothing special: both follow.)
void SurfaceState::classify(const Topology& topology) {
    for (size_t p = 0; p < isBoundary.size(); ++p) isBoundary[p] = domains[domain[p]].size() > 1;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        if (topology.facesOfEdge(e).size() == 2 && !isInconsistent(mesh, topology, e)) continue;
        isBoundary[topology.edges[e].x] = 1;
        isBoundary[topology.edges[e].y] = 1;
    }
    starNumber.assign(isBoundary.size(), kNone);
    for (uint32_t p = 0; p < isBoundary.size(); ++p) {
        if (isBoundary[p]) makeBoundary(p);
    }
}

void SurfaceState::makeBoundary(uint32_t position) {
    isBoundary[position] = 1;
    starNumber[position] = uint32_t(stars.size());
    stars.emplace_back();
    forGroupCorners(position, [&](uint32_t patch, uint32_t c) { stars.back().push_back({patch, c}); });
}

void SurfaceState::pruneStar(uint32_t r) {
    std::erase_if(starOf(r), [&](const PatchCorner& c) { return !isDrawn(patches[c.patch], c.corner); });
}

} // namespace xgc::bake
