#include "hierarchy/attribute_quadrics.h"

#include <array>

namespace xgc::bake {

AttributeQuadrics::AttributeQuadrics(const SurfaceState& state, const HierarchyOptions& options) {
    const Attributes& a = state.mesh.attributes;
    const bool normals = options.normalWeight > 0 && !a.normals.empty();
    const bool uvs = options.uvWeight > 0 && !a.uvs[0].empty();
    const bool colors = options.colorWeight > 0 && !a.colors[0].empty();
    count_ = size_t(normals ? 3 : 0) + size_t(uvs ? 2 : 0) + size_t(colors ? 4 : 0);
    if (count_ == 0) return;
    const size_t wedges = state.mesh.wedgePosition.size();
    grow(wedges);
    for (uint32_t w = 0; w < wedges; ++w) {
        float* value = valuesAt(w);
        for (int k = 0; normals && k < 3; ++k)
            *value++ = float(double(a.normals[w][k]) * options.normalWeight * state.diagonal);
        for (int k = 0; uvs && k < 2; ++k) *value++ = float(double(a.uvs[0][w][k]) * options.uvWeight * state.diagonal);
        for (int k = 0; colors && k < 4; ++k)
            *value++ = float(double(a.colors[0][w][k]) * options.colorWeight * state.diagonal);
    }
    for (const glm::uvec3& face : state.mesh.faces) addFace(state, face);
}

void AttributeQuadrics::grow(size_t wedgeCount) {
    if (empty()) return;
    values_.resize(wedgeCount * count_);
    gradients_.resize(wedgeCount * count_, glm::vec4(0));
    sums_.resize(wedgeCount);
}

void AttributeQuadrics::addFace(const SurfaceState& state, glm::uvec3 wedges) {
    std::array<glm::dvec3, 3> p;
    for (size_t k = 0; k < 3; ++k) p[k] = state.point(state.mesh.wedgePosition[wedges[int(k)]]);
    const glm::dvec3 u = p[1] - p[0], v = p[2] - p[0];
    const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) return;
    const double area = std::sqrt(determinant) / 2;
    const glm::dvec3 alongU = (vv * u - uv * v) / determinant, alongV = (uu * v - uv * u) / determinant;
    Quadric sum;
    sum.weight = area;
    std::array<glm::vec4, 9> gradients;
    for (size_t k = 0; k < count_; ++k) {
        const double a = double(valuesAt(wedges.x)[k]);
        const glm::dvec3 g =
            alongU * (double(valuesAt(wedges.y)[k]) - a) + alongV * (double(valuesAt(wedges.z)[k]) - a);
        const double constant = a - glm::dot(g, p[0]);
        sum.addSquare(g, constant, area);
        gradients[k] = glm::vec4(area * glm::dvec4(g, constant));
    }
    for (int corner = 0; corner < 3; ++corner) {
        sums_[wedges[corner]].add(sum);
        for (size_t k = 0; k < count_; ++k) gradients_[wedges[corner] * count_ + k] += gradients[k];
    }
}

/// Sum over faces and attributes of area * (gradient . point + constant - value)^2.
double AttributeQuadrics::evaluate(uint32_t wedge, const glm::dvec3& p, uint32_t first, uint32_t second,
                                   double share) const {
    const Quadric& s = sums_[wedge];
    double sum = glm::dot(p, s.times(p)) + 2 * glm::dot(s.b, p) + s.c;
    for (size_t k = 0; k < count_; ++k) {
        const double value =
            (1 - share) * double(values_[first * count_ + k]) + share * double(values_[second * count_ + k]);
        const glm::dvec4 g(gradients_[wedge * count_ + k]);
        sum += value * value * s.weight - 2 * value * (glm::dot(glm::dvec3(g), p) + g.w);
    }
    return std::max(0.0, sum);
}

double AttributeQuadrics::cost(uint32_t wedge, const glm::dvec3& point, uint32_t valuesOf) const {
    return evaluate(wedge, point, valuesOf, valuesOf, 0);
}

double AttributeQuadrics::meetingCost(uint32_t first, uint32_t second, const glm::dvec3& point, double share) const {
    return evaluate(first, point, first, second, share) + evaluate(second, point, first, second, share);
}

void AttributeQuadrics::add(uint32_t to, uint32_t from) {
    if (empty()) return;
    sums_[to].add(sums_[from]);
    for (size_t k = 0; k < count_; ++k) gradients_[to * count_ + k] += gradients_[from * count_ + k];
}

void AttributeQuadrics::make(uint32_t made, const SurfaceState::MadeWedge& of) {
    if (empty()) return;
    for (size_t k = 0; k < count_; ++k) {
        values_[made * count_ + k] =
            (1 - of.share) * values_[of.first * count_ + k] + of.share * values_[of.second * count_ + k];
        gradients_[made * count_ + k] = glm::vec4(0);
    }
    sums_[made] = {};
    add(made, of.first);
    add(made, of.second);
}

} // namespace xgc::bake
