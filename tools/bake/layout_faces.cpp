#include "bake/layout.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

// Faces of a patch lie in bands of falling death level. Within a band the order is free, and is that of the vertex
// cache, as the band is drawn at the coarsest level at which all of it lives: at finer levels its triangles are
// scattered among those of the later bands, at coarser ones they die one by one.
//
//   bands      [ 9 .. never | 4 .. 8 | 1 .. 3 ]     death levels
//   ordered at   level 8      level 3  level 0
//
// Few bands serve the fine levels, many the coarse ones: `chooseBands` tries several cuts and measures them.

namespace xgc::bake::layout {
namespace {

constexpr uint8_t kNever = kNeverCollapses;

/// What becomes of a face over the levels of its patch.
struct Life {
    uint8_t death;        ///< first level at which it is degenerate whatever the neighbours do
    uint8_t uniformDeath; ///< the same with all patches at one level
    bool interior;        ///< up to its death no corner can be moved by a neighbour
};

class Lives {
public:
    Lives(const Mesh& mesh, const Hierarchy& h, const Domains& domains) : mesh_(mesh), h_(h), domains_(domains) {}

    Life of(uint32_t face) const {
        bool movable = false;
        const uint8_t death = walk(face, movable, [&](uint32_t p) { return levelAlone(p); });
        bool ignored = false;
        const uint8_t uniform = walk(face, ignored, [&](uint32_t p) { return h_.collapseLevel[p]; });
        return {death, uniform, !movable};
    }

    /// Drawn corners of a face in a uniform state.
    glm::uvec3 drawn(uint32_t face, uint32_t level) const {
        glm::uvec3 corners = mesh_.faces[face];
        for (int k = 0; k < 3; ++k) {
            while (h_.collapseLevel[position(corners[k])] <= level) corners[k] = h_.wedgeParent[corners[k]];
        }
        return corners;
    }

private:
    uint32_t position(uint32_t wedge) const { return h_.wedgePosition[wedge]; }
    bool isShared(uint32_t p) const { return domains_.isShared(domains_.groupOf[h_.domain[p]]); }
    /// Collapse level with all other patches at level 0.
    uint8_t levelAlone(uint32_t p) const { return isShared(p) ? kNever : h_.collapseLevel[p]; }

    /// Steps from level to level until two corners meet.
    template <typename CollapseLevel>
    uint8_t walk(uint32_t face, bool& movable, const CollapseLevel& collapseLevel) const {
        glm::uvec3 w = mesh_.faces[face];
        for (uint32_t level = 0;;) {
            uint32_t next = kNever;
            for (int k = 0; k < 3; ++k) {
                while (collapseLevel(position(w[k])) <= level) w[k] = h_.wedgeParent[w[k]];
                next = std::min<uint32_t>(next, collapseLevel(position(w[k])));
            }
            const uint32_t a = position(w.x), b = position(w.y), c = position(w.z);
            if (a == b || b == c || c == a) return uint8_t(level);
            for (const uint32_t p : {a, b, c}) movable |= isShared(p) && h_.collapseLevel[p] != kNever;
            if (next == kNever) return kNever;
            level = next;
        }
    }

    const Mesh& mesh_;
    const Hierarchy& h_;
    const Domains& domains_;
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

/// Orders runs of faces for the vertex cache; keeps its scratch memory.
class CacheOrder {
public:
    CacheOrder(const Lives& lives, size_t wedgeCount) : lives_(lives), number_(wedgeCount) {}

