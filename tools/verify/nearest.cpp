#include "nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {
namespace {

double segmentDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 ab = b - a;
    const double length2 = glm::dot(ab, ab);
    const double t = length2 > 0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
    return glm::length(p - (a + t * ab));
}

/// To the plane where the foot lies inside all three edges, else to the nearest edge.
double triangleDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const bool inside = glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                        glm::dot(glm::cross(a - c, p - c), n) >= 0;
    const double length = glm::length(n);
    if (inside && length > 0) return std::abs(glm::dot(p - a, n)) / length;
    return std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)});
}

struct Query {
    const std::vector<glm::vec3>& points;
    const std::vector<glm::uvec3>& triangles;
    glm::dvec3 p;
    double best = std::numeric_limits<double>::infinity();
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
    Query& query = *static_cast<Query*>(arguments->userPtr);
    const glm::uvec3 t = query.triangles[arguments->primID];
    const double d = triangleDistance(query.p, query.points[t.x], query.points[t.y], query.points[t.z]);
    if (d >= query.best) return false;
    query.best = d;
    arguments->query->radius = std::nextafter(float(d), INFINITY);
    return true;
}

} // namespace

Nearest::Nearest(std::vector<glm::vec3> points, std::vector<glm::uvec3> triangles)
    : points_(std::move(points)), triangles_(std::move(triangles)),
      // No "threads=1": it holds all of TBB in the process to one thread for as long as the device lives.
      device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    if (!triangles_.empty()) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(glm::vec3), points_.size());
        std::copy(points_.begin(), points_.end(), static_cast<glm::vec3*>(vertices));
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                sizeof(glm::uvec3), triangles_.size());
        std::copy(triangles_.begin(), triangles_.end(), static_cast<glm::uvec3*>(indices));
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene_);
}

Nearest::~Nearest() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

double Nearest::distance(const glm::vec3& p) const {
    Query query{points_, triangles_, p};
    RTCPointQuery point{};
    point.x = p.x;
    point.y = p.y;
    point.z = p.z;
    point.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_, &point, &context, visit, &query);
    return query.best;
}

} // namespace xgc::bake
