#pragma once

#include <xgc/bake/perceptual.h>

#include <nlohmann/json.hpp>

namespace xgc::bake {

/// An object a component, for the reports of bake and segment.
nlohmann::ordered_json traceJson(std::span<const PerceptualTrace> traces);

} // namespace xgc::bake
