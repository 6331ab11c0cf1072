#include "bake/layout.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <numeric>

// What a patch draws at coarser levels is what it draws at a finer one with vertices merged: so an order of faces that
// suits the vertex cache goes on suiting it, and a list of the faces of a fine level serves coarser levels too, but
// for the degenerate ones among it, which are passed over. Where those become most of it, a new list begins, of the
// faces that are left, in an order of its own:
//
//   list 0   all faces, ordered at level 0
//   list 1   the triangles that are left at level 7, over the vertices of level 7, ordered at level 7
//   list 2   those of level 12 ...
//
// Each patch has levels of its own for its lists: it may be flat and soon down to a few faces.

namespace xgc::bake::layout {
namespace {

/// A list begins at the first level at which not more than this share of the list before is left: more lists pass
/// over fewer faces, and take more memory.
constexpr uint32_t kListRatio = 6;
/// A list of no more faces is the patch's last.
constexpr uint32_t kSmallList = 16;

bool isSolid(const glm::uvec3& t) {
    return t.x != t.y && t.y != t.z && t.z != t.x;
}

/// Triangles of wedges at the uniform levels, one level after the other.
class Uniform {
public:
    explicit Uniform(const Hierarchy& h) : h_(h) {}

    /// Takes triangles to a coarser level and drops those that become degenerate.
    void coarsen(std::vector<glm::uvec3>& triangles, uint32_t level) const {
        for (glm::uvec3& t : triangles) {
            for (int k = 0; k < 3; ++k) {
                while (h_.collapseLevel[h_.wedgePosition[t[k]]] <= level) t[k] = h_.wedgeParent[t[k]];
            }
        }
        std::erase_if(triangles, [](const glm::uvec3& t) { return !isSolid(t); });
    }

private:
    const Hierarchy& h_;
};

/// Numbers the wedges of corner lists from 0 by first use; keeps its scratch memory.
class Numbering {
public:
    explicit Numbering(size_t wedgeCount) : number_(wedgeCount, kNone) {}

    /// Returns how many there are.
    uint32_t operator()(std::vector<uint32_t>& corners) {
        for (uint32_t& c : corners) {
            if (number_[c] == kNone) {
                number_[c] = uint32_t(used_.size());
                used_.push_back(c);
            }
            c = number_[c];
        }
        const auto count = uint32_t(used_.size());
        for (const uint32_t wedge : used_) number_[wedge] = kNone;
        used_.clear();
        return count;
    }

private:
    std::vector<uint32_t> number_, used_;
};

/// Orders triangles for the vertex cache; keeps its scratch memory.
class CacheOrder {
public:
    explicit CacheOrder(size_t wedgeCount) : number_(wedgeCount) {}

    /// `order`: for each place the index of the triangle that goes there.
    void order(std::span<const glm::uvec3> triangles, std::vector<uint32_t>& order) {
        corners_.clear();
        for (const glm::uvec3& t : triangles) corners_.insert(corners_.end(), {t.x, t.y, t.z});
        const uint32_t wedges = number_(corners_);
        ordered_.resize(corners_.size());
        meshopt_optimizeVertexCache(ordered_.data(), corners_.data(), corners_.size(), wedges);
        // The optimizer returns corners: find out which triangle went where. Equal ones keep their order.
        keys(corners_, from_);
        keys(ordered_, to_);
        order.resize(triangles.size());
        for (size_t i = 0; i < from_.size(); ++i) order[to_[i][3]] = from_[i][3];
    }

private:
    using Key = std::array<uint32_t, 4>; ///< three corners, then an index

    static void keys(const std::vector<uint32_t>& corners, std::vector<Key>& out) {
        out.clear();
        for (uint32_t i = 0; 3 * size_t(i) < corners.size(); ++i) {
            out.push_back({corners[3 * size_t(i)], corners[3 * size_t(i) + 1], corners[3 * size_t(i) + 2], i});
        }
        std::sort(out.begin(), out.end());
    }

    Numbering number_;
    std::vector<uint32_t> corners_, ordered_;
    std::vector<Key> from_, to_;
};

/// Lists of one patch after the other.
class Lists {
public:
    Lists(const Mesh& mesh, const Hierarchy& h, const Tiers* pages, Faces& out)
        : mesh_(mesh), h_(h), uniform_(h), cache_(h.wedgePosition.size()), out_(out) {
        for (uint32_t t = 0; pages && t < pages->count(); ++t) edges_.push_back(pages->firstLevels[t]);
        out.firstFace = {0};
        out.lists.resize(h.patches.size());
        out.levelFaceCounts.assign(h.levelCount, 0);
    }

    void addPatch(uint32_t patch, std::span<const uint32_t> faces) {
        triangles_.clear();
        for (const uint32_t f : faces) triangles_.push_back(mesh_.faces[f]);
        cache_.order(triangles_, order_);
        for (const uint32_t i : order_) out_.order.push_back(faces[i]);
        out_.firstFace.push_back(uint32_t(out_.order.size()));
        begin(patch, 0);
        for (uint32_t level = 0; level < h_.levelCount; ++level) {
            uniform_.coarsen(triangles_, level);
            out_.levelFaceCounts[level] += uint32_t(triangles_.size());
            out_.patchFaceCounts.push_back(uint32_t(triangles_.size()));
            const size_t listed = out_.lists[patch].back().triangles.size();
            const bool isEdge = level > 0 && std::find(edges_.begin(), edges_.end(), level) != edges_.end();
            const bool isShort = triangles_.size() * kListRatio <= listed && listed > kSmallList;
            const size_t free = format::kMaxFaceLists - out_.lists[patch].size();
            if (!isEdge && (!isShort || free <= edges_.size())) continue;
            cache_.order(triangles_, order_);
            begin(patch, level);
        }
    }

private:
    /// A list of the triangles at hand in their new order, in which they stay.
    void begin(uint32_t patch, uint32_t level) {
        FacesOfLevel list{level, {}};
        for (const uint32_t i : order_) list.triangles.push_back(triangles_[i]);
        triangles_ = list.triangles;
        out_.lists[patch].push_back(std::move(list));
    }

    const Mesh& mesh_;
    const Hierarchy& h_;
    const Uniform uniform_;
    CacheOrder cache_;
    Faces& out_;
    std::vector<uint32_t> edges_; ///< levels at which tiers begin
    std::vector<glm::uvec3> triangles_;
    std::vector<uint32_t> order_;
};

} // namespace

Faces orderFaces(const Mesh& mesh, const Hierarchy& h, const Tiers* pages) {
    std::vector<std::vector<uint32_t>> facesOf(h.patches.size());
    for (uint32_t f = 0; f < h.facePatch.size(); ++f) facesOf[h.facePatch[f]].push_back(f);
    Faces faces;
    Lists lists(mesh, h, pages, faces);
    for (uint32_t p = 0; p < facesOf.size(); ++p) lists.addPatch(p, facesOf[p]);
    return faces;
}

} // namespace xgc::bake::layout
