#include "overlay.h"
#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>

namespace xgc::viewer {
namespace {

constexpr ImGuiWindowFlags kCardFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

void buildProgress(ViewerState& state, const LoadProgress& progress, const Area& area) {
    if (!progress.busy) return;
    ImGui::SetNextWindowPos({area.x + 0.5f * area.width, area.y + 0.62f * area.height}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::Begin("progress", nullptr, kCardFlags);
    ImGui::TextUnformatted(progress.name.c_str());
    if (progress.waiting > 0) {
        ImGui::SameLine();
        ImGui::TextDisabled("and %d more", int(progress.waiting));
    }
    ImGui::ProgressBar(progress.fraction, {22 * ImGui::GetFontSize(), 0},
                       fmt::format("{}  {:.0f} %", progress.stage, 100 * progress.fraction).c_str());
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) state.askCancelLoad = true;
    tip("Gives up this file and those behind it.");
    ImGui::End();
}

void buildErrors(ViewerState& state) {
    if (state.errors.empty()) return;
    constexpr const char* kTitle = "This file cannot be shown";
    if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
    const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
    ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) return;
    ImGui::PushTextWrapPos(32 * ImGui::GetFontSize());
    ImGui::TextUnformatted(state.errors.front().c_str());
    ImGui::PopTextWrapPos();
    ImGui::Dummy({0, 4});
    const bool closed = ImGui::Button("Close", {7 * ImGui::GetFontSize(), 0}) ||
                        ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter));
    ImGui::SameLine();
    if (ImGui::Button("Copy", {7 * ImGui::GetFontSize(), 0})) ImGui::SetClipboardText(state.errors.front().c_str());
    if (closed) {
        state.errors.erase(state.errors.begin());
        ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
}

void buildHelp(ViewerState& state, const Area& area) {
    if (!state.showHelp) return;
    constexpr std::pair<const char*, const char*> kKeys[] = {
        {"left drag", "orbit"},
        {"shift + drag, middle drag", "pan"},
        {"wheel", "nearer, farther"},
        {"right drag", "look around"},
        {"W A S D Q E", "fly; shift: faster"},
        {"click, double click", "pick a part, look at it"},
        {"1 2 3 4 5", "shaded, parts, levels, wire, error"},
        {"[ ]", "half, double the pixels"},
        {"B, M, X, V", "budget, morph, freeze, split"},
        {"H, P, R", "hide, pin, reset the picked part"},
        {"U, shift + R", "show all parts, reset all"},
        {"F, C", "look at everything, at the picked part"},
        {"Z", "up is y, or z"},
        {"Tab, G, F1", "panel, graphs, these keys"},
        {"F12", "write a screenshot"},
        {"Escape, control + Q", "let go, leave"},
    };
    ImGui::SetNextWindowPos({area.x + 0.5f * area.width, area.y + 0.5f * area.height}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::Begin("keys", nullptr, kCardFlags);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kAccent), "Keys");
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const auto& [key, what] : kKeys) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key);
            ImGui::TableNextColumn();
            ImGui::TextDisabled("%s", what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

} // namespace

void buildDialogs(ViewerState& state, const LoadProgress& progress, const Area& area) {
    buildProgress(state, progress, area);
    buildHelp(state, area);
    buildErrors(state);
}

} // namespace xgc::viewer
