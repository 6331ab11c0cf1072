#include "models/makers.h"

#include "models/model_builder.h"
#include "models/noise.h"
#include "models/surface_net.h"
#include "models/trig.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// A broad-leaved tree, about eight units tall, y up. Trunk, limbs and boughs are rounded cones melted into one closed
// skin of bark; around the outer half of every bough hangs a cloud of leaf cards: kites of two triangles, open, each a
// piece of its own, every sixth with a twin that crosses it. Bark takes a fifth of the faces.

namespace xgc::bake::models {
namespace {

enum TreeMaterial : uint32_t { kBark, kLeaves };

constexpr glm::vec3 kHeart(0, 5.0f, 0); ///< middle of the crown
constexpr glm::vec3 kCrownRadii(2.9f, 2.75f, 2.9f);
constexpr double kGoldenTurn = 0.381966011250105;
constexpr uint32_t kTwinEvery = 6;

const Skin kTrunkSkin{{0.19f, 0.13f, 0.09f}, kBark};
const Skin kLimbSkin{{0.22f, 0.155f, 0.105f}, kBark};

/// Numbers drawn one after another.
class Dice {
public:
    explicit Dice(uint32_t seed) : state_(hash(seed)) {}
    /// In [-1, 1).
    float side() { return signedUnit(state_ = hash(state_ + 0x9e3779b9u)); }
    float between(float low, float high) { return low + (high - low) * (0.5f + 0.5f * side()); }
    glm::vec3 inCube() {
        const float x = side(), y = side(), z = side();
        return {x, y, z};
    }
    glm::vec3 inBall() {
        for (;;) {
            const glm::vec3 p = inCube();
            if (glm::dot(p, p) < 1) return p;
        }
    }

private:
    uint32_t state_;
};

/// Quadratic curve of a limb or bough, thinner towards its end.
struct Bough {
    glm::vec3 from, bend, to;
    float thick, thin;
    glm::vec3 at(float t) const { return glm::mix(glm::mix(from, bend, t), glm::mix(bend, to, t), t); }
    float radius(float t) const { return glm::mix(thick, thin, t); }
};

void addBough(Body& body, const Bough& b, uint32_t pieces, float blend, const Skin& skin) {
    for (uint32_t i = 0; i < pieces; ++i) {
        const float s = float(i) / float(pieces), t = float(i + 1) / float(pieces);
        body.add(roundCone(b.at(s), b.radius(s), b.at(t), b.radius(t), blend, skin));
    }
}

glm::vec3 towards(double turn, float rise) {
    const glm::vec2 c = circlePoint(turn);
    return {c.x, rise, c.y};
}

/// Limbs leave the trunk in a spiral and end inside the crown, each with boughs that reach its rim.
class Skeleton {
public:
    Skeleton() {
        trunk_ = {{0, -0.05f, 0}, {0.12f, 3.2f, -0.10f}, {-0.05f, 6.3f, 0.08f}, 0.34f, 0.07f};
        constexpr uint32_t kLimbs = 11;
        Dice dice(5);
        for (uint32_t i = 0; i < kLimbs; ++i) {
            const float share = float(i) / float(kLimbs - 1), at = glm::mix(0.30f, 0.86f, share);
            const double turn = kGoldenTurn * i + 0.03 * double(dice.side());
            const glm::vec3 from = trunk_.at(at);
            const glm::vec3 out = towards(turn, glm::mix(-0.28f, 0.85f, share) + 0.1f * dice.side());
            const glm::vec3 end = kHeart + 0.62f * kCrownRadii * out / std::sqrt(glm::dot(out, out));
            const glm::vec3 bend = glm::mix(from, end, 0.55f) + glm::vec3(0, 0.12f - 0.30f * (1 - share), 0);
            limbs_.push_back({from, bend, end, 0.55f * trunk_.radius(at), 0.035f});
            addBoughs(limbs_.back(), dice);
        }
        // What the trunk ends in.
        limbs_.push_back({trunk_.at(0.9f), trunk_.at(0.96f), trunk_.at(1), 0.08f, 0.05f});
        addBoughs(limbs_.back(), dice);
    }

