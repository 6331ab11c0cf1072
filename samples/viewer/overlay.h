#pragma once

#include "models.h"

namespace xgc::viewer {

/// What stands over the picture: the frozen camera's frustum, the line of a split view, graphs and hints.
void buildOverlay(const ViewerState& state, bool empty, const Area& area);

/// Four graphs of the last frames in a card at the lower right, where there is room for it. The width that it takes.
float buildGraphs(const ViewerState& state, const Area& area);

/// What to begin with where nothing is open, progress of loading, what is wrong with a file, the keys.
void buildDialogs(ViewerState& state, const LoadProgress& progress, bool empty, const Area& area);

} // namespace xgc::viewer
