#include "models/makers.h"

#include "models/model_builder.h"
#include "models/noise.h"
#include "models/trig.h"

#include <algorithm>
#include <cmath>
#include <vector>

// A Doric temple that faces +z, y up: steps, a peristyle around a cella, entablature, pediments, a tiled roof, and in
// front a paved way between two bronze dragons. Everything is cut to one edge length, found by bisection so that the
// faces come out as asked; details appear where there are faces for them.

namespace xgc::bake::models {
namespace {

enum TempleMaterial : uint32_t { kMarble, kLimestone, kTiles, kBronze, kEarth };

constexpr float kFloor = 0.48f;    ///< top of the steps
constexpr float kColumnTop = 3.4f; ///< under the architrave
constexpr float kEaves = 4.25f;
constexpr float kRidge = 5.45f;
constexpr float kPi2 = 6.2831853f;

/// What a budget of faces allows.
struct Program {
    int front = 6, side = 9; ///< columns
    bool moulded = true;     ///< three steps, capitals, cornices, pedestals
    bool carved = true;      ///< flutes, triglyphs, single stones, tiles, statues
};

Program programFor(uint32_t faces) {
    if (faces < 4500) return {4, 5, false, false};
    return {6, 9, true, faces >= 40000};
}

struct Point2 {
    float radius;
    float y;
};

class Mason {
public:
    Mason(ModelBuilder& builder, const Program& program, float edge)
        : builder_(builder), program_(program), edge_(edge),
          half_(0.5f * float(program.front - 1) * spacingX(), 0.5f * float(program.side - 1) * spacingZ()) {}

    void build(const Model& statue) {
        steps();
        columns();
        cella();
        entablature();
        gables();
        roof();
        forecourt(statue);
    }

    /// Ground in nx x nz cells, gently uneven away from the building.
    void ground(uint32_t nx, uint32_t nz) {
        begin("ground", kEarth);
        const glm::vec2 low(-9, -9), high(9, 13);
        builder_.addGrid(nx, nz, [&](uint32_t i, uint32_t j) {
            const glm::vec2 uv(float(i) / float(nx), float(j) / float(nz));
            const glm::vec2 p(low.x + (high.x - low.x) * uv.x, high.y + (low.y - high.y) * uv.y);
            const auto height = [&](glm::vec2 q) {
                const glm::vec2 out = glm::max(glm::abs(q - glm::vec2(0, 2)) - glm::vec2(4.0f, 7.0f), glm::vec2(0));
                const float away = smoothStep(0, 3, std::sqrt(glm::dot(out, out)));
                return away * (0.5f + 0.5f * gradientNoise(q * 0.35f, 3) + 0.12f * gradientNoise(q * 1.3f, 4)) +
                       0.015f * gradientNoise(q * 4.0f, 8);
            };
            const float e = 0.02f, here = height(p);
            Row row;
            row.position = {p.x, here, p.y};
            row.normal = glm::normalize(glm::vec3(height(p - glm::vec2(e, 0)) - height(p + glm::vec2(e, 0)), 2 * e,
                                                  height(p - glm::vec2(0, e)) - height(p + glm::vec2(0, e))));
            row.uv = uv;
            const float dry = glm::clamp(0.5f + 0.7f * gradientNoise(p * 0.8f, 21), 0.0f, 1.0f);
            row.color = glm::mix(glm::vec3(0.24f, 0.31f, 0.11f), glm::vec3(0.47f, 0.42f, 0.24f), dry);
            return row;
        });
    }

private:
    float spacingX() const { return 5.0f / float(program_.front - 1); }
    float spacingZ() const { return 8.0f / float(program_.side - 1); }

    void begin(const char* node, uint32_t material) {
        builder_.beginNode(node);
        builder_.setMaterial(material);
    }

    uint32_t cells(float length) const { return std::max(1u, uint32_t(length / edge_ + 0.5f)); }

