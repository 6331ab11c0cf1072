#include "hierarchy/hierarchy_of.h"

#include "hierarchy/average_attributes.h"
#include "mesh/attribute_rows.h"

namespace xgc::bake {

namespace {

/// Which of the build's vertices and wedges go into the hierarchy, and their numbers there.
class Numbering {
public:
    explicit Numbering(const SurfaceState& state) : state_(state) {
        const size_t positions = state.mesh.positions.size(), wedges = state.mesh.wedgePosition.size();
        position.assign(state.positions.size(), kNone);
        wedge.assign(state.wedgePosition.size(), kNone);
        for (uint32_t p = 0; p < positions; ++p) take(p);
        for (uint32_t w = 0; w < wedges; ++w) {
            wedge[w] = w;
            wedges_.push_back(w);
        }
        const std::vector<uint8_t> passed = passedThrough();
        for (const SurfaceState::Room& room : state.rooms) {
            for (uint32_t p = room.firstPosition; p < room.position; ++p) {
                if (passed[p]) continue;
                take(p);
                for (const uint32_t w : state.wedgesOf(p)) {
                    wedge[w] = uint32_t(wedges_.size());
                    wedges_.push_back(w);
                }
            }
        }
    }

    std::vector<uint32_t> position, wedge; ///< kNone: left out
    const std::vector<uint32_t>& positions() const { return positions_; }
    const std::vector<uint32_t>& wedges() const { return wedges_; }

private:
    void take(uint32_t p) {
        position[p] = uint32_t(positions_.size());
        positions_.push_back(p);
    }

    /// A made vertex that goes on at the level at which it was made, with all that came into it, is never drawn.
    std::vector<uint8_t> passedThrough() const {
        std::vector<uint8_t> passed(state_.positions.size(), 0);
        for (const SurfaceState::Room& room : state_.rooms) {
            for (uint32_t p = room.firstPosition; p < room.position; ++p) {
                passed[p] = state_.collapseLevel[p] == state_.birthLevel[p];
            }
        }
        for (uint32_t p = 0; p < passed.size(); ++p) {
            const uint32_t parent = state_.parent[p];
            if (parent != kNone && state_.domain[p] != state_.domain[parent]) passed[parent] = 0;
        }
        return passed;
    }

    const SurfaceState& state_;
    std::vector<uint32_t> positions_, wedges_;
};

/// Attributes of all wedges, those left out included: others lie between them. Beside them the row of each.
Attributes makeAttributes(const SurfaceState& state, std::vector<uint32_t>& rowOf) {
    Attributes attributes = state.mesh.attributes;
    const auto base = uint32_t(state.mesh.wedgePosition.size());
    rowOf.assign(state.wedgePosition.size(), kNone);
    for (uint32_t w = 0; w < base; ++w) rowOf[w] = w;
    uint32_t row = base;
    for (const SurfaceState::Room& room : state.rooms) {
        for (uint32_t w = room.firstWedge; w < room.wedge; ++w) {
            const SurfaceState::MadeWedge& made = state.madeWedges[w - base];
            appendAverage(attributes, rowOf[made.first], rowOf[made.second], made.share);
            rowOf[w] = row++;
        }
    }
    return attributes;
}

} // namespace

Hierarchy hierarchyOf(SurfaceState& state) {
    const Numbering numbering(state);
    Hierarchy h;
    for (const uint32_t p : numbering.positions()) {
        h.positions.push_back(state.positions[p]);
        h.collapseLevel.push_back(state.collapseLevel[p]);
        h.birthLevel.push_back(state.birthLevel[p]);
        h.domain.push_back(state.domain[p]);
    }
    std::vector<uint32_t> rowOf, rows;
    const Attributes attributes = makeAttributes(state, rowOf);
    for (const uint32_t w : numbering.wedges()) {
        uint32_t parent = state.wedgeParent[w];
        while (parent != kNone && numbering.wedge[parent] == kNone) parent = state.wedgeParent[parent];
        h.wedgeParent.push_back(parent == kNone ? kNone : numbering.wedge[parent]);
        h.wedgePosition.push_back(numbering.position[state.wedgePosition[w]]);
        rows.push_back(rowOf[w]);
    }
    h.attributes = state.makesVertices() ? gatherAttributes(attributes, rows) : attributes;
    h.domainPatches = state.domains.take();
    return h;
}

} // namespace xgc::bake
