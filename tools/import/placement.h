#pragma once

#include <glm/glm.hpp>

namespace xgc::bake {

/// Takes geometry of a node into mesh space: points by the matrix, directions by its linear part, normals by the
/// inverse transpose of that. Worked in double; the identity changes no bit.
class Placement {
public:
    explicit Placement(const glm::dmat4& toMesh)
        : toMesh_(toMesh), linear_(toMesh), isIdentity_(toMesh == glm::dmat4(1)) {
        // The cofactor matrix is the inverse transpose times the determinant: no division, so flat transforms work.
        const glm::dvec3 a = linear_[0], b = linear_[1], c = linear_[2];
        mirrors_ = glm::dot(a, glm::cross(b, c)) < 0;
        normal_ = glm::dmat3(glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)) * (mirrors_ ? -1.0 : 1.0);
    }

    glm::vec3 point(const glm::vec3& p) const {
        return isIdentity_ ? p : glm::vec3(glm::dvec3(toMesh_ * glm::dvec4(glm::dvec3(p), 1)));
    }
    /// A displacement of points.
    glm::vec3 displacement(const glm::vec3& d) const { return isIdentity_ ? d : glm::vec3(linear_ * glm::dvec3(d)); }
    /// Unit, or zero.
    glm::vec3 normal(const glm::vec3& n) const {
        return glm::vec3(glm::dvec3(placedNormal(n)) * scale(placedNormal(n)));
    }
    /// A displacement of the unit normal `n`, so that the sum keeps its direction.
    glm::vec3 normalDisplacement(const glm::vec3& n, const glm::vec3& d) const {
        return glm::vec3(placedNormal(d) * scale(placedNormal(n)));
    }
    glm::vec4 tangent(const glm::vec4& t) const {
        const glm::dvec3 placed = placedTangent(glm::vec3(t));
        return {glm::vec3(placed * scale(placed)), mirrors_ ? -t.w : t.w};
    }
    glm::vec3 tangentDisplacement(const glm::vec4& t, const glm::vec3& d) const {
        return glm::vec3(placedTangent(d) * scale(placedTangent(glm::vec3(t))));
    }
    /// Corners of a face in the order that keeps its front where it was.
    glm::uvec3 wind(const glm::uvec3& corners) const {
        return mirrors_ ? glm::uvec3(corners.x, corners.z, corners.y) : corners;
    }

private:
    glm::dvec3 placedNormal(const glm::vec3& n) const { return isIdentity_ ? glm::dvec3(n) : normal_ * glm::dvec3(n); }
    glm::dvec3 placedTangent(const glm::vec3& t) const { return isIdentity_ ? glm::dvec3(t) : linear_ * glm::dvec3(t); }

    /// What makes it unit; 1 where it is so within the rounding of its stored form, so that exact input stays so.
    static double scale(const glm::dvec3& v) {
        const double square = glm::dot(v, v);
        if (square == 0 || (square > 0.9999 && square < 1.0001)) return 1;
        return 1 / glm::sqrt(square);
    }

    glm::dmat4 toMesh_;
    glm::dmat3 linear_;
    glm::dmat3 normal_{1};
    bool isIdentity_;
    bool mirrors_ = false;
};

} // namespace xgc::bake
