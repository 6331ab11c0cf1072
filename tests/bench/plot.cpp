#include "plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace xgc::bench {
namespace {

constexpr double kWidth = 640, kHeight = 300;
constexpr double kLeft = 64, kRight = 92, kTop = 30, kBottom = 40;

/// From values to the picture.
struct Axes {
    size_t steps = 2;
    double low = 0, high = 1; ///< powers of ten

    double x(size_t step) const { return kLeft + (kWidth - kLeft - kRight) * double(step) / double(steps - 1); }
    double y(double value) const {
        const double t = (std::log10(value) - low) / (high - low);
        return kHeight - kBottom - (kHeight - kTop - kBottom) * t;
    }
};

Axes axesOf(const Plot& plot) {
    double least = INFINITY, most = 0;
    Axes axes;
    for (const PlotLine& line : plot.lines) {
        axes.steps = std::max(axes.steps, line.values.size());
        for (const double v : line.values) {
            if (v <= 0) continue;
            least = std::min(least, v);
            most = std::max(most, v);
        }
    }
    if (most <= 0) return axes;
    // To halves of a power.
    axes.low = std::floor(2 * std::log10(least)) / 2;
    axes.high = std::max(std::ceil(2 * std::log10(most)) / 2, axes.low + 0.5);
    return axes;
}

std::string label(double value) {
    if (value >= 1e6) return fmt::format("{:g} M", value / 1e6);
    if (value >= 1e3) return fmt::format("{:g} k", value / 1e3);
    return fmt::format("{:g}", value);
}

std::string text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, words);
}

std::string grid(const Axes& axes) {
    std::string out;
    for (int power = int(std::ceil(axes.low)); power <= int(std::floor(axes.high)); ++power) {
        const double value = std::pow(10.0, power), y = axes.y(value);
        out += fmt::format("<line x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#d0d4da\"/>\n", kLeft,
                           kWidth - kRight, y, y);
        out += text(kLeft - 6, y + 4, "end", label(value));
    }
    for (size_t step = 0; step < axes.steps; step += 10) {
        out += text(axes.x(step), kHeight - kBottom + 16, "middle", fmt::format("{}", step));
    }
    return out;
}

/// The line, and its name where it ends.
std::string curve(const PlotLine& line, const Axes& axes, double nameY) {
    std::string points;
    for (size_t i = 0; i < line.values.size(); ++i) {
        if (line.values[i] > 0) points += fmt::format("{:.1f},{:.1f} ", axes.x(i), axes.y(line.values[i]));
    }
    return fmt::format("<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"2\" points=\"{}\"/>\n", line.color,
                       points) +
           text(kWidth - kRight + 8, nameY, "start", line.name, fmt::format(" fill=\"{}\"", line.color).c_str());
}

} // namespace

void writePlot(const Plot& plot, const std::filesystem::path& file) {
    const Axes axes = axesOf(plot);
    std::string svg = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
                                  "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
                                  "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
                                  kWidth, kHeight);
    svg += text(kLeft, 18, "start", plot.title, " font-size=\"14\" font-weight=\"bold\"");
    svg += text(0.5 * (kLeft + kWidth - kRight), kHeight - 8, "middle", plot.xName);
    svg += text(14, 0.5 * (kTop + kHeight - kBottom), "middle", plot.yName,
                fmt::format(" transform=\"rotate(-90 14 {:.1f})\"", 0.5 * (kTop + kHeight - kBottom)).c_str());
    svg += grid(axes);
    // Names beside the ends of their lines, a line of text apart at least, from the top down.
    std::vector<std::pair<double, const PlotLine*>> ends;
    for (const PlotLine& line : plot.lines) {
        const bool drawn = std::any_of(line.values.begin(), line.values.end(), [](double v) { return v > 0; });
        if (drawn) ends.emplace_back(line.values.back() > 0 ? axes.y(line.values.back()) + 4 : kTop, &line);
    }
    std::sort(ends.begin(), ends.end());
    double next = kTop;
    for (auto& [y, line] : ends) {
        next = std::max(next, y);
        svg += curve(*line, axes, next);
        next += 14;
    }
    std::ofstream(file) << svg << "</svg>\n";
}

} // namespace xgc::bench
