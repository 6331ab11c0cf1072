#include "models/makers.h"

#include "models/model_builder.h"
#include "models/trig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// A turned shaft along x, 2.4 units long. Its surface is a chain of strips from axis to axis, each between two rings;
// a ring is a contour (round, hexagonal, splined or with a keyway) sampled at the same spokes as all others:
//
//      r |        ____      ___
//        |   ____|    |    |   \____          strips: lateral faces, cones, grooves, shoulders
//        |__|         |____|        |__
//        +------------------------------ x
//
// Neighbouring strips share the positions of a ring, not its rows: creases are hard.

namespace xgc::bake::models {
namespace {

enum class Contour { round, hexagon, spline, keyed };

struct Ring {
    float x;
    float radius;
    Contour contour = Contour::round;
};

struct Strip {
    Ring from;
    Ring to;
    uint32_t material;
    float arc = 0; ///< 1: profile normals follow a quarter of a circle or more; 0: straight
    glm::vec2 normalFrom{0};
    glm::vec2 normalTo{0};
};

enum ShaftMaterial : uint32_t { kTurned, kGround, kBlack };

constexpr uint32_t kTeeth = 12;
/// Spokes that place all corners of splines and keyway.
constexpr uint32_t kFullSpokes = 4 * kTeeth;

/// How much of the part is cut: coarse models leave out what they have no faces for.
struct Detail {
    bool chamfers;
    bool grooves;
    bool fine; ///< keyway, splines, centre holes, round grooves
};

/// The profile from the left end of the axis to the right one.
class Profile {
public:
    explicit Profile(Detail detail) : detail_(detail) { cut(); }
    const std::vector<Strip>& strips() const { return strips_; }

private:
    void start(float x) { at_ = {x, 0, Contour::round}; }
    void to(float x, float radius) { toRing({x, radius, at_.contour}); }
    void toRing(Ring ring) {
        strips_.push_back({at_, ring, material_, 0, {}, {}});
        at_ = ring;
    }
    /// A shoulder up or down to another contour, with chamfers where the contour is round.
    void step(float radius, Contour contour = Contour::round) {
        const float x = at_.x;
        const float c = 0.012f;
        const bool up = radius > at_.radius;
        if (!up && detail_.chamfers && at_.contour == Contour::round) {
            back(c);
            to(x, at_.radius - c);
        }
        if (up && detail_.chamfers && contour == Contour::round) {
            toRing({x, radius - c, contour});
            to(x + c, radius);
        } else {
            toRing({x, radius, contour});
        }
    }
    /// Shortens the last strip.
    void back(float length) {
        at_.x -= length;
        strips_.back().to = at_;
    }
    void grooveSquare(float x, float width, float depth) {
        if (!detail_.grooves) return;
        const float r = at_.radius;
        to(x, r);
        to(x, r - depth);
        to(x + width, r - depth);
        to(x + width, r);
    }
    void grooveV(float x, float width, float depth) {
        if (!detail_.grooves) return;
        const float r = at_.radius;
        to(x, r);
        to(x + 0.5f * width, r - depth);
        to(x + width, r);
    }
    /// Half a circle into the surface, smooth inside.
    void grooveRound(float x, float radius) {
        if (!detail_.fine) return;
        const float r = at_.radius;
        to(x, r);
        constexpr int n = 8;
        for (int i = 0; i < n; ++i) {
            const glm::vec2 a = circlePoint(0.5 * double(i) / n), b = circlePoint(0.5 * double(i + 1) / n);
            const Ring next{x + radius - radius * b.x, i + 1 == n ? r : r - radius * b.y, Contour::round};
            strips_.push_back({at_, next, material_, 1, {a.x, a.y}, {b.x, b.y}});
            at_ = next;
        }
    }
    void endFace(float radius, float hole) {
        // From the bottom of the centre hole out to the rim.
        if (detail_.fine) {
            start(at_.x + 1.6f * hole);
            to(at_.x - 1.6f * hole, hole);
        }
        if (detail_.chamfers) {
            to(at_.x, radius - 0.014f);
            to(at_.x + 0.014f, radius);
        } else {
            to(at_.x, radius);
        }
    }
    void cut();

