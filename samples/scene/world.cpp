#include "world.h"

#include <xgc/indices.h>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace xgc::scene_sample {
namespace {

constexpr float kTerrainScale = 11;

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

Ground::Ground(const AssetView& asset, const glm::mat4& toWorld, std::string_view material)
    : heights_(kCells * kCells, -1e30f) {
    const std::vector<uint8_t> levels(asset.patchCount(), 0);
    std::vector<uint32_t> scratch(scratchCapacity(asset)), rows;
    std::vector<glm::vec3> points;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        const format::MaterialRecord& m = asset.materials[asset.patches[p].material];
        if (!material.empty() && asset.text(m.name) != material) continue;
        rows.resize(indexCapacity(asset, p, levels));
        rows.resize(buildIndices(asset, p, levels, scratch, rows));
        for (const uint32_t row : rows) points.emplace_back(toWorld * glm::vec4(asset.positions[row], 1));
    }
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

glm::vec2 Ground::range(float x, float z, float radius) const {
    glm::vec2 out(1e30f, -1e30f);
    for (int i = 0; i < 64; ++i) {
        const float angle = 2.399963f * float(i), r = radius * std::sqrt(float(i) / 63);
        const float h = height(x + r * std::cos(angle), z + r * std::sin(angle));
        out = {std::min(out.x, h), std::max(out.y, h)};
    }
    return out;
}

glm::vec2 Ground::flattest(float radius, float within) const {
    glm::vec2 best(0);
    float least = 1e30f;
    for (int j = -20; j <= 20; ++j) {
        for (int i = -20; i <= 20; ++i) {
            const glm::vec2 at = within * glm::vec2(i, j) / 20.0f, heights = range(at.x, at.y, radius);
            if (heights.y - heights.x >= least) continue;
            least = heights.y - heights.x;
            best = at;
        }
    }
    return best;
}

namespace {

/// A number from 0 to 1 that looks random.
float scattered(uint32_t i) {
    const float v = std::sin(12.9898f * float(i + 1)) * 43758.5453f;
    return v - std::floor(v);
}

/// Creatures left and right of the way to the temple, each turned to it more or less.
void placeCreatures(const AssetView& creature, const Ground& lawn, const glm::vec3& fox, uint32_t count, World& world) {
    std::vector<glm::vec2> taken{{fox.x, fox.z}};
    for (uint32_t i = 0; world.creatures.size() < count && i < 4000; ++i) {
        const glm::vec2 at(16.4f * scattered(2 * i) - 8.2f, 17 * scattered(2 * i + 1) - 5);
        const bool onWay = std::fabs(at.x) < 3.1f && at.y > 5.2f, inTemple = std::fabs(at.x) < 4.2f && at.y < 5.8f;
        const bool crowded = std::any_of(taken.begin(), taken.end(), [&](const glm::vec2& other) {
            return glm::distance(at, other) < (other == taken[0] ? 1.5f : 0.8f);
        });
        if (onWay || inTemple || crowded) continue;
        taken.push_back(at);
        const float facing = std::atan2(-at.x, -at.y) + 1.6f * (scattered(i + 7) - 0.5f);
        const glm::vec3 feet(at.x, lawn.height(at.x, at.y) - 0.02f, at.y);
        world.creatures.push_back(standing(creature, feet, 0.62f + 0.3f * scattered(i + 3), facing));
    }
}

} // namespace

/// The temple in the middle with its lawn, the terrain's flattest place below it, the eye before it.
World makeWorld(const WorldAssets& assets, uint32_t creatureCount) {
    World world;
    const Ground lawn(assets.temple, world.temple, "earth");
    const glm::mat4 scaled = glm::scale(glm::mat4(1), glm::vec3(kTerrainScale));
    const Ground terrain(assets.terrain, scaled);
    const glm::vec2 site = terrain.flattest(7, 16);
    const float floor = terrain.range(site.x, site.y, 9).y + 0.1f;
    // Turned so that the middle of the terrain, with its mountains, lies behind the temple.
    const float turn = std::atan2(site.x, site.y);
    const glm::mat4 turned = glm::rotate(glm::mat4(1), -turn, {0, 1, 0});
    world.terrain = turned * glm::translate(glm::mat4(1), {-site.x, -floor, -site.y}) * scaled;
    const glm::vec3 feet(-0.2f, lawn.height(-0.2f, 11.9f), 11.9f);
    world.fox = standing(assets.fox, feet, 1.0f, 1.25f);
    placeCreatures(assets.creature, lawn, feet, creatureCount, world);
    world.eye = {4.2f, 2.4f, 18.4f};
    world.target = {0.2f, 2.65f, 3.0f};
    world.towardsSun = glm::normalize(glm::vec3(0.45f, 0.95f, 0.6f));
    world.center = {0, 1, 3};
    world.radius = 15;
    return world;
}

} // namespace xgc::scene_sample
