#include "contour_polish.h"
#include "disjoint_sets.h"

#include <algorithm>
#include <cmath>

namespace xgc::bake {

namespace {

/// A contour is looked at over so many cell sizes around.
constexpr float kReach = 2.2f;

class Polisher {
public:
    Polisher(const Mesh& mesh, const LinkedFaces& linked, const Component& component, std::vector<uint32_t>& scratch,
             std::vector<uint32_t>& labels)
        : mesh_(mesh), linked_(linked), component_(component), graph_(component.cells.graph), scratch_(scratch),
          labels_(labels), reach_(kReach / std::sqrt(float(component.cells.graph.size()))) {}

    void run() {
        labelCells();
        findMixedCells();
        if (around_.empty()) return;
        collectBand();
        std::vector<uint32_t> before(band_.size());
        for (size_t i = 0; i < band_.size(); ++i) before[i] = labels_[faceOf(band_[i])];
        std::vector<uint32_t> voted(band_.size());
        for (size_t i = 0; i < band_.size(); ++i) voted[i] = strongestAt(band_[i]);
        for (size_t i = 0; i < band_.size(); ++i) labels_[faceOf(band_[i])] = voted[i];
        constexpr int kRounds = 4;
        bool isConnected = false;
        for (int round = 0; round < kRounds && !isConnected; ++round) isConnected = !joinLooseFaces();
        if (!isConnected) {
            for (size_t i = 0; i < band_.size(); ++i) labels_[faceOf(band_[i])] = before[i];
        }
        for (const uint32_t f : component_.face) scratch_[f] = kNone;
    }

private:
    void labelCells() {
        cellLabel_.resize(graph_.size());
        for (uint32_t t = 0; t < component_.face.size(); ++t) {
            cellLabel_[component_.cells.ofTriangle[t]] = labels_[component_.face[t]];
        }
    }

    /// For cells with a neighbour of another label: all cells within two steps.
    void findMixedCells() {
        aroundOffsets_.assign(1, 0);
        std::vector<uint32_t> seenBy(graph_.size(), kNone);
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            const std::span<const CellGraph::Arc> arcs = graph_.arcsOf(c);
            const bool isMixed = std::any_of(arcs.begin(), arcs.end(), [&](const CellGraph::Arc& arc) {
                return cellLabel_[arc.to] != cellLabel_[c];
            });
            if (isMixed) {
                const size_t begin = around_.size();
                around_.push_back(c);
                seenBy[c] = c;
                size_t end = begin + 1;
                for (size_t i = begin; i < end; ++i) {
                    for (const CellGraph::Arc& arc : graph_.arcsOf(around_[i])) {
                        if (seenBy[arc.to] == c) continue;
                        seenBy[arc.to] = c;
                        around_.push_back(arc.to);
                    }
                    if (i == begin) end = around_.size(); // the neighbours' neighbours are the last
                }
            }
            aroundOffsets_.push_back(uint32_t(around_.size()));
        }
    }

    uint32_t faceOf(uint32_t triangle) const { return component_.face[triangle]; }
    uint32_t cellOf(uint32_t triangle) const { return component_.cells.ofTriangle[triangle]; }
    bool isMixed(uint32_t cell) const { return aroundOffsets_[cell] != aroundOffsets_[cell + 1]; }

    /// Triangles of mixed cells; `scratch_` says from now on which node a face is.
    void collectBand() {
        for (uint32_t t = 0; t < component_.face.size(); ++t) {
            const uint32_t cell = cellOf(t);
            scratch_[faceOf(t)] = isMixed(cell) ? nodeOf(band_.size()) : cell;
            if (isMixed(cell)) band_.push_back(t);
        }
    }

    /// The label whose cells lie nearest, by area and less across a crease.
    uint32_t strongestAt(uint32_t triangle) {
        const uint32_t face = faceOf(triangle), cell = cellOf(triangle);
        const glm::uvec3 c = linked_.corners[face];
        const glm::vec3 p = mesh_.positions[c.x], q = mesh_.positions[c.y], r = mesh_.positions[c.z];
        const glm::vec3 center = component_.pose.placeOf(glm::dvec3(p + q + r) / 3.0);
        const glm::vec3 crossed = component_.pose.directionOf(glm::cross(q - p, r - p));
        const float length = glm::length(crossed);
        votes_.clear();
        for (uint32_t i = aroundOffsets_[cell]; i < aroundOffsets_[cell + 1]; ++i) {
            const uint32_t other = around_[i];
            const glm::vec3 step = graph_.centers[other] - center;
            const float near = 1 - glm::dot(step, step) / (reach_ * reach_);
            if (near <= 0) continue;
            const float alike = length > 0 ? std::max(0.05f, glm::dot(crossed, graph_.normals[other]) / length) : 1;
            const float vote = graph_.areas[other] * near * near * alike * alike;
            const auto at =
                std::find_if(votes_.begin(), votes_.end(), [&](const Vote& v) { return v.label == cellLabel_[other]; });
            if (at != votes_.end()) {
                at->strength += vote;
            } else {
                votes_.push_back({cellLabel_[other], vote});
            }
        }
        Vote best = {labels_[face], 0};
        for (const Vote& v : votes_) {
            if (v.strength > best.strength || (v.strength == best.strength && v.label < best.label)) best = v;
        }
        return best.label;
    }

