#include "picture/text.h"

#include <xgc/bake/evaluate_pictures.h>
#include <xgc/bake/picture.h>
#include <xgc/bake/segmentation_metrics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace xgc::bake {

namespace {

constexpr glm::u8vec4 kInk(50, 54, 60, 255);
constexpr glm::u8vec4 kPaper(246, 247, 248, 255);
constexpr float kContourWidth = 1.6f; // pixels

double commonArea(const std::vector<double>& table, size_t columns, uint32_t row, uint32_t column) {
    return table[row * columns + column];
}

/// For each part the part of `reference` whose colour it takes; numbers past those of `reference` for parts without a
/// counterpart.
std::vector<uint32_t> matchParts(const MetricSurface& surface, const Mesh& mesh, const Segmentation& reference,
                                 const Segmentation& parts) {
    const size_t columns = parts.partCount();
    std::vector<double> table(reference.partCount() * columns, 0.0);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        table[reference.facePart[f] * columns + parts.facePart[f]] += surface.faceArea[mesh.faceInput[f]];
    }
    std::vector<std::pair<uint32_t, uint32_t>> pairs; // reference, part
    for (uint32_t r = 0; r < reference.partCount(); ++r) {
        for (uint32_t p = 0; p < columns; ++p) {
            if (commonArea(table, columns, r, p) > 0) pairs.emplace_back(r, p);
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) {
        return commonArea(table, columns, a.first, a.second) > commonArea(table, columns, b.first, b.second);
    });
    std::vector<uint32_t> matched(columns, kNone);
    std::vector<bool> taken(reference.partCount(), false);
    for (const auto& [r, p] : pairs) {
        if (taken[r] || matched[p] != kNone) continue;
        matched[p] = r;
        taken[r] = true;
    }
    uint32_t next = reference.partCount();
    for (uint32_t& m : matched) m = m == kNone ? next++ : m;
    return matched;
}

/// Dark lines between parts.
std::vector<PictureLine> contours(const Mesh& mesh, const Topology& topology, const Segmentation& parts) {
    std::vector<PictureLine> lines;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        if (faces.size() < 2 || parts.facePart[faces[0]] == parts.facePart[faces[1]]) continue;
        lines.push_back({mesh.positions[topology.edges[e].x], mesh.positions[topology.edges[e].y], glm::vec3(0.02f)});
    }
    return lines;
}

struct View {
    glm::vec3 from, up;
};

/// The view from the front, from the side or from above in which most of the surface lies across the line of sight;
/// the front unless another is clearly better. The benchmark's models stand or lie in any way.
View bestView(const Mesh& mesh) {
    constexpr std::array<View, 3> kViews = {
        {{{0.45f, 0.3f, 1}, {0, 1, 0}}, {{1, 0.3f, 0.45f}, {0, 1, 0}}, {{0.3f, 1, 0.35f}, {0, 0, 1}}}};
    constexpr std::array<double, 3> kPreference = {1.305, 1, 1};
    size_t best = 0;
    double bestArea = 0;
    for (size_t v = 0; v < kViews.size(); ++v) {
        double area = 0;
        const glm::dvec3 toEye = glm::normalize(glm::dvec3(kViews[v].from));
        for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
            const glm::uvec3 c = mesh.facePositions(f);
            const glm::dvec3 a(mesh.positions[c.x]), b(mesh.positions[c.y]), d(mesh.positions[c.z]);
            area += std::abs(glm::dot(toEye, glm::cross(b - a, d - a)));
        }
        if (area * kPreference[v] <= bestArea) continue;
        bestArea = area * kPreference[v];
        best = v;
    }
    return kViews[best];
}

void paste(const Image& from, uint32_t x, uint32_t y, Image& to) {
    for (uint32_t row = 0; row < from.height; ++row) {
        std::copy_n(from.pixels.begin() + std::ptrdiff_t(size_t(row) * from.width), from.width,
                    to.pixels.begin() + std::ptrdiff_t(size_t(y + row) * to.width + x));
    }
}

Image blank(uint32_t width, uint32_t height) {
    return {width, height, std::vector<glm::u8vec4>(size_t(width) * height, kPaper)};
}

} // namespace

Image drawPartsRow(const PsbModel& model, const std::string& title, std::span<const CaptionedLabels> labelings,
                   uint32_t size) {
    const uint32_t scale = std::max(1u, size / 200);
    const uint32_t gap = 3 * scale;
    Image row = blank(size * uint32_t(labelings.size()), size + textHeight(scale) + gap);
    const MetricSurface surface = prepareSurface(model.mesh, model.topology);
    PictureOptions options;
    options.width = options.height = size;
    options.lineWidth = kContourWidth * float(size) / 400;
    const View view = bestView(model.mesh);
    options.viewFrom = view.from;
    options.up = view.up;
    Segmentation reference;
    for (uint32_t i = 0; i < labelings.size(); ++i) {
        const Segmentation parts = segmentByLabels(model.mesh, labelings[i].labels);
        if (i == 0) reference = parts;
        const std::vector<uint32_t> colorOf = matchParts(surface, model.mesh, reference, parts);
        std::vector<glm::vec3> colors;
        for (const uint32_t part : parts.facePart) colors.push_back(partColor(colorOf[part]));
        const std::vector<PictureLine> lines = contours(model.mesh, model.topology, parts);
        paste(drawPicture(model.mesh, model.topology, colors, lines, options), i * size, 0, row);
        const uint32_t width = textWidth(labelings[i].caption, scale);
        drawText(row, i * size + (size - std::min(size, width)) / 2, size + gap, labelings[i].caption, kInk, scale);
    }
    drawText(row, gap, gap, title, kInk, scale);
    return row;
}

std::vector<uint32_t> typicalPeople(const PsbModel& model, uint32_t count) {
    const MetricSurface surface = prepareSurface(model.mesh, model.topology);
    std::vector<MetricLabels> people;
    for (const std::vector<uint32_t>& labels : model.people) people.push_back(prepareLabels(surface, labels));
    std::vector<double> error(people.size(), 0.0);
    for (size_t i = 0; i < people.size(); ++i) {
        for (size_t j = 0; j < people.size(); ++j) error[i] += compareLabels(surface, people[i], people[j]).randIndex;
    }
    std::vector<uint32_t> order(people.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return error[a] < error[b]; });
    order.resize(std::min<size_t>(order.size(), count));
    return order;
}

Image contactSheet(std::span<const Image> images, uint32_t columns) {
    uint32_t width = 0, height = 0;
    for (const Image& image : images) {
        width = std::max(width, image.width);
        height = std::max(height, image.height);
    }
    columns = std::clamp(columns, 1u, std::max(1u, uint32_t(images.size())));
    const auto rows = (uint32_t(images.size()) + columns - 1) / columns;
    Image sheet = blank(width * columns, height * rows);
    for (uint32_t i = 0; i < images.size(); ++i) paste(images[i], i % columns * width, i / columns * height, sheet);
    return sheet;
}

} // namespace xgc::bake
