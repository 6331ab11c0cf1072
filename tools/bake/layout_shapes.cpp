#include "bake/layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

// A part's box lies along the principal axes of its area: the eigenvectors of
//     C = sum over faces of area / 12 * (a a^T + b b^T + c c^T + (a + b + c)(a + b + c)^T),
// the corners a, b, c taken from the part's centroid. Jacobi's rotations find them with square roots alone: the same
// on any machine.

namespace xgc::bake::layout {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>; ///< [row][column]

void addSquare(Matrix& m, const glm::dvec3& v, double weight) {
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) m[i][j] += weight * v[i] * v[j];
    }
}

/// Off-diagonal entries so much smaller than the diagonal ones count as zero: where the axes are not told apart by the
/// shape (a cube, a ball), noise does not turn them.
constexpr double kNoise = 1e-6;

/// One rotation that makes m[p][q] zero; `axes` holds the eigenvectors in its columns.
void rotate(Matrix& m, Matrix& axes, int p, int q) {
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; ++k) {
        const double kp = m[k][p], kq = m[k][q];
        m[k][p] = c * kp - s * kq;
        m[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 3; ++k) {
        const double pk = m[p][k], qk = m[q][k];
        m[p][k] = c * pk - s * qk;
        m[q][k] = s * pk + c * qk;
    }
    for (int k = 0; k < 3; ++k) {
        const double kp = axes[k][p], kq = axes[k][q];
        axes[k][p] = c * kp - s * kq;
        axes[k][q] = s * kp + c * kq;
    }
}

std::array<glm::dvec3, 3> principalAxes(Matrix m) {
    constexpr int kMostSweeps = 32;
    Matrix axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    bool turned = true;
    for (int sweep = 0; turned && sweep < kMostSweeps; ++sweep) {
        turned = false;
        for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
            if (!(std::abs(m[p][q]) > kNoise * (std::abs(m[p][p]) + std::abs(m[q][q])))) continue;
            rotate(m, axes, p, q);
            turned = true;
        }
    }
    std::array<glm::dvec3, 3> columns;
    for (int k = 0; k < 3; ++k) columns[k] = glm::dvec3(axes[0][k], axes[1][k], axes[2][k]);
    return columns;
}

struct Interval {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void add(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
    double size() const { return high - low; }
};

/// Corners of the faces of one part.
class Corners {
public:
    Corners(const Mesh& mesh, std::span<const uint32_t> faces) : mesh_(mesh), faces_(faces) {}

    template <typename Visit>
    void forEachFace(Visit&& visit) const {
        for (const uint32_t f : faces_) {
            const glm::uvec3 p = mesh_.facePositions(f);
            visit(glm::dvec3(mesh_.positions[p.x]), glm::dvec3(mesh_.positions[p.y]), glm::dvec3(mesh_.positions[p.z]));
        }
    }
    /// How far they reach along an axis from a point.
    Interval along(const glm::dvec3& axis, const glm::dvec3& from) const {
        Interval interval;
        forEachFace([&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
            for (const glm::dvec3* corner : {&a, &b, &c}) interval.add(glm::dot(axis, *corner - from));
        });
        return interval;
    }

private:
    const Mesh& mesh_;
    std::span<const uint32_t> faces_;
};

/// Faces without area count alike in a part that has none.
Matrix covarianceOf(const Corners& corners, const PartFigures& part) {
    Matrix m{};
    corners.forEachFace([&](glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
        const glm::dvec3 n = glm::cross(b - a, c - a);
        const double weight = part.area > 0 ? std::sqrt(glm::dot(n, n)) / 2 / part.area : 1.0;
        for (glm::dvec3* corner : {&a, &b, &c}) {
            *corner -= part.centroid;
            addSquare(m, *corner, weight);
        }
        addSquare(m, a + b + c, weight);
    });
    return m;
}

/// The sign that makes the largest component positive, of equal ones the first.
glm::dvec3 pointedForwards(const glm::dvec3& axis) {
    int largest = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::abs(axis[k]) > std::abs(axis[largest])) largest = k;
    }
    return axis[largest] < 0 ? -axis : axis;
}

