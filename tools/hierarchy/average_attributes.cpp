#include "hierarchy/average_attributes.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace xgc::bake {

namespace {

/// Of two directions that cancel out, the first.
glm::vec3 averageDirection(glm::vec3 a, glm::vec3 b, float share) {
    const glm::vec3 sum = a * (1 - share) + b * share;
    const float length = std::sqrt(glm::dot(sum, sum));
    return length > 0 ? sum / length : a;
}

template <typename T>
void appendMean(std::vector<T>& column, uint32_t a, uint32_t b, float share) {
    if (!column.empty()) column.push_back(column[a] * (1 - share) + column[b] * share);
}

struct Influence {
    uint16_t joint;
    float weight;
};

void addInfluences(const Attributes& attributes, uint32_t row, float share, std::vector<Influence>& influences) {
    for (size_t set = 0; set < Attributes::kJointSets; ++set) {
        if (attributes.joints[set].empty() || attributes.weights[set].empty()) continue;
        for (int k = 0; k < 4; ++k) {
            const Influence add{attributes.joints[set][row][k], attributes.weights[set][row][k] * share};
            if (!(add.weight > 0)) continue;
            const auto known = std::ranges::find(influences, add.joint, &Influence::joint);
            if (known == influences.end()) {
                influences.push_back(add);
            } else {
                known->weight += add.weight;
            }
        }
    }
}

float sumOfWeights(std::span<const Influence> influences) {
    float sum = 0;
    for (const Influence& influence : influences) sum += influence.weight;
    return sum;
}

void appendInfluences(Attributes& attributes, uint32_t a, uint32_t b, float share) {
    std::vector<Influence> influences;
    addInfluences(attributes, a, 1 - share, influences);
    addInfluences(attributes, b, share, influences);
    std::ranges::sort(influences, [](const Influence& x, const Influence& y) {
        return x.weight != y.weight ? x.weight > y.weight : x.joint < y.joint;
    });
    size_t room = 0;
    for (size_t set = 0; set < Attributes::kJointSets; ++set) {
        if (!attributes.joints[set].empty() && !attributes.weights[set].empty()) room += 4;
    }
    const float all = sumOfWeights(influences);
    if (influences.size() > room) {
        influences.resize(room);
        const float scale = all / sumOfWeights(influences);
        for (Influence& influence : influences) influence.weight *= scale;
    }
    size_t next = 0;
    for (size_t set = 0; set < Attributes::kJointSets; ++set) {
        if (attributes.joints[set].empty() || attributes.weights[set].empty()) continue;
        glm::u16vec4 joints(0);
        glm::vec4 weights(0);
        for (int k = 0; k < 4 && next < influences.size(); ++k, ++next) {
            joints[k] = influences[next].joint;
            weights[k] = influences[next].weight;
        }
        attributes.joints[set].push_back(joints);
        attributes.weights[set].push_back(weights);
    }
}

} // namespace

void appendAverage(Attributes& attributes, uint32_t a, uint32_t b, float share) {
    if (!attributes.normals.empty())
        attributes.normals.push_back(averageDirection(attributes.normals[a], attributes.normals[b], share));
    if (!attributes.tangents.empty()) {
        const glm::vec4 s = attributes.tangents[a], t = attributes.tangents[b];
        attributes.tangents.emplace_back(averageDirection(glm::vec3(s), glm::vec3(t), share), s.w);
    }
    for (auto& uvs : attributes.uvs) appendMean(uvs, a, b, share);
    for (auto& colors : attributes.colors) appendMean(colors, a, b, share);
    appendInfluences(attributes, a, b, share);
    for (MorphTarget& target : attributes.morphTargets) {
        appendMean(target.positions, a, b, share);
        appendMean(target.normals, a, b, share);
        appendMean(target.tangents, a, b, share);
    }
}

} // namespace xgc::bake
