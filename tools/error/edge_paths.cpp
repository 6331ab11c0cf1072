#include "edge_paths.h"

#include "segments.h"

#include <limits>

namespace xgc::bake {
namespace {

constexpr uint32_t kMostNodes = 200;
constexpr double kReach =
    1.1 * 1.1; ///< edges farther from the surface than this times the vertices are left to a direct measurement

using Place = TrackedMap::Place;

bool sharesEdge(const DrawnLevel& drawn, uint32_t a, uint32_t b) {
    const glm::uvec3& beside = drawn.beside[a];
    return int(beside.x == b) + int(beside.y == b) + int(beside.z == b) == 1;
}

/// Whether the surface ends a way there: the triangle of the end's place, or any with the drawn vertex that it is.
bool reaches(const DrawnLevel& drawn, uint32_t triangle, const Place& end) {
    return end.vertex != kNone ? drawn.hasCorner(triangle, end.vertex) : triangle == end.triangle;
}

/// The edge that two triangles share, by its first corner in `a`.
int sharedEdge(const DrawnLevel& drawn, uint32_t a, uint32_t b) {
    const glm::uvec3& beside = drawn.beside[a];
    return beside.x == b ? 0 : beside.y == b ? 1 : 2;
}

} // namespace

bool PathSearch::circle(const DrawnLevel& drawn, uint32_t centre, uint32_t from, uint32_t to) {
    // Both ways round, one step each in turn: the shorter one arrives first.
    uint32_t at[2] = {from, from}, before[2] = {kNone, kNone};
    for (std::vector<uint32_t>& way : ways_) way.assign(1, from);
    const glm::uvec3& corners = drawn.triangles[from];
    const int c = corners.x == centre ? 0 : corners.y == centre ? 1 : 2;
    uint32_t next[2] = {drawn.beside[from][c], drawn.beside[from][(c + 2) % 3]};
    for (int steps = 0; steps < 64; ++steps) {
        for (int w = 0; w < 2; ++w) {
            if (next[w] == kNone) continue;
            before[w] = at[w];
            at[w] = next[w];
            ways_[w].push_back(at[w]);
            if (at[w] == to) {
                path.swap(ways_[w]);
                return true;
            }
            const glm::uvec3& t = drawn.triangles[at[w]];
            const int k = t.x == centre ? 0 : t.y == centre ? 1 : 2;
            const uint32_t one = drawn.beside[at[w]][k], other = drawn.beside[at[w]][(k + 2) % 3];
            next[w] = one == before[w] ? other : one;
            if (next[w] == from) next[w] = kNone;
        }
    }
    return false;
}

bool PathSearch::walkFan(const DrawnLevel& drawn, const Segment& s, const Allowance& allowance) {
    const glm::uvec3& corners = drawn.triangles[s.from.triangle];
    for (int k = 0; k < 3; ++k) {
        const uint32_t z = corners[k];
        if (!drawn.hasCorner(s.to.triangle, z)) continue;
        const double squared = segmentToPoint(s.a, s.b, drawn.points[z]).squared;
        if (!allowance.covers(drawn.patches[s.from.triangle], squared)) continue;
        if (!allowance.covers(drawn.patches[s.to.triangle], squared)) continue;
        if (circle(drawn, z, s.from.triangle, s.to.triangle)) return true;
    }
    return false;
}

/// From a drawn vertex over the edge opposite in one of its triangles, where that arrives and costs nothing.
bool PathSearch::crossOnce(const DrawnLevel& drawn, const Segment& s, const Allowance& allowance) {
    const bool isForward = s.from.vertex != kNone;
    const uint32_t vertex = isForward ? s.from.vertex : s.to.vertex;
    for (const uint32_t t : drawn.star(vertex)) {
        const glm::uvec3& c = drawn.triangles[t];
        const int k = c.x == vertex ? 1 : c.y == vertex ? 2 : 0;
        const uint32_t next = drawn.beside[t][k];
        if (next == kNone || !reaches(drawn, next, isForward ? s.to : s.from)) continue;
        const double squared = segmentToSegment(s.a, s.b, drawn.points[c[k]], drawn.points[c[(k + 1) % 3]]).squared;
        if (!allowance.covers(drawn.patches[t], squared) || !allowance.covers(drawn.patches[next], squared)) continue;
        path.assign({t, next});
        if (!isForward) std::swap(path[0], path[1]);
        return true;
    }
    return false;
}

void PathSearch::open(uint32_t triangle, uint32_t parent, double cost) {
    nodes_.push_back({triangle, parent});
    heap_.push_back({cost, uint32_t(nodes_.size() - 1)});
    std::push_heap(heap_.begin(), heap_.end(),
                   [](const Open& a, const Open& b) { return a.cost != b.cost ? a.cost > b.cost : a.node > b.node; });
}

bool PathSearch::searchWide(const DrawnLevel& drawn, const Segment& s, const Allowance& allowance) {
    nodes_.clear();
    heap_.clear();
    stamps_.resize(std::max(stamps_.size(), drawn.triangles.size()), 0);
    ++stamp_;
    if (s.from.vertex != kNone) {
        for (const uint32_t t : drawn.star(s.from.vertex)) open(t, kNone, 0);
    } else {
        open(s.from.triangle, kNone, 0);
    }
    for (uint32_t expanded = 0; !heap_.empty() && expanded < kMostNodes; ++expanded) {
        const Open best = heap_.front();
        std::pop_heap(heap_.begin(), heap_.end(), [](const Open& a, const Open& b) {
            return a.cost != b.cost ? a.cost > b.cost : a.node > b.node;
        });
        heap_.pop_back();
        const uint32_t t = nodes_[best.node].triangle;
        if (stamps_[t] == stamp_) continue;
        stamps_[t] = stamp_;
        if (reaches(drawn, t, s.to)) {
            path.clear();
            for (uint32_t n = best.node; n != kNone; n = nodes_[n].parent) path.push_back(nodes_[n].triangle);
            std::reverse(path.begin(), path.end());
            return true;
        }
        for (int k = 0; k < 3; ++k) {
            const uint32_t next = drawn.beside[t][k];
            if (next == kNone || stamps_[next] == stamp_) continue;
            const glm::uvec3& c = drawn.triangles[t];
            double cost = segmentToSegment(s.a, s.b, drawn.points[c[k]], drawn.points[c[(k + 1) % 3]]).squared;
            if (allowance.covers(drawn.patches[t], cost) && allowance.covers(drawn.patches[next], cost)) cost = 0;
            open(next, best.node, std::max(cost, best.cost));
        }
    }
    return false;
}

bool PathSearch::find(const DrawnLevel& drawn, const Segment& s, const Allowance& allowance) {
    const bool isPlain = s.from.vertex == kNone && s.to.vertex == kNone;
    if (isPlain ? walkFan(drawn, s, allowance) : crossOnce(drawn, s, allowance)) return true;
    return searchWide(drawn, s, allowance);
}

EdgePaths::EdgePaths(const MeasuredInput& input, const TrackedMap& map)
    : input_(input), map_(map), patch_(input.topology.edges.size(), kNone), faceLeaves_(input.mesh.faces.size()),
      edgeLeaves_(patch_.size(), 0), codes_(edgeLeaves_.size(), kInside), stored_(chunkCount(codes_.size())) {
    const auto& collapse = input.hierarchy.collapseLevel;
    for (uint32_t f = 0; f < faceLeaves_.size(); ++f) {
        const glm::uvec3 p = input.mesh.facePositions(f);
        faceLeaves_[f] = std::min({collapse[p.x], collapse[p.y], collapse[p.z]});
        for (int k = 0; k < 3; ++k) {
            uint8_t& leaves = edgeLeaves_[input.topology.faceEdges[f][k]];
            leaves = std::max(leaves, faceLeaves_[f]);
        }
    }
    for (uint32_t e = 0; e < patch_.size(); ++e) {
        const auto faces = input.topology.facesOfEdge(e);
        const auto patchOf = [&](uint32_t f) { return input.hierarchy.facePatch[f]; };
        const uint32_t patch = patchOf(faces.front());
        if (std::all_of(faces.begin(), faces.end(), [&](uint32_t f) { return patchOf(f) == patch; })) patch_[e] = patch;
    }
}

double EdgePaths::leastError(uint32_t edge, const RunningErrors& running) const {
    if (patch_[edge] != kNone) return running.of(patch_[edge]);
    double least = std::numeric_limits<double>::infinity();
    for (const uint32_t f : input_.topology.facesOfEdge(edge)) {
        least = std::min(least, running.of(input_.hierarchy.facePatch[f]));
    }
    return least;
}

bool EdgePaths::isKept(uint32_t edge, const DrawnLevel& drawn) const {
    const glm::uvec2 e = input_.topology.edges[edge];
    if (codes_[edge] > kPair || map_.hasMoved(e.x) || map_.hasMoved(e.y)) return false;
    const Place &from = map_[e.x], &to = map_[e.y];
    if (codes_[edge] == kPair) return sharesEdge(drawn, from.triangle, to.triangle);
    return from.vertex == kNone || to.vertex == kNone;
}

bool EdgePaths::raise(uint32_t edge, const DrawnLevel& drawn, std::span<const uint32_t> path,
                      const Chunk& chunk) const {
    const glm::uvec2 e = input_.topology.edges[edge];
    const glm::dvec3 a = input_.point(e.x), b = input_.point(e.y);
    std::vector<double>& crossings = chunk.search.crossings;
    crossings.clear();
    double passed = 0, worst = 0;
    for (size_t i = 0; i + 1 < path.size(); ++i) {
        const int k = sharedEdge(drawn, path[i], path[i + 1]);
        const glm::dvec3& c = drawn.points[drawn.triangles[path[i]][k]];
        const glm::dvec3& d = drawn.points[drawn.triangles[path[i]][(k + 1) % 3]];
        NearOnSegment near = segmentToSegment(a, b, c, d);
        // Crossings come in their order along the edge, so that the pieces between them do not overlap.
        if (near.at < passed) near = {segmentToPoint(c, d, a + (b - a) * passed).squared, passed};
        passed = near.at;
        worst = std::max(worst, near.squared);
        crossings.push_back(near.squared);
    }
    if (worst > kReach * largestError(edge, chunk.errors)) return false;
    for (size_t i = 0; i < crossings.size(); ++i) {
        chunk.running.raise(drawn.patches[path[i]], crossings[i]);
        chunk.running.raise(drawn.patches[path[i + 1]], crossings[i]);
    }
    raisePatches(edge, worst, chunk.running);
    return true;
}

void EdgePaths::raisePatches(uint32_t edge, double squared, RunningErrors& running) const {
    if (patch_[edge] != kNone) return running.raise(patch_[edge], squared);
    for (const uint32_t f : input_.topology.facesOfEdge(edge)) running.raise(input_.hierarchy.facePatch[f], squared);
}

double EdgePaths::largestError(uint32_t edge, const std::vector<double>& errors) const {
    double largest = input_.floor;
    for (const uint32_t f : input_.topology.facesOfEdge(edge)) {
        largest = std::max(largest, errors[input_.hierarchy.facePatch[f]]);
    }
    return largest;
}

uint32_t EdgePaths::find(uint32_t edge, const DrawnLevel& drawn, Chunk& chunk) const {
    const glm::uvec2 e = input_.topology.edges[edge];
    const Place &from = map_[e.x], &to = map_[e.y];
    if (from.triangle == to.triangle) return kInside;
    if (from.vertex != kNone && drawn.hasCorner(to.triangle, from.vertex)) return kInside;
    if (to.vertex != kNone && drawn.hasCorner(from.triangle, to.vertex)) return kInside;
    if (from.vertex != kNone && to.vertex != kNone) {
        for (const uint32_t t : drawn.star(from.vertex)) {
            if (drawn.hasCorner(t, to.vertex)) return kInside;
        }
    }
    const PathSearch::Segment segment{input_.point(e.x), input_.point(e.y), from, to};
    const Allowance allowance{&chunk.running, leastError(edge, chunk.running), input_.floor};
    if (from.vertex == kNone && to.vertex == kNone && sharesEdge(drawn, from.triangle, to.triangle)) {
        const int k = sharedEdge(drawn, from.triangle, to.triangle);
        const glm::uvec3& c = drawn.triangles[from.triangle];
        const double squared =
            segmentToSegment(segment.a, segment.b, drawn.points[c[k]], drawn.points[c[(k + 1) % 3]]).squared;
        if (allowance.covers(drawn.patches[from.triangle], squared) &&
            allowance.covers(drawn.patches[to.triangle], squared)) {
            chunk.running.raise(drawn.patches[from.triangle], squared);
            chunk.running.raise(drawn.patches[to.triangle], squared);
            raisePatches(edge, squared, chunk.running);
            return kPair;
        }
    }
    if (!chunk.search.find(drawn, segment, allowance)) return kNoPath;
    const std::vector<uint32_t>& path = chunk.search.path;
    const bool isNear = raise(edge, drawn, path, chunk);
    if (isNear && path.size() == 2 && path[0] == from.triangle && path[1] == to.triangle &&
        sharesEdge(drawn, path[0], path[1])) {
        return kPair;
    }
    const auto code = uint32_t(kFirstStored + chunk.stored.size());
    chunk.stored.push_back(uint32_t(path.size()));
    chunk.stored.insert(chunk.stored.end(), path.begin(), path.end());
    return isNear ? code : code | kStrained;
}

void EdgePaths::advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                        std::vector<double>& errors) {
    level_ = level;
    const bool isAllDrawn = std::find(isDrawnComponent.begin(), isDrawnComponent.end(), 0) == isDrawnComponent.end();
    const auto isDrawn = [&](uint32_t edge) {
        return isAllDrawn || isDrawnComponent[input_.topology.faceComponent[input_.topology.facesOfEdge(edge).front()]];
    };
    tbb::enumerable_thread_specific<PathSearch> searches;
    forChunks(codes_.size(), errors, [&](RunningErrors& running, uint32_t chunk, uint32_t first, uint32_t last) {
        stored_[chunk].clear();
        Chunk c{running, errors, stored_[chunk], searches.local()};
        for (uint32_t e = first; e < last; ++e) {
            if (edgeLeaves_[e] > level || isKept(e, drawn)) continue;
            codes_[e] = isDrawn(e) ? find(e, drawn, c) : kNoPath;
        }
    });
}

