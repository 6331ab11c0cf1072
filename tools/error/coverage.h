#pragma once

#include "edge_paths.h"

namespace xgc::bake {

/// Proves that the images of the input's faces cover the drawn surface, or names where that cannot be proved.
///
/// The images of a face's edges make a loop on the drawn surface. Where the triangles that it passes form a disc, the
/// loop bounds a set of points C(face) on it, and all of C(face) is as near to the face as the crossings are: a face is
/// convex, so the distance to it is largest at the corners of the pieces. The boundaries of all C(face) cancel where an
/// even number of faces meets at an edge. So the number of faces whose C holds a point is the same modulo two all over
/// a connected piece of the drawn surface, but across the images of edges where an odd number of such faces meets. If
/// it is odd around one vertex, the piece is covered.
class Coverage {
public:
    Coverage(const MeasuredInput& input, const TrackedMap& map, const EdgePaths& paths);

    void advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                 std::vector<double>& errors);

    /// Faces whose image is not known to be near them, rising.
    const std::vector<uint32_t>& looseFaces() const { return loose_; }
    /// Faces whose image is a disc that may lie far from them, rising.
    const std::vector<uint32_t>& strainedFaces() const { return strained_; }
    /// The triangles over which such a face's image extends, and in each points whose convex hull holds it.
    struct Region {
        uint32_t triangle;
        std::vector<glm::dvec3> points;
    };
    std::vector<Region> imageOf(uint32_t face, const DrawnLevel& drawn) const;
    /// Drawn triangles that are not known to be covered, rising.
    const std::vector<uint32_t>& bareTriangles() const { return bare_; }

private:
    static constexpr uint32_t kMostTriangles = 48;
    /// The triangles that a face's loop passes, and those at which the loop leaves and enters each corner.
    struct Loop {
        uint32_t triangles[kMostTriangles];
        uint32_t count = 0;
        uint32_t starts[3], ends[3]; ///< of the edge from corner k to k + 1
        bool isStrained = false;
        bool has(uint32_t t) const { return std::find(triangles, triangles + count, t) != triangles + count; }
        bool add(uint32_t t) {
            if (has(t)) return true;
            if (count == kMostTriangles) return false;
            triangles[count++] = t;
            return true;
        }
    };
    enum class Disc { plain, aroundVertex, none };

    bool collect(uint32_t face, const DrawnLevel& drawn, Loop& loop) const;
    bool isWhole(uint32_t face, const DrawnLevel& drawn, const Loop& loop) const;
    Disc discOf(const DrawnLevel& drawn, const Loop& loop, uint32_t& centre) const;
    bool isTrivial(uint32_t face) const;
    bool isPair(uint32_t face) const;
    struct Found {
        std::vector<uint32_t> loose, strained, centres;
    };
    void checkFace(uint32_t face, const DrawnLevel& drawn, RunningErrors& running, Found& found) const;
    void cut(const DrawnLevel& drawn);
    void cutDrawnEdge(uint32_t a, uint32_t b, const DrawnLevel& drawn);
    void cutAlong(uint32_t edge, const DrawnLevel& drawn);
    void findBare(const DrawnLevel& drawn);
    bool isCoveredAround(uint32_t vertex, const DrawnLevel& drawn) const;

    const MeasuredInput& input_;
    const TrackedMap& map_;
    const EdgePaths& paths_;
    std::vector<uint32_t> oddEdges_;
    uint32_t level_ = 0;
    std::vector<uint8_t> isLoose_; ///< per face: loose, or of a component that is not drawn
    std::vector<uint32_t> loose_, strained_, bare_;
    std::vector<uint8_t> isCut_;    ///< per drawn triangle
    std::vector<uint8_t> isCentre_; ///< per drawn vertex: some C(face) holds it and its star
};

} // namespace xgc::bake
