#include "theme.h"

#include <filesystem>

namespace xgc::viewer {
namespace {

ImFont* theSmallFont = nullptr;

/// A file of a font that most systems have; null where none is there.
const char* fontFile() {
    for (const char* file :
         {"/usr/share/fonts/truetype/inter/Inter-Regular.ttf", "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
          "/usr/share/fonts/truetype/open-sans/OpenSans-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
          "/usr/share/fonts/TTF/DejaVuSans.ttf", "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"}) {
        std::error_code ignored;
        if (std::filesystem::exists(file, ignored)) return file;
    }
    return nullptr;
}

void loadFonts(float scale) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    ImFontConfig config;
    config.OversampleH = config.OversampleV = 2;
    if (const char* file = fontFile()) {
        fonts.AddFontFromFileTTF(file, 15 * scale, &config);
        theSmallFont = fonts.AddFontFromFileTTF(file, 12.5f * scale, &config);
    } else {
        config.SizePixels = 13 * scale;
        theSmallFont = fonts.AddFontDefault(&config);
    }
}

void color(ImGuiCol_ which, int r, int g, int b, int a = 255) {
    ImGui::GetStyle().Colors[which] = ImGui::ColorConvertU32ToFloat4(IM_COL32(r, g, b, a));
}

void applyColors() {
    color(ImGuiCol_Text, 226, 228, 232);
    color(ImGuiCol_TextDisabled, 140, 145, 153);
    color(ImGuiCol_WindowBg, 27, 29, 32);
    color(ImGuiCol_ChildBg, 22, 24, 26);
    color(ImGuiCol_PopupBg, 34, 36, 40, 250);
    color(ImGuiCol_Border, 255, 255, 255, 20);
    color(ImGuiCol_FrameBg, 44, 47, 52);
    color(ImGuiCol_FrameBgHovered, 56, 60, 66);
    color(ImGuiCol_FrameBgActive, 66, 70, 77);
    color(ImGuiCol_Button, 50, 53, 59);
    color(ImGuiCol_ButtonHovered, 66, 70, 77);
    color(ImGuiCol_ButtonActive, 84, 89, 97);
    color(ImGuiCol_Header, 56, 60, 66);
    color(ImGuiCol_HeaderHovered, 66, 70, 77);
    color(ImGuiCol_HeaderActive, 84, 89, 97);
    color(ImGuiCol_SliderGrab, 176, 98, 32);
    color(ImGuiCol_SliderGrabActive, 206, 116, 40);
    color(ImGuiCol_CheckMark, 255, 150, 56);
    color(ImGuiCol_Separator, 255, 255, 255, 22);
    color(ImGuiCol_ScrollbarBg, 22, 24, 26, 0);
    color(ImGuiCol_ScrollbarGrab, 62, 66, 72);
    color(ImGuiCol_PlotHistogram, 255, 150, 56);
    color(ImGuiCol_TitleBg, 27, 29, 32);
    color(ImGuiCol_TitleBgActive, 34, 36, 40);
    color(ImGuiCol_ModalWindowDimBg, 10, 11, 12, 130);
    color(ImGuiCol_TextSelectedBg, 255, 150, 56, 90);
    color(ImGuiCol_NavHighlight, 255, 150, 56, 160);
}

} // namespace

void applyTheme(float scale) {
    ImGui::StyleColorsDark();
    applyColors();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 5;
    style.FrameRounding = 4;
    style.GrabRounding = 4;
    style.ChildRounding = 4;
    style.PopupRounding = 5;
    style.ScrollbarRounding = 6;
    style.ScrollbarSize = 12;
    style.GrabMinSize = 12;
    style.WindowPadding = {14, 12};
    style.FramePadding = {9, 5};
    style.ItemSpacing = {8, 7};
    style.ItemInnerSpacing = {7, 5};
    style.WindowBorderSize = 0;
    style.PopupBorderSize = 1;
    style.ScaleAllSizes(scale);
    loadFonts(scale);
}

ImFont* smallFont() {
    return theSmallFont;
}

} // namespace xgc::viewer
