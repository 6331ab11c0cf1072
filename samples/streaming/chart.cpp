#include "chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

constexpr double kWidth = 680, kPanel = 190, kLeft = 64, kRight = 20, kGap = 46, kTop = 34;

/// One panel: x from 0 to `xMost`, y from `low` to `high`, by powers of ten where `logs`.
struct Panel {
    std::FILE* out;
    double top, xMost, low, high;
    bool logs;

    double x(double v) const { return kLeft + (kWidth - kLeft - kRight) * v / xMost; }
    double y(double v) const {
        const double t = logs ? std::log(std::max(v, low) / low) / std::log(high / low) : (v - low) / (high - low);
        return top + kPanel * (1 - std::clamp(t, 0.0, 1.0));
    }
    void frame(const char* title, const char* xName) const {
        std::fprintf(out, "<text x='%g' y='%g' font-weight='bold'>%s</text>\n", kLeft, top - 8, title);
        std::fprintf(out, "<text x='%g' y='%g' text-anchor='end'>%s</text>\n", kWidth - kRight, top + kPanel + 28,
                     xName);
        std::fprintf(out, "<rect x='%g' y='%g' width='%g' height='%g' fill='none' stroke='#8888'/>\n", kLeft, top,
                     kWidth - kLeft - kRight, kPanel);
    }
    void yMark(double v, const char* text, const char* color = "#8886") const {
        std::fprintf(out, "<path d='M%g %gH%g' stroke='%s' stroke-dasharray='4 3'/>\n", kLeft, y(v), kWidth - kRight,
                     color);
        std::fprintf(out, "<text x='%g' y='%g' text-anchor='end'>%s</text>\n", kLeft - 6, y(v) + 4, text);
    }
    void xMark(double v, const char* text) const {
        std::fprintf(out, "<text x='%g' y='%g' text-anchor='middle'>%s</text>\n", x(v), top + kPanel + 14, text);
    }
    template <typename X, typename Y>
    void line(const std::vector<Sample>& samples, const char* color, const X& xOf, const Y& yOf) const {
        std::fprintf(out, "<path fill='none' stroke='%s' stroke-width='1.6' d='", color);
        for (size_t i = 0; i < samples.size(); ++i)
            std::fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', x(xOf(samples[i], i)), y(yOf(samples[i])));
        std::fprintf(out, "'/>\n");
    }
};

std::string megabytes(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, bytes < 1e7 ? "%.1f MB" : "%.0f MB", bytes / 1e6);
    return text;
}

void marks(const Panel& panel, double most, bool isBytes) {
    for (int i = 0; i <= 4; ++i) {
        const double v = most * i / 4;
        panel.xMark(v, isBytes ? megabytes(v).c_str() : std::to_string(int(v)).c_str());
    }
}

void errorMarks(const Panel& panel) {
    for (double v = 1; v <= panel.high; v *= 10) {
        char text[32];
        std::snprintf(text, sizeof text, "%g px", v);
        panel.yMark(v, text, v == 1 ? "#2a9d5c" : "#8886");
    }
}

} // namespace

bool writeChart(const std::string& file, const std::vector<Sample>& samples, double budgetBytes, double sceneBytes) {
    std::FILE* out = std::fopen(file.c_str(), "wb");
    if (!out || samples.empty()) return false;
    double worst = 10;
    for (const Sample& s : samples) worst = std::max(worst, s.errorPixels * 1.2);
    const double frames = double(samples.size() - 1), read = samples.back().readBytes;
    const double height = kTop + 3 * (kPanel + kGap) + 12;
    std::fprintf(out,
                 "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' font-family='sans-serif' font-size='12' "
                 "fill='#888'>\n",
                 kWidth, height);
    const auto byFrame = [](const Sample&, size_t i) { return double(i); };
    const Panel errors{out, kTop, frames, 0.3, worst, true};
    errors.frame("Largest error on screen of what is drawn (1 pixel is asked for)", "frame");
    marks(errors, frames, false);
    errorMarks(errors);
    errors.line(samples, "#e4572e", byFrame, [](const Sample& s) { return s.errorPixels; });

    const Panel memory{out, kTop + kPanel + kGap, frames, 0, sceneBytes, false};
    memory.frame("Pages in memory, of a scene of which the budget holds a part", "frame");
    marks(memory, frames, false);
    memory.yMark(sceneBytes, megabytes(sceneBytes).c_str());
    memory.yMark(budgetBytes, megabytes(budgetBytes).c_str(), "#2a9d5c");
    memory.line(samples, "#3a7bd5", byFrame, [](const Sample& s) { return s.residentBytes; });

    const Panel against{out, kTop + 2 * (kPanel + kGap), read, 0.3, worst, true};
    against.frame("Error against the bytes that were read by then", "read");
    marks(against, read, true);
    errorMarks(against);
    against.line(
        samples, "#9b5de5", [](const Sample& s, size_t) { return s.readBytes; },
        [](const Sample& s) { return s.errorPixels; });
    std::fprintf(out, "</svg>\n");
    return std::fclose(out) == 0;
}
