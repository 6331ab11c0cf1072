#pragma once

#include <imgui.h>

namespace xgc::viewer {

// One accent, warm as the picked part, on neutral greys.
inline constexpr ImU32 kInk = IM_COL32(226, 228, 232, 255);
inline constexpr ImU32 kMuted = IM_COL32(150, 155, 163, 255);
inline constexpr ImU32 kAccent = IM_COL32(255, 150, 56, 255);
inline constexpr ImU32 kCard = IM_COL32(24, 26, 29, 225);
inline constexpr ImU32 kCardLine = IM_COL32(255, 255, 255, 22);

/// Dark and neutral; a readable font where the system has one.
void applyTheme(float scale);
/// The small font of graphs and hints.
ImFont* smallFont();

} // namespace xgc::viewer
