#include <xgc/bake/floor.h>

#include <algorithm>
#include <cmath>
#include <numeric>

// The coarsest state is a small mesh. For each vertex the collapses into its neighbours are tried as the builder would
// try them in this state, and the one that comes farthest names what stands in the way:
//
//   link  ->  wedges  ->  flips  ->  nothing but the error
//
// Edges that the builder does not take (off a border, off the boundary of a patch) count only where no other serves.

namespace xgc::bake {
namespace {

constexpr uint32_t kPieceFaces = 4;

struct DrawnFace {
    glm::uvec3 positions, wedges;
    uint32_t face; ///< of the mesh
};

/// An edge from a vertex, with what lies across it.
struct Edge {
    uint32_t to = 0;
    uint32_t faces = 0;
    bool severalPatches = false;
};

int cornerOf(const DrawnFace& f, uint32_t position) {
    return f.positions.x == position ? 0 : f.positions.y == position ? 1 : f.positions.z == position ? 2 : -1;
}

class CoarsestState {
public:
    CoarsestState(const Mesh& mesh, const Hierarchy& hierarchy);

    const std::vector<DrawnFace>& faces() const { return faces_; }
    uint32_t componentCount() const { return componentCount_; }
    Hold holdOf(uint32_t position) const;

private:
    enum class Step { link, wedges, flips, none };

    std::span<const uint32_t> facesOf(uint32_t position) const {
        return std::span(vertexFaces_).subspan(first_[position], first_[position + 1] - first_[position]);
    }
    void findComponents();
    std::vector<Edge> edgesOf(uint32_t position) const;
    Step farthest(uint32_t from, const Edge& edge, const std::vector<Edge>& edges) const;
    bool isLinked(uint32_t from, const Edge& edge, const std::vector<Edge>& edges) const;
    bool wedgesFit(uint32_t from, uint32_t to) const;
    bool flips(uint32_t from, uint32_t to) const;
    glm::dvec3 point(uint32_t position) const { return glm::dvec3(hierarchy_.positions[position]); }
    glm::dvec3 baseNormal(uint32_t face) const;

