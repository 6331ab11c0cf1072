#include "fill.h"

namespace xgc::bake {

namespace {

class Filler {
public:
    Filler(const Topology& topology, std::span<const EdgeKind> kinds) : topology_(topology), kinds_(kinds) {
        regions_.ofFace.assign(topology.faceEdges.size(), kNone);
    }

    /// Floods a region from every free face that `isSeed` names, across edges of kind `door` and flat ones.
    template <typename IsSeed>
    void flood(EdgeKind door, const IsSeed& isSeed) {
        for (uint32_t f = 0; f < regions_.ofFace.size(); ++f) {
            if (regions_.ofFace[f] == kNone && isSeed(f)) floodFrom(f, door);
        }
    }

    Regions take() { return std::move(regions_); }

private:
    void floodFrom(uint32_t seed, EdgeKind door) {
        const uint32_t region = regions_.count++;
        regions_.ofFace[seed] = region;
        stack_.assign(1, seed);
        while (!stack_.empty()) {
            const uint32_t f = stack_.back();
            stack_.pop_back();
            for (int k = 0; k < 3; ++k) {
                const uint32_t edge = topology_.faceEdges[f][k];
                if (kinds_[edge] != door && kinds_[edge] != EdgeKind::flat) continue;
                for (const uint32_t g : topology_.facesOfEdge(edge)) {
                    if (regions_.ofFace[g] != kNone) continue;
                    regions_.ofFace[g] = region;
                    stack_.push_back(g);
                }
            }
        }
    }

    const Topology& topology_;
    std::span<const EdgeKind> kinds_;
    Regions regions_;
    std::vector<uint32_t> stack_;
};

} // namespace

Regions fillRegions(const Topology& topology, std::span<const EdgeKind> kinds, bool seedFromConvexEdges) {
    Filler filler(topology, kinds);
    filler.flood(EdgeKind::convex, [&](uint32_t f) {
        const FaceEdgeCounts counts = countEdges(topology, kinds, f);
        return seedFromConvexEdges ? counts.convex > 0 : counts.undefined();
    });
    filler.flood(EdgeKind::concave, [&](uint32_t f) {
        const FaceEdgeCounts counts = countEdges(topology, kinds, f);
        return counts.concave > 0 && counts.convex == 0;
    });
    filler.flood(EdgeKind::convex, [](uint32_t) { return true; });
    return filler.take();
}

} // namespace xgc::bake
