#include "coverage.h"

#include "bake/surface_distance.h"
#include "segments.h"

namespace xgc::bake {
namespace {

constexpr double kReach = 1.1 * 1.1; ///< faces farther than this from a vertex that they cover are strained

/// Goes round `vertex` from triangle to triangle of a loop, from `from` to `to`; false if that does not arrive.
template <typename Loop, typename Cross>
bool walkWithin(const DrawnLevel& drawn, const Loop& loop, uint32_t vertex, uint32_t from, uint32_t to,
                const Cross& cross) {
    if (from == to) return true;
    for (int way = 0; way < 2; ++way) {
        uint32_t at = from, before = kNone;
        std::array<uint32_t, 64> steps;
        for (uint32_t count = 0; count < steps.size(); ++count) {
            const glm::uvec3& t = drawn.triangles[at];
            const int k = t.x == vertex ? 0 : t.y == vertex ? 1 : 2;
            const uint32_t one = drawn.beside[at][k], other = drawn.beside[at][(k + 2) % 3];
            const uint32_t next = before == kNone ? (way == 0 ? one : other) : one == before ? other : one;
            if (next == kNone || next == from || !loop.has(next)) break;
            steps[count] = next;
            before = at;
            at = next;
            if (at != to) continue;
            uint32_t last = from;
            for (uint32_t i = 0; i <= count; ++i) {
                cross(last, steps[i]);
                last = steps[i];
            }
            return true;
        }
    }
    return false;
}

} // namespace

Coverage::Coverage(const MeasuredInput& input, const TrackedMap& map, const EdgePaths& paths)
    : input_(input), map_(map), paths_(paths), isLoose_(input.mesh.faces.size(), 0) {
    for (uint32_t e = 0; e < input.topology.edges.size(); ++e) {
        if (input.topology.facesOfEdge(e).size() % 2) oddEdges_.push_back(e);
    }
}

bool Coverage::isTrivial(uint32_t face) const {
    const glm::uvec3 p = input_.mesh.facePositions(face);
    const uint32_t t = map_[p.x].triangle;
    return map_[p.y].triangle == t && map_[p.z].triangle == t;
}

bool Coverage::collect(uint32_t face, const DrawnLevel& drawn, Loop& loop) const {
    loop.count = 0;
    loop.isStrained = false;
    const glm::uvec3 corners = input_.mesh.facePositions(face);
    bool isOnEdge[3] = {};
    for (int k = 0; k < 3; ++k) {
        const uint32_t e = input_.topology.faceEdges[face][k];
        std::array<uint32_t, 2> two;
        const EdgePaths::Path path = paths_.of(e, drawn, two);
        if (path.kind == EdgePaths::Kind::none) return false;
        loop.isStrained |= path.isStrained;
        isOnEdge[k] = path.kind == EdgePaths::Kind::drawn;
        if (isOnEdge[k]) continue;
        for (const uint32_t t : path.triangles) {
            if (!loop.add(t)) return false;
        }
        const bool isForward = input_.topology.edges[e].x == corners[k];
        loop.starts[k] = isForward ? path.triangles.front() : path.triangles.back();
        loop.ends[k] = isForward ? path.triangles.back() : path.triangles.front();
    }
    for (int k = 0; k < 3; ++k) {
        if (!isOnEdge[k]) continue;
        const uint32_t a = map_[corners[k]].vertex, b = map_[corners[(k + 1) % 3]].vertex;
        uint32_t chosen = kNone;
        for (const uint32_t t : drawn.star(a)) {
            if (!drawn.hasCorner(t, b)) continue;
            if (chosen == kNone || loop.has(t)) chosen = t;
        }
        if (chosen == kNone || !loop.add(chosen)) return false;
        loop.starts[k] = loop.ends[k] = chosen;
    }
    return true;
}

// At a corner that is a drawn vertex the loop passes that vertex: from triangle to triangle of its star.
bool Coverage::isWhole(uint32_t face, const DrawnLevel& drawn, const Loop& loop) const {
    const glm::uvec3 corners = input_.mesh.facePositions(face);
    for (int k = 0; k < 3; ++k) {
        const uint32_t in = loop.ends[(k + 2) % 3], out = loop.starts[k];
        if (in == out) continue;
        const uint32_t vertex = map_[corners[k]].vertex;
        if (vertex == kNone) return false;
        if (!walkWithin(drawn, loop, vertex, in, out, [](uint32_t, uint32_t) {})) return false;
    }
    return true;
}

// Euler's number of the triangles, glued along edges, is 1.
Coverage::Disc Coverage::discOf(const DrawnLevel& drawn, const Loop& loop, uint32_t& centre) const {
    uint32_t glued = 0;
    for (uint32_t i = 0; i < loop.count; ++i) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t next = drawn.beside[loop.triangles[i]][k];
            glued += next != kNone && loop.has(next);
        }
    }
    glued /= 2;
    if (loop.count == glued + 1) return Disc::plain;
    if (loop.count != glued) return Disc::none;
    uint32_t inner = 0;
    for (uint32_t i = 0; i < loop.count; ++i) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t v = drawn.triangles[loop.triangles[i]][k];
            if (inner > 0 && v == centre) continue;
            bool isInner = true;
            for (const uint32_t t : drawn.star(v)) {
                isInner = isInner && loop.has(t);
                const int c = drawn.triangles[t].x == v ? 0 : drawn.triangles[t].y == v ? 1 : 2;
                isInner = isInner && drawn.beside[t][c] != kNone && drawn.beside[t][(c + 2) % 3] != kNone;
            }
            if (!isInner) continue;
            ++inner;
            centre = v;
        }
    }
    return inner == 1 ? Disc::aroundVertex : Disc::none;
}

