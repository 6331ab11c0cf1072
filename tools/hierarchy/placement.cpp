#include "hierarchy/placement.h"

namespace xgc::bake {

namespace {

/// Pull towards the middle of the edge, as a share of the quadric's trace: decides where planes leave a point free.
constexpr double kPull = 1e-3;
/// A point farther from the middle than this many edge lengths is no improvement but a pole.
constexpr double kFarthest = 2;

/// Solves (A + r I) x = r m - b by Cramer's rule.
glm::dvec3 minimum(const Quadric& q, const glm::dvec3& middle) {
    const double r = kPull * (q.xx + q.yy + q.zz);
    const double xx = q.xx + r, yy = q.yy + r, zz = q.zz + r;
    const glm::dvec3 d = r * middle - q.b;
    const double cx = yy * zz - q.yz * q.yz, cy = q.xz * q.yz - q.xy * zz, cz = q.xy * q.yz - q.xz * yy;
    const double determinant = xx * cx + q.xy * cy + q.xz * cz;
    if (!(determinant > 0)) return middle;
    const double fyy = xx * zz - q.xz * q.xz, fyz = q.xy * q.xz - xx * q.yz, fzz = xx * yy - q.xy * q.xy;
    return glm::dvec3(cx * d.x + cy * d.y + cz * d.z, cy * d.x + fyy * d.y + fyz * d.z,
                      cz * d.x + fyz * d.y + fzz * d.z) /
           determinant;
}

} // namespace

Meeting meetingOf(const SurfaceState& state, const AttributeQuadrics& attributes, Placement placement, uint32_t v,
                  uint32_t w, std::pair<uint32_t, uint32_t> wedges) {
    Quadric q = state.quadrics[v];
    q.add(state.quadrics[w]);
    const glm::dvec3 a = state.point(v), b = state.point(w), middle = (a + b) / 2.0;
    glm::dvec3 point = middle;
    if (placement == Placement::optimal) {
        point = minimum(q, middle);
        const glm::dvec3 off = point - middle, along = b - a;
        if (glm::dot(off, off) > kFarthest * kFarthest * glm::dot(along, along)) point = middle;
    }
    const double more =
        attributes.empty() ? 0 : attributes.meetingCost(wedges.first, wedges.second, point, state.shareAt(v, w, point));
    return {point, q.cost(point, more) * std::max(state.costScale[v], state.costScale[w])};
}

} // namespace xgc::bake
