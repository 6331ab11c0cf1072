#include "tracked_map.h"

#include "bake/surface_distance.h"

#include <limits>

namespace xgc::bake {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

} // namespace

TrackedMap::TrackedMap(const MeasuredInput& input, const DrawnLevel& drawn)
    : input_(input), places_(input.mesh.positions.size()), moved_(places_.size(), 0), isGone_(places_.size(), 0),
      patch_(places_.size(), kNone) {
    for (uint32_t p = 0; p < places_.size(); ++p) {
        const uint32_t vertex = drawn.newVertex[p];
        if (vertex == kNone) continue;
        places_[p] = {drawn.star(vertex).front(), vertex};
        const auto faces = input.topology.facesOfVertex(p);
        patch_[p] = input.hierarchy.facePatch[faces.front()];
        for (const uint32_t f : faces) {
            if (input.hierarchy.facePatch[f] != patch_[p]) patch_[p] = kNone;
        }
    }
}

double TrackedMap::leastError(uint32_t position, const RunningErrors& running) const {
    if (patch_[position] != kNone) return running.of(patch_[position]);
    double least = kFar;
    for (const uint32_t f : input_.topology.facesOfVertex(position)) {
        least = std::min(least, running.of(input_.hierarchy.facePatch[f]));
    }
    return least;
}

void TrackedMap::raise(uint32_t position, uint32_t trianglePatch, double squared, RunningErrors& running) const {
    if (!isGone_[position]) running.raise(trianglePatch, squared);
    if (patch_[position] != kNone) return running.raise(patch_[position], squared);
    for (const uint32_t f : input_.topology.facesOfVertex(position)) {
        running.raise(input_.hierarchy.facePatch[f], squared);
    }
}

bool TrackedMap::follow(uint32_t position, uint32_t level, const DrawnLevel& drawn, RunningErrors& running) {
    Place& place = places_[position];
    if (place.triangle == kNone) return false;
    const uint32_t old = place.triangle;
    place.triangle = drawn.newTriangle[old];
    moved_[position] = place.triangle == kNone || drawn.isFresh[place.triangle];
    if (place.vertex != kNone) {
        place.vertex = input_.hierarchy.collapseLevel[position] > level ? drawn.newVertex[place.vertex] : kNone;
        if (place.vertex != kNone) {
            if (place.triangle == kNone) place.triangle = drawn.star(place.vertex).front();
            return true;
        }
        moved_[position] = 1;
    }
    if (!moved_[position]) return true;
    const glm::dvec3 p = input_.point(position);
    const Allowance allowance{&running, leastError(position, running), input_.floor};
    NearTriangle near{place.triangle, kFar};
    glm::uvec3 seeds;
    if (place.triangle != kNone) {
        near.squared = squaredTo(drawn, place.triangle, p);
        if (allowance.covers(drawn.patches[place.triangle], near.squared)) {
            raise(position, drawn.patches[place.triangle], near.squared, running);
            return true;
        }
        seeds = drawn.triangles[place.triangle];
    } else {
        for (int k = 0; k < 3; ++k) seeds[k] = drawn.newVertex[drawn.oldTriangles[old][k]];
    }
    near = walkNear(drawn, p, near, seeds, allowance);
    place.triangle = near.triangle;
    if (near.triangle == kNone) return false;
    raise(position, drawn.patches[near.triangle], near.squared, running);
    return true;
}

void TrackedMap::findLost(const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                          const std::vector<uint32_t>& lost, std::vector<double>& errors) {
    if (lost.empty()) return;
    for (const uint32_t p : lost) {
        const auto faces = input_.topology.facesOfVertex(p);
        isGone_[p] = std::none_of(faces.begin(), faces.end(),
                                  [&](uint32_t f) { return isDrawnComponent[input_.topology.faceComponent[f]]; });
    }
    std::vector<Triangle> triangles;
    for (const glm::uvec3& t : drawn.triangles) {
        triangles.push_back({drawn.points[t.x], drawn.points[t.y], drawn.points[t.z]});
    }
    const SurfaceDistance surface(std::move(triangles));
    forChunks(lost.size(), errors, [&](RunningErrors& running, uint32_t, uint32_t first, uint32_t last) {
        for (uint32_t i = first; i < last; ++i) {
            const SurfaceDistance::Hit hit = surface.nearest(input_.point(lost[i]), input_.floor);
            places_[lost[i]] = {hit.triangle, kNone};
            moved_[lost[i]] = 1;
            raise(lost[i], drawn.patches[hit.triangle], hit.squared, running);
        }
    });
}

void TrackedMap::advance(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                         std::vector<double>& errors) {
    std::vector<std::vector<uint32_t>> lost(chunkCount(places_.size()));
    forChunks(places_.size(), errors, [&](RunningErrors& running, uint32_t chunk, uint32_t first, uint32_t last) {
        for (uint32_t p = first; p < last; ++p) {
            if (!follow(p, level, drawn, running)) lost[chunk].push_back(p);
        }
    });
    std::vector<uint32_t> all;
    for (const auto& list : lost) all.insert(all.end(), list.begin(), list.end());
    findLost(drawn, isDrawnComponent, all, errors);
}

} // namespace xgc::bake
