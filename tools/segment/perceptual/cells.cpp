#include "cells.h"
#include "disjoint_sets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace xgc::bake {

namespace {

/// Rays need no finer surface than this (of an area of 1), and a smaller one is met sooner.
constexpr float kSoupSpacing = 0.008f;
/// Fewer triangles than this stay as they are.
constexpr uint32_t kPlainSoup = 8000;

struct TriangleShape {
    glm::vec3 center, normal; ///< normal as long as the area
    float area;
};

std::vector<TriangleShape> shapesOf(const Piece& piece) {
    std::vector<TriangleShape> shapes(piece.triangles.size());
    for (uint32_t t = 0; t < piece.triangleCount(); ++t) {
        const glm::uvec3 c = piece.triangles[t];
        const glm::vec3 p = piece.positions[c.x], q = piece.positions[c.y], r = piece.positions[c.z];
        const glm::vec3 n = glm::cross(q - p, r - p) * 0.5f;
        shapes[t] = {(p + q + r) * (1.0f / 3), n, glm::length(n)};
    }
    return shapes;
}

/// Rounds down without a call, which std::floor is where the processor need not have SSE 4.1.
int floorOf(float x) {
    const int i = int(x);
    return i - int(float(i) > x);
}

glm::ivec3 cubeOf(const glm::vec3& p, float inverseSpacing) {
    return {floorOf(p.x * inverseSpacing), floorOf(p.y * inverseSpacing), floorOf(p.z * inverseSpacing)};
}

float edgeLength(const Piece& piece, uint32_t t, int k) {
    const glm::uvec3 c = piece.triangles[t];
    return glm::length(piece.positions[c[(k + 1) % 3]] - piece.positions[c[k]]);
}

/// Visits every link between triangles once: (t, its neighbour, side of t).
template <class Visit>
void forEachLink(const Piece& piece, const Visit& visit) {
    for (uint32_t t = 0; t < piece.triangleCount(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t g = piece.neighbours[t][k];
            if (g != kNone && t < g) visit(t, g, k);
        }
    }
}

/// DisjointSets under `leastArea` join the set across their longest edge.
void joinSmallSets(const Piece& piece, std::span<const TriangleShape> shapes, float leastArea, DisjointSets& sets) {
    std::vector<float> area(shapes.size(), 0.0f), longest(shapes.size(), 0.0f);
    std::vector<uint32_t> across(shapes.size(), kNone);
    for (uint32_t t = 0; t < piece.triangleCount(); ++t) area[sets.find(t)] += shapes[t].area;
    forEachLink(piece, [&](uint32_t t, uint32_t g, int k) {
        const uint32_t a = sets.find(t), b = sets.find(g);
        if (a == b || (area[a] >= leastArea && area[b] >= leastArea)) return;
        const float length = edgeLength(piece, t, k);
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
            if (across[from] != kNone && length <= longest[from]) continue;
            longest[from] = length;
            across[from] = to;
        }
    });
    for (uint32_t t = 0; t < piece.triangleCount(); ++t) {
        if (across[t] != kNone && area[t] < leastArea) sets.join(t, across[t]);
    }
}

/// Dense numbers of cells by their lowest triangle.
std::vector<uint32_t> joinTriangles(const Piece& piece, std::span<const TriangleShape> shapes, float spacing,
                                    float leastArea, uint32_t& count) {
    constexpr float kFacingAlike = 0.3f;
    std::vector<glm::ivec3> cube(shapes.size());
    std::vector<glm::vec3> normal(shapes.size());
    for (size_t t = 0; t < shapes.size(); ++t) {
        cube[t] = cubeOf(shapes[t].center, 1 / spacing);
        normal[t] = shapes[t].area > 0 ? shapes[t].normal / shapes[t].area : glm::vec3(0);
    }
    DisjointSets sets(piece.triangleCount());
    forEachLink(piece, [&](uint32_t t, uint32_t g, int) {
        if (cube[t] == cube[g] && glm::dot(normal[t], normal[g]) > kFacingAlike) sets.join(t, g);
    });
    joinSmallSets(piece, shapes, leastArea, sets);
    std::vector<uint32_t> cell(shapes.size());
    count = 0;
    for (uint32_t t = 0; t < piece.triangleCount(); ++t) {
        const uint32_t set = sets.find(t);
        cell[t] = set == t ? count++ : cell[set];
    }
    return cell;
}

