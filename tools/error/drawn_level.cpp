#include "drawn_level.h"

#include <algorithm>

namespace xgc::bake {

std::vector<uint32_t> positionParents(const Hierarchy& h) {
    std::vector<uint32_t> parents(h.positions.size(), kNone);
    for (uint32_t w = 0; w < h.wedgePosition.size(); ++w) {
        if (h.wedgeParent[w] != kNone) parents[h.wedgePosition[w]] = h.wedgePosition[h.wedgeParent[w]];
    }
    return parents;
}

void listStars(DrawnLevel& d) {
    d.starOffsets.assign(d.points.size() + 1, 0);
    for (const glm::uvec3& t : d.triangles) {
        for (int k = 0; k < 3; ++k) ++d.starOffsets[t[k] + 1];
    }
    for (size_t v = 1; v < d.starOffsets.size(); ++v) d.starOffsets[v] += d.starOffsets[v - 1];
    d.stars.resize(d.triangles.size() * 3);
    // Offsets move on to each star's end while it fills, and back.
    for (uint32_t t = 0; t < d.count(); ++t) {
        for (int k = 0; k < 3; ++k) d.stars[d.starOffsets[d.triangles[t][k]]++] = t;
    }
    for (size_t v = d.starOffsets.size() - 1; v > 0; --v) d.starOffsets[v] = d.starOffsets[v - 1];
    d.starOffsets[0] = 0;
}

LevelWalk::LevelWalk(const Mesh& mesh, const Hierarchy& hierarchy)
    : h_(hierarchy), parent_(positionParents(hierarchy)), numbers_(hierarchy.positions.size(), kNone) {
    // Level 0: the faces that are not degenerate, all of them in a welded mesh.
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        drawn_.triangles.push_back(mesh.facePositions(f));
        drawn_.faces.push_back(f);
    }
    drawn_.positions.resize(mesh.positions.size());
    std::vector<uint32_t> representatives(mesh.positions.size());
    for (uint32_t p = 0; p < representatives.size(); ++p) representatives[p] = drawn_.positions[p] = p;
    keepTriangles(representatives);
    std::fill(drawn_.isFresh.begin(), drawn_.isFresh.end(), uint8_t(0));
    findNeighbours();
}

uint32_t LevelWalk::representative(uint32_t position) const {
    while (h_.collapseLevel[position] <= level_) position = parent_[position];
    return position;
}

bool LevelWalk::advance() {
    ++level_;
    std::vector<uint32_t> representatives(drawn_.positions.size());
    bool isSame = true;
    for (size_t v = 0; v < representatives.size(); ++v) {
        representatives[v] = representative(drawn_.positions[v]);
        isSame &= representatives[v] == drawn_.positions[v];
    }
    if (isSame) return false;
    keepTriangles(representatives);
    findNeighbours();
    return true;
}

void LevelWalk::keepTriangles(const std::vector<uint32_t>& representatives) {
    DrawnLevel next;
    const size_t before = drawn_.triangles.size();
    next.newTriangle.assign(before, kNone);
    next.triangles.reserve(before);
    next.faces.reserve(before);
    for (size_t t = 0; t < before; ++t) {
        const glm::uvec3 old = drawn_.triangles[t];
        glm::uvec3 now(representatives[old.x], representatives[old.y], representatives[old.z]);
        if (now.x == now.y || now.y == now.z || now.z == now.x) continue;
        next.isFresh.push_back(now.x != drawn_.positions[old.x] || now.y != drawn_.positions[old.y] ||
                               now.z != drawn_.positions[old.z]);
        for (int k = 0; k < 3; ++k) {
            uint32_t& number = numbers_[now[k]];
            if (number == kNone) {
                number = uint32_t(next.positions.size());
                next.positions.push_back(now[k]);
            }
            now[k] = number;
        }
        next.newTriangle[t] = next.count();
        next.triangles.push_back(now);
        next.faces.push_back(drawn_.faces[t]);
    }
    next.newVertex.resize(representatives.size());
    for (size_t v = 0; v < representatives.size(); ++v) next.newVertex[v] = numbers_[representatives[v]];
    for (const uint32_t p : next.positions) {
        numbers_[p] = kNone;
        next.points.emplace_back(h_.positions[p]);
    }
    for (const uint32_t f : next.faces) next.patches.push_back(h_.facePatch[f]);
    next.oldTriangles = std::move(drawn_.triangles);
    drawn_ = std::move(next);
}

void LevelWalk::findNeighbours() {
    DrawnLevel& d = drawn_;
    listStars(d);
    d.beside.resize(d.triangles.size());
    for (uint32_t t = 0; t < d.count(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = d.triangles[t][k], b = d.triangles[t][(k + 1) % 3];
            uint32_t found = kNone, uses = 0;
            for (const uint32_t s : d.star(a)) {
                if (!d.hasCorner(s, b)) continue;
                ++uses;
                if (s != t) found = s;
            }
            d.beside[t][k] = uses == 2 ? found : kNone;
        }
    }
}

} // namespace xgc::bake
