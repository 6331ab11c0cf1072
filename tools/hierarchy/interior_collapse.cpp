#include "hierarchy/interior_collapse.h"

#include <cmath>
#include <limits>

namespace xgc::bake {

InteriorCollapser::InteriorCollapser(SurfaceState& state, AttributeQuadrics& attributes, uint32_t patch,
                                     Placement placement)
    : state_(state), attributes_(attributes), mesh_(state.patches[patch]), patch_(patch), placement_(placement),
      stamp_(mesh_.vertexCount(), 0), target_(mesh_.vertexCount(), kNone), cost_(mesh_.vertexCount()),
      blocked_(mesh_.vertexCount()), isDirty_(mesh_.vertexCount(), 0), meetsBoundary_(mesh_.vertexCount(), 0),
      held_(mesh_.vertexCount(), 0), check_(state), marks_(mesh_.vertexCount(), 0) {
    points_.reserve(mesh_.vertexCount());
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
        points_.push_back(state.point(mesh_.position[v]));
        if (isBoundary(v)) {
            markBesideBoundary(v);
        } else {
            markDirty(v);
        }
    }
}

void InteriorCollapser::markBesideBoundary(uint32_t boundaryVertex) {
    mesh_.forCorners(boundaryVertex, [&](uint32_t c) {
        meetsBoundary_[mesh_.corner[PatchMesh::next(c)]] = 1;
        meetsBoundary_[mesh_.corner[PatchMesh::previous(c)]] = 1;
    });
}

void InteriorCollapser::run(uint32_t level, double limit) {
    limit_ = limit;
    for (const uint32_t v : dirty_) {
        isDirty_[v] = 0;
        if (isBoundary(v) || mesh_.head[v] == kNone) continue;
        blocked_[v] = {};
        evaluate(v);
    }
    dirty_.clear();
    while (queue_.hasBelow(limit)) {
        const CollapseQueue::Entry entry = queue_.pop();
        const uint32_t v = entry.vertex;
        if (entry.stamp != stamp_[v] || isBoundary(v)) continue;
        const uint32_t target = target_[v];
        const Outcome outcome = tryCollapse(v, target, level);
        if (outcome == Outcome::done) continue;
        if (outcome == Outcome::heldByMixed && isBoundary(target)) held_[v] = 1;
        block(v, target, entry.cost);
    }
}

void InteriorCollapser::promote(double limit) {
    for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
        if (!meetsBoundary_[v] || isBoundary(v) || mesh_.head[v] == kNone) continue;
        if (!(held_[v] || uniformCost(v) <= limit)) continue;
        state_.makeBoundary(mesh_.position[v]);
        ++stamp_[v];
        touched_.push_back(mesh_.position[v]);
        markBesideBoundary(v);
        mesh_.forCorners(v, [&](uint32_t c) {
            const uint32_t n = mesh_.corner[PatchMesh::next(c)];
            if (!isBoundary(n)) markDirty(n);
        });
    }
    std::fill(held_.begin(), held_.end(), 0);
}

/// Of the cheapest boundary vertex to collapse into, by where it is in the uniform state alone.
double InteriorCollapser::uniformCost(uint32_t vertex) const {
    const uint32_t v = mesh_.position[vertex];
    double best = std::numeric_limits<double>::infinity();
    mesh_.forCorners(vertex, [&](uint32_t c) {
        const uint32_t target = mesh_.corner[PatchMesh::next(c)];
        if (!isBoundary(target)) return;
        const uint32_t r = state_.representative[mesh_.position[target]];
        const double cost = state_.quadrics[v].cost(state_.point(r), attributeCost(c, r));
        best = std::min(best, cost * state_.costScale[v]);
    });
    return best;
}

/// Of a vertex that collapses along the edge on from one of its corners.
double InteriorCollapser::costOf(uint32_t vertex, uint32_t corner) const {
    const uint32_t next = PatchMesh::next(corner), target = mesh_.corner[next];
    if (!makesVertex(vertex, target)) return subsetCost(vertex, corner);
    return meetingOf(state_, attributes_, placement_, mesh_.position[vertex], mesh_.position[target],
                     {mesh_.wedge[corner], mesh_.wedge[next]})
        .cost;
}

