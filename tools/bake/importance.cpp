#include "importance.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace xgc::bake {
namespace {

/// By name, else by number; kNone.
uint32_t findPart(const Segmentation& parts, const std::string& name) {
    const auto named = std::find(parts.partNames.begin(), parts.partNames.end(), name);
    if (named != parts.partNames.end()) return uint32_t(named - parts.partNames.begin());
    uint32_t number = kNone;
    const char* end = name.data() + name.size();
    const auto [last, error] = std::from_chars(name.data(), end, number);
    return error == std::errc() && last == end && number < parts.partCount() ? number : kNone;
}

Status weighParts(const BakeOptions& options, const Segmentation& parts, HierarchyOptions& out) {
    if (options.importance.empty()) return {};
    out.partImportance.assign(parts.partCount(), 1);
    for (const PartImportance& i : options.importance) {
        const uint32_t part = findPart(parts, i.part);
        if (part == kNone) {
            return usageError(
                fmt::format("{}: no part '{}': its {} parts are numbered from 0; `xgc segment` lists them",
                            options.input.string(), i.part, parts.partCount()));
        }
        if (!(i.factor > 0)) {
            return usageError(fmt::format("importance of part '{}': {} is not positive", i.part, i.factor));
        }
        out.partImportance[part] = i.factor;
    }
    return {};
}

Status weighVertices(const BakeOptions& options, const Mesh& mesh, HierarchyOptions& out) {
    if (options.importanceChannel < 0) return {};
    const auto& colors = mesh.attributes.colors[0];
    if (colors.empty()) {
        return badInput(
            fmt::format("{}: no vertex colours to read importance from; paint them, or leave the option out",
                        options.input.string()));
    }
    out.vertexImportance.assign(mesh.positions.size(), 1);
    for (size_t w = 0; w < colors.size(); ++w) {
        const float c = std::clamp(float(colors[w][options.importanceChannel]), 0.0f, 1.0f);
        const float factor = c < 1 ? 1 / (1 - c) : std::numeric_limits<float>::infinity();
        float& importance = out.vertexImportance[mesh.wedgePosition[w]];
        importance = std::max(importance, factor);
    }
    return {};
}

} // namespace

Status findImportances(const BakeOptions& options, const Mesh& mesh, const Segmentation& parts, HierarchyOptions& out) {
    if (Status s = weighParts(options, parts, out); !s.ok()) return s;
    return weighVertices(options, mesh, out);
}

} // namespace xgc::bake
