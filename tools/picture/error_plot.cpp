#include <xgc/bake/error_plot.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace xgc::bake {
namespace {

constexpr double kWidth = 720, kHeight = 460;
constexpr double kLeft = 84, kRight = 96, kTop = 64, kBottom = 60;
constexpr const char* kBoundColor = "#1f5fa8";
constexpr const char* kRmsColor = "#d1702a";

/// Decades from and to, as powers of ten.
struct Decades {
    int from = 0, to = 1;

    void span(double low, double high) {
        from = int(std::floor(std::log10(low)));
        to = std::max(from + 1, int(std::ceil(std::log10(high))));
    }
    /// 0 at the lower end, 1 at the upper.
    double share(double value) const { return (std::log10(value) - from) / (to - from); }
};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (static_cast<unsigned char>(c) >= 32)
            out += c;
    }
    return out;
}

/// 1, 10, 100, 1 k, 10 k, ..., .01
std::string label(int power) {
    if (power >= 6) return fmt::format("{:.0f} M", std::pow(10.0, power - 6));
    if (power >= 3) return fmt::format("{:.0f} k", std::pow(10.0, power - 3));
    return fmt::format("{:.{}f}", std::pow(10.0, power), std::max(0, -power));
}

class Plot {
public:
    Plot(double diagonal, std::span<const PlotLevel> levels);
    std::string draw(const std::string& title);

private:
    double percent(double error) const { return 100 * error / diagonal_; }
    double x(double value) const { return kLeft + x_.share(value) * (kWidth - kLeft - kRight); }
    double y(double faces) const { return kHeight - kBottom - y_.share(faces) * (kHeight - kTop - kBottom); }
    void text(double atX, double atY, const char* attributes, const std::string& words);
    void line(double x1, double y1, double x2, double y2, const char* color);
    void grid();
    void fullCount();
    void curve(double PlotLevel::*error, const char* color, const char* name, double nameShift);

    double diagonal_;
    std::span<const PlotLevel> levels_;
    Decades x_, y_;
    std::string svg_;
};

Plot::Plot(double diagonal, std::span<const PlotLevel> levels)
    : diagonal_(diagonal > 0 ? diagonal : 1), levels_(levels) {
    double low = 100, high = 0, least = 1e9, most = 1;
    for (const PlotLevel& l : levels) {
        for (const double error : {l.bound, l.rms}) {
            if (!(error > 0) || !std::isfinite(error)) continue;
            low = std::min(low, percent(error));
            high = std::max(high, percent(error));
        }
        if (l.faces > 0) least = std::min(least, l.faces);
        most = std::max(most, l.faces);
    }
    if (high == 0) low = 0.001, high = 10;
    x_.span(std::max(low, high * 1e-6), high);
    y_.span(std::min(least, most), most);
}

void Plot::text(double atX, double atY, const char* attributes, const std::string& words) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", atX, atY, attributes, escaped(words));
}

void Plot::line(double x1, double y1, double x2, double y2, const char* color) {
    svg_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
                        y2, color);
}

void Plot::grid() {
    const double right = kWidth - kRight, bottom = kHeight - kBottom;
    for (int power = x_.from; power <= x_.to; ++power) {
        const double at = x(std::pow(10.0, power));
        line(at, kTop, at, bottom, "#e3e5e8");
        text(at, bottom + 20, "text-anchor=\"middle\"", label(power));
    }
    for (int power = y_.from; power <= y_.to; ++power) {
        const double at = y(std::pow(10.0, power));
        line(kLeft, at, right, at, "#e3e5e8");
        text(kLeft - 10, at + 4, "text-anchor=\"end\"", label(power));
    }
    line(kLeft, bottom, right, bottom, "#8a9099");
    line(kLeft, kTop, kLeft, bottom, "#8a9099");
    text((kLeft + right) / 2, kHeight - 16, "text-anchor=\"middle\" fill=\"#59606a\"",
         "error, percent of the bounds' diagonal");
    text(kLeft - 10, kTop - 14, "text-anchor=\"end\" fill=\"#59606a\"", "faces");
}

void Plot::fullCount() {
    if (levels_.empty() || levels_[0].faces <= 0) return;
    const double at = y(levels_[0].faces);
    svg_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#8a9099\" "
                        "stroke-dasharray=\"2 4\"/>\n",
                        kLeft, at, kWidth - kRight, at);
    text(kWidth - kRight + 8, at + 4, "fill=\"#59606a\"", "level 0");
}

/// A polyline with a dot a level, named beside its last dot.
void Plot::curve(double PlotLevel::*error, const char* color, const char* name, double nameShift) {
    std::string path, dots;
    double lastX = 0, lastY = 0;
    for (size_t l = 1; l < levels_.size(); ++l) {
        const double e = levels_[l].*error;
        if (!(e > 0) || !std::isfinite(e) || levels_[l].faces <= 0) continue;
        lastX = x(std::max(percent(e), std::pow(10.0, x_.from)));
        lastY = y(levels_[l].faces);
        path += fmt::format("{:.1f},{:.1f} ", lastX, lastY);
        dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"><title>level {}: {:.0f} faces, {:.4g}</title>"
                            "</circle>\n",
                            lastX, lastY, l, levels_[l].faces, e);
    }
    if (path.empty()) return;
    path.pop_back();
    svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
                        "stroke-linejoin=\"round\"/>\n<g fill=\"{}\">\n{}</g>\n",
                        path, color, color, dots);
    text(lastX + 8, lastY + nameShift, fmt::format("fill=\"{}\" font-weight=\"600\"", color).c_str(), name);
}

std::string Plot::draw(const std::string& title) {
    svg_ = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
                       "font-family=\"sans-serif\" font-size=\"12\" fill=\"#2b3038\">\n"
                       "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
                       kWidth, kHeight);
    text(kLeft, 28, "font-size=\"16\" font-weight=\"600\"", title);
    grid();
    fullCount();
    curve(&PlotLevel::rms, kRmsColor, "RMS", 14);
    curve(&PlotLevel::bound, kBoundColor, "bound E", 0);
    return svg_ + "</svg>\n";
}

} // namespace

std::string errorPlotSvg(const std::string& title, double diagonal, std::span<const PlotLevel> levels) {
    return Plot(diagonal, levels).draw(title);
}

} // namespace xgc::bake
