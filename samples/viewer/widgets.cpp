#include "widgets.h"

#include "theme.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace xgc::viewer {
namespace {

ImU32 ramp(std::span<const uint32_t> stops, float place) {
    const float x = std::clamp(place, 0.0f, 1.0f) * float(stops.size() - 1);
    const auto i = std::min(size_t(x), stops.size() - 2);
    const auto channel = [&](int shift) {
        const float a = float((stops[i] >> shift) & 255u), b = float((stops[i + 1] >> shift) & 255u);
        return int(a + (b - a) * (x - float(i)) + 0.5f);
    };
    return IM_COL32(channel(16), channel(8), channel(0), 255);
}

} // namespace

std::string grouped(uint64_t number) {
    const std::string digits = std::to_string(number);
    std::string out;
    for (size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) out += ',';
        out += digits[i];
    }
    return out;
}

std::string counted(uint64_t number, const char* one, const char* many) {
    return grouped(number) + " " + (number == 1 ? one : many);
}

std::string pixelsText(float pixels) {
    if (pixels > 0 && pixels < 0.01f) return "under 0.01 px";
    if (pixels < 10) return fmt::format("{:.2g} px", pixels);
    constexpr float kMost = 1e6f;
    return (pixels > kMost ? "over " : "") + grouped(uint64_t(std::min(pixels, kMost) + 0.5f)) + " px";
}

std::string bytesText(double bytes) {
    if (bytes < 1024) return fmt::format("{:.0f} B", bytes);
    if (bytes < 1024 * 1024) return fmt::format("{:.1f} KiB", bytes / 1024);
    return fmt::format("{:.1f} MiB", bytes / (1024 * 1024));
}

void tip(const char* text) {
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void caption(const char* text) {
    ImGui::Dummy({0, 3});
    ImGui::PushFont(smallFont());
    ImGui::PushStyleColor(ImGuiCol_Text, kMuted);
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
    ImGui::PopFont();
}

bool toggleButton(const char* label, bool on, float width) {
    if (on) {
        ImGui::PushStyleColor(ImGuiCol_Button, IM_COL32(255, 150, 56, 255));
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, IM_COL32(255, 168, 86, 255));
        ImGui::PushStyleColor(ImGuiCol_ButtonActive, IM_COL32(255, 178, 102, 255));
        ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(30, 22, 14, 255));
    }
    const bool pressed = ImGui::Button(label, {width, 0});
    if (on) ImGui::PopStyleColor(4);
    return pressed;
}

ImU32 levelColor(float fraction) {
    constexpr uint32_t kStops[] = {0x5560C4, 0x4378CC, 0x3A8DC4, 0x37A6BA, 0x4BBBA0,
                                   0x79CC7F, 0xADD864, 0xDDE05E, 0xFFEFA0};
    return ramp(kStops, std::sqrt(std::clamp(fraction, 0.0f, 1.0f)));
}

ImU32 heatColor(float budgets) {
    constexpr uint32_t kStops[] = {0x2C3566, 0x5A4A94, 0x9D4F95, 0xD6617A, 0xF28A55, 0xF9BF4A};
    return budgets > 1.001f ? IM_COL32_WHITE : ramp(kStops, budgets);
}

void legend(ImU32 (*colorAt)(float), const char* low, const char* high) {
    constexpr int kSteps = 48;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = 0.5f * ImGui::GetFontSize();
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (int i = 0; i < kSteps; ++i) {
        const float x0 = at.x + width * float(i) / kSteps, x1 = at.x + width * float(i + 1) / kSteps;
        list->AddRectFilled({x0, at.y}, {x1, at.y + height}, colorAt((float(i) + 0.5f) / kSteps));
    }
    ImGui::Dummy({width, height});
    ImGui::PushFont(smallFont());
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kMuted), "%s", low);
    const float end = ImGui::CalcTextSize(high).x;
    ImGui::SameLine(ImGui::GetCursorPosX() + width - end);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kMuted), "%s", high);
    ImGui::PopFont();
}

} // namespace xgc::viewer
