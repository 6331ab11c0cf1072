#include "orientation.h"

#include <utility>

namespace xgc::bake {

namespace {

/// True where the face runs along its edge k from the lower position to the higher.
bool runsForward(const Mesh& mesh, uint32_t face, int k) {
    const glm::uvec3 p = mesh.facePositions(face);
    return p[k] < p[(k + 1) % 3];
}

int sideOf(const Topology& topology, uint32_t face, uint32_t edge) {
    const glm::uvec3 e = topology.faceEdges[face];
    return e.x == edge ? 0 : e.y == edge ? 1 : 2;
}

/// What one walk over two-faced edges reached. Smaller than a component where edges of more faces join it.
struct Sheet {
    std::vector<uint32_t> faces;
    uint32_t turnedCount = 0;
    uint32_t openEdges = 0;
    double volume = 0; ///< signed, times 6
};

class Walk {
public:
    Walk(const Mesh& mesh, const Topology& topology) : mesh_(mesh), topology_(topology) {
        result_.turned.assign(mesh.faces.size(), 0);
        result_.edgeConflict.assign(topology.edges.size(), 0);
        seen_.assign(mesh.faces.size(), 0);
    }

    Orientation run() {
        for (uint32_t f = 0; f < mesh_.faceCount(); ++f) {
            if (!seen_[f]) settle(collect(f));
        }
        return std::move(result_);
    }

private:
    Sheet collect(uint32_t seed) {
        Sheet sheet;
        sheet.faces.push_back(seed);
        seen_[seed] = 1;
        for (size_t i = 0; i < sheet.faces.size(); ++i) {
            const uint32_t f = sheet.faces[i];
            for (int k = 0; k < 3; ++k) visit(f, k, sheet);
            sheet.turnedCount += result_.turned[f];
            sheet.volume += volumeOf(f, mesh_.positions[mesh_.facePositions(seed).x]);
        }
        return sheet;
    }

    void visit(uint32_t f, int k, Sheet& sheet) {
        const uint32_t edge = topology_.faceEdges[f][k];
        const std::span<const uint32_t> faces = topology_.facesOfEdge(edge);
        if (faces.size() != 2) {
            ++sheet.openEdges;
            return;
        }
        const uint32_t g = faces[0] == f ? faces[1] : faces[0];
        const bool agree = runsForward(mesh_, f, k) != runsForward(mesh_, g, sideOf(topology_, g, edge));
        const auto wanted = uint8_t(agree ? result_.turned[f] : !result_.turned[f]);
        if (!seen_[g]) {
            seen_[g] = 1;
            result_.turned[g] = wanted;
            sheet.faces.push_back(g);
        } else if (result_.turned[g] != wanted) {
            result_.edgeConflict[edge] = 1;
        }
    }

    /// Six times the signed volume between the face, as turned, and a point near by.
    double volumeOf(uint32_t f, const glm::vec3& origin) const {
        const glm::uvec3 c = mesh_.facePositions(f);
        const glm::dvec3 o(origin);
        const glm::dvec3 p = glm::dvec3(mesh_.positions[c.x]) - o, q = glm::dvec3(mesh_.positions[c.y]) - o,
                         r = glm::dvec3(mesh_.positions[c.z]) - o;
        const double v = glm::dot(p, glm::cross(q, r));
        return result_.turned[f] ? -v : v;
    }

    void settle(const Sheet& sheet) {
        const size_t count = sheet.faces.size();
        const bool nearlyClosed = sheet.openEdges * 20.0 < double(count);
        const bool turn = nearlyClosed ? sheet.volume < 0 : sheet.turnedCount * 2.0 > double(count);
        if (!turn) return;
        for (const uint32_t f : sheet.faces) result_.turned[f] ^= 1;
    }

    const Mesh& mesh_;
    const Topology& topology_;
    Orientation result_;
    std::vector<uint8_t> seen_;
};

} // namespace

Orientation orientConsistently(const Mesh& mesh, const Topology& topology) {
    return Walk(mesh, topology).run();
}

} // namespace xgc::bake
