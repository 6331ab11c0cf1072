#include <xgc/bake/default_hierarchy.h>

#include "hierarchy/boundary_collapse.h"
#include "hierarchy/hierarchy_of.h"
#include "hierarchy/interior_collapse.h"
#include "hierarchy/merge_cards.h"
#include "hierarchy/patch_colors.h"
#include "hierarchy/surface_state.h"
#include "hierarchy/vanish_components.h"

#include <tbb/parallel_for.h>

#include <cassert>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

// Level by level, at error thresholds that grow by sqrt 2: boundary vertices first, then the interiors patch by patch,
// until neither moves; then once more with widening, which lets a boundary vertex wait for the patches that hold it
// back.

namespace xgc::bake {

namespace {

constexpr int kMostRounds = 3;

/// firstError * sqrt 2^(level - 1), the same on all machines.
double levelError(double firstError, uint32_t level) {
    const double odd = (level - 1) % 2 == 1 ? std::numbers::sqrt2 : 1;
    return std::ldexp(firstError * odd, int((level - 1) / 2));
}

double square(double x) {
    return x * x;
}

class Builder {
public:
    Builder(const Mesh& mesh, const Topology& topology, const PatchAssignment& assignment,
            const HierarchyOptions& options)
        : assignment_(assignment), state_(mesh, topology, assignment), attributes_(state_, options),
          pieces_(mesh, topology) {
        initQuadrics(topology, assignment, state_);
        for (const Quadric& q : state_.quadrics) weight_ += q.weight;
        standing_ = double(state_.quadrics.size());
        scaleCosts(options);
        if (options.placement != Placement::subset) state_.makeRooms();
        attributes_.grow(state_.wedgePosition.size());
        interiors_.reserve(state_.patches.size());
        for (uint32_t p = 0; p < state_.patches.size(); ++p)
            interiors_.emplace_back(state_, attributes_, p, options.placement);
        boundary_ = std::make_unique<BoundaryCollapser>(state_, attributes_, interiors_, options.placement);
        cards_ = std::make_unique<CardMerger>(pieces_, assignment, state_);
        vanisher_ = std::make_unique<ComponentVanisher>(
            pieces_, assignment.facePatch, state_,
            square(levelError(options.firstError * state_.diagonal, options.maxLevels)),
            [this](uint32_t piece) { return cards_->isCard(piece); });
    }

    CollapseCounts buildLevel(uint32_t level, double squaredError) {
        CollapseCounts counts;
        for (const uint32_t v : cards_->release(squaredError)) boundary_->markDirty(v);
        // A cost is a mean squared distance times the root of a weight.
        const double limit = squaredError * std::sqrt(weight_ / standing_);
        for (int round = 0; round < kMostRounds; ++round) {
            boundary_->run(level, limit);
            const CollapseCounts boundary = boundary_->takeCounts();
            counts.add(boundary);
            if (round > 0 && boundary.collapses == 0) break;
            const CollapseCounts interior = runInteriors(level, limit);
            counts.add(interior);
            if (interior.collapses == 0) break;
        }
        for (InteriorCollapser& i : interiors_) i.promote(limit);
        takeTouched();
        boundary_->runWidening(level, limit);
        counts.add(boundary_->takeCounts());
        // Last, when pieces are as small as the level makes them.
        counts.collapses += cards_->run(level, squaredError);
        counts.collapses += vanisher_->run(level, squaredError);
        standing_ -= counts.collapses;
        return counts;
    }

    double diagonal() const { return state_.diagonal; }
    /// Whether a face is of a small open piece.
    bool isSmallSheet(uint32_t face) const {
        return pieces_.isSmallSheet(pieces_.ofPosition(state_.mesh.facePositions(face).x), state_.diagonal);
    }
    Hierarchy finish(uint32_t levelCount, double firstError);

private:
    void scaleCosts(const HierarchyOptions& options) {
        for (uint32_t p = 0; p < state_.costScale.size(); ++p) {
            double importance = options.vertexImportance.empty() ? 1 : double(options.vertexImportance[p]);
            if (!options.partImportance.empty()) {
                double part = 0;
                for (const uint32_t patch : state_.domains[state_.domain[p]]) {
                    part = std::max(part, double(options.partImportance[assignment_.patches[patch].part]));
                }
                importance *= part;
            }
            state_.costScale[p] = importance * importance;
        }
    }

    CollapseCounts runInteriors(uint32_t level, double limit) {
        std::vector<uint32_t> waiting;
        for (uint32_t p = 0; p < interiors_.size(); ++p) {
            if (interiors_[p].hasWork(limit)) waiting.push_back(p);
        }
        CollapseCounts counts;
        if (waiting.empty()) return counts;
        for (const std::vector<uint32_t>& patches : colorPatches(state_, waiting)) {
            tbb::parallel_for(size_t(0), patches.size(), [&](size_t i) { interiors_[patches[i]].run(level, limit); });
        }
        for (const uint32_t p : waiting) counts.add(interiors_[p].takeCounts());
        takeTouched();
        return counts;
    }

