#pragma once

#include <xgc/bake/mesh.h>

namespace xgc::bake {

/// The pieces of a mesh that touch nowhere, not even at a vertex; numbered by their lowest component.
class Pieces {
public:
    Pieces(const Mesh& mesh, const Topology& topology);

    uint32_t count() const { return uint32_t(firstPosition_.size()) - 1; }
    uint32_t ofPosition(uint32_t position) const { return ofPosition_[position]; }
    /// Rising.
    std::span<const uint32_t> positionsOf(uint32_t piece) const { return range(positions_, firstPosition_, piece); }
    std::span<const uint32_t> facesOf(uint32_t piece) const { return range(faces_, firstFace_, piece); }
    /// Whether it has an edge with an odd number of faces.
    bool isOpen(uint32_t piece) const { return isOpen_[piece] != 0; }
    /// Whether it is a leaf, a feather, a sticker: open, and small in a mesh of that diagonal.
    bool isSmallSheet(uint32_t piece, double diagonal) const {
        return isOpen(piece) && squaredRadius(piece) <= kSmall * kSmall * diagonal * diagonal;
    }
    /// Half the diagonal of its box.
    double squaredRadius(uint32_t piece) const { return squaredRadius_[piece]; }
    /// Largest first.
    std::vector<uint32_t> bySize() const;

private:
    static constexpr double kSmall = 1.0 / 16;

    static std::span<const uint32_t> range(const std::vector<uint32_t>& list, const std::vector<uint32_t>& first,
                                           uint32_t i) {
        return std::span(list).subspan(first[i], first[i + 1] - first[i]);
    }
    void measure(const Mesh& mesh, const Topology& topology);

    std::vector<uint32_t> ofPosition_, firstPosition_, positions_, firstFace_, faces_;
    std::vector<uint8_t> isOpen_;
    std::vector<double> squaredRadius_;
};

} // namespace xgc::bake
