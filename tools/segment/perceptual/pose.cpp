#include "pose.h"

#include <cmath>

namespace xgc::bake {

namespace {

/// One of Jacobi's rotations: makes m[i][j] of a symmetric matrix 0; the columns of `axes` turn with it.
void annul(glm::dmat3& m, glm::dmat3& axes, int i, int j) {
    if (m[i][j] == 0) return;
    const double slope = (m[j][j] - m[i][i]) / (2 * m[i][j]);
    const double tangent = (slope < 0 ? -1 : 1) / (std::abs(slope) + std::sqrt(slope * slope + 1));
    const double c = 1 / std::sqrt(tangent * tangent + 1), s = tangent * c;
    const auto turn = [c, s](glm::dmat3& columns, int a, int b) {
        const glm::dvec3 before = columns[a];
        columns[a] = before * c - columns[b] * s;
        columns[b] = before * s + columns[b] * c;
    };
    turn(m, i, j);
    m = glm::transpose(m);
    turn(m, i, j);
    turn(axes, i, j);
}

/// Eigenvectors of a symmetric matrix by falling eigenvalue, as columns; right-handed or not.
glm::dmat3 eigenvectors(glm::dmat3 m) {
    constexpr int kRounds = 8; // each about squares what is left beside the diagonal
    glm::dmat3 axes(1.0);
    for (int round = 0; round < kRounds; ++round) {
        annul(m, axes, 0, 1);
        annul(m, axes, 0, 2);
        annul(m, axes, 1, 2);
    }
    int order[3] = {0, 1, 2};
    const auto sortPair = [&](int& a, int& b) {
        if (m[b][b] > m[a][a]) std::swap(a, b);
    };
    sortPair(order[0], order[1]);
    sortPair(order[1], order[2]);
    sortPair(order[0], order[1]);
    return glm::dmat3(axes[order[0]], axes[order[1]], axes[order[2]]);
}

/// The coordinate of largest size, the first of equals.
double largestOf(const glm::dvec3& v) {
    const glm::dvec3 size = glm::abs(v);
    return size.x >= size.y && size.x >= size.z ? v.x : size.y >= size.z ? v.y : v.z;
}

} // namespace

Pose poseOf(const Mesh& mesh, const LinkedFaces& linked, std::span<const uint32_t> faces,
            std::span<const double> faceAreas, double area) {
    constexpr double kEven =
        0.01; // tails that differ by less, as mirror images' do, leave an axis as it lies in the mesh
    Pose pose;
    pose.scale = 1 / std::sqrt(area);
    const auto corner = [&](uint32_t f, int k) { return glm::dvec3(mesh.positions[linked.corners[f][k]]); };
    for (const uint32_t f : faces)
        pose.centroid += (corner(f, 0) + corner(f, 1) + corner(f, 2)) * (faceAreas[f] / (3 * area));

    const auto placed = [&](uint32_t f, int k) { return (corner(f, k) - pose.centroid) * pose.scale; };
    glm::dmat3 spread(0.0);
    for (const uint32_t f : faces) {
        const glm::dvec3 p = placed(f, 0), q = placed(f, 1), r = placed(f, 2), sum = p + q + r;
        const double weight = faceAreas[f] / area;
        for (const glm::dvec3& x : {p, q, r, sum}) spread += glm::outerProduct(x, x * weight);
    }
    glm::dmat3 axes = eigenvectors(spread);
    for (int k = 0; k < 2; ++k) {
        double tails = 0, both = 0;
        for (const uint32_t f : faces) {
            const double along = glm::dot(placed(f, 0) + placed(f, 1) + placed(f, 2), axes[k]);
            const double cube = along * along * along * (faceAreas[f] / area);
            tails += cube;
            both += std::abs(cube);
        }
        const bool isEven = std::abs(tails) < kEven * both;
        if (isEven ? largestOf(axes[k]) < 0 : tails < 0) axes[k] = -axes[k];
    }
    axes[2] = glm::cross(axes[0], axes[1]);
    pose.turn = glm::transpose(axes);
    return pose;
}

} // namespace xgc::bake