    /// One side of a box: from `corner` along u and v, front where u x v points.
    void side(glm::vec3 corner, glm::vec3 u, glm::vec3 v, glm::vec3 color) {
        const float lengthU = std::sqrt(glm::dot(u, u)), lengthV = std::sqrt(glm::dot(v, v));
        const uint32_t nu = cells(lengthU), nv = cells(lengthV);
        const glm::vec3 normal = glm::normalize(glm::cross(u, v));
        builder_.addGrid(nu, nv, [&](uint32_t i, uint32_t j) {
            const float s = float(i) / float(nu), t = float(j) / float(nv);
            // Opposite corners are summed the same way from every side that meets there.
            const glm::vec3 p = i == nu && j == nv ? corner + (u + v)
                                : i == nu          ? (corner + u) + v * t
                                : j == nv          ? (corner + v) + u * s
                                                   : corner + u * s + v * t;
            return Row{p, normal, glm::vec2(s * lengthU, t * lengthV), color};
        });
    }

    /// A closed block with its uvs by length: a seam along every edge.
    void block(glm::vec3 low, glm::vec3 high, glm::vec3 color = glm::vec3(1)) {
        const glm::vec3 d = high - low;
        const glm::vec3 x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
        side({low.x, low.y, high.z}, x, y, color);
        side({high.x, low.y, low.z}, -x, y, color);
        side({high.x, low.y, high.z}, -z, y, color);
        side({low.x, low.y, low.z}, z, y, color);
        side({low.x, high.y, high.z}, x, -z, color);
        side({low.x, low.y, low.z}, x, z, color);
    }

    /// Shades of one stone from the next.
    glm::vec3 stone(uint32_t index) const { return glm::vec3(1.0f) * (0.95f + 0.05f * signedUnit(hash(index + 977))); }

    /// A turned body, open at both ends; its profile runs upward. Neighbouring pieces that bend by less than about 35
    /// degrees are smooth.
    void turned(glm::vec3 at, const std::vector<Point2>& profile, uint32_t spokes, bool closed) {
        std::vector<glm::vec2> normals;
        for (size_t i = 0; i + 1 < profile.size(); ++i) {
            const glm::vec2 d(profile[i + 1].radius - profile[i].radius, profile[i + 1].y - profile[i].y);
            normals.push_back(glm::normalize(glm::vec2(d.y, -d.x)));
        }
        const auto around = [&](uint32_t i) { return circlePoint(i == spokes ? 0 : double(i) / spokes); };
        for (size_t s = 0; s < normals.size(); ++s) {
            const auto meet = [&](size_t other) {
                return glm::dot(normals[s], normals[other]) > 0.82f ? glm::normalize(normals[s] + normals[other])
                                                                    : normals[s];
            };
            const glm::vec2 ends[2] = {s > 0 ? meet(s - 1) : normals[s],
                                       s + 1 < normals.size() ? meet(s + 1) : normals[s]};
            const Point2 a = profile[s], b = profile[s + 1];
            const uint32_t rings = cells(0.4f * (std::abs(b.y - a.y) + std::abs(b.radius - a.radius)));
            builder_.addGrid(spokes, rings, [&](uint32_t i, uint32_t j) {
                const float t = float(j) / float(rings);
                const float r = j == rings ? b.radius : glm::mix(a.radius, b.radius, t);
                const float y = j == rings ? b.y : glm::mix(a.y, b.y, t);
                const glm::vec2 c = around(i);
                const glm::vec2 n = glm::normalize(glm::mix(ends[0], ends[1], t));
                return Row{at + glm::vec3(c.x * r, y, -c.y * r),
                           {c.x * n.x, n.y, -c.y * n.x},
                           {float(i) / float(spokes), y},
                           glm::vec3(1)};
            });
        }
        if (!closed) return;
        for (const bool top : {false, true}) {
            const Point2 rim = top ? profile.back() : profile.front();
            const glm::vec3 normal(0, top ? 1 : -1, 0);
            builder_.addFan(spokes, {at + glm::vec3(0, rim.y, 0), normal, glm::vec2(0.5f), glm::vec3(1)},
                            [&](uint32_t i) {
                                const glm::vec2 c = around(top ? i : spokes - i);
                                return Row{at + glm::vec3(c.x * rim.radius, rim.y, -c.y * rim.radius), normal,
                                           0.5f + 0.5f * c, glm::vec3(1)};
                            });
        }
    }

    uint32_t spokesFor(float radius, uint32_t least) const {
        return std::max(least, uint32_t(kPi2 * radius / edge_ + 0.5f));
    }

