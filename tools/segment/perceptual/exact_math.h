#pragma once

/// Elementary functions from + - * / and integers alone: the same bits from any compiler, library and machine. Good to
/// about 1e-9 relative, for arguments of ordinary size.
namespace xgc::bake::exact {

double log2(double x); ///< x > 0, normal
double exp2(double x); ///< 0 below -1000; x < 1000
double ln(double x);   ///< x > 0, normal
double exp(double x);
/// x to the power of p; 0 for x <= 0.
double pow(double x, double p);
/// Angle of (x, y) for y >= 0: 0 to pi; 0 at the origin.
double upperAngle(double y, double x);
/// For |radians| up to some hundred.
double sin(double radians);
double cos(double radians);

} // namespace xgc::bake::exact
