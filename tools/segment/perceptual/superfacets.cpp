#include "superfacets.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace xgc::bake {

namespace {

constexpr float kFar = 1e30f;

/// Cells by rounded-down distance, the last that came to a bucket first. Distances are exact all the same: a bucket is
/// worked on until nothing in it changes. Entries lie in one place, each bucket's in a list.
class BucketQueue {
public:
    explicit BucketQueue(float width) : inverseWidth_(1 / width) {}

    void push(float distance, uint32_t cell) {
        const auto bucket = uint32_t(int(std::min(distance * inverseWidth_, 1e6f)));
        if (bucket >= last_.size()) last_.resize(bucket + 1, kNone);
        const uint32_t entry = free_ == kNone ? uint32_t(entries_.size()) : free_;
        if (free_ == kNone) {
            entries_.emplace_back();
        } else {
            free_ = entries_[free_].before;
        }
        entries_[entry] = {distance, cell, last_[bucket]};
        last_[bucket] = entry;
        first_ = std::min(first_, bucket);
    }
    bool pop(float& distance, uint32_t& cell) {
        while (first_ < last_.size() && last_[first_] == kNone) ++first_;
        if (first_ >= last_.size()) {
            first_ = 0;
            return false;
        }
        const uint32_t entry = last_[first_];
        distance = entries_[entry].distance;
        cell = entries_[entry].cell;
        last_[first_] = std::exchange(entries_[entry].before, free_);
        free_ = entry;
        return true;
    }

private:
    struct Entry {
        float distance;
        uint32_t cell;
        uint32_t before; ///< in the same bucket, or of those that are free; kNone: the last
    };
    float inverseWidth_;
    uint32_t first_ = 0, free_ = kNone;
    std::vector<uint32_t> last_; ///< per bucket
    std::vector<Entry> entries_;
};

class Grower {
public:
    Grower(const CellGraph& graph, const EdgeFeatures& features)
        : graph_(graph), steps_(graph.arcs.size()), reached_(graph.size(), {kFar, kNone}),
          queue_(0.3f / std::sqrt(float(graph.size()))) {
        constexpr float kToll = 0.6f;
        std::vector<float> cost(graph.links.size());
        for (size_t l = 0; l < cost.size(); ++l) {
            const CellGraph::Link& link = graph.links[l];
            const float step = glm::length(graph.centers[link.b] - graph.centers[link.a]);
            cost[l] =
                step + kToll * (features.isNoisy() ? filteredTurn(link, features) : std::max(0.0f, -features.angle[l]));
        }
        for (size_t a = 0; a < steps_.size(); ++a) steps_[a] = {graph.arcs[a].to, cost[graph.arcs[a].link]};
    }

    Superfacets run(uint32_t wanted) {
        seedIslands();
        while (result_.count() < wanted && addBatch(wanted)) {
        }
        result_.ofCell.reserve(reached_.size());
        for (const Reached& cell : reached_) result_.ofCell.push_back(cell.owner);
        return std::move(result_);
    }

private:
    /// How far the filtered normals turn across a link; 0 where convex.
    float filteredTurn(const CellGraph::Link& link, const EdgeFeatures& features) const {
        const glm::vec3 turn = features.filteredNormals[link.b] - features.filteredNormals[link.a];
        return glm::dot(turn, graph_.centers[link.b] - graph_.centers[link.a]) < 0 ? glm::length(turn) : 0;
    }

    /// An arc by what it costs.
    struct Step {
        uint32_t to;
        float cost;
    };
    /// How near a cell's nearest seed is.
    struct Reached {
        float distance;
        uint32_t owner; ///< a seed; kNone: no seed yet
    };

    void addSeed(uint32_t cell) {
        const uint32_t seed = result_.count();
        result_.seeds.push_back(cell);
        reach(cell, 0, seed);
    }
    void reach(uint32_t cell, float distance, uint32_t seed) {
        reached_[cell] = {distance, seed};
        queue_.push(distance, cell);
    }
    void settle() {
        float distance = 0;
        uint32_t cell = 0;
        while (queue_.pop(distance, cell)) {
            const Reached here = reached_[cell];
            if (distance > here.distance) continue;
            for (uint32_t a = graph_.arcOffsets[cell]; a < graph_.arcOffsets[cell + 1]; ++a) {
                const Step& step = steps_[a];
                const Reached& other = reached_[step.to];
                const float there = distance + step.cost;
                if (there < other.distance || (there == other.distance && here.owner < other.owner))
                    reach(step.to, there, here.owner);
            }
        }
    }

    /// The first seed lies farthest from the centroid, which is the origin, and of mirror images on the same side
    /// always.
    void seedIslands() {
        constexpr glm::vec3 kTowards(0.02f, 0.012f, 0.006f);
        uint32_t farthest = 0;
        float most = -1;
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            const float d = glm::length(graph_.centers[c]) + glm::dot(kTowards, graph_.centers[c]);
            if (d > most) {
                most = d;
                farthest = c;
            }
        }
        addSeed(farthest);
        settle();
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            if (reached_[c].owner != kNone) continue;
            addSeed(c);
            settle();
        }
    }

    /// The farthest cell of every region, as far as they are far; false where none is left.
    bool addBatch(uint32_t wanted) {
        struct Farthest {
            float distance;
            uint32_t cell;
        };
        std::vector<Farthest> farthest(result_.count(), {-1, kNone});
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            Farthest& best = farthest[reached_[c].owner];
            if (reached_[c].distance > best.distance) best = {reached_[c].distance, c};
        }
        std::sort(farthest.begin(), farthest.end(), [](const Farthest& a, const Farthest& b) {
            return a.distance != b.distance ? a.distance > b.distance : a.cell < b.cell;
        });
        const float most = farthest[0].distance;
        if (!(most > 0)) return false;
        const uint32_t room = std::min(wanted - result_.count(), std::max(1u, result_.count() / 4));
        for (uint32_t i = 0; i < farthest.size() && i < room && farthest[i].distance >= 0.8f * most; ++i) {
            chosen_.push_back(farthest[i].cell);
        }
        for (const uint32_t c : chosen_) addSeed(c);
        chosen_.clear();
        settle();
        return true;
    }

    const CellGraph& graph_;
    std::vector<Step> steps_; ///< as the graph's arcs
    std::vector<Reached> reached_;
    BucketQueue queue_;
    std::vector<uint32_t> chosen_;
    Superfacets result_;
};

} // namespace

Superfacets growSuperfacets(const CellGraph& graph, const EdgeFeatures& features, uint32_t wanted) {
    return Grower(graph, features).run(wanted);
}

} // namespace xgc::bake
