#include <xgc/bake/patches.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <numeric>

// A part of n faces wants ceil(n / target) patches. Its connected pieces come first: small ones are gathered into
// patches in the order of their lowest face (bolts, leaves, teeth); a large one is cut by regions that grow face by
// face from seeds. The seeds begin evenly spaced in the order of a breadth-first walk; each round moves a seed to the
// face of its region that is farthest from the region's rim, and grows again.

namespace xgc::bake {
namespace {

constexpr int kRounds = 3;
constexpr double kFill = 0.8; ///< faces a patch aimed at, of the bound: regions differ in size

/// Faces of one cell (a part's share of one material), grouped by connected piece.
class Splitter {
public:
    Splitter(const Mesh& mesh, const Topology& topology, std::vector<uint32_t> faceCell, uint32_t maxFaces)
        : topology_(topology), faceCell_(std::move(faceCell)), maxFaces_(maxFaces), label_(mesh.faces.size(), kNone),
          distance_(mesh.faces.size(), kNone) {}

    /// Patches of the faces of one cell: numbers from 0 in `label`. Returns how many.
    uint32_t split(std::span<const uint32_t> faces, std::vector<uint32_t>& label) {
        uint32_t count = 0;
        uint32_t gathered = 0; // faces in the patch that takes small pieces
        uint32_t gathering = kNone;
        for (const uint32_t f : faces) {
            if (distance_[f] != kNone) continue;
            const std::vector<uint32_t> piece = walk(f);
            if (piece.size() > maxFaces_) {
                count = cut(piece, count, label);
                continue;
            }
            if (gathering == kNone || gathered + piece.size() > maxFaces_) {
                gathering = count++;
                gathered = 0;
            }
            gathered += uint32_t(piece.size());
            for (const uint32_t g : piece) label[g] = gathering;
        }
        return count;
    }

private:
    template <typename Visit>
    void forNeighbours(uint32_t f, const Visit& visit) const {
        for (int k = 0; k < 3; ++k) {
            for (const uint32_t g : topology_.facesOfEdge(topology_.faceEdges[f][k])) {
                if (g != f && faceCell_[g] == faceCell_[f]) visit(g);
            }
        }
    }

    /// The connected piece of a face, in breadth-first order.
    std::vector<uint32_t> walk(uint32_t start) {
        std::vector<uint32_t> piece = {start};
        distance_[start] = 0;
        for (size_t i = 0; i < piece.size(); ++i) {
            forNeighbours(piece[i], [&](uint32_t g) {
                if (distance_[g] != kNone) return;
                distance_[g] = 0;
                piece.push_back(g);
            });
        }
        return piece;
    }

    /// Grows regions from seeds at once; a face goes to the first that reaches it.
    void grow(std::span<const uint32_t> piece, std::span<const uint32_t> seeds) {
        for (const uint32_t f : piece) label_[f] = kNone;
        queue_.assign(seeds.begin(), seeds.end());
        for (uint32_t s = 0; s < seeds.size(); ++s) label_[seeds[s]] = s;
        for (size_t i = 0; i < queue_.size(); ++i) {
            forNeighbours(queue_[i], [&](uint32_t g) {
                if (label_[g] != kNone) return;
                label_[g] = label_[queue_[i]];
                queue_.push_back(g);
            });
        }
    }

    /// The face of each region that is farthest from its rim: where a walk from the rims ends.
    void recentre(std::span<const uint32_t> piece, std::vector<uint32_t>& seeds) {
        queue_.clear();
        for (const uint32_t f : piece) distance_[f] = kNone;
        for (const uint32_t f : piece) {
            bool rim = false;
            forNeighbours(f, [&](uint32_t g) { rim |= label_[g] != label_[f]; });
            if (!rim) continue;
            distance_[f] = 0;
            queue_.push_back(f);
        }
        for (size_t i = 0; i < queue_.size(); ++i) {
            const uint32_t f = queue_[i];
            seeds[label_[f]] = f;
            forNeighbours(f, [&](uint32_t g) {
                if (distance_[g] != kNone || label_[g] != label_[f]) return;
                distance_[g] = distance_[f] + 1;
                queue_.push_back(g);
            });
        }
        for (const uint32_t f : piece) distance_[f] = 0;
    }

    uint32_t cut(std::span<const uint32_t> piece, uint32_t count, std::vector<uint32_t>& label) {
        auto regions = uint32_t(double(piece.size()) / (maxFaces_ * kFill)) + 1;
        regions = std::min<uint32_t>(std::max(regions, 2u), uint32_t(piece.size()));
        std::vector<uint32_t> seeds(regions);
        for (uint32_t s = 0; s < regions; ++s) seeds[s] = piece[(2 * size_t(s) + 1) * piece.size() / (2 * regions)];
        grow(piece, seeds);
        for (int round = 0; round < kRounds; ++round) {
            recentre(piece, seeds);
            grow(piece, seeds);
        }
        for (const uint32_t f : piece) label[f] = count + label_[f];
        return count + regions;
    }

    const Topology& topology_;
    const std::vector<uint32_t> faceCell_;
    const uint32_t maxFaces_;
    std::vector<uint32_t> label_, distance_, queue_;
};

} // namespace

PatchAssignment patchesOfParts(const Mesh& mesh, const Segmentation& parts) {
    assert(parts.facePart.size() == mesh.faces.size());
    PatchAssignment out;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> known;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) known[{parts.facePart[f], mesh.faceMaterial[f]}] = 0;
    for (auto& [key, patch] : known) {
        patch = uint32_t(out.patches.size());
        out.patches.push_back({key.first, key.second});
    }
    out.facePatch.resize(mesh.faces.size());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) out.facePatch[f] = known[{parts.facePart[f], mesh.faceMaterial[f]}];
    return out;
}

PatchAssignment splitPatches(const Mesh& mesh, const Topology& topology, const Segmentation& parts, uint32_t maxFaces) {
    const PatchAssignment cells = patchesOfParts(mesh, parts);
    if (maxFaces == 0) return cells;
    std::vector<uint32_t> start(cells.patches.size() + 1, 0), faces(mesh.faces.size());
    for (const uint32_t c : cells.facePatch) ++start[c + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<uint32_t> at(start.begin(), start.end() - 1);
    for (uint32_t f = 0; f < faces.size(); ++f) faces[at[cells.facePatch[f]]++] = f;

    Splitter splitter(mesh, topology, cells.facePatch, maxFaces);
    PatchAssignment out;
    out.facePatch.resize(mesh.faces.size());
    for (uint32_t c = 0; c < cells.patches.size(); ++c) {
        const std::span<const uint32_t> cell = std::span(faces).subspan(start[c], start[c + 1] - start[c]);
        const auto first = uint32_t(out.patches.size());
        const uint32_t count = splitter.split(cell, out.facePatch);
        for (const uint32_t f : cell) out.facePatch[f] += first;
        out.patches.insert(out.patches.end(), count, cells.patches[c]);
    }
    return out;
}

} // namespace xgc::bake
