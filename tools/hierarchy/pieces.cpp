#include "hierarchy/pieces.h"

#include <glm/common.hpp>

#include <algorithm>
#include <numeric>

namespace xgc::bake {

namespace {

uint32_t findRoot(std::vector<uint32_t>& parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/// The piece of every component: those that meet at a vertex are one. Returns how many pieces there are.
uint32_t joinComponents(const Mesh& mesh, const Topology& topology, std::vector<uint32_t>& pieceOf) {
    std::vector<uint32_t> root(topology.componentCount), firstOf(mesh.positions.size(), kNone);
    std::iota(root.begin(), root.end(), 0u);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            uint32_t& first = firstOf[corners[k]];
            if (first == kNone) first = topology.faceComponent[f];
            const uint32_t a = findRoot(root, first), b = findRoot(root, topology.faceComponent[f]);
            root[std::max(a, b)] = std::min(a, b);
        }
    }
    pieceOf.assign(root.size(), kNone);
    uint32_t count = 0;
    for (uint32_t c = 0; c < root.size(); ++c) {
        const uint32_t r = findRoot(root, c);
        if (pieceOf[r] == kNone) pieceOf[r] = count++;
        pieceOf[c] = pieceOf[r];
    }
    return count;
}

/// Sorts items by the group that each is in.
void gather(const std::vector<uint32_t>& group, uint32_t count, std::vector<uint32_t>& first,
            std::vector<uint32_t>& items) {
    first.assign(count + 1, 0);
    for (const uint32_t g : group) ++first[g + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    items.resize(group.size());
    std::vector<uint32_t> slot(first.begin(), first.end() - 1);
    for (uint32_t i = 0; i < group.size(); ++i) items[slot[group[i]]++] = i;
}

} // namespace

Pieces::Pieces(const Mesh& mesh, const Topology& topology) : ofPosition_(mesh.positions.size(), 0) {
    std::vector<uint32_t> ofFace;
    const uint32_t count = joinComponents(mesh, topology, ofFace);
    std::vector<uint32_t> faces(mesh.faces.size());
    for (uint32_t f = 0; f < faces.size(); ++f) {
        faces[f] = ofFace[topology.faceComponent[f]];
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) ofPosition_[corners[k]] = faces[f];
    }
    gather(ofPosition_, count, firstPosition_, positions_);
    gather(faces, count, firstFace_, faces_);
    measure(mesh, topology);
}

void Pieces::measure(const Mesh& mesh, const Topology& topology) {
    isOpen_.assign(count(), 0);
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        if (topology.facesOfEdge(e).size() % 2 == 1) isOpen_[ofPosition_[topology.edges[e].x]] = 1;
    }
    for (uint32_t piece = 0; piece < count(); ++piece) {
        glm::dvec3 low(mesh.positions[positionsOf(piece).front()]), high = low;
        for (const uint32_t p : positionsOf(piece)) {
            low = glm::min(low, glm::dvec3(mesh.positions[p]));
            high = glm::max(high, glm::dvec3(mesh.positions[p]));
        }
        squaredRadius_.push_back(glm::dot(high - low, high - low) / 4);
    }
}

std::vector<uint32_t> Pieces::bySize() const {
    std::vector<uint32_t> order(count());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return squaredRadius_[a] > squaredRadius_[b]; });
    return order;
}

} // namespace xgc::bake
