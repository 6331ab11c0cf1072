#include <xgc/bake/patches.h>

#include <algorithm>
#include <array>
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

/// A connected piece, its faces numbered in breadth-first order so that neighbours lie close in memory.
struct Piece {
    std::vector<uint32_t> faces;
    std::vector<std::array<uint32_t, 3>> neighbours; ///< kNone where there is none; of more than three, three
};

/// Cuts a piece into regions grown from seeds.
class Regions {
public:
    Regions(const Piece& piece, uint32_t count) : piece_(piece), seeds_(count) {
        const size_t n = piece.faces.size();
        for (uint32_t s = 0; s < count; ++s) seeds_[s] = uint32_t((2 * size_t(s) + 1) * n / (2 * size_t(count)));
        grow();
        for (int round = 0; round < kRounds; ++round) {
            recentre();
            grow();
        }
    }
    const std::vector<uint32_t>& labels() const { return label_; }

private:
    /// All at once; a face goes to the first that reaches it.
    void grow() {
        label_.assign(piece_.faces.size(), kNone);
        queue_ = seeds_;
        for (uint32_t s = 0; s < seeds_.size(); ++s) label_[seeds_[s]] = s;
        for (size_t i = 0; i < queue_.size(); ++i) {
            for (const uint32_t g : piece_.neighbours[queue_[i]]) {
                if (g == kNone || label_[g] != kNone) continue;
                label_[g] = label_[queue_[i]];
                queue_.push_back(g);
            }
        }
        // Where more than two faces share an edge, some are no face's neighbour.
        for (uint32_t f = 0; f < label_.size(); ++f) {
            if (label_[f] == kNone) label_[f] = labelBeside(f);
        }
    }

    uint32_t labelBeside(uint32_t f) const {
        for (const uint32_t g : piece_.neighbours[f]) {
            if (g != kNone && label_[g] != kNone) return label_[g];
        }
        return f > 0 ? label_[f - 1] : 0;
    }

    /// Moves the seeds to the faces farthest from their regions' rims: where walks from the rims end.
    void recentre() {
        queue_.clear();
        reached_.assign(piece_.faces.size(), 0);
        for (uint32_t f = 0; f < piece_.faces.size(); ++f) {
            for (const uint32_t g : piece_.neighbours[f]) {
                if (g == kNone || label_[g] == label_[f] || reached_[f]) continue;
                reached_[f] = 1;
                queue_.push_back(f);
            }
        }
        for (size_t i = 0; i < queue_.size(); ++i) {
            const uint32_t f = queue_[i];
            seeds_[label_[f]] = f;
            for (const uint32_t g : piece_.neighbours[f]) {
                if (g == kNone || reached_[g] || label_[g] != label_[f]) continue;
                reached_[g] = 1;
                queue_.push_back(g);
            }
        }
    }

    const Piece& piece_;
    std::vector<uint32_t> seeds_, label_, queue_;
    std::vector<uint8_t> reached_;
};

/// Splits the faces of one cell (a part's share of one material) at a time.
class Splitter {
public:
    Splitter(const Topology& topology, std::span<const uint32_t> faceCell, uint32_t maxFaces)
        : topology_(topology), faceCell_(faceCell), maxFaces_(maxFaces), number_(faceCell.size(), kNone) {}

    /// Numbers patches from 0 in `label`. Returns how many.
    uint32_t split(std::span<const uint32_t> faces, std::vector<uint32_t>& label) {
        uint32_t count = 0;
        uint32_t gathered = 0; // faces in the patch that takes small pieces
        uint32_t gathering = kNone;
        for (const uint32_t f : faces) {
            if (number_[f] != kNone) continue;
            walk(f);
            const auto size = uint32_t(piece_.faces.size());
            if (size > maxFaces_) {
                count = cut(count, label);
                continue;
            }
            if (gathering == kNone || gathered + size > maxFaces_) {
                gathering = count++;
                gathered = 0;
            }
            gathered += size;
            for (const uint32_t g : piece_.faces) label[g] = gathering;
        }
        return count;
    }

private:
    /// The connected piece of a face.
    void walk(uint32_t start) {
        piece_.faces.assign(1, start);
        piece_.neighbours.clear();
        number_[start] = 0;
        for (size_t i = 0; i < piece_.faces.size(); ++i) {
            const uint32_t f = piece_.faces[i];
            std::array<uint32_t, 3> neighbours = {kNone, kNone, kNone};
            for (int k = 0; k < 3; ++k) {
                for (const uint32_t g : topology_.facesOfEdge(topology_.faceEdges[f][k])) {
                    if (g == f || faceCell_[g] != faceCell_[f]) continue;
                    if (number_[g] == kNone) {
                        number_[g] = uint32_t(piece_.faces.size());
                        piece_.faces.push_back(g);
                    }
                    neighbours[size_t(k)] = number_[g];
                }
            }
            piece_.neighbours.push_back(neighbours);
        }
    }

    uint32_t cut(uint32_t count, std::vector<uint32_t>& label) const {
        const size_t size = piece_.faces.size();
        const auto regions = std::max(2u, uint32_t(double(size) / (maxFaces_ * kFill)) + 1);
        const Regions cut(piece_, std::min(regions, uint32_t(size)));
        for (size_t i = 0; i < size; ++i) label[piece_.faces[i]] = count + cut.labels()[i];
        return count + std::min(regions, uint32_t(size));
    }

    const Topology& topology_;
    const std::span<const uint32_t> faceCell_;
    const uint32_t maxFaces_;
    std::vector<uint32_t> number_; ///< of a face in its piece
    Piece piece_;
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

    Splitter splitter(topology, cells.facePatch, maxFaces);
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
