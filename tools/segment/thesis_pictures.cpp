#include "part_order.h"

#include <xgc/bake/picture.h>

#include <algorithm>

namespace xgc::bake {

namespace {

const glm::vec3 kGreyTriangles(0.62f);
/// The finest line still leaves a trace between samples.
constexpr float kThinnestLine = 0.35f;
constexpr float kLinePerEdge = 0.16f;

/// Per part a colour of the palette: its own number's, or the next that no lower neighbour has.
std::vector<uint32_t> distinctColors(const Topology& topology, const Segmentation& parts) {
    std::vector<std::pair<uint32_t, uint32_t>> pairs; // a part and a lower neighbour
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        for (size_t i = 0; i < faces.size(); ++i) {
            for (size_t j = 0; j < i; ++j) {
                const auto [low, high] = std::minmax(parts.facePart[faces[i]], parts.facePart[faces[j]]);
                if (low != high) pairs.emplace_back(high, low);
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<uint32_t> colors(parts.partCount());
    std::vector<uint32_t> takenBy(kPartColorCount, kNone); // last part that found the colour beside it
    size_t next = 0;
    for (uint32_t part = 0; part < colors.size(); ++part) {
        for (; next < pairs.size() && pairs[next].first == part; ++next) takenBy[colors[pairs[next].second]] = part;
        colors[part] = part % kPartColorCount;
        for (uint32_t i = 1; i < kPartColorCount && takenBy[colors[part]] == part; ++i)
            colors[part] = (part + i) % kPartColorCount;
    }
    return colors;
}

/// Line width for edges of this mean length: about a sixth of it on the screen.
float lineWidthFor(const Mesh& mesh, const Topology& topology, const PictureOptions& options) {
    glm::dvec3 low(mesh.positions[topology.edges.front().x]), high = low;
    double sum = 0;
    for (const glm::uvec2& e : topology.edges) {
        const glm::dvec3 a(mesh.positions[e.x]), b(mesh.positions[e.y]);
        sum += glm::length(b - a);
        low = glm::min(low, glm::min(a, b));
        high = glm::max(high, glm::max(a, b));
    }
    const double size = glm::length(high - low);
    if (!(size > 0)) return options.lineWidth;
    const double pixels = sum / double(topology.edges.size()) / size * options.height;
    return std::clamp(float(pixels) * kLinePerEdge, kThinnestLine, std::max(kThinnestLine, options.lineWidth));
}

/// Flat edges first, concave last: what matters lies on top.
std::vector<PictureLine> edgeLines(const Mesh& mesh, const Topology& topology, std::span<const EdgeKind> kinds) {
    const std::array<std::pair<EdgeKind, glm::vec3>, 4> passes = {
        {{EdgeKind::flat, glm::vec3(0.36f)},
         {EdgeKind::closed, glm::vec3(0.02f)},
         {EdgeKind::convex, glm::vec3(0.03f, 0.14f, 0.70f)},
         {EdgeKind::concave, glm::vec3(0.78f, 0.02f, 0.02f)}}};
    std::vector<PictureLine> lines;
    for (const auto& [kind, color] : passes) {
        for (uint32_t e = 0; e < topology.edges.size(); ++e) {
            if (kinds[e] != kind) continue;
            lines.push_back({mesh.positions[topology.edges[e].x], mesh.positions[topology.edges[e].y], color});
        }
    }
    return lines;
}

} // namespace

std::vector<glm::vec3> partColors(const Topology& topology, const Segmentation& parts) {
    const std::vector<uint32_t> colorOf = distinctColors(topology, parts);
    std::vector<glm::vec3> colors;
    colors.reserve(parts.facePart.size());
    for (const uint32_t part : parts.facePart) colors.push_back(partColor(colorOf[part]));
    return colors;
}

std::array<Image, 3> drawThesisStages(const Mesh& mesh, const Topology& topology, const ThesisSegmentTrace& trace,
                                      const Segmentation& parts, const PictureOptions& options) {
    PictureOptions edgeOptions = options;
    if (!topology.edges.empty()) edgeOptions.lineWidth = lineWidthFor(mesh, topology, options);
    const std::vector<glm::vec3> grey(mesh.faces.size(), kGreyTriangles);
    const Segmentation regions =
        orderParts(mesh, trace.filledRegions, [](uint32_t, uint32_t) { return std::string(); });
    return {drawPicture(mesh, topology, grey, edgeLines(mesh, topology, trace.edgeKinds), edgeOptions),
            drawPicture(mesh, topology, partColors(topology, regions), {}, options),
            drawPicture(mesh, topology, partColors(topology, parts), {}, options)};
}

} // namespace xgc::bake
