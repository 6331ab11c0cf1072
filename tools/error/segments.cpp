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

glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double area2 = squaredLength(n);
    if (area2 > 0) {
        const double u = glm::dot(glm::cross(b - p, c - p), n), v = glm::dot(glm::cross(c - p, a - p), n);
        if (u >= 0 && v >= 0 && u + v <= area2) return c + (a - c) * (u / area2) + (b - c) * (v / area2);
    }
    const NearOnSegment sides[3] = {segmentToPoint(a, b, p), segmentToPoint(b, c, p), segmentToPoint(c, a, p)};
    const int k = sides[0].squared <= sides[1].squared ? (sides[0].squared <= sides[2].squared ? 0 : 2)
                                                       : (sides[1].squared <= sides[2].squared ? 1 : 2);
    const glm::dvec3 corners[3] = {a, b, c};
    return corners[k] + (corners[(k + 1) % 3] - corners[k]) * sides[k].at;
}

} // namespace xgc::bake
