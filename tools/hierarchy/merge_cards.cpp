#include "hierarchy/merge_cards.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {

namespace {

/// Cards larger than so many errors have no neighbour that they could become one with.
constexpr double kLargestInErrors = 4;
/// Cards farther apart than so many errors neither.
constexpr double kReachInErrors = 3;
constexpr size_t kNeighbours = 8;
constexpr double kFullCell = 4; ///< cards a cell of the grid, on average
constexpr int kMostRounds = 12;
/// Share of a patch's debt that one step tries to pay, and the most, of its own area.
constexpr double kPay = 0.5, kMostPay = 0.3;
/// A card is small for an error of so many of its radii.
constexpr double kSmallRadii = 2;

/// Points in cubes of one size.
class Grid {
public:
    Grid(std::span<const glm::dvec3> points, double cell) : points_(points), cell_(cell) {
        for (uint32_t i = 0; i < points.size(); ++i) entries_.push_back({cellOf(points[i]), i});
        std::sort(entries_.begin(), entries_.end());
    }
    double pointsPerCell() const {
        size_t cells = 0;
        for (size_t i = 0; i < entries_.size(); ++i) cells += i == 0 || entries_[i].first != entries_[i - 1].first;
        return cells == 0 ? 0 : double(entries_.size()) / double(cells);
    }
    /// Visits the points in the cells around point `i`, but not itself.
    template <typename Visit>
    void forNear(uint32_t i, const Visit& visit) const {
        const Cell c = cellOf(points_[i]);
        for (int64_t x = c[0] - 1; x <= c[0] + 1; ++x) {
            for (int64_t y = c[1] - 1; y <= c[1] + 1; ++y) {
                const Cell low{x, y, c[2] - 1}, high{x, y, c[2] + 1};
                auto at = std::lower_bound(entries_.begin(), entries_.end(), std::pair(low, 0u));
                for (; at != entries_.end() && at->first <= high; ++at) {
                    if (at->second != i) visit(at->second);
                }
            }
        }
    }

private:
    using Cell = std::array<int64_t, 3>;
    Cell cellOf(const glm::dvec3& p) const {
        return {int64_t(std::floor(p.x / cell_)), int64_t(std::floor(p.y / cell_)), int64_t(std::floor(p.z / cell_))};
    }

    std::span<const glm::dvec3> points_;
    double cell_;
    std::vector<std::pair<Cell, uint32_t>> entries_;
};

double areaOf(const Mesh& mesh, uint32_t face) {
    const glm::uvec3 p = mesh.facePositions(face);
    const glm::dvec3 a(mesh.positions[p.x]);
    return glm::length(glm::cross(glm::dvec3(mesh.positions[p.y]) - a, glm::dvec3(mesh.positions[p.z]) - a)) / 2;
}

} // namespace

CardMerger::CardMerger(const Pieces& pieces, const PatchAssignment& assignment, SurfaceState& state)
    : pieces_(pieces), assignment_(assignment), state_(state), isCard_(pieces.count(), 0),
      debt_(assignment.patches.size(), 0) {
    const std::vector<uint32_t> bySize = pieces.bySize();
    for (size_t i = 1; i < bySize.size(); ++i) { // the largest piece stays
        if (mayBecomeCard(bySize[i])) waiting_.push_back(bySize[i]);
    }
    std::sort(waiting_.begin(), waiting_.end());
    if (!waiting_.empty()) guardPieces();
    adopt();
}

void CardMerger::guardPieces() {
    std::vector<uint32_t> pieceOf(state_.positions.size(), PieceGuard::kUnguarded);
    for (uint32_t i = 0; i < waiting_.size(); ++i) {
        PieceGuard::Piece piece;
        double scale = 0;
        for (const uint32_t p : pieces_.positionsOf(waiting_[i])) {
            pieceOf[p] = i;
            piece.rim += state_.isBoundary[p];
            scale = std::max(scale, state_.costScale[p]);
        }
        for (const uint32_t f : pieces_.facesOf(waiting_[i])) piece.wholeArea += areaOf(state_.mesh, f);
        piece.area = piece.wholeArea;
        piece.squaredRadius = pieces_.squaredRadius(waiting_[i]) * scale;
        state_.guard.pieces.push_back(piece);
    }
    state_.guard.guard(std::move(pieceOf));
}