    void steps() {
        begin("steps", kLimestone);
        if (!program_.moulded) {
            block({-half_.x - 0.8f, 0, -half_.y - 0.8f}, {half_.x + 0.8f, kFloor, half_.y + 0.8f});
            return;
        }
        for (int i = 0; i < 3; ++i) {
            const float out = 0.45f + 0.3f * float(2 - i);
            block({-half_.x - out, 0.16f * float(i) - (i == 0 ? 0.1f : 0.0f), -half_.y - out},
                  {half_.x + out, 0.16f * float(i + 1), half_.y + out}, stone(uint32_t(i)));
        }
    }

    void columns() {
        int number = 0;
        for (int j = 0; j < program_.side; ++j) {
            for (int i = 0; i < program_.front; ++i) {
                const bool rim = i == 0 || j == 0 || i + 1 == program_.front || j + 1 == program_.side;
                if (!rim) continue;
                begin(("column " + std::to_string(++number)).c_str(), kMarble);
                column({float(i) * spacingX() - half_.x, kFloor, float(j) * spacingZ() - half_.y});
            }
        }
    }

    void column(glm::vec3 at) {
        const float height = kColumnTop - kFloor, neck = program_.moulded ? height - 0.30f : height;
        const float bottom = 0.255f, top = 0.20f;
        if (program_.carved) {
            flutedShaft(at, bottom, top, neck);
        } else {
            turned(at, {{bottom, 0}, {top, neck}}, spokesFor(bottom, 4), program_.moulded);
        }
        if (!program_.moulded) return;
        std::vector<Point2> echinus = {{top, neck}, {top + 0.01f, neck + 0.03f}};
        const int n = program_.carved ? 6 : 2;
        for (int i = 1; i <= n; ++i) {
            const glm::vec2 c = circlePoint(0.25 * double(i) / n);
            echinus.push_back({top + 0.01f + 0.12f * c.y, neck + 0.04f + 0.13f * (1 - c.x)});
        }
        turned(at, echinus, spokesFor(bottom, 8), true);
        block(at + glm::vec3(-0.34f, height - 0.13f, -0.34f), at + glm::vec3(0.34f, height, 0.34f));
    }

    /// Twenty flutes that meet in sharp arrises; the shaft swells slightly.
    void flutedShaft(glm::vec3 at, float bottom, float top, float height) {
        constexpr uint32_t kFlutes = 20;
        const uint32_t across = std::max(2u, uint32_t(kPi2 * bottom / kFlutes / edge_ + 0.5f));
        const uint32_t rings = std::max(2u, uint32_t(height / (3 * edge_) + 0.5f));
        const uint32_t spokes = kFlutes * across;
        const auto radius = [&](float t) { return glm::mix(bottom, top, t) + 0.03f * t * (1 - t); };
        const auto place = [&](uint32_t k, float t) {
            const float phase = float(k % across) / float(across);
            const float r = radius(t) * (1 - 0.42f * phase * (1 - phase));
            const glm::vec2 c = circlePoint(double(k % spokes) / spokes);
            return at + glm::vec3(c.x * r, height * t, -c.y * r);
        };
        for (uint32_t flute = 0; flute < kFlutes; ++flute) {
            builder_.addGrid(across, rings, [&](uint32_t i, uint32_t j) {
                const float t = float(j) / float(rings);
                const uint32_t k = flute * across + i;
                // Slopes from inside the flute, so that arrises stay sharp.
                const glm::vec2 c = circlePoint(double(k) / spokes);
                const float phase = float(i) / float(across);
                const float sink = 0.42f * (1 - 2 * phase) * kFlutes / kPi2;
                const glm::vec2 n = glm::normalize(c + sink * glm::vec2(-c.y, c.x));
                const float rise = (bottom - top) / height;
                return Row{place(k, t),
                           glm::normalize(glm::vec3(n.x, rise, -n.y)),
                           {float(k) / float(spokes), height * t},
                           glm::vec3(1)};
            });
        }
        for (const bool upper : {false, true}) {
            const glm::vec3 normal(0, upper ? 1 : -1, 0);
            const float t = upper ? 1.0f : 0.0f;
            builder_.addFan(
                spokes, {at + glm::vec3(0, height * t, 0), normal, glm::vec2(0.5f), glm::vec3(1)}, [&](uint32_t i) {
                    const uint32_t k = upper ? i : spokes - i;
                    return Row{place(k, t), normal, 0.5f + 0.5f * circlePoint(double(k) / spokes), glm::vec3(1)};
                });
        }
    }

