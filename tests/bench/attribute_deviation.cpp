#include "attribute_deviation.h"

#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace xgc::bench {
namespace {

/// Candidates lie within this much of the nearest distance, and of the surface's size.
constexpr double kNear = 1.5, kNearSize = 1e-4;
/// Texture stretches of (nearly) degenerate triangles would be endless.
constexpr double kMaxLogStretch = 3;

struct Foot {
    double distance;
    glm::dvec3 weights;
};

/// Barycentric coordinates of the point of a triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
glm::dvec3 nearestWeights(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double va = d3 * d6 - d5 * d4, e = d4 - d3, f = d5 - d6;
    if (va <= 0 && e >= 0 && f >= 0) return {0, 1 - e / (e + f), e / (e + f)};
    const double sum = va + vb + vc;
    return {va / sum, vb / sum, vc / sum};
}

template <typename T>
auto mix(const std::vector<T>& rows, const glm::uvec3& t, const glm::dvec3& weights) {
    using Wide = glm::vec<T::length(), double>;
    return weights.x * Wide(rows[t.x]) + weights.y * Wide(rows[t.y]) + weights.z * Wide(rows[t.z]);
}

/// ln of the root mean square of the singular values of the map from UVs to the surface; NaN without UV area.
double logStretch(const Surface& s, const glm::uvec3& t) {
    const glm::dvec3 p = s.points[t.x], q = glm::dvec3(s.points[t.y]) - p, r = glm::dvec3(s.points[t.z]) - p;
    const glm::dvec2 u = s.uvs[t.x], v = glm::dvec2(s.uvs[t.y]) - u, w = glm::dvec2(s.uvs[t.z]) - u;
    const double area = v.x * w.y - v.y * w.x;
    if (area == 0) return NAN;
    const glm::dvec3 alongS = (q * w.y - r * v.y) / area, alongT = (r * v.x - q * w.x) / area;
    return std::log((glm::dot(alongS, alongS) + glm::dot(alongT, alongT)) / 2) / 2;
}

/// What a sample compares: of the surface it is on.
struct Values {
    glm::dvec3 normal{0};
    glm::dvec2 uv{0};
    double logStretch = 0;
};

struct Differences {
    double degrees = INFINITY, uv = INFINITY, stretch = INFINITY;
};

class Attributed {
public:
    explicit Attributed(const Surface& s) : s_(s), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                               sizeof(glm::vec3), s.points.size());
        std::copy(s.points.begin(), s.points.end(), static_cast<glm::vec3*>(points));
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                sizeof(glm::uvec3), s.triangles.size());
        std::copy(s.triangles.begin(), s.triangles.end(), static_cast<glm::uvec3*>(indices));
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        for (const glm::uvec3& t : s.triangles) logStretch_.push_back(s.uvs.empty() ? 0 : logStretch(s, t));
    }
    ~Attributed() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Attributed(const Attributed&) = delete;
    Attributed& operator=(const Attributed&) = delete;

    Values at(uint32_t triangle, const glm::dvec3& weights) const {
        const glm::uvec3& t = s_.triangles[triangle];
        Values v;
        if (!s_.normals.empty()) v.normal = mix(s_.normals, t, weights);
        if (!s_.uvs.empty()) v.uv = mix(s_.uvs, t, weights);
        v.logStretch = logStretch_[triangle];
        return v;
    }

    /// The least differences over the triangles near a point.
    Differences differences(const glm::dvec3& p, const Values& values, double size) const {
        Query query{*this, p, values, INFINITY, {}};
        run(query, visitNearest, INFINITY);
        query.limit = query.limit * kNear + size * kNearSize;
        run(query, visitNear, query.limit);
        return query.least;
    }