std::vector<uint32_t> CardMerger::release(double squaredError) {
    std::vector<uint32_t> released;
    for (const uint32_t number : waiting_) {
        PieceGuard::Piece& piece = state_.guard.pieces[state_.guard.pieceOf(pieces_.positionsOf(number).front())];
        if (piece.isSmall || piece.squaredRadius > squaredError) continue;
        piece.isSmall = true;
        for (uint32_t p : pieces_.positionsOf(number)) {
            while (state_.parent[p] != kNone) p = state_.parent[p];
            if (state_.isBoundary[p]) released.push_back(p);
        }
    }
    return released;
}

bool CardMerger::mayBecomeCard(uint32_t piece) const {
    if (!pieces_.isSmallSheet(piece, state_.diagonal)) return false;
    const std::span<const uint32_t> positions = pieces_.positionsOf(piece), faces = pieces_.facesOf(piece);
    const uint32_t patch = assignment_.facePatch[faces.front()];
    return std::all_of(faces.begin(), faces.end(), [&](uint32_t f) { return assignment_.facePatch[f] == patch; }) &&
           std::none_of(positions.begin(), positions.end(),
                        [&](uint32_t p) { return std::isinf(state_.costScale[p]) || state_.wedgesOf(p).size() != 1; });
}

/// Pieces that are down to one or two triangles become cards.
void CardMerger::adopt() {
    std::erase_if(waiting_, [&](uint32_t piece) { return adopt(piece); });
}

bool CardMerger::adopt(uint32_t piece) {
    Member card;
    if (!readCorners(piece, card) || !readFaces(piece, card)) return false;
    for (const uint32_t p : pieces_.positionsOf(piece)) {
        card.points.push_back(state_.point(p));
        card.scale = std::max(card.scale, state_.costScale[p]);
    }
    for (const uint32_t f : pieces_.facesOf(piece)) card.wantedArea += areaOf(state_.mesh, f);
    card.patch = assignment_.facePatch[pieces_.facesOf(piece).front()];
    card.domain = state_.domain[card.position[0]];
    for (uint32_t k = 0; k < card.cornerCount; ++k)
        state_.costScale[card.position[k]] = std::numeric_limits<double>::infinity();
    debt_[card.patch] += card.debt();
    cards_.push_back(std::move(card));
    isCard_[piece] = 1;
    return true;
}

bool CardMerger::readCorners(uint32_t piece, Member& card) const {
    for (uint32_t p : pieces_.positionsOf(piece)) {
        while (state_.parent[p] != kNone) p = state_.parent[p];
        const auto end = card.position.begin() + card.cornerCount;
        if (std::find(card.position.begin(), end, p) != end) continue;
        if (card.cornerCount == 4 || !state_.isBoundary[p] || state_.wedgesOf(p).size() != 1) return false;
        if (card.cornerCount > 0 && state_.domain[p] != state_.domain[card.position[0]]) return false;
        card.position[card.cornerCount++] = p;
    }
    for (uint32_t k = 0; k < card.cornerCount; ++k) {
        const uint32_t p = card.position[k], wedge = state_.wedgesOf(p).front();
        card.corner[k] = state_.point(p);
        const std::vector<glm::vec2>& uvs = state_.mesh.attributes.uvs[0];
        if (wedge < uvs.size()) card.uv[k] = uvs[wedge];
    }
    return true;
}

bool CardMerger::readFaces(uint32_t piece, Member& card) const {
    for (const uint32_t f : pieces_.facesOf(piece)) {
        const glm::uvec3 p = state_.mesh.facePositions(f);
        std::array<uint8_t, 3> corners{};
        for (int k = 0; k < 3; ++k) {
            uint32_t r = p[k];
            while (state_.parent[r] != kNone) r = state_.parent[r];
            corners[size_t(k)] =
                uint8_t(std::find(card.position.begin(), card.position.end(), r) - card.position.begin());
        }
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        if (card.faceCount == 2) return false;
        const glm::dvec3 a = state_.point(p.x);
        const glm::dvec3 n = glm::cross(state_.point(p.y) - a, state_.point(p.z) - a);
        const double length = glm::length(n);
        if (length == 0) return false;
        card.normal[card.faceCount] = n / length;
        card.face[card.faceCount++] = corners;
    }
    return card.faceCount > 0;
}

uint32_t CardMerger::run(uint32_t level, double squaredError) {
    adopt();
    refused_.clear();
    uint32_t gone = joinAll({level, squaredError, false, false});
    gone += joinAll({level, squaredError, true, false});
    refused_.clear();
    gone += joinAll({level, squaredError, true, true});
    gone += dropLonely({level, squaredError, true, true});
    std::erase_if(cards_, [](const Member& card) { return !card.stands; });
    return gone;
}