    void cella() {
        const float x = half_.x - 1.05f, z = half_.y - 1.1f, top = kColumnTop, thick = 0.28f, door = 0.62f, head = 2.7f;
        begin("cella", kMarble);
        if (!program_.moulded) {
            block({-x, kFloor, -z}, {x, top, z});
        } else {
            wall({-x, kFloor, -z}, {-x + thick, top, z});
            wall({x - thick, kFloor, -z}, {x, top, z});
            wall({-x + thick, kFloor, -z}, {x - thick, top, -z + thick});
            wall({-x + thick, kFloor, z - thick}, {-door, top, z});
            wall({door, kFloor, z - thick}, {x - thick, top, z});
            block({-door, head, z - thick}, {door, top, z});
        }
        begin("door", kBronze);
        const float front = program_.moulded ? z - 0.5f * thick : z;
        if (!program_.moulded) {
            block({-door, kFloor, front}, {door, head, front + 0.05f});
            return;
        }
        for (const float left : {-door, 0.01f}) {
            block({left, kFloor, front}, {left + door - 0.01f, head, front + 0.06f});
            for (int panel = 0; panel < 3; ++panel) {
                const float y = kFloor + 0.12f + 0.71f * float(panel);
                block({left + 0.1f, y, front + 0.05f}, {left + door - 0.11f, y + 0.58f, front + 0.085f});
            }
        }
    }

    /// Plain, or courses of single stones with joints between them.
    void wall(glm::vec3 low, glm::vec3 high) {
        if (!program_.carved) return block(low, high);
        const bool alongX = high.x - low.x > high.z - low.z;
        const int axis = alongX ? 0 : 2;
        const int courses = 9;
        const float length = high[axis] - low[axis], rise = (high.y - low.y) / float(courses);
        const int stones = std::max(1, int(length / 0.75f + 0.5f));
        const float pitch = length / float(stones), joint = 0.006f;
        for (int course = 0; course < courses; ++course) {
            const float shift = course % 2 ? 0.5f * pitch : 0.0f;
            for (int i = 0; i <= stones; ++i) {
                const float from = std::max(0.0f, float(i) * pitch - shift);
                const float to = std::min(length, float(i + 1) * pitch - shift);
                if (to - from < 0.05f) continue;
                glm::vec3 a = low, b = high;
                a[axis] = low[axis] + from + joint;
                b[axis] = low[axis] + to - joint;
                a.y = low.y + rise * float(course) + joint;
                b.y = low.y + rise * float(course + 1) - joint;
                block(a, b, stone(uint32_t(course * 64 + i)));
            }
        }
    }

    /// Four beams around the building.
    void frame(float out, float in, float low, float high) {
        const float x = half_.x + out, z = half_.y + out, w = out + in;
        block({-x, low, z - w}, {x, high, z});
        block({-x, low, -z}, {x, high, -z + w});
        block({-x, low, -z + w}, {-x + w, high, z - w});
        block({x - w, low, -z + w}, {x, high, z - w});
    }

    void entablature() {
        begin("entablature", kMarble);
        if (!program_.moulded) {
            block({-half_.x - 0.3f, kColumnTop, -half_.y - 0.3f}, {half_.x + 0.3f, kEaves, half_.y + 0.3f});
            return;
        }
        frame(0.27f, 0.27f, kColumnTop, kColumnTop + 0.32f);
        frame(0.31f, 0.25f, kColumnTop + 0.32f, kColumnTop + 0.37f);
        frame(0.25f, 0.25f, kColumnTop + 0.37f, kEaves - 0.12f);
        frame(0.55f, 0.30f, kEaves - 0.12f, kEaves);
        if (program_.carved) triglyphs();
    }