    Detail detail_;
    Ring at_{};
    uint32_t material_ = kTurned;
    std::vector<Strip> strips_;
};

void Profile::cut() {
    start(-1.2f);
    endFace(0.13f, 0.045f);
    material_ = kGround;
    grooveSquare(-1.10f, 0.022f, 0.016f);
    to(-0.80f, 0.13f);
    material_ = kTurned;
    step(0.205f);
    if (detail_.fine) {
        to(-0.72f, 0.205f);
        toRing({-0.72f, 0.205f, Contour::keyed});
        to(-0.43f, 0.205f);
        toRing({-0.43f, 0.205f, Contour::round});
    }
    grooveRound(-0.385f, 0.014f);
    to(-0.34f, 0.205f);
    material_ = kBlack;
    step(0.37f);
    grooveV(-0.295f, 0.03f, 0.022f);
    to(-0.22f, 0.37f);
    step(0.30f, Contour::hexagon);
    to(0.03f, 0.30f);
    material_ = kTurned;
    step(0.215f);
    for (int i = 0; i < 3; ++i) grooveV(0.075f + 0.045f * float(i), 0.03f, 0.02f);
    grooveRound(0.215f, 0.012f);
    to(0.26f, 0.215f);
    to(0.50f, 0.17f);
    material_ = kGround;
    to(0.60f, 0.17f);
    material_ = kTurned;
    if (detail_.fine) {
        step(0.150f, Contour::spline);
        to(1.00f, 0.150f);
    } else {
        to(1.00f, 0.17f);
    }
    step(0.105f);
    grooveSquare(1.025f, 0.03f, 0.014f);
    to(1.20f, 0.105f);
    if (detail_.chamfers) {
        back(0.014f);
        to(1.20f, 0.091f);
    }
    if (detail_.fine) {
        to(1.20f, 0.04f);
        to(1.20f - 1.6f * 0.04f, 0);
    } else {
        to(1.20f, 0);
    }
}

/// Corners of contours in the plane across the axis.
class Spokes {
public:
    explicit Spokes(uint32_t count) : count_(count) {
        for (uint32_t k = 0; k < count; ++k) unit_.push_back(circlePoint(double(k) / count));
    }

    uint32_t count() const { return count_; }

    glm::vec2 point(Contour contour, float radius, uint32_t spoke) const {
        const uint32_t k = spoke % count_;
        switch (contour) {
        case Contour::round:
            break;
        case Contour::hexagon: {
            const uint32_t side = count_ / 6, corner = k / side * side;
            const float share = float(k - corner) / float(side);
            return radius * glm::mix(unit_[corner], unit_[(corner + side) % count_], share);
        }
        case Contour::spline: {
            const uint32_t quarter = count_ / kFullSpokes, corner = k / quarter * quarter;
            if (corner / quarter % 2 == 1) return toothRadius(radius, corner) * unit_[k];
            const uint32_t next = (corner + quarter) % count_;
            return glm::mix(toothRadius(radius, corner) * unit_[corner], toothRadius(radius, next) * unit_[next],
                            float(k - corner) / float(quarter));
        }
        case Contour::keyed:
            return keyway(radius, k);
        }
        return radius * unit_[k];
    }

    /// First spokes of the smooth runs of a contour; empty where it is smooth all round.
    std::vector<uint32_t> creases(Contour contour) const {
        std::vector<uint32_t> out;
        const uint32_t step = contour == Contour::hexagon ? count_ / 6 : count_ / kFullSpokes;
        if (contour == Contour::hexagon || contour == Contour::spline) {
            for (uint32_t k = 0; k < count_; k += step) out.push_back(k);
        } else if (contour == Contour::keyed) {
            out = {slot(0), slot(1), slot(3), slot(4)};
        }
        return out;
    }

    /// Direction along the contour at a spoke of the run that starts at `first`.
    glm::vec2 tangent(Contour contour, float radius, uint32_t first, uint32_t spoke) const {
        const uint32_t quarter = count_ / kFullSpokes;
        const bool flat = contour == Contour::hexagon || (contour == Contour::spline && first / quarter % 2 == 0) ||
                          (contour == Contour::keyed && first != slot(4));
        if (!flat) {
            const glm::vec2 u = unit_[spoke % count_];
            return {-u.y, u.x};
        }
        return point(contour, radius, first + 1) - point(contour, radius, first);
    }

private:
    /// At the corners of teeth; flank up, tip, flank down and root take a quarter of the pitch each.
    float toothRadius(float radius, uint32_t corner) const {
        const uint32_t phase = corner * kFullSpokes / count_ % 4;
        return phase == 1 || phase == 2 ? radius : 0.82f * radius;
    }

    /// The keyway takes a twelfth of the turn at the top: wall, floor (two parts of four), wall.
    uint32_t slot(uint32_t quarter) const { return count_ / 4 - count_ / 24 + quarter * count_ / kFullSpokes; }

    glm::vec2 keyway(float radius, uint32_t k) const {
        if (k <= slot(0) || k >= slot(4)) return radius * unit_[k];
        const glm::vec2 right = radius * unit_[slot(0)];
        const float floor = 0.80f * radius;
        const auto part = float(count_ / kFullSpokes);
        if (k <= slot(1)) return {right.x, glm::mix(right.y, floor, float(k - slot(0)) / part)};
        if (k >= slot(3)) return {-right.x, glm::mix(floor, right.y, float(k - slot(3)) / part)};
        return {glm::mix(right.x, -right.x, float(k - slot(1)) / (2 * part)), floor};
    }