uint32_t CardMerger::joinAll(const Round& round) {
    uint32_t gone = 0;
    for (int i = 0; i < kMostRounds; ++i) {
        bool crowded = false;
        const uint32_t joined = joinNeighbours(round, crowded);
        gone += joined;
        if (joined == 0 && !crowded) break;
    }
    return gone;
}

bool CardMerger::isSmall(const Member& card, const Round& round) const {
    const double radii = round.anyArea ? 1 / kSmallRadii : kLargestInErrors, radius = card.radius();
    return radius * radius * card.scale <= radii * radii * round.squaredError;
}

CardFitLimits CardMerger::limitsOf(const Member& a, const Member& b, const Round& round) const {
    CardFitLimits limits;
    limits.squaredError = round.squaredError / std::max(a.scale, b.scale);
    limits.area = a.wantedArea + b.wantedArea;
    if (round.anyArea) limits.mostMiss = std::numeric_limits<double>::infinity();
    return limits;
}

bool CardMerger::mayMeet(const Member& a, const Member& b, bool acrossPatches) const {
    if (a.domain == b.domain) return true;
    if (!acrossPatches) return false;
    if (assignment_.patches[a.patch].material != assignment_.patches[b.patch].material) return false;
    std::vector<uint32_t> both;
    const auto s = state_.domains[a.domain], t = state_.domains[b.domain];
    std::set_union(s.begin(), s.end(), t.begin(), t.end(), std::back_inserter(both));
    return both.size() <= DomainSets::kWidest;
}

/// Pairs of cards near each other, each with its nearest few. `crowded`: there are so many that some were left out.
std::vector<CardMerger::Pair> CardMerger::pairsWithin(const Round& round, bool& crowded) const {
    double reach = kReachInErrors * std::sqrt(round.squaredError);
    std::vector<uint32_t> some;
    std::vector<glm::dvec3> middles;
    for (uint32_t i = 0; i < cards_.size(); ++i) {
        if (!cards_[i].stands || !isSmall(cards_[i], round)) continue;
        some.push_back(i);
        middles.push_back(cards_[i].middle());
    }
    Grid grid(middles, reach);
    while (grid.pointsPerCell() > kFullCell) {
        crowded = true;
        reach /= 2;
        grid = Grid(middles, reach);
    }
    std::vector<std::vector<Pair>> found(some.size());
    tbb::parallel_for(uint32_t(0), uint32_t(some.size()), [&](uint32_t i) {
        std::vector<std::pair<double, uint32_t>> near;
        grid.forNear(i, [&](uint32_t j) {
            const glm::dvec3 d = middles[j] - middles[i];
            const double squared = glm::dot(d, d);
            if (squared <= reach * reach && mayMeet(cards_[some[i]], cards_[some[j]], round.acrossPatches))
                near.push_back({squared, j});
        });
        const size_t count = std::min(near.size(), kNeighbours);
        std::partial_sort(near.begin(), near.begin() + ptrdiff_t(count), near.end());
        for (size_t k = 0; k < count; ++k) found[i].push_back(std::minmax(some[i], some[near[k].second]));
    });
    std::vector<Pair> pairs;
    for (const std::vector<Pair>& f : found) pairs.insert(pairs.end(), f.begin(), f.end());
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

/// One round: each card takes part once, the best pairs first.
uint32_t CardMerger::joinNeighbours(const Round& round, bool& crowded) {
    std::vector<Pair> pairs = pairsWithin(round, crowded);
    std::erase_if(pairs, [&](const Pair& p) { return std::binary_search(refused_.begin(), refused_.end(), p); });
    std::vector<double> score(pairs.size(), -1);
    tbb::parallel_for(size_t(0), pairs.size(), [&](size_t i) {
        const Member &a = cards_[pairs[i].first], &b = cards_[pairs[i].second];
        if (const auto fit = fitCards(a, b, limitsOf(a, b, round))) score[i] = fit->score;
    });
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < pairs.size(); ++i) {
        if (score[i] >= 0)
            order.push_back(i);
        else
            refused_.push_back(pairs[i]);
    }
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return score[a] < score[b]; });
    std::vector<uint8_t> changed(cards_.size(), 0);
    uint32_t count = 0;
    for (const uint32_t i : order) {
        const auto [a, b] = pairs[i];
        if (changed[a] || changed[b] || !join(pairs[i], round)) continue;
        changed[a] = changed[b] = 1;
        ++count;
    }
    forgetRefused(changed);
    return count;
}

/// Pairs that may be tried again since one of them is another card now.
void CardMerger::forgetRefused(const std::vector<uint8_t>& changed) {
    std::erase_if(refused_, [&](const Pair& p) { return changed[p.first] || changed[p.second]; });
    std::sort(refused_.begin(), refused_.end());
}