    /// Three bars over each column and between, and drops under the cornice.
    void triglyphs() {
        begin("triglyphs", kMarble);
        const float low = kColumnTop + 0.37f, high = kEaves - 0.12f;
        for (const float sideSign : {1.0f, -1.0f}) {
            for (int i = 0; i < 2 * program_.front - 1; ++i) {
                for (int bar = -1; bar <= 1; ++bar) {
                    const float x = 0.5f * spacingX() * float(i) - half_.x + 0.075f * float(bar);
                    const float z = sideSign * (half_.y + 0.25f);
                    block({x - 0.027f, low, std::min(z, z + 0.045f * sideSign)},
                          {x + 0.027f, high, std::max(z, z + 0.045f * sideSign)});
                }
            }
            for (int j = 0; j < 2 * program_.side - 1; ++j) {
                for (int bar = -1; bar <= 1; ++bar) {
                    const float z = 0.5f * spacingZ() * float(j) - half_.y + 0.075f * float(bar);
                    const float x = sideSign * (half_.x + 0.25f);
                    block({std::min(x, x + 0.045f * sideSign), low, z - 0.027f},
                          {std::max(x, x + 0.045f * sideSign), high, z + 0.027f});
                }
            }
        }
    }

    /// A closed prism under the roof: the tympanum and its frame.
    void gable(float z, float thick, float width, float base, float peak) {
        const glm::vec3 a(-width, base, z), b(width, base, z), c(0, peak, z);
        const glm::vec3 back(0, 0, -thick);
        const auto n = cells(2 * width) / 2 + 1;
        for (const bool front : {true, false}) {
            const glm::vec3 shift = front ? glm::vec3(0) : back;
            const glm::vec3 normal(0, 0, front ? 1 : -1);
            // Left and right halves, each a grid that closes at its outer corner.
            for (const float s : {-1.0f, 1.0f}) {
                const bool flip = (s > 0) == front;
                builder_.addGrid(1, n, [&](uint32_t i, uint32_t j) {
                    const float t = float(j) / float(n);
                    const bool upper = flip ? i == 0 : i == 1;
                    const glm::vec3 foot = s < 0 ? a : b;
                    const glm::vec3 middle(0, base, z);
                    const glm::vec3 p = upper ? c + (foot - c) * t : middle + (foot - middle) * t;
                    return Row{(j == n ? foot : p) + shift, normal, {p.x, p.y}, glm::vec3(1)};
                });
            }
        }
        const auto slope = [&](glm::vec3 from, glm::vec3 to) {
            const glm::vec3 normal = glm::normalize(glm::cross(to - from, back));
            builder_.addGrid(n, 1, [&](uint32_t i, uint32_t j) {
                const float t = float(i) / float(n);
                const glm::vec3 p = (i == n ? to : from + (to - from) * t) + (j ? back : glm::vec3(0));
                return Row{p, normal, {t, float(j)}, glm::vec3(1)};
            });
        };
        // As the front faces run: each end repeats their sums.
        const glm::vec3 middle(0, base, z);
        slope(a, middle);
        slope(middle, b);
        slopeBack(c, b, back, n);
        slopeFront(c, a, back, n);
    }

    void slopeBack(glm::vec3 top, glm::vec3 foot, glm::vec3 back, uint32_t n) {
        const glm::vec3 normal = glm::normalize(glm::cross(back, foot - top));
        builder_.addGrid(1, n, [&](uint32_t i, uint32_t j) {
            const float t = float(j) / float(n);
            const glm::vec3 p = (j == n ? foot : top + (foot - top) * t) + (i ? back : glm::vec3(0));
            return Row{p, normal, {float(i), t}, glm::vec3(1)};
        });
    }

    void slopeFront(glm::vec3 top, glm::vec3 foot, glm::vec3 back, uint32_t n) {
        const glm::vec3 normal = glm::normalize(glm::cross(foot - top, back));
        builder_.addGrid(1, n, [&](uint32_t i, uint32_t j) {
            const float t = float(j) / float(n);
            const glm::vec3 p = (j == n ? foot : top + (foot - top) * t) + (i ? glm::vec3(0) : back);
            return Row{p, normal, {float(1 - i), t}, glm::vec3(1)};
        });
    }

