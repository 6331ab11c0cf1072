#include <xgc/bake/hierarchy.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace xgc::bake {

namespace {

Status broken(std::string_view what, size_t element) {
    return {Outcome::promiseBroken, fmt::format("hierarchy: {} {}", what, element)};
}

bool includes(const std::vector<uint32_t>& wide, const std::vector<uint32_t>& narrow) {
    return std::includes(wide.begin(), wide.end(), narrow.begin(), narrow.end());
}

/// A column of attributes is empty or has a row each wedge.
bool attributesFit(const Attributes& a, size_t rows) {
    const auto fits = [rows](const auto& column) { return column.empty() || column.size() == rows; };
    bool all = fits(a.normals) && fits(a.tangents);
    for (const auto& column : a.uvs) all = all && fits(column);
    for (const auto& column : a.colors) all = all && fits(column);
    for (const auto& column : a.joints) all = all && fits(column);
    for (const auto& column : a.weights) all = all && fits(column);
    for (const MorphTarget& t : a.morphTargets) all = all && fits(t.positions) && fits(t.normals) && fits(t.tangents);
    return all;
}

Status checkColumns(const Mesh& mesh, const Hierarchy& h) {
    const size_t positions = h.positions.size(), wedges = h.wedgePosition.size();
    if (h.collapseLevel.size() != positions || h.birthLevel.size() != positions || h.domain.size() != positions)
        return broken("columns of positions differ in length, positions:", positions);
    if (h.wedgeParent.size() != wedges || !attributesFit(h.attributes, wedges))
        return broken("columns of wedges differ in length, wedges:", wedges);
    if (h.facePatch.size() != mesh.faces.size()) return broken("a patch a face is wanted, has", h.facePatch.size());
    if (h.levelCount == 0 || h.levelCount >= kNeverCollapses || h.levelThreshold.size() != h.levelCount)
        return broken("levels and their thresholds do not fit, levels:", h.levelCount);
    if (positions < mesh.positions.size() || wedges < mesh.wedgePosition.size())
        return broken("the mesh has more positions or wedges, positions:", positions);
    for (size_t p = 0; p < mesh.positions.size(); ++p) {
        if (h.positions[p] != mesh.positions[p]) return broken("not where the mesh has it, position", p);
    }
    for (size_t w = 0; w < wedges; ++w) {
        if (h.wedgePosition[w] >= positions) return broken("no position, wedge", w);
        if (w < mesh.wedgePosition.size() && h.wedgePosition[w] != mesh.wedgePosition[w])
            return broken("not at the mesh's position, wedge", w);
    }
    return {};
}

Status checkPatchesAndDomains(const Mesh& mesh, const Hierarchy& h) {
    for (size_t p = 1; p < h.patches.size(); ++p) {
        if (h.patches[p].part < h.patches[p - 1].part) return broken("not in the order of parts, patch", p);
    }
    for (size_t d = 0; d < h.domainPatches.size(); ++d) {
        const std::vector<uint32_t>& patches = h.domainPatches[d];
        if (patches.empty() || patches.back() >= h.patches.size()) return broken("patches out of range, domain", d);
        for (size_t k = 1; k < patches.size(); ++k) {
            if (patches[k] <= patches[k - 1]) return broken("patches do not rise, domain", d);
        }
    }
    for (size_t p = 0; p < h.positions.size(); ++p) {
        if (h.domain[p] >= h.domainPatches.size()) return broken("no domain, position", p);
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (h.facePatch[f] >= h.patches.size()) return broken("no patch, face", f);
        if (h.patches[h.facePatch[f]].material != mesh.faceMaterial[f])
            return broken("its patch is of another material, face", f);
        const glm::uvec3 corners = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            const std::vector<uint32_t>& d = h.domainPatches[h.domain[corners[k]]];
            if (!std::binary_search(d.begin(), d.end(), h.facePatch[f]))
                return broken("a corner's domain misses the patch of face", f);
        }
    }
    return {};
}

Status checkLevels(const Mesh& mesh, const Hierarchy& h, uint32_t p) {
    const uint32_t collapse = h.collapseLevel[p], birth = h.birthLevel[p];
    if (collapse != kNeverCollapses && (collapse == 0 || collapse >= h.levelCount))
        return broken("collapse level out of range, position", p);
    if (p < mesh.positions.size()) return birth == 0 ? Status{} : broken("born though the mesh has it, position", p);
    if (birth == 0 || birth >= h.levelCount || birth > collapse) return broken("birth level out of range, position", p);
    return {};
}