    /// As much of it as a skin of so many faces can show.
    Body body(uint32_t faces) const {
        Body body;
        addBough(body, trunk_, 6, 0.05f, kTrunkSkin);
        for (uint32_t i = 0; i < 6; ++i) { // roots
            const glm::vec3 out = towards(double(i) / 6 + 0.05 * (i % 2), 0);
            const float reach = 0.70f + 0.13f * float(i % 3);
            body.add(roundCone({0, 0.50f, 0}, 0.22f, out * reach + glm::vec3(0, -0.10f, 0), 0.035f, 0.18f, kTrunkSkin));
        }
        if (faces < 700) return body;
        for (size_t l = 0; l < limbs_.size(); ++l) {
            addBough(body, limbs_[l], 4, 0.07f, kLimbSkin);
            if (faces < 2500) continue;
            for (const Bough& b : boughs_[l]) addBough(body, b, 2, 0.03f, kLimbSkin);
        }
        return body;
    }

    size_t limbCount() const { return boughs_.size(); }
    const std::vector<Bough>& boughsOf(size_t limb) const { return boughs_[limb]; }

private:
    void addBoughs(const Bough& limb, Dice& dice) {
        constexpr uint32_t kBoughs = 5;
        boughs_.emplace_back();
        for (uint32_t k = 0; k < kBoughs; ++k) {
            const float at = glm::mix(0.45f, 1.0f, float(k) / float(kBoughs - 1));
            const glm::vec3 from = limb.at(at);
            const glm::vec3 way = (limb.to - kHeart) / kCrownRadii + 0.85f * dice.inBall();
            const glm::vec3 rim =
                kHeart + dice.between(0.66f, 0.98f) * kCrownRadii * way / std::sqrt(glm::dot(way, way) + 1e-6f);
            const glm::vec3 to = glm::mix(from, rim, 0.85f);
            const glm::vec3 bend = glm::mix(from, to, 0.5f) + glm::vec3(0, 0.14f, 0);
            boughs_.back().push_back({from, bend, to, glm::min(0.045f, limb.radius(at)), 0.012f});
        }
    }

    Bough trunk_;
    std::vector<Bough> limbs_;
    std::vector<std::vector<Bough>> boughs_; ///< per limb
};

class Foliage {
public:
    Foliage(ModelBuilder& builder, const Skeleton& skeleton, uint32_t cards)
        : builder_(builder), skeleton_(skeleton), cards_(cards), dice_(91),
          // The fewer, the larger: the crown stays as dense.
          size_(0.20f * std::sqrt(20000.0f / float(std::max(cards, 1u)))) {
        size_ = std::min(size_, 1.6f);
    }

    void grow() {
        const size_t limbs = skeleton_.limbCount();
        for (size_t l = 0; l < limbs; ++l) {
            const auto first = uint32_t(uint64_t(cards_) * l / limbs),
                       last = uint32_t(uint64_t(cards_) * (l + 1) / limbs);
            if (first == last) continue;
            builder_.beginNode("foliage " + std::to_string(l + 1));
            const std::vector<Bough>& boughs = skeleton_.boughsOf(l);
            for (uint32_t i = first; i < last; ++i) {
                const bool twin = (i - first) % kTwinEvery == kTwinEvery - 1;
                // Boughs one after another, so that neighbours lie together in the file.
                if (!twin) place(boughs[size_t(i - first) * boughs.size() / (last - first)]);
                card(twin);
            }
        }
    }

private:
    /// Draws the next leaf's place and pose.
    void place(const Bough& bough) {
        const float t = dice_.between(0.35f, 1.08f);
        at_ = bough.at(t) + 0.46f * dice_.inBall();
        glm::vec3 out = (at_ - kHeart) / kCrownRadii;
        out /= std::sqrt(glm::dot(out, out) + 1e-6f);
        outward_ = out;
        const glm::vec3 wish = out + glm::vec3(0, -0.35f, 0) + 0.9f * dice_.inBall();
        along_ = glm::normalize(wish + glm::vec3(1e-3f, 0, 0));
        glm::vec3 face = out + glm::vec3(0, 0.5f, 0) + 0.8f * dice_.inBall();
        face -= along_ * glm::dot(face, along_);
        face_ = glm::normalize(face + glm::vec3(0, 1e-3f, 2e-3f));
        length_ = size_ * dice_.between(0.75f, 1.15f);
        const float depth = glm::clamp(glm::length((at_ - kHeart) / kCrownRadii), 0.0f, 1.0f);
        const glm::vec3 shade = glm::mix(glm::vec3(0.05f, 0.11f, 0.03f), glm::vec3(0.17f, 0.32f, 0.07f), depth * depth);
        const float hue = dice_.side();
        color_ = shade * (1 + 0.18f * dice_.side()) + glm::vec3(0.04f, 0.02f, 0) * hue * depth;
    }