    void order(std::span<uint32_t> faces, uint32_t level) {
        if (faces.size() < 2) return;
        corners_.clear();
        for (const uint32_t f : faces) {
            const glm::uvec3 c = lives_.drawn(f, level);
            corners_.insert(corners_.end(), {c.x, c.y, c.z});
        }
        const uint32_t wedges = number_(corners_);
        ordered_.resize(corners_.size());
        meshopt_optimizeVertexCache(ordered_.data(), corners_.data(), corners_.size(), wedges);
        permute(faces);
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

    /// The optimizer returns corners: find out which face went where. Faces with equal corners keep their order.
    void permute(std::span<uint32_t> faces) {
        keys(corners_, from_);
        keys(ordered_, to_);
        faces_.assign(faces.begin(), faces.end());
        for (size_t i = 0; i < from_.size(); ++i) faces[to_[i][3]] = faces_[from_[i][3]];
    }

    const Lives& lives_;
    Numbering number_;
    std::vector<uint32_t> corners_, ordered_, faces_;
    std::vector<Key> from_, to_;
};

/// The patches that are laid out: all, or a sample.
struct FacesByPatch {
    std::vector<uint32_t> patches;
    std::vector<std::vector<uint32_t>> faces; ///< beside patches
};

FacesByPatch groupByPatch(const Hierarchy& h) {
    FacesByPatch all;
    all.patches.resize(h.patches.size());
    std::iota(all.patches.begin(), all.patches.end(), 0u);
    all.faces.resize(h.patches.size());
    for (uint32_t f = 0; f < h.facePatch.size(); ++f) all.faces[h.facePatch[f]].push_back(f);
    return all;
}

/// Every n-th patch, of about `faceCount` faces together.
FacesByPatch sample(const FacesByPatch& all, size_t total, size_t faceCount) {
    FacesByPatch some;
    const size_t step = std::max<size_t>(1, total / faceCount);
    for (size_t i = 0; i < all.patches.size(); i += std::min(step, all.patches.size())) {
        some.patches.push_back(all.patches[i]);
        some.faces.push_back(all.faces[i]);
    }
    return some;
}

/// Faces that die at each level, and (entry 255) those that never do.
using DeathCounts = std::array<size_t, 256>;

DeathCounts countDeaths(const std::vector<Life>& lives) {
    DeathCounts counts{};
    for (const Life& life : lives) ++counts[life.death];
    return counts;
}

/// Cuts bands wherever the faces have become fewer by `factor`.
std::vector<uint32_t> cutBands(const DeathCounts& counts, double factor) {
    size_t alive = std::accumulate(counts.begin(), counts.end(), size_t(0));
    double atCut = double(alive);
    std::vector<uint32_t> bands = {1};
    for (uint32_t level = 1; level < kNever && bands.size() < format::kMaxBands; ++level) {
        if (alive == 0) break;
        if (double(alive) * factor <= atCut) {
            bands.push_back(level);
            atCut = double(alive);
        }
        alive -= counts[level]; // now those that live at `level`, that is, with a death above it
    }
    std::reverse(bands.begin(), bands.end());
    return bands;
}

uint32_t bandOf(const std::vector<uint32_t>& bands, uint8_t death) {
    return uint32_t(std::partition_point(bands.begin(), bands.end(), [&](uint32_t b) { return b > death; }) -
                    bands.begin());
}

/// Sorts the faces of one patch into its two runs and their bands, orders each, and appends all.
void appendPatch(const std::vector<uint32_t>& patchFaces, const std::vector<Life>& lives, uint32_t levelCount,
                 CacheOrder& cache, Faces& out) {
    const auto runOf = [&](uint32_t f) { return lives[f].interior ? 0u : 1u; };
    std::vector<uint32_t> faces = patchFaces;
    std::stable_sort(faces.begin(), faces.end(), [&](uint32_t a, uint32_t b) {
        return std::pair(runOf(a), bandOf(out.bands, lives[a].death)) <
               std::pair(runOf(b), bandOf(out.bands, lives[b].death));
    });
    std::array<uint32_t, 2> runStart = {0, 0};
    std::vector<format::BandEnd> ends(out.bands.size());
    size_t at = 0;
    for (uint32_t run = 0; run < 2; ++run) {
        runStart[run] = uint32_t(at);
        for (uint32_t b = 0; b < out.bands.size(); ++b) {
            const size_t start = at;
            while (at < faces.size() && runOf(faces[at]) == run && bandOf(out.bands, lives[faces[at]].death) == b) ++at;
            cache.order(std::span(faces).subspan(start, at - start), std::min(out.bands[b], levelCount) - 1);
            (run == 0 ? ends[b].interior : ends[b].boundary) = uint32_t(at) - runStart[run];
        }
    }
    out.interiorCount.push_back(runStart[1]);
    out.bandEnds.insert(out.bandEnds.end(), ends.begin(), ends.end());
    for (const uint32_t f : faces) {
        out.order.push_back(f);
        out.deaths.push_back(lives[f].death);
    }
    out.firstFace.push_back(uint32_t(out.order.size()));
}

Faces layOut(const FacesByPatch& patches, const std::vector<Life>& lives, uint32_t levelCount,
             std::vector<uint32_t> bands, CacheOrder& cache) {
    Faces faces;
    faces.bands = std::move(bands);
    faces.firstFace = {0};
    for (const std::vector<uint32_t>& patch : patches.faces) appendPatch(patch, lives, levelCount, cache, faces);
    return faces;
}

/// Cache misses and triangles of each level.
struct Misses {
    std::vector<size_t> misses, triangles;
    std::vector<uint32_t> corners;
    Numbering number;

