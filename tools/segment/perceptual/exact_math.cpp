#include "exact_math.h"

#include <bit>
#include <cstdint>

namespace xgc::bake::exact {

namespace {

constexpr double kLn2 = 0.6931471805599453;
constexpr double kPi = 3.141592653589793;

/// For |x| <= 0.27: Taylor's series to x^13.
double atanSmall(double x) {
    const double s = x * x;
    double sum = 1.0 / 13;
    sum = 1.0 / 11 - s * sum;
    sum = 1.0 / 9 - s * sum;
    sum = 1.0 / 7 - s * sum;
    sum = 1.0 / 5 - s * sum;
    sum = 1.0 / 3 - s * sum;
    return x * (1 - s * sum);
}

/// For 0 <= x <= 1: atan(x) = atan(1/2) + atan((x - 1/2) / (1 + x/2)) above .25.
double atanUnit(double x) {
    constexpr double kAtanHalf = 0.4636476090008061;
    constexpr double kQuarterPi = 0.7853981633974483;
    if (x <= 0.25) return atanSmall(x);
    if (x <= 0.75) return kAtanHalf + atanSmall((x - 0.5) / (1 + 0.5 * x));
    return kQuarterPi + atanSmall((x - 1) / (1 + x));
}

} // namespace

double log2(double x) {
    const auto bits = std::bit_cast<uint64_t>(x);
    auto exponent = int(bits >> 52 & 0x7ff) - 1023;
    double m = std::bit_cast<double>((bits & 0xfffffffffffffull) | 0x3ff0000000000000ull);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++exponent;
    }
    const double t = (m - 1) / (m + 1), s = t * t; // ln m = 2 artanh t, |t| <= .172
    double sum = 1.0 / 13;
    sum = 1.0 / 11 + s * sum;
    sum = 1.0 / 9 + s * sum;
    sum = 1.0 / 7 + s * sum;
    sum = 1.0 / 5 + s * sum;
    sum = 1.0 / 3 + s * sum;
    return exponent + 2 * t * (1 + s * sum) / kLn2;
}

double exp2(double x) {
    if (x < -1000) return 0;
    const auto whole = int64_t(x < 0 ? x - 0.5 : x + 0.5);
    const double t = (x - double(whole)) * kLn2; // |t| <= .35
    double sum = 1;
    for (int n = 11; n >= 1; --n) sum = 1 + t * sum / n;
    return sum * std::bit_cast<double>(uint64_t(whole + 1023) << 52);
}

double ln(double x) {
    return log2(x) * kLn2;
}

double exp(double x) {
    return exp2(x / kLn2);
}

double pow(double x, double p) {
    return x <= 0 ? 0 : exp2(p * log2(x));
}

double upperAngle(double y, double x) {
    if (y <= 0) return x < 0 ? kPi : 0;
    if (x < 0) return kPi - upperAngle(y, -x);
    return y <= x ? atanUnit(y / x) : 0.5 * kPi - atanUnit(x / y);
}

double sin(double radians) {
    return cos(radians - 0.5 * kPi);
}

double cos(double radians) {
    double t = radians < 0 ? -radians : radians;
    t -= 2 * kPi * double(int64_t(t / (2 * kPi)));
    if (t > kPi) t = 2 * kPi - t;
    const bool turned = t > 0.5 * kPi;
    if (turned) t = kPi - t;
    const double s = t * t;
    double sum = 1;
    for (int n = 16; n >= 2; n -= 2) sum = 1 - s * sum / (n * (n - 1));
    return turned ? -sum : sum;
}

} // namespace xgc::bake::exact
