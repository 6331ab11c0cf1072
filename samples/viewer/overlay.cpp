#include "overlay.h"

#include "frustum_lines.h"
#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>

namespace xgc::viewer {
namespace {

ImVec2 textSize(const std::string& text) {
    return ImGui::CalcTextSize(text.c_str());
}

/// A line of text on a card; `x` is its middle.
void label(ImDrawList& list, float x, float y, const std::string& text, ImU32 color = kInk) {
    const ImVec2 size = textSize(text);
    const ImVec2 pad{10, 5};
    const ImVec2 low{x - 0.5f * size.x - pad.x, y};
    list.AddRectFilled(low, {low.x + size.x + 2 * pad.x, y + size.y + 2 * pad.y}, kCard, 5);
    list.AddText({low.x + pad.x, y + pad.y}, color, text.c_str());
}

void drawFrustum(ImDrawList& list, const ViewerState& state, const Area& area) {
    const vulkan::Camera camera = state.camera.camera(area.aspect());
    const float distance = glm::distance(state.frozen->eye, state.frozen->target);
    const auto draw = [&](float depth, ImU32 color, float width) {
        for (const Line& line : frustumLines(camera, *state.frozen, depth)) {
            const ImVec2 from{area.x + area.width * line.from.x, area.y + area.height * line.from.y};
            const ImVec2 to{area.x + area.width * line.to.x, area.y + area.height * line.to.y};
            list.AddLine(from, to, IM_COL32(20, 20, 22, 70), width + 2);
            list.AddLine(from, to, color, width);
        }
    };
    draw(1.5f * distance, IM_COL32(255, 150, 56, 110), 1); // how far it sees is not bounded: about the models
    draw(0.18f * distance, kAccent, 2);                    // the camera
}

/// What one side of a split view draws.
struct Side {
    const char* name;
    uint64_t triangles;
    float pixels;
    ImU32 color;
};

/// In the middle between two places, in as many words as there is room for.
void sideLabel(ImDrawList& list, float from, float to, float y, const Side& side) {
    const std::string triangles = grouped(side.triangles), pixels = pixelsText(side.pixels);
    for (const std::string& text : {fmt::format("{}:  {} triangles, error up to {}", side.name, triangles, pixels),
                                    fmt::format("{}:  {} triangles, {}", side.name, triangles, pixels),
                                    fmt::format("{} triangles, {}", triangles, pixels), triangles}) {
        if (textSize(text).x + 40 > to - from) continue;
        label(list, 0.5f * (from + to), y, text, side.color);
        return;
    }
}

void drawSplit(ImDrawList& list, const ViewerState& state, const Area& area) {
    const float x = area.x + area.width * state.splitAt, middle = area.y + 0.5f * area.height;
    list.AddLine({x, area.y}, {x, area.y + area.height}, IM_COL32(20, 20, 22, 160), 3);
    list.AddLine({x, area.y}, {x, area.y + area.height}, IM_COL32(255, 255, 255, 230), 1.2f);
    list.AddCircleFilled({x, middle}, 9, IM_COL32(255, 255, 255, 240));
    list.AddTriangleFilled({x - 6, middle}, {x - 2, middle - 4}, {x - 2, middle + 4}, IM_COL32(40, 42, 46, 255));
    list.AddTriangleFilled({x + 6, middle}, {x + 2, middle - 4}, {x + 2, middle + 4}, IM_COL32(40, 42, 46, 255));
    const Measured& m = state.measured;
    sideLabel(list, area.x, x, area.y + 14, {"levels by part", m.triangles, m.worstPixels, kAccent});
    sideLabel(list, x, area.x + area.width, area.y + 14,
              {"one error for all", m.uniformTriangles, m.uniformWorstPixels, kInk});
}

/// What to do with the mouse, as far as there is room to say it.
void drawHint(ImDrawList& list, const Area& area, float width) {
    ImFont* font = smallFont();
    const float size = font->FontSize;
    for (const char* words : {"drag: orbit   shift-drag: pan   wheel: nearer   right-drag: look   WASD: fly   "
                              "click: pick a part   F1: keys",
                              "drag: orbit   wheel: nearer   F1: keys"}) {
        if (font->CalcTextSizeA(size, 1e9f, 0, words).x + 28 > width) continue;
        list.AddText(font, size, {area.x + 14, area.y + area.height - 1.9f * size}, IM_COL32(70, 74, 80, 255), words);
        return;
    }
}

} // namespace

void buildOverlay(const ViewerState& state, bool empty, const Area& area) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({area.x, area.y}, {area.x + area.width, area.y + area.height});
    if (!empty) {
        if (state.frozen) drawFrustum(list, state, area);
        if (state.split) drawSplit(list, state, area);
        if (state.frozen) {
            const float y = area.y + 14 + (state.split ? ImGui::GetFontSize() + 20 : 0);
            label(list, area.x + 0.5f * area.width, y, "levels are frozen: X thaws them", kAccent);
        }
    }
    const float graphs = !empty && state.showGraphs ? buildGraphs(state, area) : 0;
    drawHint(list, area, area.width - graphs);
    if (state.noticeSeconds > 0)
        label(list, area.x + 0.5f * area.width, area.y + area.height - 4 * ImGui::GetFontSize(), state.notice);
    list.PopClipRect();
}

} // namespace xgc::viewer
