#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::bake {

/// Sum of weighted squared distances to planes (Garland and Heckbert 1997): p'Ap + 2 b'p + c, and the sum of weights.
struct Quadric {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    glm::dvec3 b{0};
    double c = 0;
    double weight = 0;

    /// The plane through `point` with unit normal `n`.
    void addPlane(const glm::dvec3& n, const glm::dvec3& point, double w) {
        const double d = -glm::dot(n, point);
        xx += w * n.x * n.x;
        yy += w * n.y * n.y;
        zz += w * n.z * n.z;
        xy += w * n.x * n.y;
        xz += w * n.x * n.z;
        yz += w * n.y * n.z;
        b += (w * d) * n;
        c += w * d * d;
        weight += w;
    }

    void add(const Quadric& q) {
        xx += q.xx;
        yy += q.yy;
        zz += q.zz;
        xy += q.xy;
        xz += q.xz;
        yz += q.yz;
        b += q.b;
        c += q.c;
        weight += q.weight;
    }

    glm::dvec3 times(const glm::dvec3& p) const {
        return {xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
    }

    /// Never negative: rounding may take the sum of squares below zero.
    double sum(const glm::dvec3& p) const { return std::max(0.0, glm::dot(p, times(p)) + 2 * glm::dot(b, p) + c); }

    /// Half-way between the sum of squares (least RMS error) and their mean (least maximum error): the mean times the
    /// root of the weight.
    /// `more`: a sum of squares of other things at that point, weighted alike.
    double cost(const glm::dvec3& p, double more = 0) const {
        return weight > 0 ? (sum(p) + more) / std::sqrt(weight) : 0;
    }
};

} // namespace xgc::bake
