#include "world.h"

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::scene_sample {
namespace {

constexpr float kTerrainHalf = 24; ///< world units from the middle of the terrain to its border

glm::vec3 low(const AssetView& a) {
    return {a.record->boundsMin[0], a.record->boundsMin[1], a.record->boundsMin[2]};
}
glm::vec3 high(const AssetView& a) {
    return {a.record->boundsMax[0], a.record->boundsMax[1], a.record->boundsMax[2]};
}

/// An asset at a height, turned about y, its feet's middle at `feet`.
glm::mat4 standing(const AssetView& a, const glm::vec3& feet, float height, float turn) {
    const float scale = height / std::max(high(a).y - low(a).y, 1e-6f);
    const glm::vec3 middle = 0.5f * (low(a) + high(a));
    glm::mat4 m = glm::translate(glm::mat4(1), feet);
    m = glm::scale(glm::rotate(m, turn, {0, 1, 0}), glm::vec3(scale));
    return glm::translate(m, -glm::vec3(middle.x, low(a).y, middle.z));
}

} // namespace

bake::Status LoadedAsset::load(const std::filesystem::path& file) {
    const bake::Status status = bake::readImage(file, bytes);
    if (!status.ok()) return status;
    const Status opened = openAll(bytes.span(), view);
    if (opened.ok()) return {};
    return bake::badInput(fmt::format("{}: {} (element {})", file.string(), opened.message, opened.element));
}

Ground::Ground(const AssetView& terrain, const glm::mat4& toWorld) : heights_(kCells * kCells, -1e30f) {
    std::vector<glm::vec3> points;
    for (const glm::vec3& p : terrain.positions) points.emplace_back(toWorld * glm::vec4(p, 1));
    for (const glm::vec3& p : points) half_ = std::max({half_, std::fabs(p.x), std::fabs(p.z)});
    for (const glm::vec3& p : points) {
        const auto at = [&](float v) { return std::clamp(int((v / half_ + 1) * 0.5f * kCells), 0, kCells - 1); };
        float& h = heights_[size_t(at(p.z) * kCells + at(p.x))];
        h = std::max(h, p.y);
    }
    // Cells without a vertex take the height beside them.
    for (int pass = 0; pass < kCells; ++pass) {
        bool holes = false;
        for (int z = 0; z < kCells; ++z) {
            for (int x = 0; x < kCells; ++x) {
                float& h = heights_[size_t(z * kCells + x)];
                if (h > -1e29f) continue;
                h = std::max({cell(x - 1, z), cell(x + 1, z), cell(x, z - 1), cell(x, z + 1)});
                holes = true;
            }
        }
        if (!holes) break;
    }
}

float Ground::cell(int x, int z) const {
    return heights_[size_t(std::clamp(z, 0, kCells - 1) * kCells + std::clamp(x, 0, kCells - 1))];
}

float Ground::height(float x, float z) const {
    const float gx = (x / half_ + 1) * 0.5f * kCells - 0.5f, gz = (z / half_ + 1) * 0.5f * kCells - 0.5f;
    const int x0 = int(std::floor(gx)), z0 = int(std::floor(gz));
    const float a = gx - float(x0), b = gz - float(z0);
    return glm::mix(glm::mix(cell(x0, z0), cell(x0 + 1, z0), a), glm::mix(cell(x0, z0 + 1), cell(x0 + 1, z0 + 1), a),
                    b);
}

float Ground::roughness(float x, float z, float radius) const {
    float least = 1e30f, most = -1e30f;
    for (int i = 0; i < 24; ++i) {
        const float angle = 2.399963f * float(i), r = radius * std::sqrt(float(i) / 23);
        const float h = height(x + r * std::cos(angle), z + r * std::sin(angle));
        least = std::min(least, h);
        most = std::max(most, h);
    }
    return most - least;
}

glm::vec3 Ground::flattest(float radius, float within) const {
    glm::vec3 best(0);
    float least = 1e30f;
    for (int j = -20; j <= 20; ++j) {
        for (int i = -20; i <= 20; ++i) {
            const float x = within * float(i) / 20, z = within * float(j) / 20, rough = roughness(x, z, radius);
            if (rough >= least) continue;
            least = rough;
            best = {x, height(x, z), z};
        }
    }
    return best;
}

World makeWorld(const WorldAssets& assets, uint32_t creatureCount) {
    World world;
    const glm::vec3 size = high(assets.terrain) - low(assets.terrain),
                    middle = 0.5f * (low(assets.terrain) + high(assets.terrain));
    world.terrain = glm::scale(glm::mat4(1), glm::vec3(2 * kTerrainHalf / std::max(size.x, size.z)));
    world.terrain = glm::translate(world.terrain, -glm::vec3(middle.x, low(assets.terrain).y, middle.z));
    const Ground ground(assets.terrain, world.terrain);

    const glm::vec3 site = ground.flattest(5.0f, 14);
    world.temple = standing(assets.temple, site - glm::vec3(0, 0.12f, 0), 3.0f, 0.35f);

    // The eye looks at the temple from the open side, low over the ground; the fox stands before it.
    float best = 1e30f;
    glm::vec2 side(0, 1);
    for (int i = 0; i < 32; ++i) {
        const glm::vec2 way(std::cos(0.19635f * float(i)), std::sin(0.19635f * float(i)));
        float worst = 0;
        for (float r = 3; r <= 11; r += 0.5f) {
            worst = std::max(worst, ground.height(site.x + r * way.x, site.z + r * way.y) - site.y);
        }
        const float rise = worst + 0.02f * std::fabs(float(i) - 8);
        if (rise >= best) continue;
        best = rise;
        side = way;
    }
    const glm::vec2 across(-side.y, side.x);
    const auto at = [&](float away, float aside) {
        const glm::vec2 p = glm::vec2(site.x, site.z) + away * side + aside * across;
        return glm::vec3(p.x, ground.height(p.x, p.y), p.y);
    };
    world.eye = at(11.5f, 0.6f) + glm::vec3(0, 1.9f, 0);
    world.target = site + glm::vec3(0, 0.9f, 0);
    const glm::vec3 foxFeet = at(8.9f, 1.15f);
    world.fox = standing(assets.fox, foxFeet, 0.8f, std::atan2(-across.x, -across.y) + 0.35f);

    for (uint32_t i = 0; world.creatures.size() < creatureCount && i < 40 * creatureCount; ++i) {
        const float angle = 2.399963f * float(i), r = 2.6f + 0.42f * std::sqrt(float(i));
        const glm::vec2 p(site.x + r * std::cos(angle), site.z + r * std::sin(angle));
        const bool inView = glm::distance(p, {world.eye.x, world.eye.z}) > 3.4f;
        const bool clear = glm::distance(p, {foxFeet.x, foxFeet.z}) > 1.3f;
        if (!inView || !clear || ground.roughness(p.x, p.y, 0.3f) > 0.5f) continue;
        const float jitter = std::sin(12.9898f * float(i)) * 43758.5453f, random = jitter - std::floor(jitter);
        const float facing = std::atan2(site.x - p.x, site.z - p.y) + 1.4f * (random - 0.5f);
        const glm::vec3 feet(p.x, ground.height(p.x, p.y) - 0.02f, p.y);
        world.creatures.push_back(standing(assets.creature, feet, 0.5f + 0.25f * random, facing));
    }
    world.center = site;
    world.radius = 15;
    return world;
}

} // namespace xgc::scene_sample