/// At a boundary vertex that has itself collapsed: the larger of the costs at where it was and at where it is.
double InteriorCollapser::subsetCost(uint32_t vertex, uint32_t corner) const {
    const uint32_t target = mesh_.corner[PatchMesh::next(corner)];
    const uint32_t v = mesh_.position[vertex], w = mesh_.position[target];
    const uint32_t r = state_.representative[w];
    const Quadric& quadric = state_.quadrics[v];
    double cost = quadric.cost(points_[target], attributeCost(corner, w));
    if (r != w) cost = std::max(cost, quadric.cost(state_.point(r), attributeCost(corner, r)));
    return cost * state_.costScale[v];
}

/// Of the corner's wedge at the next corner's vertex, or at its representative.
double InteriorCollapser::attributeCost(uint32_t corner, uint32_t position) const {
    if (attributes_.empty()) return 0;
    const uint32_t next = PatchMesh::next(corner);
    const bool inPlace = position == state_.positionAt(mesh_, next);
    const uint32_t wedge = inPlace ? mesh_.wedge[next] : state_.uniformWedgeAt(mesh_, next);
    return attributes_.cost(mesh_.wedge[corner], state_.point(position), wedge);
}

uint32_t InteriorCollapser::cornerTowards(uint32_t vertex, uint32_t target) const {
    uint32_t corner = mesh_.head[vertex];
    while (corner != kNone && mesh_.corner[PatchMesh::next(corner)] != target) corner = mesh_.link[corner];
    return corner;
}

/// Finds the cheapest target that was not refused, and queues the vertex.
void InteriorCollapser::evaluate(uint32_t vertex) {
    if (std::isinf(state_.costScale[mesh_.position[vertex]])) return; // locked
    const Blocked blocked = blocked_[vertex];
    double best = std::numeric_limits<double>::infinity();
    uint32_t bestTarget = kNone;
    mesh_.forCorners(vertex, [&](uint32_t c) {
        const uint32_t target = mesh_.corner[PatchMesh::next(c)];
        const double cost = costOf(vertex, c);
        if (cost < blocked.cost || (cost == blocked.cost && target <= blocked.target)) return;
        if (cost > best || (cost == best && target >= bestTarget)) return;
        best = cost;
        bestTarget = target;
    });
    ++stamp_[vertex];
    target_[vertex] = bestTarget;
    cost_[vertex] = best;
    if (bestTarget != kNone) queue_.push({best, vertex, stamp_[vertex]});
}

/// After a neighbour has gone into `target`, which is a neighbour now. The costs of the others are as before.
void InteriorCollapser::reconsider(uint32_t vertex, uint32_t gone, uint32_t target) {
    const bool targetMoved = placement_ != Placement::subset && target_[vertex] == target;
    if (blocked_[vertex].cost >= 0 || target_[vertex] == gone || targetMoved) {
        blocked_[vertex] = {};
        evaluate(vertex);
        return;
    }
    const uint32_t corner = cornerTowards(vertex, target);
    if (corner == kNone) return;
    const double cost = costOf(vertex, corner);
    if (cost > cost_[vertex] || (cost == cost_[vertex] && target >= target_[vertex])) return;
    target_[vertex] = target;
    cost_[vertex] = cost;
    queue_.push({cost, vertex, ++stamp_[vertex]});
}

void InteriorCollapser::block(uint32_t vertex, uint32_t target, double cost) {
    blocked_[vertex] = {cost, target};
    evaluate(vertex);
}