void storeAxis(const glm::dvec3& axis, float (&out)[3]) {
    for (int k = 0; k < 3; ++k) out[k] = float(axis[k]) + 0.0f; // no -0
}

glm::dvec3 axisOf(const float (&axis)[3]) {
    return {double(axis[0]), double(axis[1]), double(axis[2])};
}

float roundedUp(double value) {
    const auto f = float(value);
    return f > 0 ? std::nextafter(f, std::numeric_limits<float>::infinity()) : 0.0f;
}

void setBox(const Corners& corners, const PartFigures& part, format::PartShape& shape) {
    const std::array<glm::dvec3, 3> axes = principalAxes(covarianceOf(corners, part));
    std::array<double, 3> sizes;
    for (int k = 0; k < 3; ++k) sizes[k] = corners.along(axes[k], part.centroid).size();
    std::array<int, 3> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sizes[a] > sizes[b]; });
    const glm::dvec3 first = pointedForwards(axes[order[0]]), second = pointedForwards(axes[order[1]]);
    storeAxis(first, shape.boxAxes[0]);
    storeAxis(second, shape.boxAxes[1]);
    storeAxis(glm::cross(first, second), shape.boxAxes[2]);

    // The sizes are those along the axes and around the centre as they are stored: the box contains the part.
    glm::dvec3 center = part.centroid;
    for (const float(&axis)[3] : shape.boxAxes) {
        const Interval interval = corners.along(axisOf(axis), part.centroid);
        center += axisOf(axis) * ((interval.low + interval.high) / 2);
    }
    for (int k = 0; k < 3; ++k) shape.boxCenter[k] = float(center[k]);
    for (int k = 0; k < 3; ++k) {
        const Interval interval = corners.along(axisOf(shape.boxAxes[k]), axisOf(shape.boxCenter));
        shape.boxHalfSizes[k] = roundedUp(std::max(-interval.low, interval.high));
    }
}

/// Faces part by part, and where each part's begin.
struct FacesByPart {
    std::vector<uint32_t> faces, first;
};

FacesByPart facesByPart(const Segmentation& parts) {
    FacesByPart by = {std::vector<uint32_t>(parts.facePart.size()), std::vector<uint32_t>(parts.partCount() + 1, 0)};
    for (const uint32_t part : parts.facePart) ++by.first[part + 1];
    std::partial_sum(by.first.begin(), by.first.end(), by.first.begin());
    std::vector<uint32_t> next(by.first.begin(), by.first.end() - 1);
    for (uint32_t f = 0; f < parts.facePart.size(); ++f) by.faces[next[parts.facePart[f]]++] = f;
    return by;
}

} // namespace

std::vector<format::PartShape> shapesOfParts(const Mesh& mesh, const Segmentation& parts,
                                             std::span<const PartFigures> figures) {
    const FacesByPart by = facesByPart(parts);
    std::vector<format::PartShape> shapes(parts.partCount());
    for (uint32_t i = 0; i < shapes.size(); ++i) {
        shapes[i].salience = 1;
        shapes[i].joinedBy = format::kNone;
        const auto faces = std::span(by.faces).subspan(by.first[i], by.first[i + 1] - by.first[i]);
        if (!faces.empty()) setBox({mesh, faces}, figures[i], shapes[i]);
    }
    for (uint32_t m = uint32_t(parts.merges.size()); m-- > 0;) {
        const PartMerge& merge = parts.merges[m];
        shapes[merge.a].salience = shapes[merge.b].salience = std::clamp(merge.cost, 0.0f, 1.0f);
        shapes[merge.b].joinedBy = m;
    }
    return shapes;
}

} // namespace xgc::bake::layout
