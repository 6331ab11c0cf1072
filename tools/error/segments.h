#pragma once

#include <glm/glm.hpp>

namespace xgc::bake {

/// How near a segment comes to something: the squared distance, and where on the segment (0 at its start, 1 at its
/// end).
struct NearOnSegment {
    double squared;
    double at;
};

/// Segment ab against the point p.
NearOnSegment segmentToPoint(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p);

/// Segment ab against the segment cd (Ericson, Real-Time Collision Detection, 5.1.9).
NearOnSegment segmentToSegment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

/// The point of the triangle abc that is nearest to p (Ericson, 5.1.5).
glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

} // namespace xgc::bake
