#include "models/surface_net.h"

#include "models/voxels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

// The body is sampled on a lattice, inside or outside. Each cell that sees both gets one vertex, each lattice edge
// that crosses the surface one quad, between the four cells around it:
//
//      o----o----o        o  outside, *  inside
//      |  v-|-v--|-       v  vertex of a mixed cell
//      o--|-*----*
//      |  v |    |        The quads are the walls between inside and outside points, so they form a closed
//      o----*----*        manifold where the points are a well-composed set (Voxels::makeManifold).
//
// Then vertices slide on the true surface until the quads are even.

namespace xgc::bake::models {
namespace {

constexpr int kBlock = 8;

/// Where the field is sampled: the lattice, the bits, and for each block near the surface the blobs that matter.
struct Lattice {
    glm::vec3 origin;
    float step;
    float inflate;
    glm::ivec3 blocks;
    Voxels voxels;
    std::vector<uint32_t> listOf; ///< per block, in lists
    std::vector<BlobList> lists;

    glm::vec3 point(glm::ivec3 p) const { return origin + glm::vec3(p) * step; }
    const BlobList& list(glm::ivec3 cell) const {
        const glm::ivec3 b = cell / kBlock;
        return lists[listOf[(size_t(b.z) * blocks.y + b.y) * blocks.x + b.x]];
    }
};

/// Descends from cubes of blocks to blocks, leaving out what is wholly inside or outside.
class Sampler {
public:
    Sampler(const Body& body, Lattice& lattice) : body_(body), lattice_(lattice) {}

    void descend(glm::ivec3 low, int blocks, const BlobList& list, int depth) {
        if (glm::any(glm::greaterThanEqual(low, lattice_.blocks))) return;
        const float half = 0.5f * float(blocks * kBlock) * lattice_.step;
        const glm::vec3 center = lattice_.point(low * kBlock) + half;
        if (kept_.size() <= size_t(depth)) kept_.resize(depth + 1);
        BlobList kept = std::move(kept_[depth]);
        // Vertices wander up to two cells from where they start.
        const float reach = half * 1.7321f + 3 * lattice_.step;
        const glm::vec2 range = body_.bounds(center, reach, list, kept) - lattice_.inflate;
        if (range.y < 0) {
            const glm::ivec3 high = glm::min((low + blocks) * kBlock, lattice_.voxels.size() - 1);
            lattice_.voxels.fill(glm::max(low * kBlock, glm::ivec3(1)), high);
        } else if (range.x <= 0 && blocks == 1) {
            sample(low, kept);
        } else if (range.x <= 0) {
            const int child = blocks / 2;
            for (int k = 0; k < 8; ++k) {
                descend(low + child * glm::ivec3(k & 1, (k >> 1) & 1, k >> 2), child, kept, depth + 1);
            }
        }
        kept_[depth] = std::move(kept);
    }

private:
    void sample(glm::ivec3 block, const BlobList& list) {
        lattice_.listOf[(size_t(block.z) * lattice_.blocks.y + block.y) * lattice_.blocks.x + block.x] =
            uint32_t(lattice_.lists.size());
        lattice_.lists.push_back(list);
        const glm::ivec3 low = glm::max(block * kBlock, glm::ivec3(1));
        const glm::ivec3 high = glm::min((block + 1) * kBlock, lattice_.voxels.size() - 1);
        for (int z = low.z; z < high.z; ++z) {
            for (int y = low.y; y < high.y; ++y) {
                for (int x = low.x; x < high.x; ++x) {
                    const glm::ivec3 p(x, y, z);
                    if (body_.field(lattice_.point(p), list) < lattice_.inflate) lattice_.voxels.set(p);
                }
            }
        }
    }

    const Body& body_;
    Lattice& lattice_;
    std::vector<BlobList> kept_;
};

Lattice sampleBody(const Body& body, glm::vec3 low, glm::vec3 high, float step, float inflate) {
    const glm::vec3 margin(3 * step + inflate);
    const glm::vec3 extent = high - low + 2.0f * margin;
    const glm::ivec3 blocks = glm::ivec3(extent / (step * float(kBlock))) + 1;
    Lattice lattice{low - margin, step, inflate, blocks, Voxels(blocks * kBlock), {}, {}};
    lattice.listOf.assign(size_t(blocks.x) * blocks.y * blocks.z, 0);
    lattice.lists.push_back(body.all());
    int root = 1;
    while (root < std::max({blocks.x, blocks.y, blocks.z})) root *= 2;
    Sampler(body, lattice).descend(glm::ivec3(0), root, body.all(), 0);
    lattice.voxels.makeManifold();
    return lattice;
}

/// Quads between the mixed cells of a lattice, outward, and the cell of each vertex.
struct Net {
    std::vector<glm::ivec3> cells;
    std::vector<glm::uvec4> quads;
};

class NetBuilder {
public:
    explicit NetBuilder(const Voxels& voxels) : voxels_(voxels), size_(voxels.size()) {}

