#pragma once

#include <glm/glm.hpp>

#include <bit>
#include <cstdint>
#include <vector>

namespace xgc::bake::models {

/// Bits on a lattice of points: set inside a solid. The outermost points stay clear.
class Voxels {
public:
    Voxels(glm::ivec3 size)
        : size_(size), rowWords_((size.x + 63) / 64 + 1), words_(size_t(rowWords_) * size.y * size.z) {}

    glm::ivec3 size() const { return size_; }
    bool get(glm::ivec3 p) const { return (word(p.x >> 6, p.y, p.z) >> (p.x & 63)) & 1; }
    void set(glm::ivec3 p) { words_[row(p.y, p.z) + (p.x >> 6)] |= uint64_t(1) << (p.x & 63); }
    /// Sets a box of points.
    void fill(glm::ivec3 low, glm::ivec3 high);

    /// Lattice edges whose ends differ: a surface net has that many quads.
    uint64_t countCrossings() const;

    /// Sets points until the boundary of the solid is a manifold: no four points around a lattice square and no eight
    /// around a cell meet only across a diagonal (Latecki's well-composed sets).
    void makeManifold();

    /// The eight points of the cell whose lowest one is `c`: bit x + 2 y + 4 z.
    uint32_t corners(glm::ivec3 c) const;

    /// Calls `visit(glm::ivec3)` for the cells of layer z, in rising order, that hold both kinds of points.
    template <typename Visit>
    void forMixedCells(int z, Visit&& visit) const {
        for (int y = 0; y + 1 < size_.y; ++y) {
            for (int w = 0; w + 1 < rowWords_; ++w) {
                for (uint64_t bits = mixed(w, y, z); bits; bits &= bits - 1) {
                    visit(glm::ivec3(w * 64 + std::countr_zero(bits), y, z));
                }
            }
        }
    }

private:
    size_t row(int y, int z) const { return size_t(rowWords_) * (size_t(z) * size_.y + y); }
    uint64_t word(int w, int y, int z) const { return words_[row(y, z) + w]; }
    uint64_t mixed(int w, int y, int z) const;

    glm::ivec3 size_;
    int rowWords_; ///< one more than the points need: the cells of the last word look there
    std::vector<uint64_t> words_;
};

} // namespace xgc::bake::models