private:
    struct Query {
        const Attributed& on;
        glm::dvec3 p;
        const Values& values;
        double limit;
        Differences least;
    };

    Foot footOn(uint32_t triangle, const glm::dvec3& p) const {
        const glm::uvec3& t = s_.triangles[triangle];
        const glm::dvec3 weights = nearestWeights(p, s_.points[t.x], s_.points[t.y], s_.points[t.z]);
        return {glm::distance(mix(s_.points, t, weights), p), weights};
    }

    void run(Query& query, RTCPointQueryFunction visit, double radius) const {
        RTCPointQuery point{};
        point.x = float(query.p.x);
        point.y = float(query.p.y);
        point.z = float(query.p.z);
        point.radius = float(radius);
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        rtcPointQuery(scene_, &point, &context, visit, &query);
    }

    static bool visitNearest(RTCPointQueryFunctionArguments* arguments) {
        Query& query = *static_cast<Query*>(arguments->userPtr);
        const double d = query.on.footOn(arguments->primID, query.p).distance;
        if (d >= query.limit) return false;
        query.limit = d;
        arguments->query->radius = std::nextafter(float(d), INFINITY);
        return true;
    }

    static bool visitNear(RTCPointQueryFunctionArguments* arguments) {
        Query& query = *static_cast<Query*>(arguments->userPtr);
        const Foot foot = query.on.footOn(arguments->primID, query.p);
        if (foot.distance > query.limit) return false;
        const Values theirs = query.on.at(arguments->primID, foot.weights);
        const Values& ours = query.values;
        const double lengths = glm::length(ours.normal) * glm::length(theirs.normal);
        const double cosine = lengths > 0 ? std::clamp(glm::dot(ours.normal, theirs.normal) / lengths, -1.0, 1.0) : 1;
        Differences& least = query.least;
        least.degrees = std::min(least.degrees, std::acos(cosine) * 180 / std::numbers::pi);
        least.uv = std::min(least.uv, glm::distance(ours.uv, theirs.uv));
        // fmin, fmax: the difference to a triangle without UV area (NaN) counts as the largest.
        least.stretch =
            std::fmin(least.stretch, std::fmin(kMaxLogStretch, std::abs(ours.logStretch - theirs.logStretch)));
        return false;
    }

    const Surface& s_;
    RTCDevice device_;
    RTCScene scene_;
    std::vector<double> logStretch_;
};

/// Sums of squares over samples of one surface against another.
struct Sums {
    double degrees = 0, uv = 0, stretch = 0, count = 0;
};

void addOneWay(const Surface& from, const Attributed& fromTree, const Attributed& to, double size, uint32_t samples,
               Sums& sums) {
    const std::vector<SamplePoint> points = samplePoints(from, samples);
    std::vector<Differences> found(points.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 1024), [&](const auto& range) {
        for (size_t i = range.begin(); i != range.end(); ++i) {
            const Values values = fromTree.at(points[i].triangle, points[i].weights);
            found[i] = to.differences(points[i].point, values, size);
        }
    });
    for (const Differences& d : found) {
        sums.degrees += d.degrees * d.degrees;
        sums.uv += d.uv * d.uv;
        sums.stretch += d.stretch * d.stretch;
    }
    sums.count += double(found.size());
}

/// Length on the surface of a step of 1 in UV.
double lengthOfUv(const Surface& s) {
    double area = 0, uvArea = 0;
    for (const glm::uvec3& t : s.triangles) {
        const glm::dvec3 p = s.points[t.x], q = s.points[t.y], r = s.points[t.z];
        area += glm::length(glm::cross(q - p, r - p));
        const glm::dvec2 u = s.uvs[t.x], v = glm::dvec2(s.uvs[t.y]) - u, w = glm::dvec2(s.uvs[t.z]) - u;
        uvArea += std::abs(v.x * w.y - v.y * w.x);
    }
    return uvArea > 0 ? std::sqrt(area / uvArea) : 0;
}

double sizeOf(const Surface& s) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& p : s.points) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    return glm::distance(low, high);
}

} // namespace

AttributeDeviation compareAttributes(const Surface& reference, const Surface& other, uint32_t samples) {
    AttributeDeviation deviation;
    if (reference.triangles.empty() || other.triangles.empty()) return deviation;
    const Attributed a(reference), b(other);
    const double size = sizeOf(reference);
    Sums sums;
    addOneWay(reference, a, b, size, samples, sums);
    addOneWay(other, b, a, size, samples, sums);
    if (!reference.normals.empty() && !other.normals.empty())
        deviation.normalDegrees = std::sqrt(sums.degrees / sums.count);
    if (!reference.uvs.empty() && !other.uvs.empty()) {
        deviation.uvRms = std::sqrt(sums.uv / sums.count) * lengthOfUv(reference);
        deviation.stretch = std::sqrt(sums.stretch / sums.count);
    }
    return deviation;
}

} // namespace xgc::bench