    Net build() {
        const size_t layer = size_t(size_.x) * size_.y;
        below_.assign(layer, 0);
        here_.assign(layer, 0);
        for (int z = 0; z + 1 < size_.z; ++z) {
            std::swap(below_, here_);
            voxels_.forMixedCells(z, [&](glm::ivec3 c) {
                here_[index(c)] = uint32_t(net_.cells.size());
                net_.cells.push_back(c);
            });
            voxels_.forMixedCells(z, [&](glm::ivec3 c) { addQuads(c); });
        }
        return std::move(net_);
    }

private:
    size_t index(glm::ivec3 c) const { return size_t(c.y) * size_.x + c.x; }

    /// Quads of the three lattice edges that start at a cell's lowest point.
    void addQuads(glm::ivec3 c) {
        const bool inside = voxels_.get(c);
        const size_t i = index(c);
        const auto row = size_t(size_.x);
        if (inside != voxels_.get(c + glm::ivec3(1, 0, 0))) {
            addQuad({below_[i - row], below_[i], here_[i], here_[i - row]}, inside);
        }
        if (inside != voxels_.get(c + glm::ivec3(0, 1, 0))) {
            addQuad({below_[i - 1], here_[i - 1], here_[i], below_[i]}, inside);
        }
        if (inside != voxels_.get(c + glm::ivec3(0, 0, 1))) {
            addQuad({here_[i - row - 1], here_[i - row], here_[i], here_[i - 1]}, inside);
        }
    }

    void addQuad(glm::uvec4 q, bool inside) { net_.quads.push_back(inside ? q : glm::uvec4(q.x, q.w, q.z, q.y)); }

    const Voxels& voxels_;
    glm::ivec3 size_;
    std::vector<uint32_t> below_, here_;
    Net net_;
};

/// Leaves the largest connected piece.
void keepLargestPiece(Net& net) {
    std::vector<uint32_t> root(net.cells.size());
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (const glm::uvec4 q : net.quads) {
        for (int k = 1; k < 4; ++k) {
            const uint32_t a = find(q[0]), b = find(q[k]);
            root[std::max(a, b)] = std::min(a, b);
        }
    }
    std::vector<uint32_t> count(root.size(), 0);
    for (uint32_t v = 0; v < root.size(); ++v) ++count[find(v)];
    const auto largest = uint32_t(std::max_element(count.begin(), count.end()) - count.begin());
    std::vector<uint32_t> renumbered(root.size(), 0);
    uint32_t kept = 0;
    for (uint32_t v = 0; v < root.size(); ++v) {
        if (find(v) != largest) continue;
        net.cells[kept] = net.cells[v];
        renumbered[v] = kept++;
    }
    std::erase_if(net.quads, [&](glm::uvec4 q) { return find(q.x) != largest; });
    net.cells.resize(kept);
    for (glm::uvec4& q : net.quads) {
        for (int k = 0; k < 4; ++k) q[k] = renumbered[q[k]];
    }
}

/// Puts the vertices of a net onto the surface.
class Fitter {
public:
    Fitter(const Body& body, const Lattice& lattice, const Net& net)
        : body_(body), lattice_(lattice), net_(net), positions_(net.cells.size()) {}