InteriorCollapser::Outcome InteriorCollapser::tryCollapse(uint32_t vertex, uint32_t target, uint32_t level) {
    if (!mapWedges(vertex, target)) {
        ++counts_.wedgeRefused;
        return Outcome::refused;
    }
    const Outcome linked = checkLinks(vertex, target);
    if (linked == Outcome::refused) {
        ++counts_.linkRefused;
        return Outcome::refused;
    }
    bool meets = makesVertex(vertex, target);
    if (meets && !arePaired(target)) {
        meets = false;
        if (subsetCost(vertex, cornerTowards(vertex, target)) > limit_) {
            ++counts_.wedgeRefused;
            return Outcome::refused;
        }
    }
    Outcome outcome = meets ? tryMeeting(vertex, target, level) : checkStates(vertex, target, level);
    if (outcome == Outcome::done) outcome = linked;
    if (outcome != Outcome::done) {
        ++counts_.flipRefused;
        return outcome;
    }
    if (meets) {
        meet(vertex, target, state_.rooms[patch_].position, level);
    } else {
        collapse(vertex, target, level);
    }
    return outcome;
}

/// Both answer to this patch alone, and neither must stay where it is.
bool InteriorCollapser::makesVertex(uint32_t vertex, uint32_t target) const {
    return placement_ != Placement::subset && !isBoundary(target) &&
           !std::isinf(state_.costScale[mesh_.position[target]]) &&
           !std::isinf(state_.costScale[mesh_.position[vertex]]);
}

/// Whether the wedges of both go together in pairs.
bool InteriorCollapser::arePaired(uint32_t target) const {
    bool paired = wedges_.isOneToOne();
    mesh_.forCorners(target, [&](uint32_t c) { paired = paired && wedges_.reaches(mesh_.wedge[c]); });
    return paired;
}

/// Drafts the vertex at which both meet, and tries the triangles of both.
InteriorCollapser::Outcome InteriorCollapser::tryMeeting(uint32_t vertex, uint32_t target, uint32_t level) {
    const uint32_t v = mesh_.position[vertex], w = mesh_.position[target];
    const Meeting meeting = meetingOf(state_, attributes_, placement_, v, w, wedges_.pairs().front());
    const uint32_t firstWedge = state_.rooms[patch_].wedge;
    const uint32_t made = state_.draft(patch_, meeting.point, v, w, wedges_.pairs());
    vertexWedges_.setMade(wedges_, firstWedge, false);
    targetWedges_.setMade(wedges_, firstWedge, true);
    const Outcome outcome = checkFaces(vertex, target, {v, made, level, 0, false}, vertexWedges_);
    return outcome == Outcome::done ? checkFaces(target, vertex, {w, made, level, 0, false}, targetWedges_) : outcome;
}

/// The made vertex takes the target's place in the patch mesh.
void InteriorCollapser::meet(uint32_t vertex, uint32_t target, uint32_t made, uint32_t level) {
    retire(mesh_.position[vertex], made, vertexWedges_, level);
    retire(mesh_.position[target], made, targetWedges_, level);
    state_.keep(patch_, level, {patch_, target});
    for (const uint32_t wedge : state_.wedgesOf(made)) attributes_.make(wedge, state_.madeWedge(wedge));
    mesh_.forCorners(target, [&](uint32_t c) { mesh_.wedge[c] = targetWedges_(mesh_.wedge[c]); });
    mesh_.collapse(vertex, target, vertexWedges_);
    mesh_.position[target] = made;
    points_[target] = state_.point(made);
    ring_.clear();
    mesh_.forCorners(target, [&](uint32_t c) { ring_.push_back(mesh_.corner[PatchMesh::next(c)]); });
    ring_.push_back(target);
    meetsBoundary_[target] |= meetsBoundary_[vertex];
    afterCollapse(vertex, target);
}

void InteriorCollapser::retire(uint32_t v, uint32_t parent, const WedgeMap& wedges, uint32_t level) {
    state_.collapseLevel[v] = uint8_t(level);
    state_.parent[v] = parent;
    for (const uint32_t wedge : state_.wedgesOf(v)) {
        const uint32_t to = wedges(wedge);
        state_.wedgeParent[wedge] = to == kNone ? wedges.any() : to; // no face draws it any more
    }
}

