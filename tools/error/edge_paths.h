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
        double most; ///< squared distance beyond which no edge is crossed
    };
    /// The triangles that the segment passes on its way, of which each is beside the one before: such that the largest
    /// distance between the segment and a crossed edge is small. False where none is found.
    bool find(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);
    std::vector<uint32_t> path;

private:
    struct Node {
        uint32_t triangle;
        uint32_t parent;
    };
    struct Open {
        double cost;
        uint32_t node;
    };
    bool walkFan(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);
    bool circle(const DrawnLevel& drawn, uint32_t centre, uint32_t from, uint32_t to);
    void open(uint32_t triangle, uint32_t parent, double cost);
    bool searchWide(const DrawnLevel& drawn, const Segment& segment, const Allowance& allowance);

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
    /// edge and the drawn edges that it crosses: of the patches around it and on both sides of those.
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
        std::span<const uint32_t> triangles; ///< from the edge's first position to its second; empty for `drawn`
    };
    /// `two` holds the triangles of short ways.
    Path of(uint32_t edge, const DrawnLevel& drawn, std::array<uint32_t, 2>& two) const;

    /// The level at which no face keeps the edge, or face, as it is any more.
    uint32_t edgeLeaves(uint32_t edge) const { return edgeLeaves_[edge]; }
    uint32_t faceLeaves(uint32_t face) const { return faceLeaves_[face]; }

private:
    static constexpr uint32_t kInside = 0, kPair = 1, kNoPath = 0xffffffff, kFirstStored = 2;
    struct Chunk {
        RunningErrors& running;
        const std::vector<double>& errors; ///< before the edges raised them
        std::vector<uint32_t>& stored;
        PathSearch& search;
    };
    bool isKept(uint32_t edge, const DrawnLevel& drawn) const;
    uint32_t find(uint32_t edge, const DrawnLevel& drawn, Chunk& chunk) const;
    void raise(uint32_t edge, const DrawnLevel& drawn, std::span<const uint32_t> path, RunningErrors& running) const;
    double largestError(uint32_t edge, const std::vector<double>& errors) const;
    double leastError(uint32_t edge, const RunningErrors& running) const;

    const MeasuredInput& input_;
    const TrackedMap& map_;
    std::vector<uint8_t> faceLeaves_, edgeLeaves_;
    std::vector<uint32_t> codes_;
    std::vector<std::vector<uint32_t>> stored_; ///< per chunk: count and triangles of each longer way
};

} // namespace xgc::bake
