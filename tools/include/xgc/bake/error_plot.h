#pragma once

#include <span>
#include <string>

namespace xgc::bake {

/// One level of an asset, for its plot.
struct PlotLevel {
    double faces = 0;
    double bound = 0; ///< E, mesh units
    double rms = 0;   ///< sampled; 0 where it was not
};

/// An SVG of faces against error, both logarithmic: the bound and the RMS of each level as a curve each. Errors are
/// shown in percent of `diagonal`. Levels without an error, as level 0, stand at the left edge in neither curve but as
/// a line across: the full face count.
std::string errorPlotSvg(const std::string& title, double diagonal, std::span<const PlotLevel> levels);

} // namespace xgc::bake
