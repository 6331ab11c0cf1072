#include "min_cut.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// Rests below this are rounding.
constexpr float kNothing = 1e-9f;

} // namespace

void MinCut::addEdge(uint32_t a, uint32_t b, float capacity) {
    halves_.push_back({b, first_[a], capacity});
    first_[a] = uint32_t(halves_.size()) - 1;
    halves_.push_back({a, first_[b], capacity});
    first_[b] = uint32_t(halves_.size()) - 1;
}

bool MinCut::findLayers() {
    layer_.assign(first_.size(), kEnd);
    std::vector<uint32_t> queue = {kSource};
    layer_[kSource] = 0;
    for (size_t i = 0; i < queue.size(); ++i) {
        for (uint32_t h = first_[queue[i]]; h != kEnd; h = halves_[h].next) {
            const uint32_t to = halves_[h].to;
            if (layer_[to] != kEnd || halves_[h].rest <= kNothing) continue;
            layer_[to] = layer_[queue[i]] + 1;
            queue.push_back(to);
        }
    }
    return layer_[kSink] != kEnd;
}

float MinCut::push(uint32_t node, float most) {
    // One path at a time, without recursion: bands of cells are long.
    std::vector<uint32_t> path; // halves
    float pushed = 0;
    for (uint32_t at = node;;) {
        if (at == kSink) {
            float least = most;
            for (const uint32_t h : path) least = std::min(least, halves_[h].rest);
            for (const uint32_t h : path) {
                halves_[h].rest -= least;
                halves_[h ^ 1].rest += least;
            }
            pushed += least;
            size_t keep = 0;
            while (keep < path.size() && halves_[path[keep]].rest > kNothing) ++keep;
            at = keep < path.size() ? halves_[path[keep] ^ 1].to : at;
            path.resize(keep);
            continue;
        }
        uint32_t& h = current_[at];
        while (h != kEnd && (halves_[h].rest <= kNothing || layer_[halves_[h].to] != layer_[at] + 1))
            h = halves_[h].next;
        if (h != kEnd) {
            path.push_back(h);
            at = halves_[h].to;
            continue;
        }
        if (path.empty()) return pushed;
        layer_[at] = kEnd; // leads nowhere
        at = halves_[path.back() ^ 1].to;
        path.pop_back();
    }
}

std::vector<uint8_t> MinCut::run() {
    constexpr float kAll = 1e30f;
    while (findLayers()) {
        current_ = first_;
        push(kSource, kAll);
    }
    std::vector<uint8_t> side(first_.size());
    for (size_t n = 0; n < side.size(); ++n) side[n] = layer_[n] != kEnd;
    return side;
}

} // namespace xgc::bake
