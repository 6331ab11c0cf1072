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
        for (uint32_t f = 0; f < faces; ++f) {
            linked_.corners[f] = mesh_.facePositions(f);
            linked_.standsFor[f] = f;
        }
        findRepeated();
        for (uint32_t e = 0; e < topology_.edges.size(); ++e) linkEdge(e);
        windComponents();
        return std::move(linked_);
    }

private:
    uint32_t sideOf(uint32_t f, uint32_t edge) const {
        const glm::uvec3 e = topology_.faceEdges[f];
        return e.x == edge ? 0 : e.y == edge ? 1 : 2;
    }
    uint32_t oppositeOf(uint32_t f, uint32_t edge) const { return linked_.corners[f][(sideOf(f, edge) + 2) % 3]; }

    void findRepeated() {
        for (uint32_t e = 0; e < topology_.edges.size(); ++e) {
            const std::span<const uint32_t> faces = topology_.facesOfEdge(e);
            for (size_t i = 1; i < faces.size(); ++i) {
                for (size_t j = 0; j < i; ++j) {
                    if (oppositeOf(faces[i], e) != oppositeOf(faces[j], e)) continue;
                    linked_.standsFor[faces[i]] =
                        faces[j]; // faces of an edge rise: j stands for itself or is lower yet
                    break;
                }
            }
        }
    }

    void link(uint32_t edge, uint32_t f, uint32_t g) {
        linked_.neighbours[f][int(sideOf(f, edge))] = g;
        linked_.neighbours[g][int(sideOf(g, edge))] = f;
    }

    void linkEdge(uint32_t edge) {
        const std::span<const uint32_t> faces = topology_.facesOfEdge(edge);
        if (faces.size() < 2) return;
        if (faces.size() == 2) {
            if (linked_.standsFor[faces[1]] == faces[1]) link(edge, faces[0], faces[1]);
            return;
        }
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
        turned_.assign(mesh_.faces.size(), 0);
        std::vector<uint8_t> seen(mesh_.faces.size(), 0);
        std::vector<uint32_t>& walk = linked_.componentFaces;
        walk.reserve(mesh_.faces.size());
        linked_.componentOffsets.push_back(0);
        for (uint32_t seed = 0; seed < mesh_.faceCount(); ++seed) {
            if (seen[seed] || linked_.standsFor[seed] != seed) continue;
            const size_t begin = walk.size();
            walk.push_back(seed);
            seen[seed] = 1;
            for (size_t i = begin; i < walk.size(); ++i) visitNeighbours(walk[i], seen);
            settle(std::span(walk).subspan(begin));
            linked_.componentOffsets.push_back(uint32_t(walk.size()));
        }
        for (const uint32_t f : walk) {
            if (!turned_[f]) continue;
            std::swap(linked_.corners[f].y, linked_.corners[f].z);
            std::swap(linked_.neighbours[f].x, linked_.neighbours[f].z);
        }
    }

    /// True where the face runs along its edge k from the lower position to the higher.
    bool runsForward(uint32_t f, int k) const { return linked_.corners[f][k] < linked_.corners[f][(k + 1) % 3]; }

    void visitNeighbours(uint32_t f, std::vector<uint8_t>& seen) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = linked_.neighbours[f][k];
            if (g == kNone || seen[g]) continue;
            const int side = int(sideOf(g, topology_.faceEdges[f][k]));
            const bool agree = runsForward(f, k) != runsForward(g, side);
            turned_[g] = uint8_t(agree ? turned_[f] : !turned_[f]);
            seen[g] = 1;
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
            turnedCount += turned_[f];
            const glm::dvec3 p = glm::dvec3(mesh_.positions[c.x]) - origin,
                             q = glm::dvec3(mesh_.positions[c.y]) - origin,
                             r = glm::dvec3(mesh_.positions[c.z]) - origin;
            const double v = glm::dot(p, glm::cross(q, r));
            volume += turned_[f] ? -v : v;
        }
        const bool nearlyClosed = openEdges * 20 < faces.size();
        const bool turn = nearlyClosed ? volume < 0 : turnedCount * 2 > faces.size();
        if (!turn) return;
        for (const uint32_t f : faces) turned_[f] ^= 1;
    }

    const Mesh& mesh_;
    const Topology& topology_;
    LinkedFaces linked_;
    std::vector<Leaf> leaves_;
    std::vector<uint8_t> turned_;
};

} // namespace

LinkedFaces linkFaces(const Mesh& mesh, const Topology& topology) {
    return Linker(mesh, topology).run();
}

} // namespace xgc::bake