/// Whether the loop passes two triangles beside each other and no drawn vertex: the most frequent disc.
bool Coverage::isPair(uint32_t face) const {
    const glm::uvec3 p = input_.mesh.facePositions(face);
    if (map_[p.x].vertex != kNone || map_[p.y].vertex != kNone || map_[p.z].vertex != kNone) return false;
    return paths_.isPairOnly(input_.topology.faceEdges[face]);
}

void Coverage::checkFace(uint32_t face, const DrawnLevel& drawn, RunningErrors& running, Found& found) const {
    if (isPair(face)) return;
    Loop loop;
    uint32_t centre = kNone;
    Disc disc = Disc::none;
    if (collect(face, drawn, loop) && isWhole(face, drawn, loop)) disc = discOf(drawn, loop, centre);
    if (disc == Disc::none) return found.loose.push_back(face);
    if (disc == Disc::aroundVertex) {
        found.centres.push_back(centre);
        const glm::uvec3 p = input_.mesh.facePositions(face);
        const double squared =
            squaredDistance(drawn.points[centre], input_.point(p.x), input_.point(p.y), input_.point(p.z));
        if (squared > std::max(input_.floor, kReach * running.of(input_.hierarchy.facePatch[face]))) {
            loop.isStrained = true;
        } else {
            running.raise(input_.hierarchy.facePatch[face], squared);
            for (const uint32_t t : drawn.star(centre)) running.raise(drawn.patches[t], squared);
        }
    }
    if (loop.isStrained) found.strained.push_back(face);
}

std::vector<Coverage::Region> Coverage::imageOf(uint32_t face, const DrawnLevel& drawn) const {
    Loop loop;
    uint32_t centre = kNone;
    collect(face, drawn, loop);
    const Disc disc = discOf(drawn, loop, centre);
    std::vector<Region> regions;
    for (uint32_t i = 0; i < loop.count; ++i) regions.push_back({loop.triangles[i], {}});
    const auto add = [&](uint32_t triangle, const glm::dvec3& point) {
        for (Region& r : regions) {
            if (r.triangle == triangle) r.points.push_back(point);
        }
    };
    const auto addVertex = [&](uint32_t vertex) {
        for (const uint32_t t : drawn.star(vertex)) add(t, drawn.points[vertex]);
    };
    if (disc == Disc::aroundVertex) addVertex(centre);
    const glm::uvec3 corners = input_.mesh.facePositions(face);
    for (int k = 0; k < 3; ++k) {
        const TrackedMap::Place& place = map_[corners[k]];
        const glm::uvec3& t = drawn.triangles[place.triangle];
        if (place.vertex != kNone)
            addVertex(place.vertex);
        else
            add(place.triangle,
                nearestOnTriangle(input_.point(corners[k]), drawn.points[t.x], drawn.points[t.y], drawn.points[t.z]));
        paths_.forCrossings(input_.topology.faceEdges[face][k], drawn,
                            [&](uint32_t a, uint32_t b, const glm::dvec3& point) {
                                add(a, point);
                                add(b, point);
                            });
    }
    return regions;
}

void Coverage::advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                       std::vector<double>& errors) {
    level_ = level;
    std::vector<Found> found(chunkCount(isLoose_.size()));
    forChunks(isLoose_.size(), errors, [&](RunningErrors& running, uint32_t chunk, uint32_t first, uint32_t last) {
        for (uint32_t f = first; f < last; ++f) {
            if (paths_.faceLeaves(f) > level || isTrivial(f)) continue;
            if (isDrawnComponent[input_.topology.faceComponent[f]])
                checkFace(f, drawn, running, found[chunk]);
            else
                found[chunk].loose.push_back(f);
        }
    });
    std::fill(isLoose_.begin(), isLoose_.end(), uint8_t(0));
    isCentre_.assign(drawn.points.size(), 0);
    loose_.clear();
    strained_.clear();
    for (const Found& f : found) {
        loose_.insert(loose_.end(), f.loose.begin(), f.loose.end());
        strained_.insert(strained_.end(), f.strained.begin(), f.strained.end());
        for (const uint32_t c : f.centres) isCentre_[c] = 1;
    }
    for (const uint32_t f : loose_) isLoose_[f] = 1;
    cut(drawn);
    findBare(drawn);
}

