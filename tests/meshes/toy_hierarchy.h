#pragma once

#include <xgc/bake/asset_writer.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

/// Hierarchies for tests of what comes after the builder: they keep every rule of `checkHierarchy` and care for
/// nothing else (they fold and flip at will). Boundaries collapse too, domains widen, vertices may be made.
namespace xgc::test {

struct ToyOptions {
    uint32_t seed = 1;
    uint32_t levelCount = 6;
    float share = 0.4f;          ///< of the vertices alive that a level collapses, about
    bool lockBoundaries = false; ///< as the thesis does
    bool makeVertices = false;   ///< some pairs collapse into a new vertex between them
    bool wedgeIdsAsUvs = true;   ///< UV set 0 holds (wedge, 0): tells which wedge a row is
};

/// Splits the faces into `count` patches of one part each, by the angle of their centre around the z axis' slabs:
/// deterministic and connected enough. `mesh` must be welded.
inline bake::Segmentation slabs(const bake::Mesh& mesh, uint32_t count) {
    bake::Segmentation parts;
    std::vector<std::pair<float, uint32_t>> order;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        const glm::vec3 c = mesh.positions[p.x] + mesh.positions[p.y] + mesh.positions[p.z];
        order.emplace_back(c.x * 1.0f + c.y * 0.31f + c.z * 0.17f, f);
    }
    std::sort(order.begin(), order.end());
    parts.facePart.resize(order.size());
    for (size_t i = 0; i < order.size(); ++i) parts.facePart[order[i].second] = uint32_t(i * count / order.size());
    for (uint32_t i = 0; i < count; ++i) parts.partNames.push_back("part " + std::to_string(i));
    return parts;
}

class ToyBuilder {
public:
    ToyBuilder(const bake::Mesh& mesh, const bake::Segmentation& parts, const ToyOptions& options)
        : mesh_(mesh), options_(options), random_(options.seed) {
        h_.levelCount = options.levelCount;
        h_.positions = mesh.positions;
        h_.wedgePosition = mesh.wedgePosition;
        h_.attributes = mesh.attributes;
        h_.facePatch = parts.facePart;
        h_.patches.resize(parts.partCount());
        for (uint32_t p = 0; p < h_.patches.size(); ++p) h_.patches[p].part = p;
        h_.levelThreshold.assign(options.levelCount, 0.0f);
        h_.collapseLevel.assign(mesh.positions.size(), bake::kNeverCollapses);
        h_.birthLevel.assign(mesh.positions.size(), 0);
        h_.wedgeParent.assign(mesh.wedgePosition.size(), bake::kNone);
        setDomains();
    }

    bake::Hierarchy build() {
        for (uint32_t level = 1; level < options_.levelCount; ++level) collapseLevel(uint8_t(level));
        for (const std::set<uint32_t>& d : domains_) h_.domain.push_back(intern(d));
        if (options_.wedgeIdsAsUvs) {
            auto& uv = h_.attributes.uvs[0];
            uv.clear();
            for (size_t w = 0; w < h_.wedgePosition.size(); ++w) uv.emplace_back(float(w), 0.0f);
        }
        return h_;
    }

private:
    void setDomains() {
        domains_.resize(mesh_.positions.size());
        wedges_.resize(mesh_.positions.size());
        for (uint32_t f = 0; f < mesh_.faceCount(); ++f) {
            for (int k = 0; k < 3; ++k) domains_[mesh_.facePositions(f)[k]].insert(h_.facePatch[f]);
        }
        for (uint32_t w = 0; w < h_.wedgePosition.size(); ++w) wedges_[h_.wedgePosition[w]].push_back(w);
        for (auto& d : domains_) {
            if (d.empty()) d.insert(0);
        }
    }

    uint32_t drawn(uint32_t wedge) const {
        while (h_.wedgeParent[wedge] != bake::kNone) wedge = h_.wedgeParent[wedge];
        return wedge;
    }

