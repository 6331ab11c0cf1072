#include "superfacets.h"

#include <algorithm>
#include <cmath>

namespace xgc::bake {

namespace {

constexpr float kFar = 1e30f;

/// Cells by rounded-down distance. Distances are exact all the same: a bucket is worked on until nothing in it changes.
class BucketQueue {
public:
    explicit BucketQueue(float width) : inverseWidth_(1 / width) {}

    void push(float distance, uint32_t cell) {
        const auto bucket = size_t(std::min(distance * inverseWidth_, 1e6f));
        if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
        buckets_[bucket].push_back({distance, cell});
        first_ = std::min(first_, bucket);
    }
    bool pop(float& distance, uint32_t& cell) {
        while (first_ < buckets_.size() && buckets_[first_].empty()) ++first_;
        if (first_ >= buckets_.size()) {
            first_ = 0;
            return false;
        }
        distance = buckets_[first_].back().distance;
        cell = buckets_[first_].back().cell;
        buckets_[first_].pop_back();
        return true;
    }

private:
    struct Entry {
        float distance;
        uint32_t cell;
    };
    float inverseWidth_;
    size_t first_ = 0;
    std::vector<std::vector<Entry>> buckets_;
};

class Grower {
public:
    Grower(const CellGraph& graph, const EdgeFeatures& features)
        : graph_(graph), cost_(graph.links.size()), distance_(graph.size(), kFar), owner_(graph.size(), kNone),
          queue_(0.3f / std::sqrt(float(graph.size()))) {
        constexpr float kToll = 0.15f;
        for (size_t l = 0; l < cost_.size(); ++l) {
            const CellGraph::Link& link = graph.links[l];
            const float step = glm::length(graph.centers[link.b] - graph.centers[link.a]);
            cost_[l] = step + kToll * std::max(0.0f, -features.angle[l]);
        }
    }

    Superfacets run(uint32_t wanted) {
        seedIslands();
        while (result_.count() < wanted && addBatch(wanted)) {
        }
        result_.ofCell = std::move(owner_);
        return std::move(result_);
    }

private:
    void addSeed(uint32_t cell) {
        const uint32_t seed = result_.count();
        result_.seeds.push_back(cell);
        reach(cell, 0, seed);
    }
    void reach(uint32_t cell, float distance, uint32_t seed) {
        distance_[cell] = distance;
        owner_[cell] = seed;
        queue_.push(distance, cell);
    }
    void settle() {
        float distance = 0;
        uint32_t cell = 0;
        while (queue_.pop(distance, cell)) {
            if (distance > distance_[cell]) continue;
            for (const CellGraph::Arc& arc : graph_.arcsOf(cell)) {
                const float there = distance + cost_[arc.link];
                const bool nearer = there < distance_[arc.to];
                if (nearer || (there == distance_[arc.to] && owner_[cell] < owner_[arc.to]))
                    reach(arc.to, there, owner_[cell]);
            }
        }
    }

    void seedIslands() {
        uint32_t farthest = 0;
        float most = -1;
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            const float d = glm::dot(graph_.centers[c], graph_.centers[c]); // the centroid is the origin
            if (d > most) {
                most = d;
                farthest = c;
            }
        }
        addSeed(farthest);
        settle();
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            if (owner_[c] != kNone) continue;
            addSeed(c);
            settle();
        }
    }

    /// The farthest cell of every region, as far as they are far; false where none is left.
    bool addBatch(uint32_t wanted) {
        std::vector<uint32_t> farthest(result_.count(), kNone);
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            uint32_t& best = farthest[owner_[c]];
            if (best == kNone || distance_[c] > distance_[best]) best = c;
        }
        std::sort(farthest.begin(), farthest.end(), [&](uint32_t a, uint32_t b) {
            return distance_[a] != distance_[b] ? distance_[a] > distance_[b] : a < b;
        });
        const float most = distance_[farthest[0]];
        if (!(most > 0)) return false;
        const uint32_t room = std::min(wanted - result_.count(), std::max(1u, result_.count() / 4));
        for (uint32_t i = 0; i < farthest.size() && i < room && distance_[farthest[i]] >= 0.8f * most; ++i) {
            chosen_.push_back(farthest[i]);
        }
        for (const uint32_t c : chosen_) addSeed(c);
        chosen_.clear();
        settle();
        return true;
    }

    const CellGraph& graph_;
    std::vector<float> cost_; ///< per link
    std::vector<float> distance_;
    std::vector<uint32_t> owner_;
    BucketQueue queue_;
    std::vector<uint32_t> chosen_;
    Superfacets result_;
};

} // namespace

Superfacets growSuperfacets(const CellGraph& graph, const EdgeFeatures& features, uint32_t wanted) {
    return Grower(graph, features).run(wanted);
}

} // namespace xgc::bake
