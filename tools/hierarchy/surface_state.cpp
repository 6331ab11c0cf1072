#include "hierarchy/surface_state.h"

#include "hierarchy/first_domains.h"

#include <glm/common.hpp>

#include <numeric>
#include <utility>

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
    positions = mesh.positions;
    wedgePosition = mesh.wedgePosition;
    grow(positions.size(), wedgePosition.size());

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
    patches.reserve(assignment.patches.size());
    for (uint32_t p = 0; p < assignment.patches.size(); ++p) {
        patches.emplace_back(mesh, std::span(faces).subspan(start[p], start[p + 1] - start[p]), localOf);
        for (const uint32_t v : patches.back().position) ++occurrenceRanges[v].count;
    }
    uint32_t first = 0;
    for (Range& range : occurrenceRanges) {
        range.first = first;
        first += std::exchange(range.count, 0);
    }
    occurrences.resize(first);
    for (uint32_t p = 0; p < patches.size(); ++p) {
        for (uint32_t v = 0; v < patches[p].vertexCount(); ++v) {
            Range& range = occurrenceRanges[patches[p].position[v]];
            occurrences[range.first + range.count++] = {p, v};
        }
    }
}

void SurfaceState::listWedges() {
    for (const uint32_t p : wedgePosition) ++wedgeRanges[p].count;
    uint32_t first = 0;
    for (Range& range : wedgeRanges) {
        range.first = first;
        first += std::exchange(range.count, 0);
    }
    for (uint32_t w = 0; w < wedgePosition.size(); ++w) {
        Range& range = wedgeRanges[wedgePosition[w]];
        positionWedges[range.first + range.count++] = w;
    }
}

void SurfaceState::grow(size_t positionCount, size_t wedgeCount) {
    const auto extend = [](auto& column, size_t count, auto value) { column.resize(count, value); };
    const auto count = [](std::vector<uint32_t>& column, size_t to) {
        const size_t from = column.size();
        column.resize(to);
        std::iota(column.begin() + ptrdiff_t(from), column.end(), uint32_t(from));
    };
    extend(positions, positionCount, glm::vec3(0));
    extend(birthLevel, positionCount, uint8_t(0));
    extend(isBoundary, positionCount, uint8_t(0));
    extend(collapseLevel, positionCount, kNeverCollapses);
    extend(parent, positionCount, kNone);
    extend(domain, positionCount, 0u);
    extend(quadrics, positionCount, Quadric{});
    extend(costScale, positionCount, 1.0);
    extend(occurrenceRanges, positionCount, Range{});
    extend(wedgeRanges, positionCount, Range{});
    extend(starNumber, positionCount, kNone);
    count(representative, positionCount);
    count(groupNext, positionCount);
    extend(wedgePosition, wedgeCount, kNone);
    extend(wedgeParent, wedgeCount, kNone);
    count(wedgeRepresentative, wedgeCount);
    count(positionWedges, wedgeCount);
}

/// A collapse that makes a vertex takes two, so a worker never makes as many as it has; of wedges likewise.
void SurfaceState::makeRooms() {
    std::vector<Room> sizes(patches.size() + 1, Room{});
    for (uint32_t p = 0; p < mesh.positions.size(); ++p) {
        Room& room = isBoundary[p] ? sizes.back() : sizes[occurrencesOf(p).front().patch];
        ++room.position;
        room.wedge += wedgeRanges[p].count;
        // One inside a patch may come to the boundary later.
        if (!isBoundary[p]) {
            ++sizes.back().position;
            sizes.back().wedge += wedgeRanges[p].count;
        }
    }
    auto position = uint32_t(positions.size()), wedge = uint32_t(wedgePosition.size());
    const uint32_t baseWedges = wedge;
    for (const Room& size : sizes) {
        rooms.push_back({position, wedge, position, wedge});
        position += size.position;
        wedge += size.wedge;
    }
    grow(position, wedge);
    madeWedges.resize(wedge - baseWedges);
    firstMadeOccurrence = occurrences.size();
    occurrences.resize(firstMadeOccurrence + position - mesh.positions.size());
}

double SurfaceState::shareAt(uint32_t v, uint32_t w, const glm::dvec3& at) const {
    const glm::dvec3 along = point(w) - point(v);
    const double squared = glm::dot(along, along);
    return squared > 0 ? glm::clamp(glm::dot(at - point(v), along) / squared, 0.0, 1.0) : 0.5;
}

uint32_t SurfaceState::draft(uint32_t room, const glm::dvec3& at, uint32_t v, uint32_t w,
                             std::span<const std::pair<uint32_t, uint32_t>> wedgePairs) {
    const uint32_t x = rooms[room].position;
    positions[x] = glm::vec3(at + origin);
    const double share = shareAt(v, w, at); // not of the rounded point: g++ 12 at -O3 skips the rounding
    wedgeRanges[x] = {rooms[room].wedge, uint32_t(wedgePairs.size())};
    uint32_t wedge = rooms[room].wedge;
    for (const auto& [a, b] : wedgePairs) {
        wedgePosition[wedge] = x;
        madeWedges[wedge - mesh.wedgePosition.size()] = {a, b, float(share)};
        ++wedge;
    }
    quadrics[x] = quadrics[v];
    quadrics[x].add(quadrics[w]);
    costScale[x] = std::max(costScale[v], costScale[w]);
    domain[x] = domain[v];
    guard.inherit(x, v);
    return x;
}

void SurfaceState::keep(uint32_t room, uint32_t level, const Occurrence& home) {
    const uint32_t x = rooms[room].position++;
    rooms[room].wedge += wedgeRanges[x].count;
    birthLevel[x] = uint8_t(level);
    if (room + 1 == rooms.size()) return;
    const size_t slot = firstMadeOccurrence + (x - mesh.positions.size());
    occurrences[slot] = home;
    occurrenceRanges[x] = {uint32_t(slot), 1};
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
    for (uint32_t p = 0; p < isBoundary.size(); ++p) {
        if (isBoundary[p]) makeBoundary(p);
    }
}

void SurfaceState::collapseWhole(uint32_t from, uint32_t to, uint32_t stepDomain, uint32_t level) {
    const uint32_t wedge = wedgesOf(to).front();
    collapseLevel[from] = uint8_t(level);
    parent[from] = to;
    domain[from] = stepDomain;
    for (const uint32_t w : wedgesOf(from)) wedgeParent[w] = wedge;
    forGroup(from, [&](uint32_t m) {
        representative[m] = to;
        for (const uint32_t w : wedgesOf(m)) wedgeRepresentative[w] = wedge;
    });
    std::swap(groupNext[from], groupNext[to]);
}

void SurfaceState::makeBoundary(uint32_t position) {
    isBoundary[position] = 1;
    guard.joinRim(position);
    starNumber[position] = uint32_t(stars.size());
    stars.emplace_back();
    forGroupCorners(position, [&](uint32_t patch, uint32_t c) { stars.back().push_back({patch, c}); });
}

void SurfaceState::pruneStar(uint32_t r) {
    std::erase_if(starOf(r), [&](const PatchCorner& c) { return !isDrawn(patches[c.patch], c.corner); });
}

} // namespace xgc::bake