    /// Nodes of connectivity: a whole cell where it is of one label all around, else each triangle (those of the band,
    /// numbered after the cells).
    uint32_t nodeOf(size_t inBand) const { return graph_.size() + uint32_t(inBand); }
    size_t nodeCount() const { return graph_.size() + band_.size(); }
    void findSets() {
        sets_ = DisjointSets(nodeCount());
        for (const CellGraph::Link& link : graph_.links) {
            const bool areWhole = !isMixed(link.a) && !isMixed(link.b);
            if (areWhole && cellLabel_[link.a] == cellLabel_[link.b]) sets_.join(link.a, link.b);
        }
        for (size_t i = 0; i < band_.size(); ++i) {
            const uint32_t f = faceOf(band_[i]);
            for (int k = 0; k < 3; ++k) {
                const uint32_t g = linked_.neighbours[f][k];
                if (g != kNone && labels_[g] == labels_[f]) sets_.join(nodeOf(i), scratch_[g]);
            }
        }
    }

    /// Sets of triangles that lie apart from the largest of their label, by area, take the label that borders them
    /// most. False where there were none.
    bool joinLooseFaces() {
        findSets();
        std::vector<float> area(nodeCount(), 0.0f);
        std::vector<std::pair<uint32_t, uint32_t>> sets; // label, set
        for (uint32_t c = 0; c < graph_.size(); ++c) {
            if (isMixed(c)) continue;
            area[sets_.find(c)] += graph_.areas[c];
            if (sets_.find(c) == c) sets.emplace_back(cellLabel_[c], c);
        }
        for (size_t i = 0; i < band_.size(); ++i) { // an area each: good enough to tell which set is largest
            const uint32_t node = nodeOf(i);
            area[sets_.find(node)] += 1e-9f;
            if (sets_.find(node) == node) sets.emplace_back(labels_[faceOf(band_[i])], node);
        }
        std::sort(sets.begin(), sets.end(), [&](const auto& a, const auto& b) {
            if (a.first != b.first) return a.first < b.first;
            return area[a.second] != area[b.second] ? area[a.second] > area[b.second] : a.second < b.second;
        });
        std::vector<uint32_t> loose;
        for (size_t i = 1; i < sets.size(); ++i) {
            if (sets[i].first == sets[i - 1].first) loose.push_back(sets[i].second);
        }
        std::sort(loose.begin(), loose.end());
        giveAway(loose);
        return !loose.empty();
    }

    /// `loose`: sets, rising.
    void giveAway(std::span<const uint32_t> loose) {
        std::vector<uint8_t> isLoose(nodeCount(), 0);
        for (const uint32_t set : loose) isLoose[set] = 1;
        std::vector<std::pair<uint32_t, uint32_t>> members; // set, face
        for (size_t i = 0; i < band_.size(); ++i) {
            const uint32_t set = sets_.find(nodeOf(i));
            if (isLoose[set]) members.emplace_back(set, faceOf(band_[i]));
        }
        std::stable_sort(members.begin(), members.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<uint32_t> faces;
        for (size_t i = 0; i < members.size();) {
            faces.clear();
            for (const uint32_t set = members[i].first; i < members.size() && members[i].first == set; ++i)
                faces.push_back(members[i].second);
            giveAwayFaces(faces);
        }
    }

    void giveAwayFaces(std::span<const uint32_t> members) {
        std::vector<uint32_t> around;
        for (const uint32_t f : members) {
            for (int k = 0; k < 3; ++k) {
                const uint32_t g = linked_.neighbours[f][k];
                if (g != kNone && labels_[g] != labels_[f]) around.push_back(labels_[g]);
            }
        }
        std::sort(around.begin(), around.end());
        size_t most = 0;
        uint32_t best = kNone;
        for (size_t i = 0, j = 0; i < around.size(); i = j) {
            while (j < around.size() && around[j] == around[i]) ++j;
            if (j - i <= most) continue;
            most = j - i;
            best = around[i];
        }
        if (best == kNone) return;
        for (const uint32_t f : members) labels_[f] = best;
    }

    struct Vote {
        uint32_t label;
        float strength;
    };

    const Mesh& mesh_;
    const LinkedFaces& linked_;
    const Component& component_;
    const CellGraph& graph_;
    std::vector<uint32_t>& scratch_;
    std::vector<uint32_t>& labels_;
    float reach_; ///< in the component's scale
    std::vector<uint32_t> cellLabel_;
    std::vector<uint32_t> aroundOffsets_, around_; ///< per cell; none where one label is all around
    std::vector<uint32_t> band_;                   ///< triangles, rising
    DisjointSets sets_{0};                         ///< of nodes
    std::vector<Vote> votes_;
};

} // namespace

void polishContours(const Mesh& mesh, const LinkedFaces& linked, const Component& component,
                    std::vector<uint32_t>& scratch, std::vector<uint32_t>& labelOfFace) {
    Polisher(mesh, linked, component, scratch, labelOfFace).run();
}

} // namespace xgc::bake
