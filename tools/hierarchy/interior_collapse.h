#pragma once

#include "hierarchy/collapse_queue.h"
#include "hierarchy/placement.h"
#include "hierarchy/state_check.h"
#include "hierarchy/wedge_map.h"

namespace xgc::bake {

/// Collapses of one kind at one level.
struct CollapseCounts {
    uint32_t collapses = 0;
    uint32_t linkRefused = 0;
    uint32_t flipRefused = 0;
    uint32_t wedgeRefused = 0;

    void add(const CollapseCounts& c) {
        collapses += c.collapses;
        linkRefused += c.linkRefused;
        flipRefused += c.flipRefused;
        wedgeRefused += c.wedgeRefused;
    }
};

/// Collapses a patch's own vertices, into one another and into the boundary vertices beside them, cheapest
/// first. Writes to its patch mesh, to the state's entries of its own vertices, and to the quadrics of boundary
/// vertices; reads the patches around. So patches without a common representative can work at the same time.
class InteriorCollapser {
public:
    InteriorCollapser(SurfaceState& state, AttributeQuadrics& attributes, uint32_t patch, Placement placement);

    /// A boundary vertex beside this one, or this one itself, has changed.
    void markDirty(uint32_t vertex) {
        if (!isDirty_[vertex]) dirty_.push_back(vertex);
        isDirty_[vertex] = 1;
    }
    bool hasWork(double limit) const { return !dirty_.empty() || queue_.hasBelow(limit); }
    /// Until nothing is left whose squared error is at most `limit`.
    void run(uint32_t level, double limit);
    /// Makes boundary vertices of those that only mixed states keep from collapsing into one: they may then go together
    /// with the patches that hold them back.
    void promote(double limit);

    CollapseCounts takeCounts() { return std::exchange(counts_, {}); }
    /// Boundary vertices whose surroundings changed.
    std::vector<uint32_t> takeTouched() { return std::exchange(touched_, {}); }

private:
    enum class Outcome { done, refused, heldByMixed };

    void evaluate(uint32_t vertex);
    void reconsider(uint32_t vertex, uint32_t gone, uint32_t target);
    double costOf(uint32_t vertex, uint32_t corner) const;
    double subsetCost(uint32_t vertex, uint32_t corner) const;
    double attributeCost(uint32_t corner, uint32_t position) const;
    uint32_t cornerTowards(uint32_t vertex, uint32_t target) const;
    double uniformCost(uint32_t vertex) const;
    Outcome tryCollapse(uint32_t vertex, uint32_t target, uint32_t level);
    bool mapWedges(uint32_t vertex, uint32_t target);
    Outcome checkLinks(uint32_t vertex, uint32_t target);
    bool isLinkedInPatch(uint32_t vertex, uint32_t target);
    void markBesideBoundary(uint32_t boundaryVertex);
    bool isLinkedInUniform(uint32_t vertex, uint32_t target);
    bool hasUniformEdge(uint32_t a, uint32_t b) const;
    Outcome checkStates(uint32_t vertex, uint32_t target, uint32_t level);
    Outcome checkFaces(uint32_t vertex, uint32_t other, const StateCheck::Move& move, const WedgeMap& wedges);
    void collapse(uint32_t vertex, uint32_t target, uint32_t level);
    bool makesVertex(uint32_t vertex, uint32_t target) const;
    bool arePaired(uint32_t target) const;
    Outcome tryMeeting(uint32_t vertex, uint32_t target, uint32_t level);
    void meet(uint32_t vertex, uint32_t target, uint32_t made, uint32_t level);
    void retire(uint32_t vertex, uint32_t parent, const WedgeMap& wedges, uint32_t level);
    void afterCollapse(uint32_t vertex, uint32_t target);
    void block(uint32_t vertex, uint32_t target, double cost);

    bool isBoundary(uint32_t vertex) const { return state_.isBoundary[mesh_.position[vertex]]; }

    SurfaceState& state_;
    AttributeQuadrics& attributes_;
    PatchMesh& mesh_;
    const uint32_t patch_;
    const Placement placement_;
    double limit_ = 0;
    CollapseQueue queue_;
    std::vector<uint32_t> stamp_, target_;
    std::vector<double> cost_; ///< of target_
    struct Blocked {
        double cost = -1; ///< targets up to here, and at equal cost up to that position, were refused
        uint32_t target = 0;
    };
    std::vector<Blocked> blocked_;
    std::vector<uint8_t> isDirty_;
    std::vector<uint8_t> meetsBoundary_; ///< a boundary vertex is, or was, beside it
    std::vector<glm::dvec3> points_;     ///< about the state's origin
    std::vector<uint32_t> dirty_;
    std::vector<uint8_t> held_; ///< only mixed states refused to let the vertex go into a boundary vertex
    std::vector<uint32_t> touched_;
    CollapseCounts counts_;

    StateCheck check_;
    WedgeMap wedges_, vertexWedges_, targetWedges_;
    std::vector<uint32_t> ring_, marks_;
    uint32_t mark_ = 0;
};

} // namespace xgc::bake