/// Aims at the area of both and some of what their neighbours lack.
bool CardMerger::join(Pair pair, const Round& round) {
    Member &a = cards_[pair.first], &b = cards_[pair.second];
    CardFitLimits limits = limitsOf(a, b, round);
    const double owed = debt_[a.patch] - a.debt() - (a.patch == b.patch ? b.debt() : 0);
    limits.area += std::clamp(kPay * owed, -kMostPay * limits.area, kMostPay * limits.area);
    const auto fit = fitCards(a, b, limits);
    if (!fit) return false;
    if (state_.domains[state_.domains.unite(a.domain, b.domain)].size() > DomainSets::kWidest) return false;
    take(fit->secondSurvives ? b : a, fit->secondSurvives ? a : b, *fit, round.level);
    return true;
}

void CardMerger::take(Member& survivor, Member& other, const CardFit& fit, uint32_t level) {
    debt_[survivor.patch] -= survivor.debt();
    debt_[other.patch] -= other.debt();
    const bool moves =
        std::any_of(fit.target.begin(), fit.target.end(), [](uint8_t t) { return t != CardFit::kStays; });
    const uint32_t domain = state_.domains.unite(survivor.domain, other.domain);
    uint32_t last = other.position[0];
    std::array<bool, 4> isTarget{};
    std::array<uint32_t, 4> position = survivor.position;
    for (uint32_t k = 0; k < survivor.cornerCount; ++k) {
        if (fit.target[k] == CardFit::kStays) continue;
        isTarget[fit.target[k]] = true;
        position[k] = last = other.position[fit.target[k]];
    }
    if (!moves) isTarget[0] = true;
    for (uint32_t j = 0; j < other.cornerCount; ++j) {
        if (isTarget[j]) state_.domain[other.position[j]] = domain;
    }
    for (uint32_t k = 0; k < survivor.cornerCount; ++k) {
        if (position[k] != survivor.position[k]) {
            state_.collapseWhole(survivor.position[k], position[k], domain, level);
        } else if (moves) {
            state_.domain[position[k]] = domain;
        }
    }
    for (uint32_t j = 0; j < other.cornerCount; ++j) {
        if (!isTarget[j]) state_.collapseWhole(other.position[j], last, domain, level);
    }
    CardFit own = fit;
    own.secondSurvives = false;
    static_cast<Card&>(survivor) = joined(survivor, other, own);
    survivor.position = position;
    if (moves) survivor.domain = domain;
    survivor.scale = std::max(survivor.scale, other.scale);
    other.stands = false;
    debt_[survivor.patch] += survivor.debt();
}

/// Small cards that found no other: those near surface of another kind (a sticker, a rivet's head).
uint32_t CardMerger::dropLonely(const Round& round) {
    uint32_t gone = 0;
    for (Member& card : cards_) {
        if (!card.stands || !isSmall(card, round) || !standsBeside(card, round.squaredError / card.scale)) continue;
        state_.domain[card.position[0]] = card.domain;
        for (uint32_t k = 1; k < card.cornerCount; ++k)
            state_.collapseWhole(card.position[k], card.position[0], card.domain, round.level);
        debt_[card.patch] -= card.debt();
        card.stands = false;
        ++gone;
    }
    return gone;
}

/// Whether other surface is near all that a card stands for. Its patches are in the card's domain then: none of them is
/// finer while the card is gone.
bool CardMerger::standsBeside(Member& card, double squaredError) {
    if (!others_) listOthers();
    uint32_t domain = card.domain;
    for (const glm::dvec3& p : card.points) {
        const SurfaceDistance::Hit hit = others_->nearest(p + state_.origin, squaredError);
        if (hit.squared > squaredError) return false;
        domain = state_.domains.unite(domain, state_.domains.single(otherPatch_[hit.triangle]));
        if (state_.domains[domain].size() > DomainSets::kWidest) return false;
    }
    card.domain = domain;
    return true;
}

void CardMerger::listOthers() {
    std::vector<Triangle> triangles;
    for (uint32_t f = 0; f < state_.mesh.faceCount(); ++f) {
        const glm::uvec3 p = state_.mesh.facePositions(f);
        if (state_.guard.pieceOf(p.x) != PieceGuard::kUnguarded) continue;
        triangles.push_back({state_.mesh.positions[p.x], state_.mesh.positions[p.y], state_.mesh.positions[p.z]});
        otherPatch_.push_back(assignment_.facePatch[f]);
    }
    others_.emplace(std::move(triangles));
}

} // namespace xgc::bake
