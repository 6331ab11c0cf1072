#pragma once

#include "state.h"

#include <xgc/selection.h>

namespace xgc::viewer {

/// The camera that levels are selected for: the frozen one, or the one that looks.
struct SelectedFor {
    vulkan::Camera camera;
    float height = 1; ///< of its picture, pixels
};
SelectedFor selectedFor(const ViewerState& state, const Area& area);

/// What the settings ask of the selection.
SelectionDesc selectionFor(const ViewerState& state, const SelectedFor& view);

/// The same view at levels of the host's own: what `levels` was set to, and the coarsest where it was not.
SelectionDesc selectionFor(const SelectedFor& view, const Selection* levels);

/// How it is coloured.
vulkan::ViewDesc viewFor(const ViewerState& state, const Area& area, const SelectedFor& view);

} // namespace xgc::viewer
