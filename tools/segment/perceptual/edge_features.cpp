#include "edge_features.h"
#include "exact_math.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace xgc::bake {

namespace {

/// Above this median step between neighbouring normals a surface counts as noisy.
constexpr float kNoisyStep = 0.15f;

float angleBetween(const glm::vec3& a, const glm::vec3& b) {
    return float(exact::upperAngle(double(glm::length(glm::cross(a, b))), double(glm::dot(a, b))));
}

/// The element in the middle, by value.
float medianOf(std::vector<float> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Mean square distance that a round of the filter mixes over.
double squareStep(const CellGraph& graph) {
    double sum = 0;
    for (uint32_t c = 0; c < graph.size(); ++c) {
        double spread = 0, weight = double(graph.areas[c]);
        for (const CellGraph::Arc& arc : graph.arcsOf(c)) {
            const glm::vec3 d = graph.centers[arc.to] - graph.centers[c];
            spread += double(graph.areas[arc.to]) * double(glm::dot(d, d));
            weight += double(graph.areas[arc.to]);
        }
        if (weight > 0) sum += double(graph.areas[c]) * spread / weight;
    }
    return sum;
}

/// Area-weighted means over neighbours, `rounds` times.
void filterNormals(const CellGraph& graph, uint32_t rounds, std::vector<glm::vec3>& normals) {
    std::vector<glm::vec3> weighted(normals.size());
    for (uint32_t round = 0; round < rounds; ++round) {
        for (size_t c = 0; c < normals.size(); ++c) weighted[c] = normals[c] * graph.areas[c];
        for (uint32_t c = 0; c < graph.size(); ++c) {
            glm::vec3 sum = weighted[c];
            for (const CellGraph::Arc& arc : graph.arcsOf(c)) sum += weighted[arc.to];
            const float square = glm::dot(sum, sum);
            if (square > 0) normals[c] = sum / std::sqrt(square);
        }
    }
}

/// Signed turns at one scale: below 0 where concave.
std::vector<float> turnsAt(const CellGraph& graph, std::span<const glm::vec3> normals, float width) {
    const float leastStep = 0.3f / std::sqrt(float(graph.size()));
    std::vector<float> turns(graph.links.size());
    for (size_t l = 0; l < turns.size(); ++l) {
        const CellGraph::Link& link = graph.links[l];
        const glm::vec3 between = graph.centers[link.b] - graph.centers[link.a];
        const glm::vec3& na = normals[link.a];
        const glm::vec3& nb = normals[link.b];
        const float turn = angleBetween(na, nb) / std::max(glm::length(between), leastStep) * width;
        turns[l] = glm::dot(nb - na, between) < 0 ? -turn : turn;
    }
    return turns;
}

/// Turns that noise alone would give are taken off all.
void shrinkTurns(std::vector<float>& turns, float factor) {
    std::vector<float> sizes(turns.size());
    for (size_t l = 0; l < turns.size(); ++l) sizes[l] = std::abs(turns[l]);
    const float by = factor * medianOf(sizes);
    for (float& t : turns) t = t > 0 ? std::max(0.0f, t - by) : std::min(0.0f, t + by);
}

} // namespace

EdgeFeatures findEdgeFeatures(const CellGraph& graph) {
    EdgeFeatures features;
    features.angle.resize(graph.links.size());
    std::vector<float> steps(graph.links.size());
    for (size_t l = 0; l < steps.size(); ++l) {
        const CellGraph::Link& link = graph.links[l];
        const glm::vec3 step = graph.normals[link.b] - graph.normals[link.a];
        steps[l] = glm::length(step);
        const float angle = angleBetween(graph.normals[link.a], graph.normals[link.b]);
        features.angle[l] = glm::dot(step, graph.centers[link.b] - graph.centers[link.a]) < 0 ? -angle : angle;
    }
    features.noise = medianOf(std::move(steps));

    const float noisy = std::min(4.0f, std::max(1.0f, features.noise / kNoisyStep));
    const std::array<double, 2> radii = {0.010 * double(noisy), 0.025 * (1 + 0.5 * double(noisy - 1))};
    const double q = std::max(1e-12, squareStep(graph));
    std::vector<glm::vec3> normals = graph.normals;
    features.concave.assign(graph.links.size(), 0.0f);
    features.convex.assign(graph.links.size(), 0.0f);
    uint32_t done = 0;
    for (const double r : radii) {
        const auto rounds = uint32_t(std::clamp(r * r / q + 0.5, 1.0, 400.0));
        filterNormals(graph, std::max(rounds, done) - done, normals);
        done = std::max(rounds, done);
        if (r == radii[0]) features.filteredNormals = normals;
        std::vector<float> turns = turnsAt(graph, normals, float(1.77 * std::sqrt(double(done) * q)));
        if (noisy > 1) shrinkTurns(turns, 2 * std::min(1.0f, noisy - 1));
        for (size_t l = 0; l < turns.size(); ++l) {
            features.concave[l] = std::max(features.concave[l], -turns[l]);
            features.convex[l] = std::max(features.convex[l], turns[l]);
        }
    }
    return features;
}

} // namespace xgc::bake
