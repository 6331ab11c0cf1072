#pragma once

#include <xgc/bake/mesh.h>

#include <array>
#include <span>
#include <vector>

namespace xgc::bake {

/// The triangles of one patch while a hierarchy is built: vertices that several patches share stand where the
/// input has them, its own vertices are collapsed as far as the build has come. Vertices and faces have numbers of
/// their own (all of it fits a cache); corner 3f + k is corner k of face f. Each vertex has a list of its live corners.
class PatchMesh {
public:
    /// `localOf`: a scratch entry a position, all kNone, and so again at the end.
    PatchMesh(const Mesh& mesh, std::span<const uint32_t> faces, std::vector<uint32_t>& localOf);

    uint32_t vertexCount() const { return uint32_t(position.size()); }
    bool isLive(uint32_t f) const { return corner[3 * size_t(f)] != kNone; }
    static uint32_t next(uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }
    static uint32_t previous(uint32_t c) { return c % 3 == 0 ? c + 2 : c - 1; }

    template <typename Visit>
    void forCorners(uint32_t vertex, const Visit& visit) const {
        for (uint32_t c = head[vertex]; c != kNone; c = link[c]) visit(c);
    }

    /// Moves the corners of `from` to `to`; faces that have both die. `wedgeOf(wedge)` is what becomes of a corner's.
    template <typename WedgeOf>
    void collapse(uint32_t from, uint32_t to, const WedgeOf& wedgeOf) {
        for (uint32_t c = head[from]; c != kNone;) {
            const uint32_t after = link[c], n = next(c), p = previous(c);
            if (corner[n] == to || corner[p] == to) {
                drop(corner[n], n);
                drop(corner[p], p);
                corner[c - c % 3] = kNone;
            } else {
                corner[c] = to;
                wedge[c] = wedgeOf(wedge[c]);
                link[c] = head[to];
                head[to] = c;
            }
            c = after;
        }
        head[from] = kNone;
    }

    std::vector<uint32_t> position; ///< a vertex
    std::vector<uint32_t> head;     ///< a vertex: its first corner
    std::vector<uint32_t> corner;   ///< a corner: its vertex; of a dead face the first is kNone
    std::vector<uint32_t> wedge;    ///< a corner
    std::vector<uint32_t> link;     ///< a corner: the next of its vertex
    std::vector<uint32_t> face;     ///< a face: in the mesh
    std::vector<glm::vec3> normal;  ///< a face: the input's, of unit length; 0 where it has no area

private:
    void drop(uint32_t vertex, uint32_t dead) {
        uint32_t* at = &head[vertex];
        while (*at != dead) at = &link[*at];
        *at = link[dead];
    }
};

} // namespace xgc::bake
