#include "panel.h"
#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace xgc::viewer {
namespace {

constexpr int kMostBias = 6;

/// Levels that a part is drawn at.
struct Span {
    uint32_t finest = 255, coarsest = 0;
};
Span levelsOf(const Model& model, const DrawnModels& drawn, uint32_t index, uint32_t part) {
    Span out;
    if (index >= drawn.levels.size()) return out;
    const format::PartRecord& record = model.file.view.parts[part];
    for (uint32_t i = record.firstPatch; i < record.firstPatch + record.patchCount; ++i) {
        out.finest = std::min<uint32_t>(out.finest, drawn.levels[index][i]);
        out.coarsest = std::max<uint32_t>(out.coarsest, drawn.levels[index][i]);
    }
    return out;
}

std::string steering(const PartControl& c) {
    std::string out;
    if (c.hidden) out += " hidden";
    if (c.finest == c.coarsest) {
        out += fmt::format(" pinned {}", c.finest);
    } else if (c.bias != 0) {
        out += fmt::format(" {:+d}", c.bias);
    }
    if (c.importance != 1) out += fmt::format(" x{:.2g}", c.importance);
    return out;
}

/// Pin, bias and importance; true where something changed.
bool buildControls(PartControl& control, const Span& now, uint32_t levelCount) {
    bool changed = false;
    const float labels = -ImGui::GetFontSize() * 5.6f;
    bool pinned = control.finest == control.coarsest;
    if (ImGui::Checkbox("##pinned", &pinned)) {
        const uint32_t level = std::min(now.finest, levelCount - 1);
        control.finest = pinned ? level : 0;
        control.coarsest = pinned ? level : format::kMaxLevels;
        changed = true;
    }
    tip("P: keep the part at one level, whatever the view.");
    ImGui::SameLine();
    ImGui::BeginDisabled(!pinned);
    ImGui::SetNextItemWidth(labels);
    int level = pinned ? int(control.finest) : int(std::min(now.finest, levelCount - 1));
    if (ImGui::SliderInt("pin", &level, 0, int(levelCount) - 1, "level %d")) {
        control.finest = control.coarsest = uint32_t(level);
        changed = true;
    }
    ImGui::EndDisabled();
    ImGui::SetNextItemWidth(labels);
    changed |= ImGui::SliderInt("bias", &control.bias, -kMostBias, kMostBias, "%+d levels");
    tip("Levels added to the policy's choice: right is coarser.");
    ImGui::SetNextItemWidth(labels);
    changed |= ImGui::SliderFloat("importance", &control.importance, 0.125f, 8, "x %.2f", ImGuiSliderFlags_Logarithmic);
    tip("The part's error counts so many times: 2 asks for half the error.");
    return changed;
}

void buildPicked(ViewerState& state, Models& models, const DrawnModels& drawn) {
    caption("PICKED PART");
    if (!state.selected) {
        ImGui::PushFont(smallFont());
        ImGui::TextDisabled("Click a part to steer it.");
        ImGui::PopFont();
        return;
    }
    const PartName name = *state.selected;
    Model& model = *models.all()[name.model];
    PartControl& control = model.controls[name.part];
    const Span now = levelsOf(model, drawn, name.model, name.part);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kAccent), "%s", model.partName(name.part).c_str());
    ImGui::PushFont(smallFont());
    const format::PartRecord& record = model.file.view.parts[name.part];
    ImGui::TextDisabled("%s", fmt::format("{}, {}, at {}", counted(record.faceCount, "triangle", "triangles"),
                                          counted(record.patchCount, "patch", "patches"),
                                          now.finest == now.coarsest
                                              ? fmt::format("level {}", now.finest)
                                              : fmt::format("levels {} to {}", now.finest, now.coarsest))
                                  .c_str());
    ImGui::PopFont();
    bool changed = buildControls(control, now, model.file.view.levelCount());
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    const float width = (ImGui::GetContentRegionAvail().x - 2 * gap) / 3;
    if (toggleButton(control.hidden ? "Hidden" : "Hide", control.hidden, width)) {
        control.hidden = !control.hidden;
        changed = true;
    }
    tip("H: draw the part no more, or again.");
    ImGui::SameLine(0, gap);
    if (ImGui::Button("Reset", {width, 0})) {
        control = {};
        changed = true;
    }
    tip("R: give the part back to the policy. Shift+R: all parts.");
    ImGui::SameLine(0, gap);
    if (ImGui::Button("Look at", {width, 0})) state.askFocus = true;
    tip("C: bring the part to the middle. A double click on it does so, too.");
    if (changed) state.changedParts.push_back(name);
}

bool matches(const std::string& name, const std::string& filter) {
    const auto same = [](char a, char b) { return std::tolower(uint8_t(a)) == std::tolower(uint8_t(b)); };
    return std::search(name.begin(), name.end(), filter.begin(), filter.end(), same) != name.end();
}

/// A line of the list: a swatch in the colour of its level, its name, and how it is steered.
void buildRow(ViewerState& state, const Model& model, const DrawnModels& drawn, const PartName& name) {
    const PartControl& control = model.controls[name.part];
    const Span now = levelsOf(model, drawn, name.model, name.part);
    const float coarsest = float(std::max(model.file.view.levelCount(), 2u) - 1);
    const float size = ImGui::GetTextLineHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool picked = state.selected && state.selected->model == name.model && state.selected->part == name.part;
    if (picked && std::exchange(state.showPickedRow, false)) ImGui::SetScrollHereY();
    if (ImGui::Selectable("##row", picked, ImGuiSelectableFlags_AllowDoubleClick)) {
        state.selected = name;
        if (ImGui::IsMouseDoubleClicked(0)) state.askFocus = true;
    }
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 low{at.x + 2, at.y + 0.2f * size}, high{at.x + 2 + 0.6f * size, at.y + 0.8f * size};
    if (control.hidden) {
        list->AddRect(low, high, kMuted, 2);
    } else {
        list->AddRectFilled(low, high, levelColor(float(now.finest) / coarsest), 2);
    }
    list->AddText({at.x + 1.1f * size, at.y}, control.hidden ? kMuted : kInk, model.partName(name.part).c_str());
    const std::string word = steering(control);
    const ImVec2 extent = ImGui::CalcTextSize(word.c_str());
    list->AddText({at.x + ImGui::GetContentRegionAvail().x - extent.x - 4, at.y}, kAccent, word.c_str());
}

} // namespace

void buildParts(ViewerState& state, Models& models, const DrawnModels& drawn) {
    if (models.all().empty()) return;
    buildPicked(state, models, drawn);
    caption("PARTS");
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##filter", "filter by name", &state.partFilter);
    tip("Shows the parts whose names have these letters.");
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {4, 3});
    ImGui::BeginChild("parts", {0, 0}, false);
    for (uint32_t m = 0; m < models.all().size(); ++m) {
        const Model& model = *models.all()[m];
        if (models.all().size() > 1) ImGui::TextDisabled("%s", model.file.name.c_str());
        for (uint32_t part = 0; part < model.controls.size(); ++part) {
            if (!matches(model.partName(part), state.partFilter)) continue;
            ImGui::PushID(int(m * 65536 + part));
            buildRow(state, model, drawn, {m, part});
            ImGui::PopID();
        }
    }
    ImGui::EndChild();
    ImGui::PopStyleVar();
}

} // namespace xgc::viewer
