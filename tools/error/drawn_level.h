#pragma once

#include <xgc/bake/hierarchy.h>

namespace xgc::bake {

/// The drawn surface of one uniform state, numbered densely, and who is beside whom on it.
struct DrawnLevel {
    std::vector<glm::dvec3> points;    ///< per vertex
    std::vector<uint32_t> positions;   ///< of the hierarchy, per vertex
    std::vector<glm::uvec3> triangles; ///< vertices
    std::vector<glm::uvec3> beside;    ///< across the edge from corner k to k + 1; kNone unless two triangles use it
    std::vector<uint32_t> faces;       ///< mesh face of each triangle
    std::vector<uint32_t> patches;     ///< patch of each triangle
    std::vector<uint8_t> isFresh;      ///< 1: the level before did not draw the triangle so
    std::vector<uint32_t> starOffsets, stars; ///< triangles of each vertex

    // What became of the level before.
    std::vector<glm::uvec3> oldTriangles; ///< its triangles
    std::vector<uint32_t> newVertex;      ///< of each of its vertices: of its representative; kNone: not drawn
    std::vector<uint32_t> newTriangle;    ///< of each of its triangles; kNone: degenerate now

    uint32_t count() const { return uint32_t(triangles.size()); }
    std::span<const uint32_t> star(uint32_t vertex) const {
        return {stars.data() + starOffsets[vertex], starOffsets[vertex + 1] - starOffsets[vertex]};
    }
    /// Of a triangle, as long as twice its area.
    glm::dvec3 normal(uint32_t triangle) const {
        const glm::uvec3& t = triangles[triangle];
        return glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]);
    }
    bool hasCorner(uint32_t triangle, uint32_t vertex) const {
        const glm::uvec3& t = triangles[triangle];
        return t.x == vertex || t.y == vertex || t.z == vertex;
    }
};

/// Position that each position collapses into; kNone for those that never do.
std::vector<uint32_t> positionParents(const Hierarchy& hierarchy);

/// Fills `starOffsets` and `stars` from the triangles.
void listStars(DrawnLevel& drawn);

/// Goes through the uniform states of a hierarchy in turn.
class LevelWalk {
public:
    LevelWalk(const Mesh& mesh, const Hierarchy& hierarchy);
    /// The next level; false where it draws what the level before does.
    bool advance();
    const DrawnLevel& drawn() const { return drawn_; }

private:
    uint32_t representative(uint32_t position) const;
    void keepTriangles(const std::vector<uint32_t>& representatives);
    void findNeighbours();

    const Hierarchy& h_;
    const std::vector<uint32_t> parent_;
    std::vector<uint32_t> numbers_; ///< vertex of each position, kNone; scratch
    uint32_t level_ = 0;
    DrawnLevel drawn_;
};

} // namespace xgc::bake