bool InteriorCollapser::mapWedges(uint32_t vertex, uint32_t target) {
    wedges_.clear();
    bool fits = true;
    mesh_.forCorners(vertex, [&](uint32_t c) {
        const uint32_t n = PatchMesh::next(c), p = PatchMesh::previous(c);
        if (mesh_.corner[n] == target) fits &= wedges_.add(mesh_.wedge[c], mesh_.wedge[n]);
        if (mesh_.corner[p] == target) fits &= wedges_.add(mesh_.wedge[c], mesh_.wedge[p]);
    });
    if (!fits) return false;
    mesh_.forCorners(vertex, [&](uint32_t c) { fits &= wedges_(mesh_.wedge[c]) != kNone; });
    return fits;
}

/// Lk(v) and Lk(w) meet in Lk(vw) alone, the two vertices opposite to the edge: in the patch mesh, for the states in
/// which the boundary is not collapsed, and in the uniform state.
InteriorCollapser::Outcome InteriorCollapser::checkLinks(uint32_t vertex, uint32_t target) {
    const bool inPatch = isLinkedInPatch(vertex, target);
    if (!meetsBoundary_[vertex]) return inPatch ? Outcome::done : Outcome::refused;
    if (!isLinkedInUniform(vertex, target)) return Outcome::refused;
    return inPatch ? Outcome::done : Outcome::heldByMixed;
}

bool InteriorCollapser::isLinkedInPatch(uint32_t vertex, uint32_t target) {
    ++mark_;
    uint32_t shared = 0, common = 0, valence = 0;
    mesh_.forCorners(vertex, [&](uint32_t c) {
        const uint32_t n = mesh_.corner[PatchMesh::next(c)], p = mesh_.corner[PatchMesh::previous(c)];
        shared += n == target || p == target;
        marks_[n] = marks_[p] = mark_;
        ++valence;
    });
    const uint32_t seen = ++mark_; // marked by the vertex: seen - 1; counted: seen
    bool closesTetrahedron = false;
    mesh_.forCorners(target, [&](uint32_t c) {
        const uint32_t n = mesh_.corner[PatchMesh::next(c)], p = mesh_.corner[PatchMesh::previous(c)];
        if (n == vertex || p == vertex) return;
        if (valence == 3 && marks_[n] + 1 >= seen && marks_[p] + 1 >= seen) closesTetrahedron = true;
        for (const uint32_t x : {n, p}) {
            if (marks_[x] == seen - 1) {
                marks_[x] = seen;
                ++common;
            }
        }
    });
    return shared == 2 && common == 2 && !closesTetrahedron;
}

/// Whether the uniform state has an edge between two representatives.
bool InteriorCollapser::hasUniformEdge(uint32_t a, uint32_t b) const {
    if (state_.isBoundary[a] && (!state_.isBoundary[b] || state_.starOf(b).size() < state_.starOf(a).size())) {
        std::swap(a, b);
    }
    return state_.anyOfStar(a, [&](const PatchMesh& mesh, uint32_t c) {
        const bool meets =
            state_.uniformAt(mesh, PatchMesh::next(c)) == b || state_.uniformAt(mesh, PatchMesh::previous(c)) == b;
        return meets && state_.isDrawn(mesh, c);
    });
}

