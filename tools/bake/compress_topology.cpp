#include "bake/compress.h"

#include <algorithm>
#include <array>
#include <optional>

// The reverse of runtime/load/src/decode_topology.cpp, whose picture of a patch's codes holds here.

namespace xgc::bake::compress {
namespace {

using namespace format;

constexpr uint32_t kStray = 255, kFar = 15, kHistory = 16;

bool isWide(const PatchRecord& patch) {
    return patch.flags & kWideSlots;
}

uint32_t faceCountOf(const PatchRecord& patch) {
    return patch.listedFaceCount;
}

uint32_t cornerOf(const AssetView& asset, const PatchRecord& patch, uint32_t i) {
    const size_t at = size_t(patch.firstCorner) + i;
    return isWide(patch) ? asset.cornersWide[at] : asset.cornersNarrow[at];
}

uint32_t parentOf(const AssetView& asset, const PatchRecord& patch, uint32_t slot) {
    const size_t at = size_t(patch.firstParent) + slot;
    return isWide(patch) ? asset.parentsWide[at] : asset.parentsNarrow[at];
}

struct Rotated {
    std::array<uint32_t, 3> corners;
    uint8_t turn; ///< index of the face's own first corner in `corners`
};

/// The corners from the `by`-th on.
Rotated rotate(const std::array<uint32_t, 3>& c, uint32_t by) {
    return {{c[by], c[(by + 1) % 3], c[(by + 2) % 3]}, uint8_t((3 - by) % 3)};
}

/// Codes of all patches of one width.
class FaceEncoder {
public:
    FaceEncoder(const AssetView& asset, bool wide, std::span<const uint32_t> slots)
        : asset_(asset), wide_(wide), slots_(slots) {}

    Bytes encode(int level) {
        for (uint32_t p = 0; p < asset_.patchCount(); ++p) {
            if (isWide(asset_.patches[p]) == wide_) addPatch(p);
        }
        FacesHeader header = {};
        header.flags = canonical_ ? 0u : uint32_t(kRotations);
        header.missCount = uint32_t(misses_.size());
        header.farCount = uint32_t(far_.size());
        header.strayCount = uint32_t(strays_.size());
        header.runBytes = uint32_t(runTable_.size());
        Bytes codes = codes_;
        append(codes, misses_);
        appendPlanes(codes, far_, width());
        append(codes, runs_);
        appendPlanes(codes, strays_, width());
        append(codes, runTable_);
        if (!canonical_) append(codes, rotations_);
        Bytes out;
        append(out, std::as_bytes(std::span(&header, 1)));
        append(out, deflate(codes, level));
        return out;
    }

private:
    struct Edge {
        uint32_t a, b;
    };

    uint32_t width() const { return wide_ ? 4 : 2; }

    void addPatch(uint32_t p) {
        const PatchRecord& patch = asset_.patches[p];
        patchSlots_ = slots_.subspan(patch.firstParent, patch.slotCount);
        rank_.assign(patch.slotCount, 0);
        for (uint32_t i = 0; i < patch.slotCount; ++i) rank_[patchSlots_[i]] = i;
        used_ = lastFar_ = edgeCount_ = vertexCount_ = 0;
        edges_.fill({0, 0});
        vertices_.fill(0);
        findRuns(patch.slotCount - asset_.interiorRange(p).count);
        for (uint32_t f = 0; f < faceCountOf(patch); ++f) {
            addFace({cornerOf(asset_, patch, 3 * f), cornerOf(asset_, patch, 3 * f + 1),
                     cornerOf(asset_, patch, 3 * f + 2)});
        }
        while (used_ < patch.slotCount) addNew();
    }

    /// Cuts the interior slots into runs that are first used in rising order.
    void findRuns(uint32_t first) {
        runOf_.assign(rank_.size(), uint8_t(kStray));
        std::vector<uint32_t> lengths;
        for (size_t slot = first; slot < rank_.size(); ++slot) {
            const bool rises = slot > first && rank_[slot] > rank_[slot - 1];
            if (!rises && lengths.size() == kStray - 1) break; // the rest is stray
            if (!rises) lengths.push_back(0);
            ++lengths.back();
            runOf_[slot] = uint8_t(lengths.size() - 1);
        }
        runTable_.push_back(std::byte(lengths.size()));
        for (const uint32_t length : lengths) {
            for (uint32_t b = 0; b < width(); ++b) runTable_.push_back(std::byte(length >> (8 * b) & 255));
        }
    }

    void addNew() {
        const uint32_t slot = patchSlots_[used_++];
        runs_.push_back(std::byte(runOf_[slot]));
        if (runOf_[slot] == kStray) strays_.push_back(slot);
    }

    uint32_t addVertex(uint32_t slot) {
        uint32_t code = kFar;
        if (rank_[slot] == used_) {
            addNew();
            code = 0;
        } else {
            for (uint32_t back = 1; back < kFar; ++back) {
                if (vertices_[(vertexCount_ - back) % kHistory] == slot && back <= vertexCount_) return back;
            }
            far_.push_back(zigzag(rank_[slot] - lastFar_));
            lastFar_ = rank_[slot];
        }
        vertices_[vertexCount_++ % kHistory] = slot;
        return code;
    }

