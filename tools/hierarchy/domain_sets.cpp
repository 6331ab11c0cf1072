#include "hierarchy/domain_sets.h"

#include <algorithm>
#include <iterator>

namespace xgc::bake {

DomainSets::DomainSets(std::vector<std::vector<uint32_t>> sets) : sets_(std::move(sets)) {
    for (uint32_t s = 0; s < sets_.size(); ++s) known_.emplace(sets_[s], s);
}

bool DomainSets::has(uint32_t set, uint32_t patch) const {
    for (const uint32_t p : sets_[set]) {
        if (p >= patch) return p == patch;
    }
    return false;
}

uint32_t DomainSets::unite(uint32_t a, uint32_t b) {
    if (a == b) return a;
    std::vector<uint32_t> both;
    std::set_union(sets_[a].begin(), sets_[a].end(), sets_[b].begin(), sets_[b].end(), std::back_inserter(both));
    if (both.size() == sets_[a].size()) return a;
    if (both.size() == sets_[b].size()) return b;
    return intern(std::move(both));
}

uint32_t DomainSets::intern(std::vector<uint32_t> set) {
    const auto [entry, isNew] = known_.try_emplace(std::move(set), uint32_t(sets_.size()));
    if (isNew) sets_.push_back(entry->first);
    return entry->second;
}

} // namespace xgc::bake