glm::dvec3 EdgePaths::crossing(uint32_t edge, const DrawnLevel& drawn, uint32_t triangle, uint32_t next) const {
    const glm::uvec2 e = input_.topology.edges[edge];
    const int k = sharedEdge(drawn, triangle, next);
    const glm::dvec3& c = drawn.points[drawn.triangles[triangle][k]];
    const glm::dvec3& d = drawn.points[drawn.triangles[triangle][(k + 1) % 3]];
    return c + (d - c) * segmentToSegment(c, d, input_.point(e.x), input_.point(e.y)).at;
}

EdgePaths::Path EdgePaths::of(uint32_t edge, const DrawnLevel& drawn, std::array<uint32_t, 2>& two) const {
    const uint32_t code = codes_[edge];
    if (code == kNoPath) return {Kind::none, false, {}};
    const glm::uvec2 e = input_.topology.edges[edge];
    const Place &from = map_[e.x], &to = map_[e.y];
    if (code == kPair) {
        two = {from.triangle, to.triangle};
        return {Kind::crossing, false, two};
    }
    if (code >= kFirstStored) {
        const uint32_t* stored = stored_[edge / kChunk].data() + ((code & ~kStrained) - kFirstStored);
        return {Kind::crossing, (code & kStrained) != 0, {stored + 1, stored[0]}};
    }
    if (from.vertex != kNone && to.vertex != kNone) return {Kind::drawn, false, {}};
    const bool isInTo =
        from.triangle == to.triangle || (from.vertex != kNone && drawn.hasCorner(to.triangle, from.vertex));
    two[0] = isInTo ? to.triangle : from.triangle;
    return {Kind::inside, false, {two.data(), 1}};
}

} // namespace xgc::bake
