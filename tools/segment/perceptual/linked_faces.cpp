#include "linked_faces.h"

#include <algorithm>
#include <utility>

namespace xgc::bake {

namespace {

/// Of edges with more than two faces: a face on such an edge and the direction it leaves it in.
struct Leaf {
    uint32_t face;
    glm::dvec3 direction; ///< unit, from the edge to the opposite corner
};

class Linker {
public:
    Linker(const Mesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {}

    LinkedFaces run() {
        const uint32_t faces = mesh_.faceCount();
        linked_.corners.resize(faces);
        linked_.neighbours.assign(faces, glm::uvec3(kNone));
        linked_.standsFor.resize(faces);
        state_.resize(faces);
        for (uint32_t f = 0; f < faces; ++f) {
            const glm::uvec3 c = linked_.corners[f] = mesh_.facePositions(f);
            linked_.standsFor[f] = lowestAlike(f);
            state_[f] = uint8_t(int(c.x < c.y) | int(c.y < c.z) << 1 | int(c.z < c.x) << 2);
        }
        for (uint32_t f = 0; f < faces; ++f) linkSides(f);
        windComponents();
        return std::move(linked_);
    }

private:
    uint32_t sideOf(uint32_t f, uint32_t edge) const {
        const glm::uvec3 e = topology_.faceEdges[f];
        return e.x == edge ? 0 : e.y == edge ? 1 : 2;
    }
    uint32_t oppositeOf(uint32_t f, uint32_t edge) const { return linked_.corners[f][(sideOf(f, edge) + 2) % 3]; }

    /// The lowest face over the same positions: they share every edge.
    uint32_t lowestAlike(uint32_t f) const {
        const glm::uvec3 own = topology_.faceEdges[f];
        for (const uint32_t g : topology_.facesOfEdge(own.x)) {
            if (g == f) break;
            const glm::uvec3 other = topology_.faceEdges[g];
            if (own.y == other.x || own.y == other.y || own.y == other.z) return g;
        }
        return f;
    }

    void linkSides(uint32_t f) {
        const glm::uvec3 edges = topology_.faceEdges[f];
        for (int k = 0; k < 3; ++k) {
            const std::span<const uint32_t> faces = topology_.facesOfEdge(edges[k]);
            if (faces.size() == 2) {
                if (linked_.standsFor[faces[1]] == faces[1]) linked_.neighbours[f][k] = faces[f == faces[0]];
            } else if (faces.size() > 2 && faces[0] == f) {
                linkLeaves(edges[k], faces);
            }
        }
    }

    void link(uint32_t edge, uint32_t f, uint32_t g) {
        linked_.neighbours[f][int(sideOf(f, edge))] = g;
        linked_.neighbours[g][int(sideOf(g, edge))] = f;
    }

    /// An edge of more than two faces.
    void linkLeaves(uint32_t edge, std::span<const uint32_t> faces) {
        leaves_.clear();
        for (const uint32_t f : faces) {
            if (linked_.standsFor[f] == f) leaves_.push_back({f, directionOf(f, edge)});
        }
        if (leaves_.size() == 2) link(edge, leaves_[0].face, leaves_[1].face);
        if (leaves_.size() > 2) linkStraightest(edge);
    }

    glm::dvec3 directionOf(uint32_t f, uint32_t edge) const {
        const glm::dvec3 a(mesh_.positions[topology_.edges[edge].x]), b(mesh_.positions[topology_.edges[edge].y]);
        const glm::dvec3 c(mesh_.positions[oppositeOf(f, edge)]);
        const glm::dvec3 along = b - a;
        const glm::dvec3 out = c - a - along * (glm::dot(c - a, along) / std::max(glm::dot(along, along), 1e-300));
        const double length = glm::length(out);
        return length > 0 ? out / length : glm::dvec3(0);
    }

    /// The two that continue each other best first, as long as they turn by more than 60 degrees.
    void linkStraightest(uint32_t edge) {
        constexpr double kSharpest = 0.5;
        for (;;) {
            double best = kSharpest;
            size_t bestI = 0, bestJ = 0;
            for (size_t i = 0; i < leaves_.size(); ++i) {
                for (size_t j = i + 1; j < leaves_.size(); ++j) {
                    const double d = glm::dot(leaves_[i].direction, leaves_[j].direction);
                    if (d >= best) continue;
                    best = d;
                    bestI = i;
                    bestJ = j;
                }
            }
            if (best == kSharpest) return;
            link(edge, leaves_[bestI].face, leaves_[bestJ].face);
            leaves_.erase(leaves_.begin() + ptrdiff_t(bestJ));
            leaves_.erase(leaves_.begin() + ptrdiff_t(bestI));
        }
    }

    void windComponents() {
        std::vector<uint32_t>& walk = linked_.componentFaces;
        walk.reserve(mesh_.faces.size());
        linked_.componentOffsets.push_back(0);
        for (uint32_t seed = 0; seed < mesh_.faceCount(); ++seed) {
            if ((state_[seed] & kSeen) || linked_.standsFor[seed] != seed) continue;
            const size_t begin = walk.size();
            walk.push_back(seed);
            state_[seed] |= kSeen;
            for (size_t i = begin; i < walk.size(); ++i) visitNeighbours(walk[i]);
            settle(std::span(walk).subspan(begin));
            linked_.componentOffsets.push_back(uint32_t(walk.size()));
        }
        for (uint32_t f = 0; f < mesh_.faceCount(); ++f) {
            if (!(state_[f] & kTurned)) continue;
            std::swap(linked_.corners[f].y, linked_.corners[f].z);
            std::swap(linked_.neighbours[f].x, linked_.neighbours[f].z);
        }
    }

    void visitNeighbours(uint32_t f) {
        const glm::uvec3 neighbours = linked_.neighbours[f];
        const uint8_t own = state_[f];
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = neighbours[k];
            if (g == kNone || (state_[g] & kSeen)) continue;
            const glm::uvec3 back = linked_.neighbours[g]; // faces that are linked share one edge
            const int side = back.x == f ? 0 : back.y == f ? 1 : 2;
            const bool agree = (own >> k & 1) != (state_[g] >> side & 1);
            state_[g] |= uint8_t(kSeen | ((own & kTurned) ^ (agree ? 0 : kTurned)));
            linked_.componentFaces.push_back(g);
        }
    }

