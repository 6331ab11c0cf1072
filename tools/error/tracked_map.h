#pragma once

#include "near_walk.h"

namespace xgc::bake {

/// What the parts of the measurement share.
struct MeasuredInput {
    const Mesh& mesh;
    const Topology& topology;
    const Hierarchy& hierarchy;
    double floor; ///< squared distance too small to care about

    glm::dvec3 point(uint32_t position) const { return glm::dvec3(hierarchy.positions[position]); }
};

/// Where each input vertex lies on the drawn surface: a triangle near it, kept from level to level while it serves.
class TrackedMap {
public:
    struct Place {
        uint32_t triangle = kNone; ///< drawn; one of its star for a vertex that is drawn itself
        uint32_t vertex = kNone;   ///< the drawn vertex that it is, else kNone
    };

    TrackedMap(const MeasuredInput& input, const DrawnLevel& drawn);

    /// Follows the drawn surface to its next level and raises the errors by the distances of the vertices: of the
    /// patches around each, and of the one that it lies on if that may be covered by the vertex's faces.
    void advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                 std::vector<double>& errors);

    const Place& operator[](uint32_t position) const { return places_[position]; }
    /// Whether the last level gave the vertex another triangle, or one of another shape.
    bool hasMoved(uint32_t position) const { return moved_[position] != 0; }

private:
    /// Returns false where the surface near the vertex is gone.
    bool follow(uint32_t position, uint32_t level, const DrawnLevel& drawn, RunningErrors& running);
    double leastError(uint32_t position, const RunningErrors& running) const;
    void raise(uint32_t position, uint32_t trianglePatch, double squared, RunningErrors& running) const;
    void findLost(const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                  const std::vector<uint32_t>& lost, std::vector<double>& errors);

    const MeasuredInput& input_;
    std::vector<Place> places_;
    std::vector<uint8_t> moved_;
    std::vector<uint8_t> isGone_; ///< its components are not drawn: it lies on a surface that it is no part of
    std::vector<uint32_t> patch_; ///< of the vertex's faces; kNone: several
};

} // namespace xgc::bake
