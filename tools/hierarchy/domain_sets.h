#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace xgc::bake {

/// Interned sets of patches. Numbers are given in the order of first use; not for several threads while sets are made.
class DomainSets {
public:
    /// Patches to which steps may widen a domain: wider ones hold too much back.
    static constexpr size_t kWidest = 16;

    explicit DomainSets(std::vector<std::vector<uint32_t>> sets);

    /// Rising.
    std::span<const uint32_t> operator[](uint32_t set) const { return sets_[set]; }
    uint32_t count() const { return uint32_t(sets_.size()); }
    bool has(uint32_t set, uint32_t patch) const;
    uint32_t single(uint32_t patch) { return intern({patch}); }
    uint32_t unite(uint32_t a, uint32_t b);
    std::vector<std::vector<uint32_t>> take() { return std::move(sets_); }

private:
    uint32_t intern(std::vector<uint32_t> set);

    std::vector<std::vector<uint32_t>> sets_;
    std::map<std::vector<uint32_t>, uint32_t> known_;
};

} // namespace xgc::bake