    void settle(std::span<const uint32_t> faces) {
        size_t openEdges = 0, turnedCount = 0;
        double volume = 0; // signed, times 6
        const glm::dvec3 origin(mesh_.positions[linked_.corners[faces[0]].x]);
        for (const uint32_t f : faces) {
            const glm::uvec3 c = linked_.corners[f], n = linked_.neighbours[f];
            openEdges += size_t(n.x == kNone) + size_t(n.y == kNone) + size_t(n.z == kNone);
            turnedCount += bool(state_[f] & kTurned);
            const glm::dvec3 p = glm::dvec3(mesh_.positions[c.x]) - origin,
                             q = glm::dvec3(mesh_.positions[c.y]) - origin,
                             r = glm::dvec3(mesh_.positions[c.z]) - origin;
            const double v = glm::dot(p, glm::cross(q, r));
            volume += state_[f] & kTurned ? -v : v;
        }
        const bool nearlyClosed = openEdges * 20 < faces.size();
        const bool turn = nearlyClosed ? volume < 0 : turnedCount * 2 > faces.size();
        if (!turn) return;
        for (const uint32_t f : faces) state_[f] ^= kTurned;
    }

    const Mesh& mesh_;
    const Topology& topology_;
    LinkedFaces linked_;
    std::vector<Leaf> leaves_;
    std::vector<uint8_t> state_; ///< per face: bit k, its edge k runs from the lower position to the higher; and these
    static constexpr uint8_t kSeen = 8, kTurned = 16;
};

} // namespace

LinkedFaces linkFaces(const Mesh& mesh, const Topology& topology) {
    return Linker(mesh, topology).run();
}

} // namespace xgc::bake
