#pragma once

#include <imgui.h>

#include <cstdint>
#include <string>

namespace xgc::viewer {

/// 1,234,567
std::string grouped(uint64_t number);
/// 1 patch, 2,345 patches
std::string counted(uint64_t number, const char* one, const char* many);
/// 0.25 px, 3.4 px, 1,234 px
std::string pixelsText(float pixels);
/// 12 bytes, 3.4 KiB, ...
std::string bytesText(double bytes);

/// Shown while the pointer rests on the last item.
void tip(const char* text);
/// A small caption over a group of controls.
void caption(const char* text);
/// A button that is lit while `on`.
bool toggleButton(const char* label, bool on, float width);
/// Colour of a level, as shaders/lighting.glsl has it: 0 the finest, 1 the coarsest.
ImU32 levelColor(float fraction);
/// Colour of an error, likewise: 1 takes all that is allowed.
ImU32 heatColor(float budgets);
/// A bar of such colours with a word at both ends.
void legend(ImU32 (*colorAt)(float), const char* low, const char* high);

} // namespace xgc::viewer