    void gables() {
        const float width = half_.x + 0.25f;
        const float peak = kEaves + (kRidge - kEaves) * width / (half_.x + 0.6f);
        begin("pediments", kMarble);
        gable(half_.y + 0.20f, 0.3f, width, kEaves, peak);
        gable(-half_.y + 0.10f, 0.3f, width, kEaves, peak);
        if (!program_.moulded) return;
        begin("shield", kBronze);
        std::vector<Point2> dome;
        for (int i = 0; i <= 8; ++i) {
            const glm::vec2 c = circlePoint(0.22 * double(i) / 8);
            dome.push_back({0.34f * c.x, 0.15f * c.y});
        }
        upright({0, kEaves + 0.45f, half_.y + 0.19f}, dome);
        begin("acroteria", kBronze);
        for (const float z : {half_.y + 0.45f, -half_.y - 0.45f}) {
            for (const float x : {-half_.x - 0.45f, 0.0f, half_.x + 0.45f}) {
                const float y = kRidge - (kRidge - kEaves) * std::abs(x) / (half_.x + 0.6f) + 0.03f;
                turned({x, y, z},
                       {{0.10f, 0}, {0.05f, 0.08f}, {0.13f, 0.22f}, {0.15f, 0.28f}, {0.07f, 0.40f}, {0.02f, 0.52f}},
                       spokesFor(0.13f, 6), true);
            }
        }
    }

    /// A turned body whose axis points to +z, open at its foot.
    void upright(glm::vec3 at, const std::vector<Point2>& profile) {
        ModelBuilder flat;
        const uint32_t spokes = spokesFor(0.3f, 8);
        Mason mason(flat, program_, edge_);
        flat.beginNode("");
        mason.turned(glm::vec3(0), profile, spokes, true);
        builder_.addModel(flat.finish(""), rotationX(0.25), 1, at);
    }

    /// Two sheets of tiles, open, and a ridge of half pipes.
    void roof() {
        for (const float s : {-1.0f, 1.0f}) {
            begin(s < 0 ? "roof left" : "roof right", kTiles);
            slopeOfTiles(s);
        }
        if (!program_.moulded) return;
        begin("ridge", kTiles);
        const uint32_t around = std::max(3u, uint32_t(0.5f * kPi2 * 0.1f / edge_ + 0.5f));
        const float from = half_.y + 0.6f, length = 2 * from;
        const uint32_t along = cells(length);
        builder_.addGrid(around, along, [&](uint32_t i, uint32_t j) {
            const glm::vec2 c = circlePoint(0.5 * double(i) / around);
            const float t = float(j) / float(along);
            return Row{{0.10f * c.x, kRidge + 0.02f + 0.10f * c.y, from - length * t},
                       {c.x, c.y, 0},
                       {float(i) / float(around), length * t},
                       glm::vec3(1)};
        });
    }

    void slopeOfTiles(float s) {
        const glm::vec2 foot(half_.x + 0.6f, kEaves), top(0, kRidge);
        const float run = std::sqrt(glm::dot(top - foot, top - foot)), length = 2 * (half_.y + 0.6f);
        constexpr uint32_t kRows = 36, kCourses = 12;
        uint32_t nu = cells(length), nv = cells(run);
        const bool tiled = program_.carved;
        // Whole numbers of quads a tile keep the pattern even.
        if (tiled) {
            nu = kRows * std::max(4u, (nu + kRows / 2) / kRows);
            nv = kCourses * std::max(2u, (nv + kCourses / 2) / kCourses);
        }
        const glm::vec2 up = (top - foot) / run, out(up.y, -up.x);
        const glm::vec3 normal(s * out.x, out.y, 0);
        const auto lift = [&](float u, float v) {
            if (!tiled) return 0.0f;
            const float across = u * kRows - std::floor(u * kRows), course = v * kCourses - std::floor(v * kCourses);
            const float cover = across < 0.4f ? across / 0.4f * (1 - across / 0.4f) * 4 : 0;
            return 0.055f * std::sqrt(cover) + 0.03f * (1 - course);
        };
        const auto place = [&](float u, float v) {
            const glm::vec2 p = foot + (top - foot) * v;
            return glm::vec3(s * p.x, p.y, s * length * (0.5f - u)) + normal * lift(u, v);
        };
        builder_.addGrid(nu, nv, [&](uint32_t i, uint32_t j) {
            const float u = float(i) / float(nu), v = float(j) / float(nv);
            const float du = 0.5f / float(nu), dv = 0.5f / float(nv);
            const glm::vec3 across = place(u + du, v) - place(u - du, v), along = place(u, v + dv) - place(u, v - dv);
            const uint32_t tile = uint32_t(u * kRows) * kCourses + uint32_t(v * kCourses);
            return Row{place(u, v),
                       tiled ? glm::normalize(glm::cross(across, along)) : normal,
                       {u * length, v * run},
                       tiled ? stone(tile) : glm::vec3(1)};
        });
    }

