#pragma once

#include "hierarchy/interior_collapse.h"

namespace xgc::bake {

/// Collapses boundary vertices of the uniform state into one another, those on borders along borders, cheapest first. A
/// step v -> u has the domain of v, and widens that of u by it: so domains grow along every chain.
class BoundaryCollapser {
public:
    BoundaryCollapser(SurfaceState& state, AttributeQuadrics& attributes, std::vector<InteriorCollapser>& interiors,
                      Placement placement);

    void markDirty(uint32_t position) { dirty_.push_back(position); }
    /// Until nothing is left whose squared error is at most `limit`.
    void run(uint32_t level, double limit);
    /// Tries those again that only mixed states refused: a step may take the domains into its own that held it back.
    void runWidening(uint32_t level, double limit);

    CollapseCounts takeCounts() { return std::exchange(counts_, {}); }

private:
    enum class Outcome { done, refused, heldByMixed };

    /// A triangle of the uniform state around a vertex: the other two corners in order, and all three wedges.
    struct StarFace {
        uint32_t patch, next, previous;
        uint32_t wedge, nextWedge, previousWedge;
    };
    /// An edge from the vertex at the star's centre.
    struct StarEdge {
        uint32_t to;
        uint32_t faces;
        uint32_t wedge, toWedge; ///< of one of the faces
    };

    void gatherStar(uint32_t vertex, std::vector<StarFace>& star);
    void gatherEdges(const std::vector<StarFace>& star, std::vector<StarEdge>& edges) const;
    void evaluate(uint32_t vertex);
    Outcome tryCollapse(uint32_t vertex, uint32_t target, uint32_t level);
    bool mapWedges(uint32_t vertex, uint32_t target);
    bool isLinked(uint32_t target);
    bool guards(uint32_t vertex, uint32_t target, bool meets);
    double areaLost(uint32_t vertex, uint32_t target, const glm::dvec3& point) const;
    Outcome checkFaces(uint32_t vertex, uint32_t other, const StateCheck::Move& move, const WedgeMap& wedges);
    bool widen();
    void collapse(uint32_t vertex, uint32_t target, uint32_t level);
    double costOf(uint32_t vertex, const StarEdge& edge) const;
    double subsetCost(uint32_t vertex, const StarEdge& edge) const;
    bool makesVertex(uint32_t vertex, uint32_t target) const;
    bool arePaired(uint32_t target) const;
    Outcome tryMeeting(uint32_t vertex, uint32_t target, uint32_t level);
    void meet(uint32_t vertex, uint32_t target, uint32_t level);
    void lookAround(uint32_t vertex);
    void retire(uint32_t vertex, uint32_t parent, const WedgeMap& wedges, uint32_t level);
    void reevaluateAround();

    SurfaceState& state_;
    AttributeQuadrics& attributes_;
    std::vector<InteriorCollapser>& interiors_;
    const Placement placement_;
    double limit_ = 0;
    CollapseQueue queue_;
    std::vector<uint32_t> stamp_, target_;
    struct Blocked {
        double cost = -1;
        uint32_t target = 0;
    };
    std::vector<Blocked> blocked_;
    std::vector<uint32_t> dirty_, held_;
    CollapseCounts counts_;
    bool widening_ = false;

    StateCheck check_;
    uint32_t domain_ = 0; ///< of the step that is tried
    double areaLost_ = 0; ///< by it, where its piece is guarded
    WedgeMap wedges_, vertexWedges_, targetWedges_;
    std::vector<StarFace> star_, otherStar_;
    std::vector<StarEdge> edges_;
    std::vector<uint32_t> members_, around_;
};

} // namespace xgc::bake
