#include "tiny_components.h"
#include "nearest_position.h"

#include <algorithm>

namespace xgc::bake {

namespace {

/// The label that most corners of a component lie on, or kNone.
uint32_t labelAround(const AnalysedMesh& at, uint32_t component, const Labels& labels) {
    std::vector<uint32_t> seen;
    for (const uint32_t f : at.facesOf(component)) {
        for (int k = 0; k < 3; ++k) {
            for (const uint32_t g : at.topology.facesOfVertex(at.linked.corners[f][k])) {
                const uint32_t label = labels.ofFace[at.linked.standsFor[g]];
                if (label != kNone) seen.push_back(label);
            }
        }
    }
    std::sort(seen.begin(), seen.end());
    uint32_t best = kNone;
    size_t most = 0;
    for (size_t i = 0, j = 0; i < seen.size(); i = j) {
        while (j < seen.size() && seen[j] == seen[i]) ++j;
        if (j - i <= most) continue;
        most = j - i;
        best = seen[i];
    }
    return best;
}

void placeByNearness(const AnalysedMesh& at, Labels& labels) {
    std::vector<uint32_t> labelAt(at.mesh.positions.size(), kNone), labelled;
    for (uint32_t f = 0; f < at.mesh.faceCount(); ++f) {
        if (labels.ofFace[f] == kNone) continue;
        for (int k = 0; k < 3; ++k) {
            const uint32_t p = at.linked.corners[f][k];
            if (labelAt[p] == kNone) labelled.push_back(p);
            labelAt[p] = std::min(labelAt[p], labels.ofFace[f]);
        }
    }
    const bool none = labelled.empty(); // nothing but crumbs: one part
    const NearestPosition nearest(at.mesh.positions, std::move(labelled));
    for (const uint32_t c : at.tiny) {
        const std::span<const uint32_t> faces = at.facesOf(c);
        if (labels.ofFace[faces[0]] != kNone) continue;
        glm::vec3 center(0);
        for (const uint32_t f : faces) center += at.mesh.positions[at.linked.corners[f].x] / float(faces.size());
        const uint32_t label = none ? 0 : labelAt[nearest.of(center)];
        for (const uint32_t f : faces) labels.ofFace[f] = label;
    }
    labels.count = std::max(labels.count, 1u);
}

} // namespace

void placeTinyComponents(const AnalysedMesh& at, Labels& labels) {
    constexpr int kRounds = 4;
    std::vector<uint32_t> rest = at.tiny;
    for (int round = 0; round < kRounds && !rest.empty(); ++round) {
        std::erase_if(rest, [&](uint32_t c) {
            const uint32_t label = labelAround(at, c, labels);
            for (const uint32_t f : at.facesOf(c)) labels.ofFace[f] = label;
            return label != kNone;
        });
    }
    if (!rest.empty()) placeByNearness(at, labels);
    for (uint32_t f = 0; f < at.mesh.faceCount(); ++f) labels.ofFace[f] = labels.ofFace[at.linked.standsFor[f]];
}

} // namespace xgc::bake