    bool simple(uint32_t p) const { return wedges_[p].size() == 1; }

    bool mayCollapse(uint32_t v, uint32_t u) const {
        if (v == u || !simple(v) || !simple(u) || h_.collapseLevel[v] != bake::kNeverCollapses) return false;
        if (domains_[v].size() > 1 && (options_.lockBoundaries || domains_[u].size() == 1)) return false;
        return true;
    }

    void collapse(uint32_t v, uint32_t u, uint8_t level) {
        h_.collapseLevel[v] = level;
        h_.wedgeParent[wedges_[v].front()] = wedges_[u].front();
        domains_[u].insert(domains_[v].begin(), domains_[v].end());
    }

    uint32_t make(uint32_t v, uint32_t u, uint8_t level) {
        const auto m = uint32_t(h_.positions.size());
        h_.positions.push_back((h_.positions[v] + h_.positions[u]) * 0.5f);
        h_.collapseLevel.push_back(bake::kNeverCollapses);
        h_.birthLevel.push_back(level);
        domains_.push_back(domains_[v]);
        wedges_.push_back({uint32_t(h_.wedgePosition.size())});
        h_.wedgePosition.push_back(m);
        h_.wedgeParent.push_back(bake::kNone);
        return m;
    }

    /// Collapses along edges of the surface as it is drawn; a vertex may be passed on several times in one level.
    void collapseLevel(uint8_t level) {
        std::vector<uint32_t> faces(mesh_.faceCount());
        for (uint32_t i = 0; i < faces.size(); ++i) faces[i] = i;
        for (size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random_() % i]);
        const auto wanted = size_t(float(alive()) * options_.share);
        size_t done = 0;
        for (const uint32_t f : faces) {
            if (done >= wanted) break;
            const auto k = uint32_t(random_() % 3);
            const uint32_t v = h_.wedgePosition[drawn(mesh_.faces[f][int(k)])];
            const uint32_t u = h_.wedgePosition[drawn(mesh_.faces[f][int((k + 1) % 3)])];
            if (!mayCollapse(v, u)) continue;
            if (options_.makeVertices && domains_[u] == domains_[v] && mayCollapse(u, v) && random_() % 2) {
                const uint32_t m = make(v, u, level);
                collapse(u, m, level);
                collapse(v, m, level);
            } else {
                collapse(v, u, level);
            }
            ++done;
        }
    }

    size_t alive() const {
        return size_t(std::count(h_.collapseLevel.begin(), h_.collapseLevel.end(), bake::kNeverCollapses));
    }

    uint32_t intern(const std::set<uint32_t>& d) {
        const auto [at, isNew] = interned_.try_emplace(d, uint32_t(h_.domainPatches.size()));
        if (isNew) h_.domainPatches.emplace_back(d.begin(), d.end());
        return at->second;
    }

    const bake::Mesh& mesh_;
    ToyOptions options_;
    std::mt19937 random_;
    bake::Hierarchy h_;
    std::vector<std::set<uint32_t>> domains_;   ///< per position, still growing
    std::vector<std::vector<uint32_t>> wedges_; ///< per position
    std::map<std::set<uint32_t>, uint32_t> interned_;
};

inline bake::Hierarchy toyHierarchy(const bake::Mesh& mesh, const bake::Segmentation& parts,
                                    const ToyOptions& options) {
    return ToyBuilder(mesh, parts, options).build();
}

/// Errors that rise by a step a level, so that they are easy to tell apart.
inline bake::PatchErrors toyErrors(const bake::Hierarchy& h) {
    bake::PatchErrors errors;
    errors.estimate = true;
    for (uint32_t p = 0; p < h.patchCount(); ++p) {
        for (uint32_t level = 0; level < h.levelCount; ++level) errors.values.push_back(float(level) * 0.01f);
    }
    return errors;
}

} // namespace xgc::test
