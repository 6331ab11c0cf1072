#include "overlay.h"
#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace xgc::viewer {
namespace {

struct Look {
    const char* name;
    ImU32 color;
};

/// A filled curve under its name and latest value; the newest at the right.
template <typename Values>
void graph(ImDrawList& list, const ImVec2& at, const ImVec2& size, const Look& look, const Values& values,
           const std::string& latest) {
    ImFont* font = smallFont();
    const float text = font->FontSize;
    list.AddText(font, text, at, kMuted, look.name);
    const float end = font->CalcTextSizeA(text, 1e9f, 0, latest.c_str()).x;
    list.AddText(font, text, {at.x + size.x - end, at.y}, kInk, latest.c_str());
    const float top = at.y + 1.3f * text, bottom = at.y + size.y;
    const float ceiling = niceCeiling(values.largest());
    list.AddLine({at.x, bottom}, {at.x + size.x, bottom}, kCardLine);
    if (values.count() < 2) return;
    const float step = size.x / 239;
    std::vector<ImVec2> points;
    for (uint32_t i = 0; i < values.count(); ++i) {
        const float x = at.x + size.x - step * float(values.count() - 1 - i);
        points.push_back({x, bottom - (bottom - top) * std::min(values.at(i) / ceiling, 1.0f)});
    }
    const ImU32 fill = (look.color & 0x00ffffffu) | 0x38000000u;
    const ImDrawListFlags flags = list.Flags;
    list.Flags &= ~ImDrawListFlags_AntiAliasedFill; // or seams show between the columns
    for (size_t i = 0; i + 1 < points.size(); ++i) {
        list.AddQuadFilled(points[i], points[i + 1], {points[i + 1].x, bottom}, {points[i].x, bottom}, fill);
    }
    list.Flags = flags;
    list.AddPolyline(points.data(), int(points.size()), look.color, 0, 1.3f);
}

} // namespace

float buildGraphs(const ViewerState& state, const Area& area) {
    const float unit = smallFont()->FontSize;
    const ImVec2 size{16 * unit, 3 * unit};
    const float pad = 0.9f * unit, gap = 0.7f * unit;
    const ImVec2 card{size.x + 2 * pad, 4 * size.y + 3 * gap + 2 * pad};
    if (area.width < 2 * card.x || area.height < 1.3f * card.y) return 0;
    const ImVec2 low{area.x + area.width - card.x - unit, area.y + area.height - card.y - unit};
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled(low, {low.x + card.x, low.y + card.y}, kCard, 6);
    const Measured& m = state.measured;
    ImVec2 at{low.x + pad, low.y + pad};
    const auto next = [&] { at.y += size.y + gap; };
    graph(list, at, size, {"triangles", IM_COL32(255, 150, 56, 255)}, m.trianglesHistory, grouped(m.triangles));
    next();
    graph(list, at, size, {"uploaded a frame", IM_COL32(91, 143, 203, 255)}, m.uploadHistory,
          bytesText(double(m.uploadHistory.latest())));
    next();
    graph(list, at, size, {"patches that changed level", IM_COL32(141, 191, 103, 255)}, m.changesHistory,
          grouped(uint64_t(m.changesHistory.latest())));
    next();
    graph(list, at, size, {"frame, selection", IM_COL32(154, 127, 196, 255)}, m.frameHistory,
          fmt::format("{:.1f} ms, {:.2f} ms", m.frameHistory.latest(), m.selectHistory.latest()));
    return card.x + unit;
}

} // namespace xgc::viewer
