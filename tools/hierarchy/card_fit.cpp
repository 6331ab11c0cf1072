#include "hierarchy/card_fit.h"

#include "bake/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {

namespace {

/// Cosines that a triangle must keep to the input's and to what it was.
constexpr double kLeastCosine = 0.2;
/// Squared perimeter over area, 16 for a square, 50 for a strip of 10 to 1; or that of a blade that was so before.
constexpr double kMostSlender = 50;
constexpr double kSlenderScore = 0.004, kErrorScore = 0.3;
/// Corners whose texture coordinates differ by more than this share of the card's own extent are not alike.
constexpr float kMostUvShift = 0.3f;
constexpr size_t kMostPoints = 96;

glm::dvec3 normalOf(const CardShape& card, uint32_t f) {
    const auto& t = card.face[f];
    const glm::dvec3 a = card.corner[t[0]];
    return glm::cross(card.corner[t[1]] - a, card.corner[t[2]] - a);
}

double squared(const glm::dvec3& v) {
    return glm::dot(v, v);
}

double squaredDistanceTo(const CardShape& card, const glm::dvec3& p) {
    double best = std::numeric_limits<double>::infinity();
    for (uint32_t f = 0; f < card.faceCount; ++f) {
        const auto& t = card.face[f];
        best = std::min(best, squaredDistance(p, card.corner[t[0]], card.corner[t[1]], card.corner[t[2]]));
    }
    return best;
}

bool hasEdge(const std::array<uint8_t, 3>& t, uint8_t a, uint8_t b) {
    return (t[0] == a && t[1] == b) || (t[1] == a && t[2] == b) || (t[2] == a && t[0] == b);
}

double slenderness(const CardShape& card, double area) {
    double around = 0;
    for (uint32_t f = 0; f < card.faceCount; ++f) {
        for (uint32_t k = 0; k < 3; ++k) {
            const uint8_t a = card.face[f][k], b = card.face[f][(k + 1) % 3];
            if (card.faceCount == 2 && hasEdge(card.face[1 - f], b, a)) continue; // within
            around += glm::distance(card.corner[a], card.corner[b]);
        }
    }
    return around * around / area;
}

/// Which corners of a survivor may go to which of the other: those with texture coordinates alike.
class Likeness {
public:
    Likeness(const CardShape& from, const CardShape& to) {
        glm::vec2 low = from.uv[0], high = low;
        for (uint32_t k = 1; k < from.cornerCount; ++k) {
            low = glm::min(low, from.uv[k]);
            high = glm::max(high, from.uv[k]);
        }
        const float extent = glm::distance(low, high);
        for (uint32_t i = 0; i < from.cornerCount; ++i) {
            for (uint32_t j = 0; j < to.cornerCount; ++j)
                alike_[i][j] = glm::distance(from.uv[i], to.uv[j]) <= kMostUvShift * extent;
        }
    }
    bool operator()(uint32_t i, uint32_t j) const { return alike_[i][j]; }

private:
    bool alike_[4][4] = {};
};

class Search {
public:
    Search(const Card& survivor, const Card& other, const CardFitLimits& limits)
        : survivor_(survivor), other_(other), limits_(limits), alike_(survivor, other), moved_(survivor),
          mostSlender_(
              std::max({kMostSlender, slenderness(survivor, survivor.area()), slenderness(other, other.area())})) {}

    /// Improves on `best`.
    void run(bool secondSurvives, std::optional<CardFit>& best) {
        fit_.secondSurvives = secondSurvives;
        best_ = &best;
        tryOne();
        for (uint32_t i = 0; i < survivor_.cornerCount; ++i) {
            for (uint32_t j = 0; j < other_.cornerCount; ++j) {
                if (!alike_(i, j)) continue;
                move(i, j);
                tryOne();
                for (uint32_t k = i + 1; k < survivor_.cornerCount; ++k) {
                    for (uint32_t l = 0; l < other_.cornerCount; ++l) {
                        if (l == j || !alike_(k, l)) continue;
                        move(k, l);
                        tryOne();
                        undo(k);
                    }
                }
                undo(i);
            }
        }
    }

private:
    void move(uint32_t i, uint32_t j) {
        fit_.target[i] = uint8_t(j);
        moved_.corner[i] = other_.corner[j];
    }
    void undo(uint32_t i) {
        fit_.target[i] = CardFit::kStays;
        moved_.corner[i] = survivor_.corner[i];
    }