Status checkParent(const Hierarchy& h, uint32_t wedge, std::vector<uint32_t>& parentPosition) {
    const uint32_t p = h.wedgePosition[wedge], parent = h.wedgeParent[wedge];
    if (h.collapseLevel[p] == kNeverCollapses)
        return parent == kNone ? Status{} : broken("a vertex that never collapses has a parent, wedge", wedge);
    if (parent >= h.wedgePosition.size()) return broken("no parent, wedge", wedge);
    const uint32_t q = h.wedgePosition[parent];
    if (q == p) return broken("a vertex is its own parent, wedge", wedge);
    if (h.domain[q] == h.domain[p] && h.collapseLevel[q] < h.collapseLevel[p])
        return broken("the parent collapses first, wedge", wedge);
    if (h.birthLevel[q] > h.collapseLevel[p])
        return broken("the parent is born after its child collapses, wedge", wedge);
    if (h.domain[q] != h.domain[p] && !includes(h.domainPatches[h.domain[q]], h.domainPatches[h.domain[p]]))
        return broken("the parent's domain is not wider, wedge", wedge);
    if (parentPosition[p] != kNone && parentPosition[p] != q)
        return broken("wedges of one position part ways, position", p);
    parentPosition[p] = q;
    return {};
}

/// Each position is walked once.
Status checkChainsEnd(std::span<const uint32_t> parentPosition) {
    std::vector<uint32_t> walk(parentPosition.size(), kNone); // the start of the walk that met the position
    for (uint32_t p = 0; p < parentPosition.size(); ++p) {
        uint32_t q = p;
        while (q != kNone && walk[q] == kNone) {
            walk[q] = p;
            q = parentPosition[q];
        }
        if (q != kNone && walk[q] == p) return broken("parents form a loop, position", q);
    }
    return {};
}

/// One face in states where all that its own patch alone decides is at one level, and all that is shared at another.
class FaceStates {
public:
    FaceStates(const Hierarchy& hierarchy, std::span<const uint8_t> isSeam, glm::uvec3 corners)
        : h_(hierarchy), isSeam_(isSeam), corners_{corners.x, corners.y, corners.z} {}

    bool consistent() const {
        if (!meetsSeam()) return true;
        if (!sharedCollapse()) return consistentAt(0);
        for (uint32_t shared = 0; shared < h_.levelCount; ++shared) {
            if (!consistentAt(shared)) return false;
        }
        return true;
    }

private:
    /// Only a position with several wedges can be met with two of them.
    bool meetsSeam() const {
        for (uint32_t w : corners_) {
            for (; w != kNone; w = h_.wedgeParent[w]) {
                if (isSeam_[h_.wedgePosition[w]]) return true;
            }
        }
        return false;
    }

    bool isShared(uint32_t position) const { return h_.domainPatches[h_.domain[position]].size() > 1; }

    bool sharedCollapse() const {
        for (uint32_t w : corners_) {
            for (; w != kNone; w = h_.wedgeParent[w]) {
                const uint32_t p = h_.wedgePosition[w];
                if (isShared(p) && h_.collapseLevel[p] != kNeverCollapses) return true;
            }
        }
        return false;
    }

    bool consistentAt(uint32_t shared) const {
        std::array<uint32_t, 3> wedges = corners_;
        for (uint32_t own = shared; own < h_.levelCount; ++own) {
            std::array<uint32_t, 3> positions{};
            for (int k = 0; k < 3; ++k) {
                positions[k] = h_.wedgePosition[wedges[k]];
                while (h_.collapseLevel[positions[k]] <= (isShared(positions[k]) ? shared : own)) {
                    wedges[k] = h_.wedgeParent[wedges[k]];
                    positions[k] = h_.wedgePosition[wedges[k]];
                }
            }
            if (isDegenerate(positions) != isDegenerate(wedges)) return false;
        }
        return true;
    }

    static bool isDegenerate(const std::array<uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

    const Hierarchy& h_;
    const std::span<const uint8_t> isSeam_;
    std::array<uint32_t, 3> corners_;
};

} // namespace

Status checkHierarchy(const Mesh& mesh, const Hierarchy& h) {
    if (Status s = checkColumns(mesh, h); !s.ok()) return s;
    if (Status s = checkPatchesAndDomains(mesh, h); !s.ok()) return s;
    for (uint32_t p = 0; p < h.positions.size(); ++p) {
        if (Status s = checkLevels(mesh, h, p); !s.ok()) return s;
    }
    std::vector<uint32_t> parentPosition(h.positions.size(), kNone);
    for (uint32_t w = 0; w < h.wedgePosition.size(); ++w) {
        if (Status s = checkParent(h, w, parentPosition); !s.ok()) return s;
    }
    if (Status s = checkChainsEnd(parentPosition); !s.ok()) return s;
    std::vector<uint8_t> isMet(h.positions.size(), 0), isSeam(h.positions.size(), 0);
    for (const uint32_t p : h.wedgePosition) {
        isSeam[p] |= isMet[p];
        isMet[p] = 1;
    }
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (!FaceStates(h, isSeam, mesh.faces[f]).consistent())
            return broken("two wedges of one position meet in face", f);
    }
    return {};
}

} // namespace xgc::bake