    Misses(uint32_t levelCount, size_t wedgeCount) : misses(levelCount), triangles(levelCount), number(wedgeCount) {}

    void addPatch(const Lives& lives, std::span<const uint32_t> faces, uint32_t level) {
        corners.clear();
        for (const uint32_t f : faces) {
            const glm::uvec3 c = lives.drawn(f, level);
            if (c.x != c.y && c.y != c.z && c.z != c.x) corners.insert(corners.end(), {c.x, c.y, c.z});
        }
        if (corners.empty()) return;
        const uint32_t wedges = number(corners);
        const meshopt_VertexCacheStatistics s =
            meshopt_analyzeVertexCache(corners.data(), corners.size(), wedges, 16, 0, 0);
        misses[level] += s.vertices_transformed;
        triangles[level] += corners.size() / 3;
    }
};

std::vector<float> acmr(const Lives& lives, const Faces& faces, const Hierarchy& h) {
    const uint32_t levelCount = h.levelCount;
    Misses misses(levelCount, h.wedgePosition.size());
    for (size_t p = 0; p + 1 < faces.firstFace.size(); ++p) {
        const auto patch =
            std::span(faces.order).subspan(faces.firstFace[p], faces.firstFace[p + 1] - faces.firstFace[p]);
        for (uint32_t level = 0; level < levelCount; ++level) misses.addPatch(lives, patch, level);
    }
    std::vector<float> result;
    for (uint32_t level = 0; level < levelCount; ++level) {
        result.push_back(misses.triangles[level] ? float(misses.misses[level]) / float(misses.triangles[level]) : 0.0f);
    }
    return result;
}

/// The cut with the fewest cache misses per triangle, on a sample of the patches: a level counts by the share of the
/// faces that die at it, so that levels at which a hierarchy stalls hardly do, and level 0 half. Within a band at most
/// 7 of 8 faces die (more at one level aside), so that emission and its capacity stay near what is drawn.
std::vector<uint32_t> chooseBands(const FacesByPatch& all, const std::vector<Life>& lives, const Hierarchy& h,
                                  const Lives& walker, CacheOrder& cache) {
    constexpr size_t kSampleFaces = 100000;
    const DeathCounts counts = countDeaths(lives);
    const FacesByPatch some = sample(all, lives.size(), kSampleFaces);
    std::vector<uint32_t> best, last;
    double bestSum = std::numeric_limits<double>::infinity();
    for (const double factor : {8.0, 4.0, 2.0, 1.4}) {
        std::vector<uint32_t> bands = cutBands(counts, factor);
        if (bands == last) continue;
        last = bands;
        const std::vector<float> rates = acmr(walker, layOut(some, lives, h.levelCount, bands, cache), h);
        double sum = rates[0] / 2, alive = double(lives.size());
        for (uint32_t level = 1; level < h.levelCount && alive > 0; ++level) {
            const auto died = double(counts[level]);
            sum += rates[level] * died / alive;
            alive -= died;
        }
        if (sum < bestSum) {
            bestSum = sum;
            best = std::move(bands);
        }
    }
    return best;
}

} // namespace

Faces orderFaces(const Mesh& mesh, const Hierarchy& h, const Domains& domains) {
    const Lives walker(mesh, h, domains);
    std::vector<Life> lives;
    lives.reserve(mesh.faces.size());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) lives.push_back(walker.of(f));

    const FacesByPatch all = groupByPatch(h);
    CacheOrder cache(walker, h.wedgePosition.size());
    Faces faces = layOut(all, lives, h.levelCount, chooseBands(all, lives, h, walker, cache), cache);
    faces.levelFaceCounts.assign(h.levelCount, 0);
    for (const Life& life : lives) {
        const uint32_t levels = std::min<uint32_t>(life.uniformDeath, h.levelCount);
        for (uint32_t level = 0; level < levels; ++level) ++faces.levelFaceCounts[level];
    }
    return faces;
}

std::vector<float> measureAcmr(const Mesh& mesh, const Hierarchy& h, const Faces& faces) {
    const std::vector<uint8_t> used = usedWedges(mesh, h);
    const Domains domains = orderDomains(h, used);
    return acmr(Lives(mesh, h, domains), faces, h);
}

} // namespace xgc::bake::layout
