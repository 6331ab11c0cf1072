#pragma once

#include "asset_grid.h"

#include <xgc/bake/flight.h>

namespace xgc::headless {

/// Writes down what each frame asks for, and what the runtime makes of it without a renderer.
class Recorder {
public:
    bake::Status begin(const AssetGrid& scene, const std::vector<std::filesystem::path>& files);
    void add(const SelectionDesc& desc);
    bake::Status write(const std::filesystem::path& file) const { return bake::writeFlight(flight_, file); }

private:
    bake::Flight flight_;
    bake::FlightPlayer player_;
};

} // namespace xgc::headless
