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

void drawSplit(ImDrawList& list, const ViewerState& state, const Area& area) {
    const float x = area.x + area.width * state.splitAt, middle = area.y + 0.5f * area.height;
    list.AddLine({x, area.y}, {x, area.y + area.height}, IM_COL32(20, 20, 22, 160), 3);
    list.AddLine({x, area.y}, {x, area.y + area.height}, IM_COL32(255, 255, 255, 230), 1.2f);
    list.AddCircleFilled({x, middle}, 9, IM_COL32(255, 255, 255, 240));
    list.AddTriangleFilled({x - 6, middle}, {x - 2, middle - 4}, {x - 2, middle + 4}, IM_COL32(40, 42, 46, 255));
    list.AddTriangleFilled({x + 6, middle}, {x + 2, middle - 4}, {x + 2, middle + 4}, IM_COL32(40, 42, 46, 255));
    const Measured& m = state.measured;
    const auto words = [](const char* what, uint64_t triangles, float pixels) {
        return fmt::format("{}:  {} triangles, error up to {}", what, grouped(triangles), pixelsText(pixels));
    };
    const std::string left = words("levels by part", m.triangles, m.worstPixels);
    const std::string right = words("one error for all", m.uniformTriangles, m.uniformWorstPixels);
    const float reachLeft = 0.5f * textSize(left).x + 22, reachRight = 0.5f * textSize(right).x + 22;
    label(list, std::max(0.5f * (area.x + x), area.x + reachLeft), area.y + 14, left, kAccent);
    label(list, std::min(0.5f * (x + area.x + area.width), area.x + area.width - reachRight),
          area.y + (area.x + reachLeft * 2 > x || x + reachRight * 2 > area.x + area.width ? 50.0f : 14.0f), right);
}

void drawEmpty(ImDrawList& list, const Area& area) {
    const float x = area.x + 0.5f * area.width, y = area.y + 0.46f * area.height;
    const auto line = [&](float dy, const char* text, ImU32 color) {
        list.AddText({x - 0.5f * ImGui::CalcTextSize(text).x, y + dy}, color, text);
    };
    line(0, "Drop an .xgc file or a model here", IM_COL32(40, 42, 46, 255));
    line(1.6f * ImGui::GetFontSize(), "or press Open ... in the panel for the bundled ones",
         IM_COL32(90, 94, 100, 255));
}

} // namespace

void buildOverlay(const ViewerState& state, bool empty, const Area& area) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect({area.x, area.y}, {area.x + area.width, area.y + area.height});
    if (empty) drawEmpty(list, area);
    if (state.frozen) {
        drawFrustum(list, state, area);
        if (!state.split)
            label(list, area.x + 0.5f * area.width, area.y + 14, "levels are frozen: X thaws them", kAccent);
    }
    if (state.split && !empty) drawSplit(list, state, area);
    if (state.showGraphs && !empty) buildGraphs(state, area);
    ImFont* font = smallFont();
    list.AddText(font, font->FontSize, {area.x + 14, area.y + area.height - 1.9f * font->FontSize},
                 IM_COL32(70, 74, 80, 255),
                 "drag: orbit   shift-drag: pan   wheel: nearer   right-drag: look   WASD: fly   click: pick a part   "
                 "F1: keys");
    list.PopClipRect();
}

} // namespace xgc::viewer
