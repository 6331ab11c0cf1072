#pragma once

#include <cstdint>
#include <vector>

namespace xgc::bake {

/// A graph of nodes and undirected edges, to be cut between a source and a sink where that is cheapest (Dinic 1970).
class MinCut {
public:
    static constexpr uint32_t kSource = 0, kSink = 1;

    /// Nodes 2 and up are the caller's.
    explicit MinCut(uint32_t nodes) : first_(nodes, kEnd) {}
    /// `capacity` either way. Edges of the source and the sink count one way only.
    void addEdge(uint32_t a, uint32_t b, float capacity);
    /// Per node: 1 on the source's side of the cheapest cut; of several, the one nearest to the source.
    std::vector<uint8_t> run();

private:
    static constexpr uint32_t kEnd = 0xffffffffu;
    struct Half {
        uint32_t to, next; ///< its other half is at index ^ 1
        float rest;
    };
    bool findLayers();
    float push(uint32_t node, float most);

    std::vector<uint32_t> first_; ///< per node, into halves_
    std::vector<Half> halves_;
    std::vector<uint32_t> layer_, current_;
};

} // namespace xgc::bake