// A border of the drawn surface bounds what is covered by nature; any other edge is a cut for both sides.
void Coverage::cutDrawnEdge(uint32_t a, uint32_t b, const DrawnLevel& drawn) {
    for (const uint32_t t : drawn.star(a)) {
        if (!drawn.hasCorner(t, b)) continue;
        const glm::uvec3& c = drawn.triangles[t];
        for (int k = 0; k < 3; ++k) {
            const bool isEdge = (c[k] == a && c[(k + 1) % 3] == b) || (c[k] == b && c[(k + 1) % 3] == a);
            if (isEdge && drawn.beside[t][k] != kNone) isCut_[t] = 1;
        }
    }
}

void Coverage::cutAlong(uint32_t edge, const DrawnLevel& drawn) {
    const glm::uvec2 e = input_.topology.edges[edge];
    std::array<uint32_t, 2> two;
    EdgePaths::Path path{EdgePaths::Kind::drawn, false, {}};
    if (paths_.edgeLeaves(edge) <= level_) path = paths_.of(edge, drawn, two);
    if (path.kind == EdgePaths::Kind::drawn) return cutDrawnEdge(map_[e.x].vertex, map_[e.y].vertex, drawn);
    for (const uint32_t t : path.triangles) isCut_[t] = 1;
}

void Coverage::cut(const DrawnLevel& drawn) {
    isCut_.assign(drawn.count(), 0);
    const auto cutIfOdd = [&](uint32_t e) {
        uint32_t uses = 0;
        for (const uint32_t f : input_.topology.facesOfEdge(e)) uses += !isLoose_[f];
        if (uses % 2) cutAlong(e, drawn);
    };
    for (const uint32_t e : oddEdges_) {
        cutIfOdd(e);
    }
    for (const uint32_t f : loose_) {
        for (int k = 0; k < 3; ++k) cutIfOdd(input_.topology.faceEdges[f][k]);
    }
}

bool Coverage::isCoveredAround(uint32_t vertex, const DrawnLevel& drawn) const {
    const uint32_t position = drawn.positions[vertex];
    if (position >= input_.mesh.positions.size() || isCentre_[vertex]) return false;
    // The spoke between two triangles, at which the turns of the loops' corners around the vertex are counted.
    const uint32_t first = drawn.star(vertex).front();
    const int k = drawn.triangles[first].x == vertex ? 0 : drawn.triangles[first].y == vertex ? 1 : 2;
    const uint32_t second = drawn.beside[first][k];
    if (second == kNone || second == drawn.beside[first][(k + 2) % 3]) return false;
    const uint32_t tip = drawn.triangles[first][(k + 1) % 3];
    for (const uint32_t t : drawn.star(vertex)) {
        if (isCut_[t]) return false;
    }
    uint32_t turns = 0;
    const auto cross = [&](uint32_t a, uint32_t b) {
        turns += (a == first && b == second) || (a == second && b == first);
    };
    Loop loop;
    for (const uint32_t f : input_.topology.facesOfVertex(position)) {
        if (isLoose_[f]) return false;
        const glm::uvec3 corners = input_.mesh.facePositions(f);
        const int c = corners.x == position ? 0 : corners.y == position ? 1 : 2;
        if (paths_.faceLeaves(f) > level_) {
            // An edge along the spoke counts as on the side of `first`: the face that is `second` turns across it.
            turns += drawn.faces[second] == f;
            continue;
        }
        if (!collect(f, drawn, loop)) return false;
        uint32_t out = loop.starts[c], in = loop.ends[(c + 2) % 3];
        if (map_[corners[(c + 1) % 3]].vertex == tip) turns += out == second;
        if (map_[corners[(c + 2) % 3]].vertex == tip) turns += in == second;
        if (!walkWithin(drawn, loop, vertex, in, out, cross)) return false;
    }
    return turns % 2 == 1;
}

void Coverage::findBare(const DrawnLevel& drawn) {
    // Pieces: triangles beside each other and not cut.
    std::vector<uint32_t> piece(drawn.count(), kNone), queue;
    uint32_t pieceCount = 0;
    for (uint32_t seed = 0; seed < drawn.count(); ++seed) {
        if (piece[seed] != kNone || isCut_[seed]) continue;
        piece[seed] = pieceCount;
        queue.assign(1, seed);
        while (!queue.empty()) {
            const uint32_t t = queue.back();
            queue.pop_back();
            for (int k = 0; k < 3; ++k) {
                const uint32_t next = drawn.beside[t][k];
                if (next == kNone || isCut_[next] || piece[next] != kNone) continue;
                piece[next] = pieceCount;
                queue.push_back(next);
            }
        }
        ++pieceCount;
    }
    std::vector<uint8_t> isCovered(pieceCount, 0);
    for (uint32_t v = 0; v < drawn.points.size(); ++v) {
        const uint32_t p = piece[drawn.star(v).front()];
        if (p != kNone && !isCovered[p]) isCovered[p] = isCoveredAround(v, drawn);
    }
    bare_.clear();
    for (uint32_t t = 0; t < drawn.count(); ++t) {
        if (isCut_[t] || !isCovered[piece[t]]) bare_.push_back(t);
    }
}

} // namespace xgc::bake