    void meet(uint32_t a, uint32_t b) { edges_[edgeCount_++ % kHistory] = {a, b}; }

    /// How far back an edge of the face was met, and the face from it on.
    std::optional<uint32_t> findEdge(const std::array<uint32_t, 3>& c, Rotated& found) const {
        for (uint32_t back = 0; back < kFar && back < edgeCount_; ++back) {
            const Edge e = edges_[(edgeCount_ - 1 - back) % kHistory];
            for (uint32_t k = 0; k < 3; ++k) {
                if (e.a != c[k] || e.b != c[(k + 1) % 3]) continue;
                found = rotate(c, k);
                return back;
            }
        }
        return {};
    }

    void addFace(const std::array<uint32_t, 3>& corners) {
        Rotated r = rotate(corners, 0);
        const std::optional<uint32_t> edge = findEdge(corners, r);
        const auto [a, b, c] = r.corners;
        if (edge) {
            codes_.push_back(std::byte(*edge << 4 | addVertex(c)));
        } else {
            const uint32_t first = addVertex(a), second = addVertex(b);
            misses_.push_back(std::byte(first << 4 | second));
            codes_.push_back(std::byte(0xf0 | addVertex(c)));
            meet(b, a);
        }
        meet(c, b);
        meet(a, c);
        rotations_.push_back(std::byte(r.turn));
        canonical_ = canonical_ && corners[0] < std::min(corners[1], corners[2]);
    }

    const AssetView& asset_;
    const bool wide_;
    const std::span<const uint32_t> slots_;
    Bytes codes_, misses_, runs_, runTable_, rotations_;
    std::vector<uint32_t> far_, strays_;
    bool canonical_ = true;
    // Of the patch at hand.
    std::span<const uint32_t> patchSlots_;
    std::vector<uint32_t> rank_;
    std::vector<uint8_t> runOf_;
    uint32_t used_ = 0, lastFar_ = 0, edgeCount_ = 0, vertexCount_ = 0;
    std::array<Edge, kHistory> edges_{};
    std::array<uint32_t, kHistory> vertices_{};
};

} // namespace

std::vector<uint32_t> slotsByUse(const AssetView& asset, bool wide) {
    std::vector<uint32_t> slots;
    std::vector<uint8_t> seen;
    for (const PatchRecord& patch : asset.patches) {
        if (isWide(patch) != wide) continue;
        seen.assign(patch.slotCount, 0);
        const auto touch = [&](uint32_t slot) {
            if (!seen[slot]) slots.push_back(slot);
            seen[slot] = 1;
        };
        // In the order in which the encoder names a face's corners, which a shared edge may turn: a face has at most
        // one new corner then, so that the order is that of the corners as they are.
        for (uint32_t i = 0; i < 3 * faceCountOf(patch); ++i) touch(cornerOf(asset, patch, i));
        for (uint32_t slot = 0; slot < patch.slotCount; ++slot) touch(slot);
    }
    return slots;
}

Bytes encodeFaces(const AssetView& asset, bool wide, std::span<const uint32_t> slots, int level) {
    return FaceEncoder(asset, wide, slots).encode(level);
}

Bytes encodeParents(const AssetView& asset, bool wide, std::span<const uint32_t> slots, int level) {
    std::vector<uint32_t> distances, rank;
    distances.reserve(slots.size());
    for (const PatchRecord& patch : asset.patches) {
        if (isWide(patch) != wide) continue;
        const std::span<const uint32_t> own = slots.subspan(patch.firstParent, patch.slotCount);
        rank.assign(patch.slotCount, 0);
        for (uint32_t i = 0; i < own.size(); ++i) rank[own[i]] = i;
        for (uint32_t i = 0; i < own.size(); ++i) {
            distances.push_back(zigzag(i - rank[parentOf(asset, patch, own[i])]));
        }
    }
    Bytes planes;
    appendPlanes(planes, distances, wide ? 4 : 2);
    return deflate(planes, level);
}

std::vector<uint32_t> rowReferences(const AssetView& asset) {
    std::vector<uint32_t> references(asset.record->vertexCount, 0), rows;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        rows.clear();
        const auto add = [&](VertexRange range) {
            for (uint32_t i = 0; i < range.count; ++i) rows.push_back(range.first + i);
        };
        for (const uint32_t d : asset.domainsOf(p)) add(asset.domainRange(d));
        add(asset.interiorRange(p));
        for (uint32_t slot = 0; slot < rows.size(); ++slot) {
            const uint32_t parent = parentOf(asset, asset.patches[p], slot), row = rows[slot];
            references[row] = parent != slot ? rows[parent] : row > 0 ? row - 1 : 0;
        }
    }
    return references;
}

} // namespace xgc::bake::compress