    /// A kite from its stalk to its tip; its twin stands across it and a little further out, so that the two do not
    /// touch at a vertex.
    void card(bool twin) {
        glm::vec3 side = glm::cross(along_, face_), face = face_;
        if (twin) {
            std::swap(side, face);
            if (glm::dot(face, outward_) < 0) face = -face, side = -side;
            side = glm::cross(along_, face);
            at_ += 0.13f * length_ * along_;
        }
        const float half = 0.36f * length_;
        const glm::vec3 belly = at_ + 0.42f * length_ * along_;
        const glm::vec3 lean = face * 0.6f + outward_ * (glm::dot(face, outward_) > 0 ? 0.7f : 0.0f);
        const glm::vec3 normal = glm::normalize(lean);
        const auto row = [&](glm::vec3 p, glm::vec2 uv, float shade) {
            return builder_.addRow({p, normal, uv, color_ * shade});
        };
        const uint32_t stalk = row(at_, {0.5f, 0}, 0.8f), left = row(belly - half * side, {0, 0.42f}, 1);
        const uint32_t tip = row(at_ + length_ * along_, {0.5f, 1}, 1.1f),
                       right = row(belly + half * side, {1, 0.42f}, 1);
        builder_.addTriangle(stalk, tip, left);
        builder_.addTriangle(stalk, right, tip);
    }

    ModelBuilder& builder_;
    const Skeleton& skeleton_;
    uint32_t cards_;
    Dice dice_;
    float size_, length_ = 1;
    glm::vec3 at_{0}, along_{0, 1, 0}, face_{0, 0, 1}, outward_{0, 1, 0}, color_{1};
};

/// Bark's texture winds half around the trunk and is mirrored on the other side, without a seam.
glm::vec2 barkUv(glm::vec3 p) {
    return {p.x / (std::abs(p.x) + std::abs(p.z) + 1e-4f), 0.5f * p.y};
}

void addBark(ModelBuilder& builder, const Surface& surface) {
    builder.beginNode("bark");
    builder.setMaterial(kBark);
    std::vector<uint32_t> rows;
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const glm::vec3 p = surface.positions[v];
        const float moss = 0.10f * gradientNoise({3.0f * p.x + p.z, 2.0f * p.y}, 17);
        const glm::vec3 color = surface.skins[v].color * (1 + 0.25f * gradientNoise({9 * p.x + 4 * p.z, 3 * p.y}, 31)) +
                                glm::vec3(0, std::max(moss, 0.0f), 0) * 0.3f;
        rows.push_back(builder.addRow({p, surface.normals[v], barkUv(p), color}));
    }
    for (const glm::uvec3 t : surface.triangles) builder.addTriangle(rows[t.x], rows[t.y], rows[t.z]);
}

} // namespace

Model makeTree(uint32_t faces) {
    const Skeleton skeleton;
    ModelBuilder builder;
    builder.addMaterial("bark", {1, 1, 1}, 0.9f, 0);
    builder.addMaterial("leaves", {1, 1, 1}, 0.75f, 0);
    const uint32_t skin = std::max(120u, faces / 5);
    addBark(builder, polygonise(skeleton.body(skin), {-3.2f, -0.4f, -3.2f}, {3.2f, 8.2f, 3.2f}, skin));
    builder.setMaterial(kLeaves);
    const auto used = uint32_t(builder.faceCount());
    Foliage(builder, skeleton, (std::max(faces, used) - used) / 2).grow();
    Model model = builder.finish("tree");
    model.materials[kLeaves].doubleSided = true;
    model.materials[kLeaves].alphaMask = true;
    return model;
}

} // namespace xgc::bake::models