    void tryOne() {
        double area = 0;
        for (uint32_t f = 0; f < moved_.faceCount; ++f) {
            const glm::dvec3 n = normalOf(moved_, f), before = normalOf(survivor_, f);
            const double length = std::sqrt(squared(n));
            if (length == 0 || glm::dot(n, moved_.normal[f]) < kLeastCosine * length) return;
            if (glm::dot(n, before) < kLeastCosine * length * std::sqrt(squared(before))) return;
            area += length / 2;
        }
        const double miss = std::abs(area / limits_.area - 1);
        if (miss > limits_.mostMiss) return;
        const double slender = slenderness(moved_, area);
        if (slender > mostSlender_) return;
        const double score = miss + kSlenderScore * slender;
        if (*best_ && score >= (*best_)->score) return;
        const double error = squaredError();
        if (error > limits_.squaredError) return;
        fit_.area = area;
        fit_.squaredError = error;
        fit_.score = score + kErrorScore * std::sqrt(error / limits_.squaredError);
        if (!*best_ || fit_.score < (*best_)->score) *best_ = fit_;
    }

    /// Of what both stand for from the one; and of its edges' and faces' middles from the two.
    double squaredError() const {
        double worst = 0;
        for (const Card* card : {&survivor_, &other_}) {
            for (const glm::dvec3& p : card->points) {
                worst = std::max(worst, squaredDistanceTo(moved_, p));
                if (worst > limits_.squaredError) return worst;
            }
        }
        const auto check = [&](const glm::dvec3& p) {
            worst = std::max(worst, std::min(squaredDistanceTo(survivor_, p), squaredDistanceTo(other_, p)));
        };
        for (uint32_t f = 0; f < moved_.faceCount; ++f) {
            const auto& t = moved_.face[f];
            glm::dvec3 sum(0);
            for (uint32_t k = 0; k < 3; ++k) {
                const glm::dvec3 a = moved_.corner[t[k]], b = moved_.corner[t[(k + 1) % 3]];
                check((a + b) / 2.0);
                sum += a;
            }
            check(sum / 3.0);
        }
        return worst;
    }

    const Card& survivor_;
    const Card& other_;
    const CardFitLimits& limits_;
    const Likeness alike_;
    CardShape moved_;
    const double mostSlender_;
    CardFit fit_;
    std::optional<CardFit>* best_ = nullptr;
};

} // namespace

double CardShape::area() const {
    double sum = 0;
    for (uint32_t f = 0; f < faceCount; ++f) sum += std::sqrt(squared(normalOf(*this, f))) / 2;
    return sum;
}

glm::dvec3 CardShape::middle() const {
    glm::dvec3 sum(0);
    for (uint32_t k = 0; k < cornerCount; ++k) sum += corner[k];
    return sum / double(cornerCount);
}

double CardShape::radius() const {
    const glm::dvec3 m = middle();
    double most = 0;
    for (uint32_t k = 0; k < cornerCount; ++k) most = std::max(most, squared(corner[k] - m));
    return std::sqrt(most);
}

std::optional<CardFit> fitCards(const Card& first, const Card& second, const CardFitLimits& limits) {
    std::optional<CardFit> best;
    if (!(limits.area > 0) || !(limits.squaredError > 0)) return best;
    Search(first, second, limits).run(false, best);
    Search(second, first, limits).run(true, best);
    return best;
}

Card joined(const Card& first, const Card& second, const CardFit& fit) {
    Card card = fit.secondSurvives ? second : first;
    const Card& other = fit.secondSurvives ? first : second;
    for (uint32_t k = 0; k < card.cornerCount; ++k) {
        if (fit.target[k] == CardFit::kStays) continue;
        card.corner[k] = other.corner[fit.target[k]];
        card.uv[k] = other.uv[fit.target[k]];
    }
    card.wantedArea += other.wantedArea;
    card.points.insert(card.points.end(), other.points.begin(), other.points.end());
    if (card.points.size() > kMostPoints) {
        for (size_t i = 0; 2 * i < card.points.size(); ++i) card.points[i] = card.points[2 * i];
        card.points.resize((card.points.size() + 1) / 2);
    }
    return card;
}

} // namespace xgc::bake
