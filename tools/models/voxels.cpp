#include "models/voxels.h"

#include <array>

namespace xgc::bake::models {
namespace {

/// A point of a cell to set, or -1 where the cell is fine.
int pointToSet(uint32_t corners) {
    // Squares of the cell as their corners in turn.
    constexpr int squares[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    const auto bit = [&](int k) { return (corners >> k) & 1; };
    for (const auto& s : squares) {
        if (bit(s[0]) == bit(s[2]) && bit(s[1]) == bit(s[3]) && bit(s[0]) != bit(s[1])) {
            return bit(s[0]) ? s[1] : s[0];
        }
    }
    for (int k = 0; k < 4; ++k) {
        const uint32_t pair = (1u << k) | (1u << (7 - k));
        if (corners == pair) return k == 0 ? 1 : 0;
        if (corners == (0xffu & ~pair)) return k;
    }
    return -1;
}

std::array<int8_t, 256> repairTable() {
    std::array<int8_t, 256> table{};
    for (uint32_t i = 0; i < 256; ++i) table[i] = int8_t(pointToSet(i));
    return table;
}

} // namespace

void Voxels::fill(glm::ivec3 low, glm::ivec3 high) {
    for (int z = low.z; z < high.z; ++z) {
        for (int y = low.y; y < high.y; ++y) {
            for (int x = low.x; x < high.x; ++x) set({x, y, z});
        }
    }
}

uint64_t Voxels::mixed(int w, int y, int z) const {
    uint64_t any[2], all[2];
    for (int k = 0; k < 2; ++k) {
        const uint64_t a = word(w + k, y, z), b = word(w + k, y + 1, z);
        const uint64_t c = word(w + k, y, z + 1), d = word(w + k, y + 1, z + 1);
        any[k] = a | b | c | d;
        all[k] = a & b & c & d;
    }
    const uint64_t anyWide = any[0] | (any[0] >> 1) | (any[1] << 63);
    const uint64_t allWide = all[0] & ((all[0] >> 1) | (all[1] << 63));
    return anyWide & ~allWide;
}

uint64_t Voxels::countCrossings() const {
    uint64_t count = 0;
    for (int z = 0; z + 1 < size_.z; ++z) {
        for (int y = 0; y + 1 < size_.y; ++y) {
            for (int w = 0; w + 1 < rowWords_; ++w) {
                const uint64_t here = word(w, y, z);
                count += std::popcount(here ^ ((here >> 1) | (word(w + 1, y, z) << 63)));
                count += std::popcount(here ^ word(w, y + 1, z));
                count += std::popcount(here ^ word(w, y, z + 1));
            }
        }
    }
    return count;
}

uint32_t Voxels::corners(glm::ivec3 c) const {
    uint32_t result = 0;
    for (int k = 0; k < 8; ++k) result |= uint32_t(get(c + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2))) << k;
    return result;
}

void Voxels::makeManifold() {
    const std::array<int8_t, 256> table = repairTable();
    std::vector<glm::ivec3> work;
    for (int z = 0; z + 1 < size_.z; ++z) {
        forMixedCells(z, [&](glm::ivec3 c) {
            if (table[corners(c)] >= 0) work.push_back(c);
        });
    }
    while (!work.empty()) {
        const glm::ivec3 cell = work.back();
        const int point = table[corners(cell)];
        if (point < 0) {
            work.pop_back();
            continue;
        }
        const glm::ivec3 p = cell + glm::ivec3(point & 1, (point >> 1) & 1, point >> 2);
        set(p);
        for (int k = 0; k < 8; ++k) {
            const glm::ivec3 c = p - glm::ivec3(k & 1, (k >> 1) & 1, k >> 2);
            const bool within =
                glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c + 1, size_));
            if (within && table[corners(c)] >= 0) work.push_back(c);
        }
    }
}

} // namespace xgc::bake::models
