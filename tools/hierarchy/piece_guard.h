#pragma once

#include <cstdint>
#include <vector>

namespace xgc::bake {

/// Small open pieces (leaves, blades, feathers) whose rims must not waste away: collapses along a rim leave four
/// vertices, and most of the area until the error is as large as the piece.
class PieceGuard {
public:
    static constexpr uint32_t kUnguarded = 0xffffffffu;
    static constexpr uint32_t kLeastRim = 4;
    static constexpr double kLeastArea = 0.92; ///< share that a piece keeps

    /// Nothing is guarded until `guard` is called. `pieceOf`: per position, or kUnguarded.
    void guard(std::vector<uint32_t> pieceOf) { pieceOf_ = std::move(pieceOf); }
    struct Piece {
        double wholeArea = 0;
        double squaredRadius = 0; ///< times importance squared
        double area = 0;
        uint32_t rim = 0;     ///< vertices on it
        bool isSmall = false; ///< for the error of the level being built
    };
    std::vector<Piece> pieces;

    bool isEmpty() const { return pieces.empty(); }
    uint32_t pieceOf(uint32_t position) const { return position < pieceOf_.size() ? pieceOf_[position] : kUnguarded; }
    /// For vertices that a build makes.
    void inherit(uint32_t made, uint32_t from) {
        if (!isEmpty()) pieceOf_[made] = pieceOf_[from];
    }
    void joinRim(uint32_t position) {
        if (const uint32_t piece = pieceOf(position); piece != kUnguarded) ++pieces[piece].rim;
    }
    /// Whether a piece may lose one vertex of its rim, and `area` with it.
    bool mayLose(uint32_t piece, double area) const {
        const Piece& p = pieces[piece];
        return p.rim > kLeastRim && (p.isSmall || p.area - area >= kLeastArea * p.wholeArea);
    }
    void lose(uint32_t piece, double area) {
        --pieces[piece].rim;
        pieces[piece].area -= area;
    }

private:
    std::vector<uint32_t> pieceOf_;
};

} // namespace xgc::bake
