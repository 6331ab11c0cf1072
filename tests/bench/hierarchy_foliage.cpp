#include "asset.h"
#include "sections.h"
#include "surface.h"

#include <xgc/bake/models.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace xgc::bench {
namespace {

constexpr uint32_t kTreeFaces = 50'000; ///< 20 k cards
constexpr double kPixels = 4;           ///< a few
constexpr double kViewPixels = 128;     ///< that the asset's bounding sphere fills in the view

/// A tree's leaves: the faces of one material, and the sphere around all.
struct Foliage {
    Subject subject;
    uint32_t material = 0;
    double diameter = 0;
};

double areaAt(const Foliage& foliage, const bake::Hierarchy& h, uint32_t level, uint32_t& faces) {
    const bake::Mesh& mesh = foliage.subject.mesh;
    const std::vector<uint8_t> levels(h.patchCount(), uint8_t(level));
    const bake::DrawnSurface surface = bake::drawSurface(mesh, h, levels);
    double area = 0;
    faces = 0;
    for (size_t i = 0; i < surface.triangles.size(); ++i) {
        if (mesh.faceMaterial[surface.face[i]] != foliage.material) continue;
        const glm::uvec3 t = surface.triangles[i];
        const auto at = [&](uint32_t wedge) { return glm::dvec3(h.positions[h.wedgePosition[wedge]]); };
        area += glm::length(glm::cross(at(t.y) - at(t.x), at(t.z) - at(t.x))) / 2;
        ++faces;
    }
    return area;
}

bake::Status makeFoliage(Foliage& out) {
    const bake::Model model = bake::makeModel(bake::BundledModel::tree, kTreeFaces);
    if (bake::Status s = bake::weld(model, {}, out.subject.mesh, out.subject.weld); !s.ok()) return s;
    bake::Mesh& mesh = out.subject.mesh;
    out.subject.name = "tree";
    out.subject.topology = bake::buildTopology(mesh);
    out.subject.parts = bake::segmentByMaterial(mesh);
    while (mesh.materials[out.material].name != "leaves") ++out.material;
    glm::vec3 low(mesh.positions.front()), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    for (const glm::vec3& p : mesh.positions)
        out.diameter = std::max(out.diameter, 2 * double(glm::distance(p, (low + high) / 2.0f)));
    return {};
}

} // namespace

int benchFoliage(const Flags& flags) {
    Csv csv(flags, "foliage", "level,faces,leaf_faces,error,error_pixels,area_percent");
    Foliage foliage;
    if (const bake::Status s = makeFoliage(foliage); !s.ok()) {
        fmt::print(stderr, "{}\n", s.message);
        return int(s.outcome);
    }
    const bake::Hierarchy h = build(foliage.subject, foliage.subject.parts);
    const bake::PatchErrors errors = measureErrors(foliage.subject, h);
    fmt::print("{:>5} {:>7} {:>7} {:>9} {:>9} {:>7}\n", "level", "faces", "leaves", "error", "pixels", "area %");
    double whole = 0, least = 100, most = 100;
    const std::vector<uint32_t> faces = uniformFaces(foliage.subject.mesh, h);
    for (uint32_t level = 0; level < h.levelCount; ++level) {
        double error = 0; // of the leaves alone: each patch has a level of its own
        for (uint32_t p = 0; p < h.patchCount(); ++p) {
            if (h.patches[p].material == foliage.material)
                error = std::max(error, double(errors.values[p * h.levelCount + level]));
        }
        const double pixels = error / foliage.diameter * kViewPixels;
        uint32_t leaves = 0;
        const double area = areaAt(foliage, h, level, leaves);
        if (level == 0) whole = area;
        const double percent = 100 * area / whole;
        if (pixels <= kPixels) {
            least = std::min(least, percent);
            most = std::max(most, percent);
        }
        fmt::print("{:>5} {:>7} {:>7} {:>9.5f} {:>9.2f} {:>7.1f}\n", level, faces[level], leaves, error, pixels,
                   percent);
        csv.row(fmt::format("{},{},{},{:.6e},{:.4f},{:.2f}", level, faces[level], leaves, error, pixels, percent));
    }
    fmt::print("leaf area at errors of up to {} pixels where the tree is {} pixels high: {:.1f} to {:.1f} %\n", kPixels,
               kViewPixels, least, most);
    return 0;
}

} // namespace xgc::bench