    std::vector<glm::vec3> fit() {
        for (size_t v = 0; v < positions_.size(); ++v) {
            positions_[v] = lattice_.point(net_.cells[v]) + 0.5f * lattice_.step;
            for (int k = 0; k < 3; ++k) project(v);
        }
        for (int round = 0; round < 5; ++round) relax();
        for (size_t v = 0; v < positions_.size(); ++v) project(v);
        return std::move(positions_);
    }

private:
    /// One Newton step to the surface, at most a cell long, never far from where the vertex began.
    void project(size_t v) {
        const glm::vec3 a(1, -1, -1), b(-1, -1, 1), c(-1, 1, -1), d(1, 1, 1);
        const BlobList& list = lattice_.list(net_.cells[v]);
        const float step = std::max(0.25f * lattice_.step, 2e-4f);
        const glm::vec3 p = positions_[v];
        const float fa = body_.field(p + a * step, list), fb = body_.field(p + b * step, list);
        const float fc = body_.field(p + c * step, list), fd = body_.field(p + d * step, list);
        const glm::vec3 gradient = (a * fa + b * fb + c * fc + d * fd) / (4 * step);
        const float value = 0.25f * (fa + fb + fc + fd) - lattice_.inflate;
        const float square = std::max(glm::dot(gradient, gradient), 0.1f);
        const float length = std::abs(value) / std::sqrt(square);
        const float share = length > lattice_.step ? lattice_.step / length : 1;
        const glm::vec3 center = lattice_.point(net_.cells[v]) + 0.5f * lattice_.step;
        const glm::vec3 wander(1.25f * lattice_.step);
        positions_[v] = glm::clamp(p - gradient * (value / square * share), center - wander, center + wander);
    }

    void relax() {
        std::vector<glm::vec3> sum(positions_.size(), glm::vec3(0));
        std::vector<float> count(positions_.size(), 0);
        for (const glm::uvec4 q : net_.quads) {
            for (int k = 0; k < 4; ++k) {
                sum[q[k]] += positions_[q[(k + 1) & 3]] + positions_[q[(k + 3) & 3]];
                count[q[k]] += 2;
            }
        }
        for (size_t v = 0; v < positions_.size(); ++v) {
            positions_[v] = glm::mix(positions_[v], sum[v] / count[v], 0.6f);
            project(v);
        }
    }

    const Body& body_;
    const Lattice& lattice_;
    const Net& net_;
    std::vector<glm::vec3> positions_;
};

/// Cuts a quad along its shorter diagonal.
void cutQuad(glm::uvec4 q, const std::vector<glm::vec3>& p, std::vector<glm::uvec3>& out) {
    const glm::vec3 d = p[q.z] - p[q.x], e = p[q.w] - p[q.y];
    if (glm::dot(d, d) <= glm::dot(e, e)) {
        out.emplace_back(q.x, q.y, q.z);
        out.emplace_back(q.x, q.z, q.w);
    } else {
        out.emplace_back(q.x, q.y, q.w);
        out.emplace_back(q.y, q.z, q.w);
    }
}

/// Fattening that lets a lattice see thin limbs.
float inflation(float step) {
    return std::max(0.0f, 0.45f * step - 0.006f);
}

/// A lattice that gives the face count: faces grow with 1 / step^2, so a coarse trial predicts a fine one.
Lattice latticeFor(const Body& body, glm::vec3 low, glm::vec3 high, uint32_t faces) {
    const glm::vec3 extent = high - low;
    float step = std::max({extent.x, extent.y, extent.z}) / 60;
    const uint32_t coarse = std::min(faces, 20000u), middle = std::min(faces, 200000u);
    for (const uint32_t trial : {coarse, coarse, middle, faces, faces}) {
        Lattice lattice = sampleBody(body, low, high, step, inflation(step));
        const float ratio = float(2 * lattice.voxels.countCrossings()) / float(trial);
        if (trial == faces && std::abs(ratio - 1) < 0.03f) return lattice;
        step *= std::sqrt(ratio);
    }
    return sampleBody(body, low, high, step, inflation(step));
}

} // namespace

Surface polygonise(const Body& body, glm::vec3 low, glm::vec3 high, uint32_t faces) {
    const Lattice lattice = latticeFor(body, low, high, faces);
    Net net = NetBuilder(lattice.voxels).build();
    keepLargestPiece(net);

    Surface surface;
    surface.positions = Fitter(body, lattice, net).fit();
    surface.triangles.reserve(2 * net.quads.size());
    for (const glm::uvec4 q : net.quads) cutQuad(q, surface.positions, surface.triangles);
    const float reach = std::max(0.5f * lattice.step, 5e-4f);
    surface.normals.reserve(surface.positions.size());
    surface.skins.reserve(surface.positions.size());
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const BlobList& list = lattice.list(net.cells[v]);
        surface.normals.push_back(body.normal(surface.positions[v], reach, list));
        surface.skins.push_back(body.skin(surface.positions[v], list));
    }
    return surface;
}

} // namespace xgc::bake::models
