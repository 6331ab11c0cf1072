#include "loose_faces.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// A run of a walk over faces of one label.
struct Set {
    uint32_t begin, end, label;
    uint32_t size() const { return end - begin; }
};

class LooseFaces {
public:
    LooseFaces(const LinkedFaces& linked, std::span<const uint32_t> component, std::span<const uint32_t> group,
               std::vector<uint32_t>& scratch, std::vector<uint32_t>& labels)
        : linked_(linked), component_(component), group_(group), setOf_(scratch), labels_(labels) {}

    /// False where there were none that could be joined.
    bool join() {
        findSets();
        for (const uint32_t f : walk_) setOf_[f] = kNone;
        std::sort(sets_.begin(), sets_.end(), [](const Set& a, const Set& b) {
            if (a.label != b.label) return a.label < b.label;
            return a.size() != b.size() ? a.size() > b.size() : a.begin < b.begin;
        });
        bool joined = false;
        for (size_t i = 1; i < sets_.size(); ++i) {
            if (sets_[i].label != sets_[i - 1].label) continue; // the largest of its label
            joined |= giveAway(std::span(walk_).subspan(sets_[i].begin, sets_[i].size()));
        }
        return joined;
    }

private:
    void findSets() {
        for (const uint32_t seed : component_) {
            if (setOf_[seed] != kNone) continue;
            const auto begin = uint32_t(walk_.size());
            walk_.push_back(seed);
            setOf_[seed] = uint32_t(sets_.size());
            for (size_t i = begin; i < walk_.size(); ++i) {
                for (int k = 0; k < 3; ++k) {
                    const uint32_t g = linked_.neighbours[walk_[i]][k];
                    if (g == kNone || setOf_[g] != kNone || labels_[g] != labels_[seed]) continue;
                    setOf_[g] = uint32_t(sets_.size());
                    walk_.push_back(g);
                }
            }
            sets_.push_back({begin, uint32_t(walk_.size()), labels_[seed]});
        }
    }

    bool isOneGroup(uint32_t f, uint32_t g) const { return group_.empty() || group_[f] == group_[g]; }

    bool giveAway(std::span<const uint32_t> set) {
        const uint32_t own = labels_[set[0]];
        std::vector<uint32_t> around;
        for (const uint32_t f : set) {
            for (int k = 0; k < 3; ++k) {
                const uint32_t g = linked_.neighbours[f][k];
                if (g != kNone && labels_[g] != own && isOneGroup(f, g)) around.push_back(labels_[g]);
            }
        }
        if (around.empty()) return false;
        std::sort(around.begin(), around.end());
        size_t most = 0;
        uint32_t best = own;
        for (size_t i = 0, j = 0; i < around.size(); i = j) {
            while (j < around.size() && around[j] == around[i]) ++j;
            if (j - i <= most) continue;
            most = j - i;
            best = around[i];
        }
        for (const uint32_t f : set) labels_[f] = best;
        return true;
    }

    const LinkedFaces& linked_;
    std::span<const uint32_t> component_, group_;
    std::vector<uint32_t>& setOf_;
    std::vector<uint32_t>& labels_;
    std::vector<uint32_t> walk_;
    std::vector<Set> sets_;
};

} // namespace

void joinLooseFaces(const LinkedFaces& linked, std::span<const uint32_t> component, std::span<const uint32_t> group,
                    std::vector<uint32_t>& scratch, std::vector<uint32_t>& labelOfFace) {
    constexpr int kRounds = 16; // a set may join one that is loose itself
    for (int round = 0; round < kRounds; ++round) {
        if (!LooseFaces(linked, component, group, scratch, labelOfFace).join()) return;
    }
}

} // namespace xgc::bake
