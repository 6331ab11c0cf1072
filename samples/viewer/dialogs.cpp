#include "overlay.h"
#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>

namespace xgc::viewer {
namespace {

constexpr ImGuiWindowFlags kCardFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

/// What to do first.
void buildWelcome(ViewerState& state, const Area& area) {
    ImGui::SetNextWindowPos({area.x + 0.5f * area.width, area.y + 0.46f * area.height}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::Begin("welcome", nullptr, kCardFlags);
    ImGui::TextUnformatted("Drop an .xgc file or a model here,");
    ImGui::TextUnformatted("or begin with a bundled one:");
    ImGui::Dummy({0, 2});
    for (const char* name : kBundledNames) {
        if (name != kBundledNames[0]) ImGui::SameLine();
        if (ImGui::Button(name)) state.askOpen = name;
    }
    ImGui::End();
}

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
    constexpr const char* kTitle = "This did not work";
    if (!ImGui::IsPopupOpen(kTitle)) ImGui::OpenPopup(kTitle);
    const ImVec2 middle = ImGui::GetMainViewport()->GetCenter();
    ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) return;
    ImGui::PushTextWrapPos(32 * ImGui::GetFontSize());
    ImGui::TextUnformatted(state.errors.front().c_str());
    ImGui::PopTextWrapPos();
    ImGui::Dummy({0, 4});
    const bool closed = ImGui::Button("Close", {7 * ImGui::GetFontSize(), 0}) ||
                        ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter)) ||
                        ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    ImGui::SameLine();
    if (ImGui::Button("Copy", {7 * ImGui::GetFontSize(), 0})) ImGui::SetClipboardText(state.errors.front().c_str());
    if (state.errors.size() > 1) {
        ImGui::SameLine();
        ImGui::TextDisabled("and %d more", int(state.errors.size() - 1));
    }
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
        {"[ ]", "half, double the error"},
        {"B, M, X, V", "budget, morph, freeze, split"},
        {"H, P, R", "hide, pin, reset the picked part"},
        {"U, shift + R", "show all parts, reset all"},
        {"F, C", "look at everything, at the picked part"},
        {"Z", "up is y, or z"},
        {"Tab, G, F1 or ?", "panel, graphs, these keys"},
        {"F12", "write a screenshot"},
        {"Escape, control + Q", "let go, leave"},
    };
    const bool fits = area.width > 32 * ImGui::GetFontSize(); // else over the panel, too
    ImGui::SetNextWindowPos({0.5f * (fits ? 2 * area.x + area.width : area.x + area.width), 0.5f * area.height},
                            ImGuiCond_Always, {0.5f, 0.5f});
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x - 20, screen.y - 20});
    ImGui::Begin("keys", nullptr, kCardFlags & ~ImGuiWindowFlags_NoScrollbar);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kAccent), "Mouse and keys");
    ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, {10, 3});
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const auto& [key, what] : kKeys) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key);
            ImGui::TableNextColumn();
            ImGui::TextDisabled("%s", what);
        }
        ImGui::EndTable();
    }
    ImGui::PopStyleVar();
    ImGui::End();
}

} // namespace

void buildDialogs(ViewerState& state, const LoadProgress& progress, bool empty, const Area& area) {
    if (empty && !progress.busy && state.errors.empty()) buildWelcome(state, area);
    buildProgress(state, progress, area);
    buildHelp(state, area);
    buildErrors(state);
}

} // namespace xgc::viewer
