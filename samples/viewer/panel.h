#pragma once

#include "models.h"

namespace xgc::viewer {

/// The panel at the left, from top to bottom: models, colours, levels, comparison, the picked part, all parts. It edits
/// the state and the models' controls.
void buildPanel(ViewerState& state, Models& models, const DrawnModels& drawn, float width, float height);

/// Its lower half: steering of the picked part, and the list of parts.
void buildParts(ViewerState& state, Models& models, const DrawnModels& drawn);

} // namespace xgc::viewer