    uint32_t count_;
    std::vector<glm::vec2> unit_;
};

/// Longest line of a strip along its spokes.
float strideOf(const Strip& s) {
    const glm::vec2 d(s.to.x - s.from.x, s.to.radius - s.from.radius);
    return std::sqrt(glm::dot(d, d));
}

uint32_t stepsOf(const Strip& s, float length) {
    return std::max(1u, uint32_t(strideOf(s) / length + 0.5f));
}

/// Spokes of a strip that has a surface: all, or the keyway's where its ends are.
uint64_t countFaces(const std::vector<Strip>& strips, uint32_t spokes, float length) {
    uint64_t count = 0;
    for (const Strip& s : strips) {
        if (s.from.x == s.to.x && s.from.radius == s.to.radius) {
            count += spokes / 6;
        } else {
            count += uint64_t(2) * spokes * stepsOf(s, length);
            if (s.from.radius == 0 || s.to.radius == 0) count -= spokes;
        }
    }
    return count;
}

void addStrip(ModelBuilder& builder, const Spokes& spokes, const Strip& strip, float length) {
    const Ring a = strip.from, b = strip.to;
    const bool flat = a.x == b.x;
    const uint32_t steps = stepsOf(strip, length);
    // A shoulder is flat whatever its contours; elsewhere both rings have the same one.
    std::vector<uint32_t> runs = flat ? std::vector<uint32_t>{} : spokes.creases(a.contour);
    if (runs.empty()) runs = {0};
    builder.setMaterial(strip.material);
    for (size_t r = 0; r < runs.size(); ++r) {
        const uint32_t first = runs[r], last = r + 1 < runs.size() ? runs[r + 1] : runs[0] + spokes.count();
        builder.addGrid(last - first, steps, [&](uint32_t i, uint32_t j) {
            const uint32_t k = first + i;
            const float t = float(j) / float(steps);
            const glm::vec2 pa = spokes.point(a.contour, a.radius, k), pb = spokes.point(b.contour, b.radius, k);
            const glm::vec2 p = j == 0 ? pa : j == steps ? pb : glm::mix(pa, pb, t);
            const float x = j == 0 ? a.x : j == steps ? b.x : glm::mix(a.x, b.x, t);
            Row row;
            row.position = {x, p.y, -p.x};
            const glm::vec2 u = spokes.point(Contour::round, 1, k);
            if (flat) {
                row.normal = {b.radius > a.radius || (b.radius == a.radius && b.contour == Contour::round) ? -1 : 1, 0,
                              0};
            } else if (strip.arc > 0) {
                const glm::vec2 n = glm::normalize(glm::mix(strip.normalFrom, strip.normalTo, t));
                row.normal = {n.x, n.y * u.y, -n.y * u.x};
            } else {
                const bool fromAxis = a.radius == 0;
                const glm::vec2 along = spokes.tangent(a.contour, fromAxis ? b.radius : a.radius, first, k);
                const glm::vec3 around(0, along.y, -along.x), up(b.x - a.x, pb.y - pa.y, -(pb.x - pa.x));
                row.normal = glm::normalize(glm::cross(around, up));
            }
            return row;
        });
    }
}

struct Plan {
    std::vector<Strip> strips;
    uint32_t spokes;
    float length;
};

/// The spokes and the length of quads along the axis that give the face count with the squarest quads.
Plan planFor(uint32_t faces) {
    const bool fine = faces >= 9000;
    const Plan base{Profile({faces >= 1500, faces >= 3000, fine}).strips(), 0, 0};
    Plan best = base;
    float bestScore = 1e30f;
    const uint32_t unit = fine ? kFullSpokes : 6;
    for (uint32_t spokes = unit; spokes * unit < faces * 6 && spokes <= 16384; spokes += unit) {
        float low = 1e-5f, high = 4;
        for (int i = 0; i < 40; ++i) {
            const float middle = std::sqrt(low * high);
            (countFaces(base.strips, spokes, middle) > faces ? low : high) = middle;
        }
        const float count = float(countFaces(base.strips, spokes, high));
        const float aspect = high / (6.2832f * 0.2f / float(spokes));
        const float miss = std::abs(count / float(faces) - 1);
        const float score = std::max(aspect, 1 / aspect) + 100 * std::max(0.0f, miss - 0.03f);
        if (score < bestScore) {
            bestScore = score;
            best.spokes = spokes;
            best.length = high;
        }
    }
    return best;
}

} // namespace

Model makeShaft(uint32_t faces) {
    const Plan plan = planFor(faces);
    const Spokes spokes(plan.spokes);
    ModelBuilder builder;
    builder.addMaterial("turned steel", {0.50f, 0.51f, 0.53f}, 0.38f, 1);
    builder.addMaterial("ground steel", {0.66f, 0.67f, 0.69f}, 0.18f, 1);
    builder.addMaterial("black oxide", {0.10f, 0.105f, 0.115f}, 0.45f, 1);
    builder.beginNode("shaft");
    for (const Strip& strip : plan.strips) addStrip(builder, spokes, strip, plan.length);
    Model model = builder.finish("shaft");
    model.attributes.uvs[0].clear();
    model.attributes.colors[0].clear();
    return model;
}

} // namespace xgc::bake::models