    const Mesh& mesh_;
    const Hierarchy& hierarchy_;
    std::vector<DrawnFace> faces_;
    std::vector<uint32_t> first_, vertexFaces_; ///< drawn faces of each position
    std::vector<uint32_t> component_;           ///< of a position: the lowest of it
    std::vector<uint32_t> componentFaces_;      ///< by that
    uint32_t componentCount_ = 0;
};

CoarsestState::CoarsestState(const Mesh& mesh, const Hierarchy& hierarchy) : mesh_(mesh), hierarchy_(hierarchy) {
    const std::vector<uint8_t> levels(hierarchy.patchCount(), uint8_t(hierarchy.levelCount - 1));
    const DrawnSurface surface = drawSurface(mesh, hierarchy, levels);
    first_.assign(hierarchy.positions.size() + 1, 0);
    for (size_t i = 0; i < surface.triangles.size(); ++i) {
        const glm::uvec3 w = surface.triangles[i];
        const std::vector<uint32_t>& at = hierarchy.wedgePosition;
        faces_.push_back({{at[w.x], at[w.y], at[w.z]}, w, surface.face[i]});
        for (int k = 0; k < 3; ++k) ++first_[faces_.back().positions[k] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    vertexFaces_.resize(3 * faces_.size());
    std::vector<uint32_t> slot(first_.begin(), first_.end() - 1);
    for (uint32_t f = 0; f < faces_.size(); ++f) {
        for (int k = 0; k < 3; ++k) vertexFaces_[slot[faces_[f].positions[k]]++] = f;
    }
    findComponents();
}

void CoarsestState::findComponents() {
    component_.resize(hierarchy_.positions.size());
    std::iota(component_.begin(), component_.end(), 0u);
    const auto root = [&](uint32_t p) {
        while (component_[p] != p) p = component_[p] = component_[component_[p]];
        return p;
    };
    for (const DrawnFace& f : faces_) {
        for (int k = 1; k < 3; ++k) {
            const uint32_t a = root(f.positions[0]), b = root(f.positions[k]);
            component_[std::max(a, b)] = std::min(a, b);
        }
    }
    componentFaces_.assign(component_.size(), 0);
    for (const DrawnFace& f : faces_) componentCount_ += uint32_t(componentFaces_[root(f.positions[0])]++ == 0);
    for (uint32_t p = 0; p < component_.size(); ++p) component_[p] = root(p);
}

std::vector<Edge> CoarsestState::edgesOf(uint32_t position) const {
    std::vector<std::pair<uint32_t, uint32_t>> uses; // neighbour, patch
    for (const uint32_t f : facesOf(position)) {
        const int k = cornerOf(faces_[f], position);
        const uint32_t patch = hierarchy_.facePatch[faces_[f].face];
        uses.emplace_back(faces_[f].positions[(k + 1) % 3], patch);
        uses.emplace_back(faces_[f].positions[(k + 2) % 3], patch);
    }
    std::sort(uses.begin(), uses.end());
    std::vector<Edge> edges;
    for (size_t i = 0; i < uses.size(); ++i) {
        const bool isNew = i == 0 || uses[i].first != uses[i - 1].first;
        if (isNew) edges.push_back({uses[i].first});
        ++edges.back().faces;
        edges.back().severalPatches |= !isNew && uses[i].second != uses[i - 1].second;
    }
    return edges;
}

/// Common neighbours are the vertices opposite the edge alone; one more may close a hole of three edges. No face falls
/// on another, and not all of them die.
bool CoarsestState::isLinked(uint32_t from, const Edge& edge, const std::vector<Edge>& edges) const {
    if (edge.faces > 2) return false;
    const std::vector<Edge> others = edgesOf(edge.to);
    uint32_t common = 0, open = 0;
    for (const Edge& e : edges) {
        const auto same = std::find_if(others.begin(), others.end(), [&](const Edge& o) { return o.to == e.to; });
        if (same == others.end()) continue;
        ++common;
        open += uint32_t(e.faces == 1 && same->faces == 1);
    }
    const bool closesHole = edge.faces == 1 && common == 2 && open > 0;
    if (common != edge.faces && !closesHole) return false;
    if (facesOf(from).size() == edge.faces && facesOf(edge.to).size() == edge.faces) return false;
    for (const uint32_t f : facesOf(from)) {
        if (cornerOf(faces_[f], edge.to) >= 0) continue;
        const int k = cornerOf(faces_[f], from);
        const uint32_t a = faces_[f].positions[(k + 1) % 3], b = faces_[f].positions[(k + 2) % 3];
        for (const uint32_t g : facesOf(edge.to)) {
            if (cornerOf(faces_[g], a) >= 0 && cornerOf(faces_[g], b) >= 0) return false;
        }
    }
    return true;
}

/// Each wedge has one place to go: the wedge at the other end of a face that dies.
bool CoarsestState::wedgesFit(uint32_t from, uint32_t to) const {
    std::vector<std::pair<uint32_t, uint32_t>> map;
    for (const uint32_t f : facesOf(from)) {
        const int k = cornerOf(faces_[f], from), other = cornerOf(faces_[f], to);
        if (other >= 0) map.emplace_back(faces_[f].wedges[k], faces_[f].wedges[other]);
    }
    for (const uint32_t f : facesOf(from)) {
        const uint32_t wedge = faces_[f].wedges[cornerOf(faces_[f], from)];
        uint32_t target = kNone;
        for (const auto& [w, t] : map) {
            if (w != wedge) continue;
            if (target != kNone && target != t) return false;
            target = t;
        }
        if (target == kNone) return false;
    }
    return true;
}

glm::dvec3 CoarsestState::baseNormal(uint32_t face) const {
    const glm::uvec3 p = mesh_.facePositions(face);
    return glm::cross(point(p.y) - point(p.x), point(p.z) - point(p.x));
}

bool CoarsestState::flips(uint32_t from, uint32_t to) const {
    for (const uint32_t f : facesOf(from)) {
        if (cornerOf(faces_[f], to) >= 0) continue;
        const int k = cornerOf(faces_[f], from);
        const glm::dvec3 a = point(faces_[f].positions[(k + 1) % 3]), b = point(faces_[f].positions[(k + 2) % 3]);
        const glm::dvec3 before = glm::cross(a - point(from), b - point(from));
        const glm::dvec3 after = glm::cross(a - point(to), b - point(to));
        if (before == glm::dvec3(0)) continue;
        if (!(glm::dot(before, after) > 0)) return true;
        const glm::dvec3 base = baseNormal(faces_[f].face);
        if (glm::dot(base, before) >= 0 && glm::dot(base, after) < 0) return true;
    }
    return false;
}

CoarsestState::Step CoarsestState::farthest(uint32_t from, const Edge& edge, const std::vector<Edge>& edges) const {
    if (!isLinked(from, edge, edges)) return Step::link;
    if (!wedgesFit(from, edge.to)) return Step::wedges;
    return flips(from, edge.to) ? Step::flips : Step::none;
}

Hold CoarsestState::holdOf(uint32_t position) const {
    const std::vector<Edge> edges = edgesOf(position);
    const auto strength = [](const Edge& e) { return e.faces != 2 ? 2 : e.severalPatches ? 1 : 0; };
    int strongest = 0;
    bool sheets = false;
    for (const Edge& e : edges) {
        strongest = std::max(strongest, strength(e));
        sheets |= e.faces > 2;
    }
    Step taken = Step::link, other = Step::link; // along edges that the builder takes, along others
    for (const Edge& e : edges) {
        Step& best = strength(e) == strongest ? taken : other;
        if (best != Step::none) best = std::max(best, farthest(position, e, edges));
    }
    if (taken == Step::none) return Hold::error;
    if (sheets) return Hold::nonManifold;
    if (componentFaces_[component_[position]] <= kPieceFaces) return Hold::piece;
    if (other == Step::none && strongest == 1) return Hold::boundary;
    return taken == Step::link ? Hold::handle : taken == Step::wedges ? Hold::seam : Hold::fold;
}

/// Positions that no error moves: those of locked parts, and painted ones.
std::vector<uint8_t> lockedPositions(const Mesh& mesh, const Hierarchy& hierarchy, const HierarchyOptions& options) {
    std::vector<uint8_t> locked(hierarchy.positions.size(), 0);
    for (size_t p = 0; p < options.vertexImportance.size(); ++p) locked[p] = std::isinf(options.vertexImportance[p]);
    if (options.partImportance.empty()) return locked;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (!std::isinf(options.partImportance[hierarchy.patches[hierarchy.facePatch[f]].part])) continue;
        const glm::uvec3 p = mesh.facePositions(f);
        locked[p.x] = locked[p.y] = locked[p.z] = 1;
    }
    return locked;
}

/// Reasons of the drawn faces.
std::vector<Hold> holdsOfFaces(const CoarsestState& state, const std::vector<uint8_t>& locked) {
    constexpr auto kUnknown = Hold(kHoldCount);
    std::vector<Hold> ofPosition(locked.size(), kUnknown), holds;
    holds.reserve(state.faces().size());
    for (const DrawnFace& f : state.faces()) {
        Hold hardest = Hold::error;
        for (int k = 0; k < 3; ++k) {
            Hold& hold = ofPosition[f.positions[k]];
            if (hold == kUnknown) hold = locked[f.positions[k]] ? Hold::locked : state.holdOf(f.positions[k]);
            hardest = std::min(hardest, hold);
        }
        holds.push_back(hardest);
    }
    return holds;
}

} // namespace

const char* holdName(Hold hold) {
    constexpr const char* kNames[kHoldCount] = {"locked", "nonManifold", "piece", "handle",
                                                "seam",   "boundary",    "fold",  "error"};
    return kNames[size_t(hold)];
}

FloorReport findFloor(const Mesh& mesh, const Hierarchy& hierarchy, const HierarchyOptions& options) {
    const CoarsestState state(mesh, hierarchy);
    const std::vector<Hold> holds = holdsOfFaces(state, lockedPositions(mesh, hierarchy, options));
    FloorReport report;
    report.components = state.componentCount();
    const auto partOf = [&](uint32_t face) { return hierarchy.patches[hierarchy.facePatch[face]].part; };
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        if (partOf(f) >= report.parts.size()) report.parts.resize(partOf(f) + 1);
        ++report.parts[partOf(f)].baseFaces;
    }
    for (uint32_t p = 0; p < report.parts.size(); ++p) report.parts[p].part = p;
    for (size_t i = 0; i < holds.size(); ++i) {
        PartFloor& part = report.parts[partOf(state.faces()[i].face)];
        ++part.faces;
        ++part.held[size_t(holds[i])];
        ++report.held[size_t(holds[i])];
        ++report.faces;
    }
    for (PartFloor& part : report.parts) {
        part.hold = Hold(std::max_element(part.held.begin(), part.held.end()) - part.held.begin());
    }
    std::vector<glm::dvec3> sums(report.parts.size(), glm::dvec3(0));
    for (size_t i = 0; i < holds.size(); ++i) {
        const DrawnFace& f = state.faces()[i];
        if (holds[i] != report.parts[partOf(f.face)].hold) continue;
        for (int k = 0; k < 3; ++k) sums[partOf(f.face)] += glm::dvec3(hierarchy.positions[f.positions[k]]) / 3.0;
    }
    for (PartFloor& part : report.parts) {
        if (part.faces > 0) part.place = glm::vec3(sums[part.part] / double(part.heldBy(part.hold)));
    }
    std::erase_if(report.parts, [](const PartFloor& p) { return p.faces == 0; });
    std::stable_sort(report.parts.begin(), report.parts.end(),
                     [](const PartFloor& a, const PartFloor& b) { return a.faces > b.faces; });
    return report;
}

} // namespace xgc::bake
