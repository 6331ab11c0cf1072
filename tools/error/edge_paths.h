#pragma once

#include "tracked_map.h"

#include <tbb/enumerable_thread_specific.h>

namespace xgc::bake {

/// Searches ways over the drawn surface.
class PathSearch {
public:
    struct Segment {
        glm::dvec3 a, b;
        TrackedMap::Place from, to;
    };
    /// The triangles that the segment passes on its way, of which each is beside the one before: such that the largest
    /// distance between the segment and a crossed edge is small. False where none is found.
    bool find(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);
    std::vector<uint32_t> path;
    std::vector<double> crossings; ///< squared distances

private:
    struct Node {
        uint32_t triangle;
        uint32_t parent;
    };
    struct Open {
        double cost;
        uint32_t node;
    };
    bool crossOnce(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);
    bool walkFan(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);
    bool circle(const DrawnLevel& drawn, uint32_t centre, uint32_t from, uint32_t to);
    void open(uint32_t triangle, uint32_t parent, double cost);
    bool searchWide(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);

    std::vector<uint32_t> ways_[2];
    std::vector<Node> nodes_;
    std::vector<Open> heap_;
    std::vector<uint64_t> stamps_;
    uint64_t stamp_ = 0;
};

/// The image of each input edge: a way over the drawn triangles between the places of its ends.
class EdgePaths {
public:
    EdgePaths(const MeasuredInput& input, const TrackedMap& map);

    /// Finds the ways of the edges that no face keeps as they are, and raises the errors by the distances between each
    /// edge and the drawn edges that it crosses: of the patches around it and on both sides of those. Those of ways
    /// that lead much farther away than the vertices are left out: such a way proves little.
    void advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                 std::vector<double>& errors);

    enum class Kind {
        drawn,    ///< a drawn edge: both ends are drawn vertices
        inside,   ///< within one triangle
        crossing, ///< over several triangles
        none      ///< no way was found
    };
    struct Path {
        Kind kind;
        bool isStrained;                     ///< it leads far from the edge: the distances are not in the errors
        std::span<const uint32_t> triangles; ///< from the edge's first position to its second; empty for `drawn`
    };
    /// `two` holds the triangles of short ways.
    Path of(uint32_t edge, const DrawnLevel& drawn, std::array<uint32_t, 2>& two) const;

    /// Calls `visit(triangle, next, point)` where the way of an edge passes from triangle to triangle.
    template <typename Visit>
    void forCrossings(uint32_t edge, const DrawnLevel& drawn, const Visit& visit) const {
        if (edgeLeaves_[edge] > level_) return;
        std::array<uint32_t, 2> two;
        const Path path = of(edge, drawn, two);
        for (size_t i = 0; i + 1 < path.triangles.size(); ++i) {
            visit(path.triangles[i], path.triangles[i + 1],
                  crossing(edge, drawn, path.triangles[i], path.triangles[i + 1]));
        }
    }

    /// Whether the three ways together stay in two triangles beside each other.
    bool isPairOnly(const glm::uvec3& edges) const {
        const uint32_t a = codes_[edges.x], b = codes_[edges.y], c = codes_[edges.z];
        return a <= kPair && b <= kPair && c <= kPair && a + b + c == 2 * kPair;
    }

    /// The level at which no face keeps the edge, or face, as it is any more.
    uint32_t edgeLeaves(uint32_t edge) const { return edgeLeaves_[edge]; }
    uint32_t faceLeaves(uint32_t face) const { return faceLeaves_[face]; }

private:
    /// Codes of ways; of a stored one: its place in the chunk's list, and a bit for a strained one.
    static constexpr uint32_t kStrained = 0x80000000, kInside = 0, kPair = 1, kNoPath = 0xffffffff, kFirstStored = 2;
    struct Chunk {
        RunningErrors& running;
        const std::vector<double>& errors; ///< before the edges raised them
        std::vector<uint32_t>& stored;
        PathSearch& search;
    };
    glm::dvec3 crossing(uint32_t edge, const DrawnLevel& drawn, uint32_t triangle, uint32_t next) const;
    bool isKept(uint32_t edge, const DrawnLevel& drawn) const;
    uint32_t find(uint32_t edge, const DrawnLevel& drawn, Chunk& chunk) const;
    bool raise(uint32_t edge, const DrawnLevel& drawn, std::span<const uint32_t> path, const Chunk& chunk) const;
    void raisePatches(uint32_t edge, double squared, RunningErrors& running) const;
    double largestError(uint32_t edge, const std::vector<double>& errors) const;
    double leastError(uint32_t edge, const RunningErrors& running) const;

    const MeasuredInput& input_;
    const TrackedMap& map_;
    std::vector<uint32_t> patch_; ///< of the edge's faces; kNone: several
    std::vector<uint8_t> faceLeaves_, edgeLeaves_;
    uint32_t level_ = 0;
    std::vector<uint32_t> codes_;
    std::vector<std::vector<uint32_t>> stored_; ///< per chunk: count and triangles of each longer way
};

} // namespace xgc::bake
