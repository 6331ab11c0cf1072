#include "segments.h"

#include <algorithm>

namespace xgc::bake {
namespace {

double squaredLength(const glm::dvec3& v) {
    return glm::dot(v, v);
}

} // namespace

NearOnSegment segmentToPoint(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
    const glm::dvec3 ab = b - a, ap = p - a;
    const double length2 = squaredLength(ab);
    const double at = length2 > 0 ? std::clamp(glm::dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
    return {squaredLength(ap - ab * at), at};
}

NearOnSegment segmentToSegment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const glm::dvec3 u = b - a, v = d - c, r = a - c;
    const double uu = squaredLength(u), vv = squaredLength(v), vr = glm::dot(v, r);
    if (!(uu > 0)) return {segmentToPoint(c, d, a).squared, 0.0};
    if (!(vv > 0)) return segmentToPoint(a, b, c);
    const double ur = glm::dot(u, r), uv = glm::dot(u, v);
    const double determinant = uu * vv - uv * uv;
    double s = determinant > 0 ? std::clamp((uv * vr - ur * vv) / determinant, 0.0, 1.0) : 0.0;
    double t = (uv * s + vr) / vv;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((uv * t - ur) / uu, 0.0, 1.0);
    }
    return {squaredLength(r + u * s - v * t), s};
}

} // namespace xgc::bake