    void takeTouched() {
        for (InteriorCollapser& i : interiors_) {
            for (const uint32_t v : i.takeTouched()) boundary_->markDirty(v);
        }
    }

    void skipLockedSteps();

    const PatchAssignment& assignment_;
    SurfaceState state_;
    AttributeQuadrics attributes_;
    double weight_ = 0;   ///< of all quadrics
    double standing_ = 0; ///< vertices of the uniform state, about: components that vanish count as one
    std::vector<InteriorCollapser> interiors_;
    std::unique_ptr<BoundaryCollapser> boundary_;
    const Pieces pieces_;
    std::unique_ptr<CardMerger> cards_;
    std::unique_ptr<ComponentVanisher> vanisher_;
};

/// An interior vertex may have collapsed into a vertex that had collapsed before it, which matters where other patches
/// may still hold that one. Where no other can, the child goes straight to where it went: a child never
/// collapses after its parent within one domain.
void Builder::skipLockedSteps() {
    std::vector<uint32_t>& parent = state_.parent;
    for (uint32_t v = 0; v < parent.size(); ++v) {
        if (parent[v] == kNone) continue;
        const auto passes = [&](uint32_t p) {
            return state_.collapseLevel[p] < state_.collapseLevel[v] && state_.domain[p] == state_.domain[v];
        };
        while (passes(parent[v])) {
            for (const uint32_t w : state_.wedgesOf(v))
                state_.wedgeParent[w] = state_.wedgeParent[state_.wedgeParent[w]];
            parent[v] = parent[parent[v]];
        }
    }
}

Hierarchy Builder::finish(uint32_t levelCount, double firstError) {
    skipLockedSteps();
    Hierarchy h = hierarchyOf(state_);
    h.levelCount = levelCount;
    h.patches = assignment_.patches;
    h.facePatch = assignment_.facePatch;
    h.levelThreshold.push_back(0);
    for (uint32_t l = 1; l < levelCount; ++l) {
        h.levelThreshold.push_back(float(levelError(firstError, l)));
    }
    return h;
}

double areaOf(const Hierarchy& h, const glm::uvec3& p) {
    const glm::dvec3 a(h.positions[p.x]);
    return glm::length(glm::cross(glm::dvec3(h.positions[p.y]) - a, glm::dvec3(h.positions[p.z]) - a)) / 2;
}

/// Faces of the uniform states and their area.
void measureStates(const Mesh& mesh, const Hierarchy& h, const std::function<bool(uint32_t)>& isSheet,
                   std::vector<HierarchyLevelReport>& levels) {
    for (HierarchyLevelReport& l : levels) l.faces = 0;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        glm::uvec3 w = mesh.faces[f];
        for (uint32_t level = 0; level < h.levelCount; ++level) {
            for (int k = 0; k < 3; ++k) {
                while (h.collapseLevel[h.wedgePosition[w[k]]] <= level) w[k] = h.wedgeParent[w[k]];
            }
            const glm::uvec3 p(h.wedgePosition[w.x], h.wedgePosition[w.y], h.wedgePosition[w.z]);
            if (p.x == p.y || p.y == p.z || p.z == p.x) break;
            const double area = areaOf(h, p);
            ++levels[level].faces;
            levels[level].area += area;
            if (isSheet(f)) levels[level].sheetArea += area;
        }
    }
}

double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

Hierarchy buildDefaultHierarchy(const Mesh& mesh, const Topology& topology, const PatchAssignment& patches,
                                const HierarchyOptions& options, std::vector<HierarchyLevelReport>* report) {
    assert(options.maxLevels < kNeverCollapses);
    auto start = std::chrono::steady_clock::now();
    Builder builder(mesh, topology, patches, options);
    const double first = options.firstError * builder.diagonal();
    std::vector<HierarchyLevelReport> levels = {{mesh.faceCount(), 0, 0, 0, 0, secondsSince(start)}};
    uint32_t levelCount = 1;
    for (uint32_t level = 1; level <= options.maxLevels; ++level) {
        start = std::chrono::steady_clock::now();
        const CollapseCounts c = builder.buildLevel(level, square(levelError(first, level)));
        if (c.collapses > 0) levelCount = level + 1;
        levels.push_back({0, c.collapses, c.linkRefused, c.flipRefused, c.wedgeRefused, secondsSince(start)});
    }
    Hierarchy h = builder.finish(levelCount, first);
    levels.resize(levelCount);
    measureStates(
        mesh, h, [&](uint32_t face) { return builder.isSmallSheet(face); }, levels);
    if (report) *report = std::move(levels);
    return h;
}

} // namespace xgc::bake