    void forecourt(const Model& statue) {
        if (!program_.moulded) return;
        begin("way", kLimestone);
        for (int j = 0; j < 7; ++j) {
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 low(-1.2f + 0.8f * float(i), -0.05f, half_.y + 1.3f + 0.8f * float(j));
                const float rise = 0.012f * signedUnit(hash(uint32_t(16 * j + i)));
                block(low + 0.02f, low + glm::vec3(0.78f, 0.09f + rise, 0.78f), stone(uint32_t(300 + 16 * j + i)));
            }
        }
        for (const float x : {-2.1f, 2.1f}) {
            const glm::vec3 at(x, -0.05f, half_.y + 2.6f);
            begin(x < 0 ? "pedestal left" : "pedestal right", kMarble);
            block(at + glm::vec3(-0.52f, 0, -0.52f), at + glm::vec3(0.52f, 0.16f, 0.52f));
            block(at + glm::vec3(-0.42f, 0.16f, -0.42f), at + glm::vec3(0.42f, 0.72f, 0.42f));
            block(at + glm::vec3(-0.50f, 0.72f, -0.50f), at + glm::vec3(0.50f, 0.84f, 0.50f));
            begin(x < 0 ? "dragon left" : "dragon right", kBronze);
            if (!statue.triangles.empty()) {
                builder_.addModel(statue, rotationY(x < 0 ? 0.04 : -0.04), 1.15f,
                                  at + glm::vec3(-0.06f, 0.845f, 0.05f));
            } else {
                turned(at, {{0.2f, 0.84f}, {0.1f, 0.95f}, {0.3f, 1.3f}, {0.26f, 1.5f}}, spokesFor(0.25f, 6), true);
            }
        }
        for (const float x : {-1.6f, 1.6f}) {
            begin(x < 0 ? "brazier left" : "brazier right", kBronze);
            // Open at the top.
            turned({x, 0, half_.y + 5.4f},
                   {{0.22f, 0},
                    {0.20f, 0.05f},
                    {0.06f, 0.14f},
                    {0.045f, 0.75f},
                    {0.09f, 0.82f},
                    {0.26f, 0.92f},
                    {0.34f, 1.08f},
                    {0.37f, 1.10f}},
                   spokesFor(0.3f, 8), false);
        }
    }

    ModelBuilder& builder_;
    Program program_;
    float edge_;
    glm::vec2 half_; ///< from the middle to the outer columns
};

} // namespace

Model makeTemple(uint32_t faces) {
    const Program program = programFor(faces);
    const Model statue = program.carved ? makeCreature(faces / 12) : Model{};
    const auto withoutGround = [&](float edge) {
        ModelBuilder counter(true);
        Mason(counter, program, edge).build(statue);
        return counter.faceCount();
    };
    float fine = 1e-4f, coarse = 50;
    for (int i = 0; i < 40; ++i) {
        const float middle = std::sqrt(fine * coarse);
        (withoutGround(middle) > uint64_t(0.95 * faces) ? fine : coarse) = middle;
    }
    ModelBuilder builder;
    builder.addMaterial("marble", {0.83f, 0.80f, 0.74f}, 0.55f, 0);
    builder.addMaterial("limestone", {0.66f, 0.60f, 0.50f}, 0.85f, 0);
    builder.addMaterial("roof tiles", {0.56f, 0.24f, 0.14f}, 0.8f, 0);
    builder.addMaterial("bronze", {0.36f, 0.27f, 0.15f}, 0.35f, 1);
    builder.addMaterial("earth", {1.0f, 1.0f, 1.0f}, 0.95f, 0);
    Mason mason(builder, program, coarse);
    mason.build(statue);
    // The ground takes what is left.
    const double left = std::max(2.0, double(faces) - double(builder.faceCount())) / 2;
    const auto across = uint32_t(std::max(1.0, std::sqrt(left * 18 / 22)));
    mason.ground(across, std::max(1u, uint32_t(left / across + 0.5)));
    Model model = builder.finish("temple");
    model.materials[kTiles].doubleSided = true;
    model.materials[kBronze].doubleSided = true;
    return model;
}

} // namespace xgc::bake::models
