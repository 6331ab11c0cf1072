#include "hierarchy/boundary_collapse.h"

#include <cmath>
#include <limits>
#include <tuple>

namespace xgc::bake {

namespace {} // namespace

BoundaryCollapser::BoundaryCollapser(SurfaceState& state, AttributeQuadrics& attributes,
                                     std::vector<InteriorCollapser>& interiors, Placement placement)
    : state_(state), attributes_(attributes), interiors_(interiors), placement_(placement),
      stamp_(state.isBoundary.size(), 0), target_(state.isBoundary.size(), kNone), blocked_(state.isBoundary.size()),
      check_(state) {
    for (uint32_t p = 0; p < state.isBoundary.size(); ++p) {
        if (state.isBoundary[p]) markDirty(p);
    }
}

void BoundaryCollapser::run(uint32_t level, double limit) {
    limit_ = limit;
    std::sort(dirty_.begin(), dirty_.end());
    dirty_.erase(std::unique(dirty_.begin(), dirty_.end()), dirty_.end());
    for (const uint32_t v : dirty_) {
        if (state_.parent[v] != kNone) continue;
        blocked_[v] = {};
        evaluate(v);
    }
    dirty_.clear();
    while (queue_.hasBelow(limit)) {
        const CollapseQueue::Entry entry = queue_.pop();
        const uint32_t v = entry.vertex;
        if (entry.stamp != stamp_[v] || state_.parent[v] != kNone || std::isinf(state_.costScale[v])) continue;
        const Outcome outcome = tryCollapse(v, target_[v], level);
        if (outcome == Outcome::done) continue;
        if (outcome == Outcome::heldByMixed) held_.push_back(v);
        blocked_[v] = {entry.cost, target_[v]};
        evaluate(v);
    }
}

void BoundaryCollapser::runWidening(uint32_t level, double limit) {
    widening_ = true;
    for (const uint32_t v : std::exchange(held_, {})) markDirty(v);
    run(level, limit);
    held_.clear();
    widening_ = false;
}

void BoundaryCollapser::gatherStar(uint32_t vertex, std::vector<StarFace>& star) {
    star.clear();
    state_.pruneStar(vertex);
    for (const auto [patch, c] : state_.starOf(vertex)) {
        const PatchMesh& mesh = state_.patches[patch];
        const uint32_t cn = PatchMesh::next(c), cp = PatchMesh::previous(c);
        star.push_back({patch, state_.uniformAt(mesh, cn), state_.uniformAt(mesh, cp), state_.uniformWedgeAt(mesh, c),
                        state_.uniformWedgeAt(mesh, cn), state_.uniformWedgeAt(mesh, cp)});
    }
}

void BoundaryCollapser::gatherEdges(const std::vector<StarFace>& star, std::vector<StarEdge>& edges) const {
    thread_local std::vector<StarEdge> ends;
    ends.clear();
    for (const StarFace& f : star) {
        ends.push_back({f.next, 1, f.wedge, f.nextWedge});
        ends.push_back({f.previous, 1, f.wedge, f.previousWedge});
    }
    std::sort(ends.begin(), ends.end(), [](const StarEdge& a, const StarEdge& b) {
        return std::tie(a.to, a.wedge, a.toWedge) < std::tie(b.to, b.wedge, b.toWedge);
    });
    edges.clear();
    for (const StarEdge& end : ends) {
        if (edges.empty() || edges.back().to != end.to) {
            edges.push_back(end);
        } else {
            ++edges.back().faces;
        }
    }
}

/// Along borders (and where sheets meet) if it has any; else to any boundary vertex beside it, across a patch too.
void BoundaryCollapser::evaluate(uint32_t vertex) {
    if (std::isinf(state_.costScale[vertex])) return; // locked
    gatherStar(vertex, star_);
    gatherEdges(star_, edges_);
    const bool onBorder = std::any_of(edges_.begin(), edges_.end(), [](const StarEdge& e) { return e.faces != 2; });
    const Blocked blocked = blocked_[vertex];
    double best = std::numeric_limits<double>::infinity();
    uint32_t bestTarget = kNone;
    for (const StarEdge& e : edges_) {
        if ((onBorder && e.faces == 2) || !state_.isBoundary[e.to]) continue;
        const double cost = costOf(vertex, e);
        if (cost < blocked.cost || (cost == blocked.cost && e.to <= blocked.target)) continue;
        if (cost > best || (cost == best && e.to >= bestTarget)) continue;
        best = cost;
        bestTarget = e.to;
    }
    ++stamp_[vertex];
    target_[vertex] = bestTarget;
    if (best < std::numeric_limits<double>::infinity()) queue_.push({best, vertex, stamp_[vertex]});
}

BoundaryCollapser::Outcome BoundaryCollapser::tryCollapse(uint32_t vertex, uint32_t target, uint32_t level) {
    gatherStar(vertex, star_);
    if (!isLinked(target)) {
        ++counts_.linkRefused;
        return Outcome::refused;
    }
    if (!mapWedges(vertex, target)) {
        ++counts_.wedgeRefused;
        return Outcome::refused;
    }
    bool meets = makesVertex(vertex, target);
    if (meets && !arePaired(target)) {
        meets = false;
        const auto [wedge, toWedge] = wedges_.pairs().front();
        if (subsetCost(vertex, {target, 0, wedge, toWedge}) > limit_) {
            ++counts_.wedgeRefused;
            return Outcome::refused;
        }
    }
    if (!state_.guard.isEmpty() && guards(vertex, target, meets)) {
        ++counts_.linkRefused;
        return Outcome::refused;
    }
    domain_ = state_.domain[vertex];
    const Outcome outcome = meets ? tryMeeting(vertex, target, level)
                                  : checkFaces(vertex, vertex, {vertex, target, level, domain_, true}, wedges_);
    if (outcome != Outcome::done) {
        ++counts_.flipRefused;
        return outcome;
    }
    if (meets) {
        meet(vertex, target, level);
    } else {
        collapse(vertex, target, level);
    }
    return outcome;
}

/// Whether the vertex's piece would lose too much. Needs the stars of both that `isLinked` gathered.
bool BoundaryCollapser::guards(uint32_t vertex, uint32_t target, bool meets) {
    const uint32_t piece = state_.guard.pieceOf(vertex);
    if (piece == PieceGuard::kUnguarded) return false;
    const glm::dvec3 point =
        meets ? meetingOf(state_, attributes_, placement_, vertex, target, wedges_.pairs().front()).point
              : state_.point(target);
    areaLost_ = areaLost(vertex, target, point);
    return !state_.guard.mayLose(piece, areaLost_);
}

/// Around two vertices that both go to a point.
double BoundaryCollapser::areaLost(uint32_t vertex, uint32_t target, const glm::dvec3& point) const {
    double lost = 0;
    const auto add = [&](uint32_t center, const StarFace& f, bool dies) {
        const glm::dvec3 n = state_.point(f.next), p = state_.point(f.previous), c = state_.point(center);
        lost += glm::length(glm::cross(n - c, p - c)) / 2;
        if (!dies) lost -= glm::length(glm::cross(n - point, p - point)) / 2;
    };
    for (const StarFace& f : star_) add(vertex, f, f.next == target || f.previous == target);
    for (const StarFace& f : otherStar_) {
        if (f.next != vertex && f.previous != vertex) add(target, f, false);
    }
    return lost;
}

double BoundaryCollapser::costOf(uint32_t vertex, const StarEdge& edge) const {
    if (!makesVertex(vertex, edge.to)) return subsetCost(vertex, edge);
    return meetingOf(state_, attributes_, placement_, vertex, edge.to, {edge.wedge, edge.toWedge}).cost;
}

double BoundaryCollapser::subsetCost(uint32_t vertex, const StarEdge& edge) const {
    const glm::dvec3 point = state_.point(edge.to);
    const double more = attributes_.empty() ? 0 : attributes_.cost(edge.wedge, point, edge.toWedge);
    return state_.quadrics[vertex].cost(point, more) * state_.costScale[vertex];
}

/// Both answer to the same patches, and neither must stay where it is.
bool BoundaryCollapser::makesVertex(uint32_t vertex, uint32_t target) const {
    return placement_ != Placement::subset && state_.domain[vertex] == state_.domain[target] &&
           !std::isinf(state_.costScale[vertex]) && !std::isinf(state_.costScale[target]);
}

/// Whether the wedges of both go together in pairs, all that any state shows.
bool BoundaryCollapser::arePaired(uint32_t target) const {
    bool paired = wedges_.isOneToOne();
    state_.forGroupCorners(target, [&](uint32_t patch, uint32_t c) {
        paired = paired && wedges_.reaches(state_.uniformWedgeAt(state_.patches[patch], c));
    });
    return paired;
}

/// Drafts the vertex at which both meet, and tries the triangles of both. Their steps are one: of the same domain.
BoundaryCollapser::Outcome BoundaryCollapser::tryMeeting(uint32_t vertex, uint32_t target, uint32_t level) {
    const auto room = uint32_t(state_.rooms.size() - 1);
    const Meeting meeting = meetingOf(state_, attributes_, placement_, vertex, target, wedges_.pairs().front());
    const uint32_t firstWedge = state_.rooms[room].wedge;
    const uint32_t made = state_.draft(room, meeting.point, vertex, target, wedges_.pairs());
    vertexWedges_.setMade(wedges_, firstWedge, false);
    targetWedges_.setMade(wedges_, firstWedge, true);
    const Outcome outcome = checkFaces(vertex, target, {vertex, made, level, domain_, true}, vertexWedges_);
    if (outcome != Outcome::done) return outcome;
    return checkFaces(target, vertex, {target, made, level, domain_, true}, targetWedges_);
}

/// The map comes from the dying triangles of the uniform state; all wedges that any state shows must have a target.
bool BoundaryCollapser::mapWedges(uint32_t vertex, uint32_t target) {
    wedges_.clear();
    bool fits = true;
    for (const StarFace& f : star_) {
        if (f.next == target) fits &= wedges_.add(f.wedge, f.nextWedge);
        if (f.previous == target) fits &= wedges_.add(f.wedge, f.previousWedge);
    }
    if (!fits || state_.wedgesOf(vertex).size() == 1) return fits;
    state_.forGroupCorners(vertex, [&](uint32_t patch, uint32_t c) {
        fits = fits && wedges_(state_.uniformWedgeAt(state_.patches[patch], c)) != kNone;
    });
    return fits;
}

/// Lk(v) and Lk(u) meet in Lk(vu) alone; but a border may close over a hole of three edges.
bool BoundaryCollapser::isLinked(uint32_t target) {
    thread_local std::vector<uint32_t> opposite;
    opposite.clear();
    for (const StarFace& f : star_) {
        if (f.next == target) opposite.push_back(f.previous);
        if (f.previous == target) opposite.push_back(f.next);
    }
    std::sort(opposite.begin(), opposite.end());
    if (opposite.empty() || std::adjacent_find(opposite.begin(), opposite.end()) != opposite.end()) return false;
    const auto isOpposite = [&](uint32_t x) { return std::binary_search(opposite.begin(), opposite.end(), x); };

    gatherEdges(star_, edges_);
    gatherStar(target, otherStar_);
    // The last triangles of a component do not go one by one.
    if (opposite.size() == star_.size() && opposite.size() == otherStar_.size()) return false;
    thread_local std::vector<StarEdge> others;
    gatherEdges(otherStar_, others);
    uint32_t holes = 0;
    for (size_t i = 0, j = 0; i < edges_.size() && j < others.size();) {
        if (edges_[i].to != others[j].to) {
            ++(edges_[i].to < others[j].to ? i : j);
            continue;
        }
        if (!isOpposite(edges_[i].to)) {
            const bool closesHole = opposite.size() == 1 && edges_[i].faces == 1 && others[j].faces == 1;
            if (!closesHole || ++holes > 1) return false;
        }
        ++i;
        ++j;
    }
    // A triangle that stays must not fall on another.
    for (const StarFace& f : star_) {
        if (!isOpposite(f.next) || !isOpposite(f.previous)) continue;
        for (const StarFace& g : otherStar_) {
            if ((g.next == f.next && g.previous == f.previous) || (g.next == f.previous && g.previous == f.next))
                return false;
        }
    }
    return true;
}

/// Tries the triangles at a vertex's group that do not have it twice, or the other one. May widen the step's domain.
BoundaryCollapser::Outcome BoundaryCollapser::checkFaces(uint32_t vertex, uint32_t other, const StateCheck::Move& move,
                                                         const WedgeMap& wedges) {
    Outcome outcome = Outcome::done;
    state_.forGroupCorners(vertex, [&](uint32_t patch, uint32_t c) {
        if (outcome != Outcome::done) return;
        const PatchMesh& mesh = state_.patches[patch];
        const uint32_t n = state_.uniformAt(mesh, PatchMesh::next(c));
        const uint32_t p = state_.uniformAt(mesh, PatchMesh::previous(c));
        if (n == vertex || p == vertex || n == other || p == other) return;
        for (;;) {
            StateCheck::Move step = move;
            step.domain = domain_;
            const StateCheck::Verdict verdict = check_.check(patch, c / 3, step, wedges);
            if (verdict == StateCheck::Verdict::good) return;
            outcome = verdict == StateCheck::Verdict::badInUniform ? Outcome::refused : Outcome::heldByMixed;
            if (outcome == Outcome::refused || !widening_ || !widen()) return;
            outcome = Outcome::done;
        }
    });
    return outcome;
}

/// Takes the failing domain into the step's own that makes the smaller set.
bool BoundaryCollapser::widen() {
    uint32_t best = domain_;
    for (const uint32_t d : check_.failingDomains) {
        const uint32_t united = state_.domains.unite(domain_, d);
        if (united == domain_) continue;
        if (best == domain_ || state_.domains[united].size() < state_.domains[best].size()) best = united;
    }
    if (best == domain_ || state_.domains[best].size() > DomainSets::kWidest) return false;
    domain_ = best;
    return true;
}

/// The representatives around a vertex's group; vertices inside patches are marked.
void BoundaryCollapser::lookAround(uint32_t vertex) {
    state_.forGroupCorners(vertex, [&](uint32_t patch, uint32_t c) {
        const PatchMesh& mesh = state_.patches[patch];
        for (const uint32_t x : {PatchMesh::next(c), PatchMesh::previous(c)}) {
            const uint32_t p = state_.positionAt(mesh, x);
            if (!state_.isBoundary[p]) {
                interiors_[patch].markDirty(mesh.corner[x]);
            } else {
                around_.push_back(state_.representative[p]);
            }
        }
    });
}

/// Ends a vertex: its group goes to the parent.
void BoundaryCollapser::retire(uint32_t vertex, uint32_t parent, const WedgeMap& wedges, uint32_t level) {
    state_.collapseLevel[vertex] = uint8_t(level);
    state_.parent[vertex] = parent;
    state_.domain[vertex] = domain_;
    for (const uint32_t w : state_.wedgesOf(vertex)) {
        const uint32_t to = wedges(w);
        state_.wedgeParent[w] = to == kNone ? wedges.any() : to; // no face draws it any more
    }
    members_.clear();
    state_.forGroup(vertex, [&](uint32_t m) { members_.push_back(m); });
    for (const uint32_t m : members_) {
        state_.representative[m] = parent;
        for (const uint32_t w : state_.wedgesOf(m)) {
            uint32_t& r = state_.wedgeRepresentative[w];
            const uint32_t to = wedges(r);
            r = to == kNone ? wedges.any() : to;
        }
    }
    std::swap(state_.groupNext[vertex], state_.groupNext[parent]);
    if (const uint32_t piece = state_.guard.pieceOf(vertex); piece != PieceGuard::kUnguarded) {
        state_.guard.lose(piece, std::exchange(areaLost_, 0.0));
    }
    auto &from = state_.starOf(vertex), &to = state_.starOf(parent);
    to.insert(to.end(), from.begin(), from.end());
    from = {};
    ++stamp_[vertex];
}

void BoundaryCollapser::collapse(uint32_t vertex, uint32_t target, uint32_t level) {
    around_.clear();
    lookAround(vertex);
    state_.domain[target] = state_.domains.unite(state_.domain[target], domain_);
    state_.quadrics[target].add(state_.quadrics[vertex]);
    for (const auto& [from, to] : wedges_.pairs()) attributes_.add(to, from);
    retire(vertex, target, wedges_, level);
    around_.push_back(target);
    reevaluateAround();
}

void BoundaryCollapser::meet(uint32_t vertex, uint32_t target, uint32_t level) {
    around_.clear();
    lookAround(vertex);
    lookAround(target);
    const auto room = uint32_t(state_.rooms.size() - 1);
    const uint32_t made = state_.rooms[room].position;
    state_.keep(room, level, {});
    for (const uint32_t wedge : state_.wedgesOf(made)) attributes_.make(wedge, state_.madeWedge(wedge));
    state_.makeBoundary(made);
    state_.domain[made] = domain_;
    retire(vertex, made, vertexWedges_, level);
    retire(target, made, targetWedges_, level);
    around_.push_back(made);
    reevaluateAround();
}

void BoundaryCollapser::reevaluateAround() {
    ++counts_.collapses;
    std::sort(around_.begin(), around_.end());
    around_.erase(std::unique(around_.begin(), around_.end()), around_.end());
    for (const uint32_t v : around_) {
        if (state_.parent[v] != kNone) continue;
        blocked_[v] = {};
        evaluate(v);
    }
}

} // namespace xgc::bake
