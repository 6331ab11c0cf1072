#pragma once

#include <xgc/select.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <random>
#include <vector>

namespace xgc::test {

/// Numbers, places, placements and states that are the same on every machine.
class Random {
public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    uint32_t below(uint32_t n) { return uint32_t(engine_() % n); }
    float between(float a, float b) { return a + (b - a) * float(engine_() % 100001u) / 100000.0f; }
    glm::vec3 point(float size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
    glm::vec3 direction() { return glm::normalize(point(1) + glm::vec3(1e-3f)); }
    /// Turned, stretched and mirrored at random.
    Placement placement(float size) {
        glm::mat4 m = glm::translate(glm::mat4(1), point(size));
        m = glm::rotate(m, between(0, 6), direction());
        const float mirror = below(2) ? 1.0f : -1.0f;
        return makePlacement(glm::scale(m, glm::vec3(mirror * between(0.5f, 2), between(0.5f, 2), between(0.5f, 2))));
    }

    /// Any level for each patch.
    std::vector<uint8_t> levels(const AssetView& asset) {
        std::vector<uint8_t> out(asset.patchCount());
        for (uint8_t& level : out) level = uint8_t(below(asset.levelCount()));
        return out;
    }

private:
    std::mt19937 engine_;
};

} // namespace xgc::test
