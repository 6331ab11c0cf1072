#include "image_difference.h"

#include <algorithm>
#include <cmath>

namespace xgc::bench {
namespace {

std::vector<double> luma(const bake::Image& image) {
    std::vector<double> out;
    out.reserve(image.pixels.size());
    for (const glm::u8vec4& p : image.pixels) out.push_back(0.299 * p.r + 0.587 * p.g + 0.114 * p.b);
    return out;
}

/// Structural similarity of one window.
double similarity(const std::vector<double>& a, const std::vector<double>& b, size_t corner, size_t width) {
    constexpr size_t kSide = 8;
    constexpr double kCount = kSide * kSide, kC1 = 6.5025, kC2 = 58.5225; // (.01 * 255)^2, (.03 * 255)^2
    double sumA = 0, sumB = 0, sumAA = 0, sumBB = 0, sumAB = 0;
    for (size_t y = 0; y < kSide; ++y) {
        for (size_t x = 0; x < kSide; ++x) {
            const double u = a[corner + y * width + x], v = b[corner + y * width + x];
            sumA += u;
            sumB += v;
            sumAA += u * u;
            sumBB += v * v;
            sumAB += u * v;
        }
    }
    const double meanA = sumA / kCount, meanB = sumB / kCount;
    const double varA = sumAA / kCount - meanA * meanA, varB = sumBB / kCount - meanB * meanB;
    const double covariance = sumAB / kCount - meanA * meanB;
    return (2 * meanA * meanB + kC1) * (2 * covariance + kC2) /
           ((meanA * meanA + meanB * meanB + kC1) * (varA + varB + kC2));
}

} // namespace

ImageDifference imageDifference(const bake::Image& a, const bake::Image& b) {
    const std::vector<double> x = luma(a), y = luma(b);
    double squares = 0;
    for (size_t i = 0; i < x.size(); ++i) squares += (x[i] - y[i]) * (x[i] - y[i]);
    ImageDifference out;
    const double mse = squares / double(std::max<size_t>(x.size(), 1));
    out.psnr = mse > 0 ? std::min(99.0, 10 * std::log10(255.0 * 255.0 / mse)) : 99;
    double sum = 0;
    size_t windows = 0;
    for (size_t row = 0; row + 8 <= a.height; row += 4) {
        for (size_t column = 0; column + 8 <= a.width; column += 4, ++windows) {
            sum += similarity(x, y, row * a.width + column, a.width);
        }
    }
    out.ssim = windows ? sum / double(windows) : 1;
    return out;
}

} // namespace xgc::bench