void addShapes(std::span<const TriangleShape> shapes, std::span<const uint32_t> ofTriangle, uint32_t count,
               CellGraph& graph) {
    graph.areas.assign(count, 0.0f);
    graph.centers.assign(count, glm::vec3(0));
    graph.normals.assign(count, glm::vec3(0));
    std::vector<glm::vec3> plain(count, glm::vec3(0)); // for cells without area
    std::vector<uint32_t> members(count, 0);
    for (size_t t = 0; t < shapes.size(); ++t) {
        const uint32_t c = ofTriangle[t];
        graph.areas[c] += shapes[t].area;
        graph.centers[c] += shapes[t].center * shapes[t].area;
        graph.normals[c] += shapes[t].normal;
        plain[c] += shapes[t].center;
        ++members[c];
    }
    for (uint32_t c = 0; c < count; ++c) {
        graph.centers[c] = graph.areas[c] > 0 ? graph.centers[c] / graph.areas[c] : plain[c] / float(members[c]);
        const float length = glm::length(graph.normals[c]);
        graph.normals[c] = length > 0 ? graph.normals[c] / length : glm::vec3(0);
    }
}

/// Links by a counting sort on the lower cell, then a short sort for each.
void addLinks(const Piece& piece, std::span<const uint32_t> ofTriangle, CellGraph& graph) {
    const uint32_t count = graph.size();
    std::vector<uint32_t> offsets(count + 1, 0);
    forEachLink(piece, [&](uint32_t t, uint32_t g, int) {
        const uint32_t a = ofTriangle[t], b = ofTriangle[g];
        if (a != b) ++offsets[std::min(a, b) + 1];
    });
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    std::vector<CellGraph::Link> raw(offsets.back());
    std::vector<uint32_t> at(offsets.begin(), offsets.end() - 1);
    forEachLink(piece, [&](uint32_t t, uint32_t g, int k) {
        const uint32_t a = std::min(ofTriangle[t], ofTriangle[g]), b = std::max(ofTriangle[t], ofTriangle[g]);
        if (a != b) raw[at[a]++] = {a, b, edgeLength(piece, t, k)};
    });
    for (uint32_t c = 0; c < count; ++c) {
        const auto begin = raw.begin() + offsets[c], end = raw.begin() + offsets[c + 1];
        std::sort(begin, end,
                  [](const auto& x, const auto& y) { return x.b != y.b ? x.b < y.b : x.length < y.length; });
        const size_t first = graph.links.size();
        for (auto link = begin; link != end; ++link) {
            if (graph.links.size() > first && graph.links.back().b == link->b) {
                graph.links.back().length += link->length;
            } else {
                graph.links.push_back(*link);
            }
        }
    }
}

void addArcs(CellGraph& graph) {
    graph.arcOffsets.assign(graph.size() + 1, 0);
    for (const CellGraph::Link& link : graph.links) {
        ++graph.arcOffsets[link.a + 1];
        ++graph.arcOffsets[link.b + 1];
    }
    std::partial_sum(graph.arcOffsets.begin(), graph.arcOffsets.end(), graph.arcOffsets.begin());
    graph.arcs.resize(graph.arcOffsets.back());
    std::vector<uint32_t> at(graph.arcOffsets.begin(), graph.arcOffsets.end() - 1);
    for (uint32_t l = 0; l < graph.links.size(); ++l) {
        graph.arcs[at[graph.links[l].a]++] = {graph.links[l].b, l};
        graph.arcs[at[graph.links[l].b]++] = {graph.links[l].a, l};
    }
}

