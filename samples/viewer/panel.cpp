#include "panel.h"

#include "theme.h"
#include "widgets.h"

#include <fmt/format.h>
#include <imgui_stdlib.h>

#include <algorithm>

namespace xgc::viewer {
namespace {

void buildOpen(ViewerState& state) {
    if (ImGui::Button("Open ...", {-1, 0})) ImGui::OpenPopup("open");
    tip("Open another model beside these. Files can be dropped into the window, too.");
    ImGui::SetNextWindowPos({ImGui::GetItemRectMin().x, ImGui::GetItemRectMax().y + 4});
    if (!ImGui::BeginPopup("open")) return;
    static std::string path;
    ImGui::TextUnformatted("A file: .xgc, or a model to bake (glTF, OBJ, PLY, ...)");
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 22);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    bool open = ImGui::InputText("##path", &path, ImGuiInputTextFlags_EnterReturnsTrue);
    ImGui::SameLine();
    open |= ImGui::Button("Open");
    if (open && !path.empty()) {
        state.askOpen = path;
        ImGui::CloseCurrentPopup();
    }
    caption("OR A BUNDLED ONE");
    for (const char* name : kBundledNames) {
        if (ImGui::Selectable(name)) state.askOpen = name;
    }
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void buildModels(ViewerState& state, const Models& models) {
    caption("MODELS");
    for (uint32_t i = 0; i < models.all().size(); ++i) {
        const LoadedFile& file = models.all()[i]->file;
        ImGui::PushID(int(i));
        ImGui::TextUnformatted(file.name.c_str());
        ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(" x ").x -
                        2 * ImGui::GetStyle().FramePadding.x);
        if (ImGui::SmallButton(" x ")) state.askClose = i;
        tip("Close this model.");
        ImGui::PushFont(smallFont());
        ImGui::TextDisabled("%s",
                            fmt::format("{}, {}, {}", counted(file.view.record->faceCount, "triangle", "triangles"),
                                        counted(file.view.parts.size(), "part", "parts"),
                                        counted(file.view.levelCount(), "level", "levels"))
                                .c_str());
        ImGui::PopFont();
        tip(fmt::format("{}, {} in memory{}", counted(file.view.patchCount(), "patch", "patches"),
                        bytesText(double(file.bytes.size)),
                        file.baked ? ", baked here with the defaults of xgc bake" : "")
                .c_str());
        ImGui::PopID();
    }
    buildOpen(state);
}

void buildColours(ViewerState& state) {
    struct Mode {
        const char* label;
        const char* tip;
    };
    constexpr Mode kModes[] = {{"Shaded", "1: the model's own materials under studio light"},
                               {"Parts", "2: a colour for each part, unlike its neighbours'"},
                               {"Levels", "3: from fine (blue) to coarse (yellow)"},
                               {"Wire", "4: the triangles' edges"},
                               {"Error", "5: how much of the allowed error each patch takes; white is past it"}};
    caption("COLOUR BY");
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x * 0.5f;
    float spare = ImGui::GetContentRegionAvail().x - 4 * gap;
    for (const Mode& mode : kModes) spare -= ImGui::CalcTextSize(mode.label).x;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, ImGui::GetStyle().FramePadding.y});
    for (uint32_t i = 0; i < 5; ++i) {
        if (i > 0) ImGui::SameLine(0, gap);
        const auto mode = vulkan::ShadingMode(i);
        const float width = ImGui::CalcTextSize(kModes[i].label).x + 0.2f * spare;
        if (toggleButton(kModes[i].label, state.mode == mode, width)) state.mode = mode;
        tip(kModes[i].tip);
    }
    ImGui::PopStyleVar();
    if (state.mode == vulkan::ShadingMode::levels) legend(levelColor, "finest", "coarsest");
    if (state.mode == vulkan::ShadingMode::error)
        legend(heatColor, "no error", fmt::format("{}; white: more", pixelsText(state.pixels)).c_str());
}

void buildLevels(ViewerState& state, const Models& models) {
    caption("LEVELS");
    uint32_t faces = 1000;
    for (const auto& model : models.all()) faces = std::max(faces, model->file.view.record->faceCount);
    ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 5.6f);
    ImGui::SliderFloat("error", &state.pixels, 0.0f, 64, "%.2f px", ImGuiSliderFlags_Logarithmic);
    tip("Error that is allowed on screen: each patch takes the coarsest level that stays below. [ halves, ] doubles. "
        "Ctrl+click to type.");
    ImGui::Checkbox("##budget", &state.useBudget);
    tip("B: hold a number of triangles, at as few pixels of error as that takes.");
    ImGui::SameLine();
    ImGui::BeginDisabled(!state.useBudget || state.morph);
    ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 5.6f);
    ImGui::SliderInt("budget", &state.budget, 100, int(faces * std::max<size_t>(1, models.all().size())),
                     "%d triangles", ImGuiSliderFlags_Logarithmic);
    ImGui::EndDisabled();
    tip("Most triangles of a frame. Levels that change continuously take no budget.");
    ImGui::Checkbox("morph", &state.morph);
    tip("M: levels change continuously, without a pop.");
    ImGui::SameLine(0, ImGui::GetFontSize());
    bool frozen = state.frozen.has_value();
    if (ImGui::Checkbox("freeze", &frozen)) state.askFreeze = true;
    tip("X: keep the levels and the culling of this camera, and look at them from outside.");
    ImGui::SameLine(0, ImGui::GetFontSize());
    ImGui::Checkbox("split", &state.split);
    tip("V: beside it, one error for all patches, near or far, at as many triangles. Drag the line.");
    if (models.all().empty()) return;
    const Measured& m = state.measured;
    ImGui::PushFont(smallFont());
    ImGui::TextDisabled("%s", fmt::format("{} triangles in {} draws hold {}{}", grouped(m.triangles), m.draws,
                                          pixelsText(m.pixels), m.overBudget ? " (the least there are)" : "")
                                  .c_str());
    ImGui::PopFont();
}

} // namespace

void buildPanel(ViewerState& state, Models& models, const DrawnModels& drawn, float width, float height) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    ImGui::TextUnformatted("xgc-viewer");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(" ? ").x -
                    2 * ImGui::GetStyle().FramePadding.x);
    if (ImGui::SmallButton(" ? ")) state.showHelp = !state.showHelp;
    tip("F1: mouse and keys");
    ImGui::PushFont(smallFont());
    ImGui::TextDisabled("%s", state.device.c_str());
    ImGui::PopFont();
    buildModels(state, models);
    buildColours(state);
    buildLevels(state, models);
    buildParts(state, models, drawn);
    ImGui::End();
}

} // namespace xgc::viewer
