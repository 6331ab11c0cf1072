#include "hierarchy/state_check.h"

#include <cmath>

namespace xgc::bake {

namespace {

constexpr uint32_t kMostPicks = 4096;
/// Cosines that a triangle must keep: to what it was before the collapse, and to the input's normal.
constexpr double kLeastTurn = 0.05;
constexpr double kLeastBase = 1e-3;

} // namespace

/// Steps whose domain is the patch alone are always taken.
void StateCheck::addStops(uint32_t wedge, uint32_t position, Corner& corner) {
    uint8_t lastLevel = 0;
    uint32_t lastDomain = 0;
    for (;;) {
        const uint32_t parent = state_.parent[position];
        if (parent == kNone) {
            corner.stops.push_back({wedge, position, kNeverCollapses, 0, lastLevel, lastDomain});
            return;
        }
        const uint8_t level = state_.collapseLevel[position];
        const uint32_t domain = state_.domain[position];
        const bool held = state_.domains[domain].size() > 1 && !(level == lastLevel && domain == lastDomain);
        if (held) corner.stops.push_back({wedge, position, level, domain, lastLevel, lastDomain});
        lastLevel = level;
        lastDomain = domain;
        wedge = state_.wedgeParent[wedge];
        position = parent;
    }
}

StateCheck::Verdict StateCheck::checkPicks(uint32_t picks) {
    if (picks > kMostPicks) return Verdict::badInUniform;
    // The ends first: the uniform state.
    const Pick last = {uint32_t(corners_[0].stops.size()) - 1, uint32_t(corners_[1].stops.size()) - 1,
                       uint32_t(corners_[2].stops.size()) - 1};
    if (checkPick(last, false) != Verdict::good) return Verdict::badInUniform;
    Pick pick;
    for (pick[0] = 0; pick[0] <= last[0]; ++pick[0]) {
        for (pick[1] = 0; pick[1] <= last[1]; ++pick[1]) {
            for (pick[2] = 0; pick[2] <= last[2]; ++pick[2]) {
                if (pick == last || isGood(pick) || !isPossible(pick)) continue;
                return checkPick(pick, true);
            }
        }
    }
    return Verdict::good;
}

bool StateCheck::canHold(const Stop& stop, const Pick& pick) const {
    for (const uint32_t q : state_.domains[stop.domain]) {
        if (q == patch_) continue;
        bool below = true;
        for (size_t k = 0; k < 3 && below; ++k) {
            const Stop& other = corners_[k].stops[pick[k]];
            below = other.lastLevel < stop.level || !state_.domains.has(other.lastDomain, q);
        }
        if (below) return true;
    }
    return false;
}

bool StateCheck::isPossible(const Pick& pick) const {
    for (size_t k = 0; k < 3; ++k) {
        const Stop& stop = corners_[k].stops[pick[k]];
        if (stop.level != kNeverCollapses && !canHold(stop, pick)) return false;
    }
    return true;
}

bool StateCheck::isGood(const Pick& pick) const {
    std::array<const Stop*, 3> stops;
    for (size_t k = 0; k < 3; ++k) stops[k] = &corners_[k].stops[pick[k]];
    for (size_t k = 0; k < 3; ++k) {
        const Stop &a = *stops[k], &b = *stops[(k + 1) % 3];
        if (a.position == b.position) return a.wedge == b.wedge; // not drawn, and known by its wedges not to be
    }
    std::array<glm::dvec3, 3> after, before;
    for (size_t k = 0; k < 3; ++k) {
        after[k] = glm::dvec3(state_.positions[stops[k]->position]);
        before[k] = corners_[k].moves ? glm::dvec3(state_.positions[before_]) : after[k];
    }
    return !isTurned(before, after);
}

/// Whether a triangle turns over, against what it was or against the input's, or loses its area.
bool StateCheck::isTurned(const std::array<glm::dvec3, 3>& before, const std::array<glm::dvec3, 3>& after) const {
    const glm::dvec3 n = glm::cross(after[1] - after[0], after[2] - after[0]);
    const double length = glm::length(n);
    if (length == 0) return true;
    if (normal_ != glm::vec3(0) && glm::dot(n, glm::dvec3(normal_)) < kLeastBase * length) return true;
    const glm::dvec3 m = glm::cross(before[1] - before[0], before[2] - before[0]);
    const double squared = glm::dot(m, m);
    return squared > 0 && glm::dot(n, m) <= kLeastTurn * length * std::sqrt(squared);
}

StateCheck::Verdict StateCheck::checkInside(const PatchMesh& mesh, uint32_t face, const Move& move) const {
    std::array<glm::dvec3, 3> before, after;
    for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t p = state_.positionAt(mesh, 3 * face + k);
        before[k] = glm::dvec3(state_.positions[p]);
        after[k] = p == move.from ? glm::dvec3(state_.positions[move.to]) : before[k];
    }
    return isTurned(before, after) ? Verdict::badInUniform : Verdict::good;
}

StateCheck::Verdict StateCheck::checkPick(const Pick& pick, bool mixed) {
    if (isGood(pick)) return Verdict::good;
    if (!mixed) return Verdict::badInUniform;
    failingDomains.clear();
    for (size_t k = 0; k < 3; ++k) {
        const Stop& stop = corners_[k].stops[pick[k]];
        if (stop.level != kNeverCollapses) failingDomains.push_back(stop.domain);
    }
    return Verdict::badInMixed;
}

} // namespace xgc::bake
