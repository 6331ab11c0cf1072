#include "bake/layout.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace xgc::bake::layout {
namespace {

/// An edge over positions and the part of one face at it.
using EdgePart = std::array<uint32_t, 3>;

std::vector<EdgePart> edgeParts(const Mesh& mesh, const Segmentation& parts) {
    std::vector<EdgePart> edges;
    edges.reserve(3 * mesh.faces.size());
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(p[k], p[(k + 1) % 3]);
            edges.push_back({a, b, parts.facePart[f]});
        }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

/// An edge that two parts share.
struct Border {
    uint32_t part, other;
    double length;
};

/// By part and other, the edges between two parts in one order for both.
std::vector<Border> bordersOf(const Mesh& mesh, const Segmentation& parts) {
    const std::vector<EdgePart> edges = edgeParts(mesh, parts);
    std::vector<Border> borders;
    for (size_t i = 0; i < edges.size(); ++i) {
        for (size_t j = i + 1; j < edges.size() && edges[j][0] == edges[i][0] && edges[j][1] == edges[i][1]; ++j) {
            const glm::dvec3 d = glm::dvec3(mesh.positions[edges[i][1]]) - glm::dvec3(mesh.positions[edges[i][0]]);
            const double length = std::sqrt(glm::dot(d, d));
            borders.push_back({edges[i][2], edges[j][2], length});
            borders.push_back({edges[j][2], edges[i][2], length});
        }
    }
    std::stable_sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) {
        return a.part != b.part ? a.part < b.part : a.other < b.other;
    });
    return borders;
}

void findNeighbours(const Mesh& mesh, const Segmentation& parts, std::vector<PartFigures>& figures) {
    const std::vector<Border> borders = bordersOf(mesh, parts);
    for (size_t i = 0, j = 0; i < borders.size(); i = j) {
        double length = 0;
        for (; j < borders.size() && borders[j].part == borders[i].part && borders[j].other == borders[i].other; ++j)
            length += borders[j].length;
        figures[borders[i].part].neighbours.push_back(borders[i].other);
        figures[borders[i].part].contours.push_back(float(length));
    }
}

} // namespace

std::vector<PartFigures> measureParts(const Mesh& mesh, const Segmentation& parts) {
    std::vector<PartFigures> figures(parts.partCount());
    std::vector<glm::dvec3> plain(parts.partCount(), glm::dvec3(0)); // means of parts without area
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        const glm::uvec3 p = mesh.facePositions(f);
        const glm::dvec3 a(mesh.positions[p.x]), b(mesh.positions[p.y]), c(mesh.positions[p.z]);
        const glm::dvec3 n = glm::cross(b - a, c - a);
        const double area = std::sqrt(glm::dot(n, n)) / 2;
        PartFigures& part = figures[parts.facePart[f]];
        ++part.faceCount;
        part.area += area;
        part.centroid += area * (a + b + c) / 3.0;
        plain[parts.facePart[f]] += (a + b + c) / 3.0;
    }
    for (size_t i = 0; i < figures.size(); ++i) {
        PartFigures& part = figures[i];
        if (part.area > 0)
            part.centroid /= part.area;
        else if (part.faceCount > 0)
            part.centroid = plain[i] / double(part.faceCount);
    }
    findNeighbours(mesh, parts, figures);
    return figures;
}

} // namespace xgc::bake::layout