/// Numbers of cubes by first use: open addressing, a power of two of slots.
class CubeNumbers {
public:
    explicit CubeNumbers(size_t expected) {
        size_t slots = 64;
        while (slots < expected * 2) slots *= 2;
        slots_.assign(slots, kNone);
    }
    uint32_t of(const glm::ivec3& cube) {
        uint64_t hash = uint64_t(uint32_t(cube.x)) * 0x9e3779b97f4a7c15ull;
        hash = (hash ^ uint64_t(uint32_t(cube.y))) * 0xbf58476d1ce4e5b9ull;
        hash = (hash ^ uint64_t(uint32_t(cube.z))) * 0x94d049bb133111ebull;
        for (size_t slot = (hash ^ hash >> 29) & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
            if (slots_[slot] == kNone) {
                slots_[slot] = uint32_t(cubes_.size());
                cubes_.push_back(cube);
                return slots_[slot];
            }
            if (cubes_[slots_[slot]] == cube) return slots_[slot];
        }
    }
    size_t count() const { return cubes_.size(); }

private:
    std::vector<uint32_t> slots_;
    std::vector<glm::ivec3> cubes_;
};

/// The triangles with their corners moved to the mean of those in the same cube; what collapses is left out.
std::vector<glm::vec3> clusteredSoup(const Piece& piece, float spacing) {
    CubeNumbers numbers(piece.positions.size());
    std::vector<uint32_t> cluster(piece.positions.size());
    for (size_t p = 0; p < piece.positions.size(); ++p)
        cluster[p] = numbers.of(cubeOf(piece.positions[p], 1 / spacing));
    std::vector<glm::vec3> mean(numbers.count(), glm::vec3(0));
    std::vector<float> members(numbers.count(), 0.0f);
    for (size_t p = 0; p < piece.positions.size(); ++p) {
        mean[cluster[p]] += piece.positions[p];
        members[cluster[p]] += 1;
    }
    for (size_t c = 0; c < mean.size(); ++c) mean[c] /= members[c];
    std::vector<glm::vec3> soup;
    for (const glm::uvec3& t : piece.triangles) {
        const glm::uvec3 c(cluster[t.x], cluster[t.y], cluster[t.z]);
        if (c.x == c.y || c.y == c.z || c.z == c.x) continue;
        for (int k = 0; k < 3; ++k) soup.push_back(mean[c[k]]);
    }
    return soup;
}

std::vector<glm::vec3> plainSoup(const Piece& piece) {
    std::vector<glm::vec3> soup;
    soup.reserve(piece.triangles.size() * 3);
    for (const glm::uvec3& t : piece.triangles) {
        for (int k = 0; k < 3; ++k) soup.push_back(piece.positions[t[k]]);
    }
    return soup;
}

} // namespace

Cells makeCells(const Piece& piece, uint32_t most) {
    const std::vector<TriangleShape> shapes = shapesOf(piece);
    Cells cells;
    uint32_t count = piece.triangleCount();
    float soupSpacing = kSoupSpacing;
    if (double(count) > 1.5 * most) {
        const float spacing = 1.35f * std::sqrt(1.0f / float(most));
        cells.ofTriangle = joinTriangles(piece, shapes, spacing, 0.3f / float(most), count);
        soupSpacing = std::max(soupSpacing, 0.9f * spacing);
    } else {
        cells.ofTriangle.resize(count);
        std::iota(cells.ofTriangle.begin(), cells.ofTriangle.end(), 0u);
    }
    cells.soup = piece.triangleCount() > kPlainSoup ? clusteredSoup(piece, soupSpacing) : plainSoup(piece);
    cells.skin = 0.5f * soupSpacing;
    addShapes(shapes, cells.ofTriangle, count, cells.graph);
    addLinks(piece, cells.ofTriangle, cells.graph);
    addArcs(cells.graph);
    return cells;
}

} // namespace xgc::bake