/// What the patch mesh cannot tell: neighbours in common that are several boundary vertices there.
bool InteriorCollapser::isLinkedInUniform(uint32_t vertex, uint32_t target) {
    const uint32_t v = mesh_.position[vertex], w = state_.representative[mesh_.position[target]];
    const bool targetIsBoundary = isBoundary(target);
    ring_.clear();
    std::array<uint32_t, 2> opposite = {kNone, kNone};
    uint32_t faces = 0, shared = 0;
    mesh_.forCorners(vertex, [&](uint32_t c) {
        const uint32_t n = state_.uniformAt(mesh_, PatchMesh::next(c));
        const uint32_t p = state_.uniformAt(mesh_, PatchMesh::previous(c));
        if (n == p || n == v || p == v) return;
        ++faces;
        if (n == w || p == w) {
            if (shared < 2) opposite[shared] = n == w ? p : n;
            ++shared;
        }
        // Where no boundary vertex is near, the patch mesh has told.
        for (const uint32_t x : {PatchMesh::next(c), PatchMesh::previous(c)}) {
            const uint32_t local = mesh_.corner[x];
            if (targetIsBoundary ? meetsBoundary_[local] : isBoundary(local))
                ring_.push_back(state_.uniformAt(mesh_, x));
        }
    });
    if (shared != 2 || opposite[0] == opposite[1]) return false;
    std::sort(ring_.begin(), ring_.end());
    ring_.erase(std::unique(ring_.begin(), ring_.end()), ring_.end());
    for (const uint32_t n : ring_) {
        if (n != w && n != opposite[0] && n != opposite[1] && hasUniformEdge(n, w)) return false;
    }
    if (faces != 3) return true;
    // The third face becomes (w, opposite): it must not be there already.
    return !state_.anyOfStar(w, [&](const PatchMesh& mesh, uint32_t c) {
        const uint32_t n = state_.uniformAt(mesh, PatchMesh::next(c));
        const uint32_t p = state_.uniformAt(mesh, PatchMesh::previous(c));
        return ((n == opposite[0] && p == opposite[1]) || (n == opposite[1] && p == opposite[0])) &&
               state_.isDrawn(mesh, c);
    });
}

InteriorCollapser::Outcome InteriorCollapser::checkStates(uint32_t vertex, uint32_t target, uint32_t level) {
    return checkFaces(vertex, target, {mesh_.position[vertex], mesh_.position[target], level, 0, false}, wedges_);
}

/// Tries the triangles of a vertex that do not have the other one.
InteriorCollapser::Outcome InteriorCollapser::checkFaces(uint32_t vertex, uint32_t other, const StateCheck::Move& move,
                                                         const WedgeMap& wedges) {
    Outcome outcome = Outcome::done;
    mesh_.forCorners(vertex, [&](uint32_t c) {
        if (outcome == Outcome::refused) return;
        if (mesh_.corner[PatchMesh::next(c)] == other || mesh_.corner[PatchMesh::previous(c)] == other) return;
        const StateCheck::Verdict verdict = check_.check(patch_, c / 3, move, wedges);
        if (verdict == StateCheck::Verdict::badInUniform) outcome = Outcome::refused;
        if (verdict == StateCheck::Verdict::badInMixed) outcome = Outcome::heldByMixed;
    });
    return outcome;
}

void InteriorCollapser::collapse(uint32_t vertex, uint32_t target, uint32_t level) {
    const uint32_t v = mesh_.position[vertex], w = mesh_.position[target];
    retire(v, w, wedges_, level);
    state_.quadrics[state_.representative[w]].add(state_.quadrics[v]);
    for (const auto& [from, to] : wedges_.pairs()) attributes_.add(state_.wedgeRepresentative[to], from);
    ring_.clear();
    mesh_.forCorners(vertex, [&](uint32_t c) {
        ring_.push_back(mesh_.corner[PatchMesh::next(c)]);
        const bool dies = ring_.back() == target || mesh_.corner[PatchMesh::previous(c)] == target;
        if (!dies && isBoundary(target)) state_.starOf(state_.representative[w]).push_back({patch_, c});
    });
    mesh_.collapse(vertex, target, wedges_);
    if (isBoundary(target)) {
        for (const uint32_t n : ring_) meetsBoundary_[n] = 1;
    } else {
        meetsBoundary_[target] |= meetsBoundary_[vertex];
    }
    afterCollapse(vertex, target);
}

/// Looks again at the vertices around.
void InteriorCollapser::afterCollapse(uint32_t vertex, uint32_t target) {
    ++stamp_[vertex];
    ++counts_.collapses;
    for (const uint32_t n : ring_) {
        if (isBoundary(n)) {
            touched_.push_back(state_.representative[mesh_.position[n]]);
        } else if (n == target) {
            blocked_[n] = {};
            evaluate(n);
        } else {
            reconsider(n, vertex, target);
        }
    }
}

} // namespace xgc::bake
