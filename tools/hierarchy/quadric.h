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
        addSquare(n, -glm::dot(n, point), w);
        weight += w;
    }

    /// w (g.p + d)^2, of no weight of its own.
    void addSquare(const glm::dvec3& g, double d, double w) {
        xx += w * g.x * g.x;
        yy += w * g.y * g.y;
        zz += w * g.z * g.z;
        xy += w * g.x * g.y;
        xz += w * g.x * g.z;
        yz += w * g.y * g.z;
        b += (w * d) * g;
        c += w * d * d;
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
