#pragma once

#include "models.h"

namespace xgc::viewer {

/// The state as JSON on one line: settings, camera, picked part, how parts are steered, what was drawn. Documented in
/// README.md.
std::string reportJson(const ViewerState& state, const Models& models, const Area& area, uint32_t frames);

} // namespace xgc::viewer
