#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace xgc::bench {

struct PlotLine {
    std::string name;
    std::string color;          ///< of SVG
    std::vector<double> values; ///< one a step of the x axis; not positive: no point
};

struct Plot {
    std::string title, xName, yName;
    std::vector<PlotLine> lines;
};

/// Lines over steps, the y axis in powers of ten, as an SVG that is read on light and dark pages.
void writePlot(const Plot& plot, const std::filesystem::path& file);

} // namespace xgc::bench
