#include "mixed_states.h"

#include "bake/surface_distance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace xgc::bake {
namespace {

constexpr uint32_t kSampledFaces = 128; ///< of a patch, about
constexpr size_t kFewFaces = 4;         ///< a patch is tried when it is down to one in so many of its faces
/// How many levels below a patch's own the others are tried at, besides level 0.
constexpr size_t kMostSteps = 4;
/// Squared: beyond the farthest sample of a patch, farther points lie.
constexpr double kBetweenSamples = 1.05 * 1.05;

bool isDegenerate(const glm::uvec3& t) {
    return t.x == t.y || t.y == t.z || t.z == t.x;
}

} // namespace

MixedStates::MixedStates(const MeasuredInput& input, const TrackedMap& map, const DrawnLevel& base)
    : input_(input), map_(map), parent_(positionParents(input.hierarchy)),
      number_(input.hierarchy.positions.size(), kNone), patches_(input.hierarchy.patchCount()),
      isGone_(input.topology.componentCount, 0), scratch_([this] {
          Scratch scratch;
          scratch.number.assign(input_.hierarchy.positions.size(), kNone);
          return scratch;
      }) {
    listBoundary();
    listFaces();
    rims_.push_back(rimOf(0, base, std::vector<uint8_t>(input.topology.componentCount, 1),
                          std::vector<double>(patches_.size(), 0.0)));
}

void MixedStates::listBoundary() {
    const Hierarchy& h = input_.hierarchy;
    std::vector<uint8_t> isUsed(h.domainPatches.size(), 0);
    for (uint32_t p = 0; p < h.positions.size(); ++p) {
        const std::vector<uint32_t>& patches = h.domainPatches[h.domain[p]];
        if (patches.size() < 2) continue;
        isUsed[h.domain[p]] = 1;
        number_[p] = uint32_t(boundary_.size());
        boundary_.push_back(p);
        for (const uint32_t patch : patches) patches_[patch].boundary.push_back(number_[p]);
    }
    for (uint32_t d = 0; d < isUsed.size(); ++d) {
        if (!isUsed[d]) continue;
        for (const uint32_t patch : h.domainPatches[d]) {
            std::vector<uint32_t>& adjacent = patches_[patch].adjacent;
            adjacent.insert(adjacent.end(), h.domainPatches[d].begin(), h.domainPatches[d].end());
        }
    }
    for (PatchState& patch : patches_) {
        std::sort(patch.adjacent.begin(), patch.adjacent.end());
        patch.adjacent.erase(std::unique(patch.adjacent.begin(), patch.adjacent.end()), patch.adjacent.end());
    }
}

void MixedStates::listFaces() {
    const Hierarchy& h = input_.hierarchy;
    std::vector<uint32_t> counts(patches_.size(), 0), seen(patches_.size(), 0);
    for (const uint32_t patch : h.facePatch) ++counts[patch];
    for (uint32_t f = 0; f < h.facePatch.size(); ++f) {
        const uint32_t p = h.facePatch[f];
        PatchState& patch = patches_[p];
        if (patch.boundary.empty()) continue; // nobody beside it
        const glm::uvec3 corners = input_.mesh.facePositions(f);
        patch.faces.push_back(corners);
        ++patch.faceCount;
        if (seen[p]++ % ((counts[p] + kSampledFaces - 1) / kSampledFaces) != 0) continue;
        const uint32_t component = input_.topology.faceComponent[f];
        const glm::dvec3 a = input_.point(corners.x), b = input_.point(corners.y), c = input_.point(corners.z);
        patch.samples.push_back({a, corners, component});
        patch.samples.push_back({(a + b + c) / 3.0, corners, component});
    }
}

/// What a position is drawn as by its patch at a level and all others at level 0.
uint32_t MixedStates::alone(uint32_t position, uint32_t level) const {
    while (number_[position] == kNone && input_.hierarchy.collapseLevel[position] <= level) {
        position = parent_[position];
    }
    return position;
}

void MixedStates::follow(PatchState& patch, uint32_t level) const {
    const auto now = [&](const glm::uvec3& t) {
        return glm::uvec3(alone(t.x, level), alone(t.y, level), alone(t.z, level));
    };
    size_t kept = 0;
    for (const glm::uvec3& face : patch.faces) {
        const glm::uvec3 t = now(face);
        if (!isDegenerate(t)) patch.faces[kept++] = t;
    }
    patch.faces.resize(kept);
    for (Sample& sample : patch.samples) sample.corners = now(sample.corners);
}

MixedStates::Rim MixedStates::rimOf(uint32_t level, const DrawnLevel& drawn,
                                    const std::vector<uint8_t>& isDrawnComponent,
                                    const std::vector<double>& errors) const {
    Rim rim;
    rim.isDrawnComponent = isDrawnComponent;
    rim.errors = errors;
    for (uint32_t position : boundary_) {
        while (input_.hierarchy.collapseLevel[position] <= level) position = parent_[position];
        rim.representatives.push_back(position);
    }
    rim.starOffsets.assign(boundary_.size() + 1, 0);
    for (uint32_t i = 0; i < drawn.count(); ++i) {
        const glm::uvec3& t = drawn.triangles[i];
        const glm::uvec3 positions(drawn.positions[t.x], drawn.positions[t.y], drawn.positions[t.z]);
        bool touches = false;
        for (int k = 0; k < 3; ++k) {
            const uint32_t number = number_[positions[k]];
            if (number == kNone) continue;
            ++rim.starOffsets[number + 1];
            touches = true;
        }
        if (!touches) continue;
        rim.triangles.push_back(positions);
        rim.patches.push_back(drawn.patches[i]);
    }
    for (size_t v = 1; v < rim.starOffsets.size(); ++v) rim.starOffsets[v] += rim.starOffsets[v - 1];
    rim.stars.resize(rim.starOffsets.back());
    std::vector<uint32_t> next(rim.starOffsets.begin(), rim.starOffsets.end() - 1);
    for (uint32_t t = 0; t < rim.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t number = number_[rim.triangles[t][k]];
            if (number != kNone) rim.stars[next[number]++] = t;
        }
    }
    return rim;
}

void MixedStates::addTriangle(glm::uvec3 t, uint32_t owner, Scratch& scratch) const {
    DrawnLevel& around = scratch.around;
    for (int k = 0; k < 3; ++k) {
        uint32_t& number = scratch.number[t[k]];
        if (number == kNone) {
            number = uint32_t(around.positions.size());
            around.positions.push_back(t[k]);
            around.points.emplace_back(input_.hierarchy.positions[t[k]]);
        }
        t[k] = number;
    }
    around.triangles.push_back(t);
    around.patches.push_back(owner);
}

void MixedStates::drawPatch(uint32_t patch, const Rim& rim, Scratch& scratch) const {
    DrawnLevel& around = scratch.around;
    for (const uint32_t p : around.positions) scratch.number[p] = kNone;
    around.positions.clear();
    around.points.clear();
    around.triangles.clear();
    around.patches.clear();
    around.faces.clear();
    const std::vector<glm::uvec3>& faces = patches_[patch].faces;
    for (uint32_t f = 0; f < faces.size(); ++f) {
        const glm::uvec3 t = standing(faces[f], rim);
        if (isDegenerate(t)) continue;
        addTriangle(t, patch, scratch);
        around.faces.push_back(f);
    }
    listStars(around);
}

/// What the others draw at the patch's boundary.
void MixedStates::drawOthers(uint32_t patch, const Rim& rim, Scratch& scratch) const {
    scratch.standing.clear();
    for (const uint32_t b : patches_[patch].boundary) scratch.standing.push_back(number_[rim.representatives[b]]);
    std::sort(scratch.standing.begin(), scratch.standing.end());
    scratch.standing.erase(std::unique(scratch.standing.begin(), scratch.standing.end()), scratch.standing.end());
    for (const uint32_t r : scratch.standing) {
        for (uint32_t i = rim.starOffsets[r]; i < rim.starOffsets[r + 1]; ++i) {
            const uint32_t t = rim.stars[i];
            if (rim.patches[t] != patch) addTriangle(rim.triangles[t], rim.patches[t], scratch);
        }
    }
    listStars(scratch.around);
}

/// Most samples are near a triangle known from before: where all are, nothing needs to be drawn.
void MixedStates::listFar(const PatchState& patch, const Rim& rim, double allowed, Scratch& scratch) const {
    scratch.far.clear();
    for (uint32_t i = 0; i < patch.samples.size(); ++i) {
        const Sample& sample = patch.samples[i];
        if (!rim.isDrawnComponent[sample.component]) continue; // as in the uniform state
        const glm::uvec3 t = standing(sample.corners, rim);
        const bool isNear = !isDegenerate(t) && squaredDistance(sample.point, input_.point(t.x), input_.point(t.y),
                                                                input_.point(t.z)) <= allowed;
        if (!isNear) scratch.far.push_back(i);
    }
}

NearTriangle MixedStates::walkFrom(const Sample& sample, const Rim& rim, double allowed, const Scratch& scratch) const {
    glm::uvec3 seeds = standing(sample.corners, rim);
    for (int k = 0; k < 3; ++k) seeds[k] = scratch.number[seeds[k]];
    return walkNear(scratch.around, sample.point, {kNone, std::numeric_limits<double>::infinity()}, seeds,
                    {nullptr, allowed, input_.floor});
}

/// Leaves those samples far that the patch's own triangles do not come near.
void MixedStates::leaveFar(PatchState& patch, const Rim& rim, double allowed, Scratch& scratch) const {
    size_t kept = 0;
    for (const uint32_t i : scratch.far) {
        Sample& sample = patch.samples[i];
        const NearTriangle near = walkFrom(sample, rim, allowed, scratch);
        if (near.triangle == kNone || near.squared > allowed)
            scratch.far[kept++] = i;
        else if (isDegenerate(standing(sample.corners, rims_.back())))
            sample.corners = patch.faces[scratch.around.faces[near.triangle]];
    }
    scratch.far.resize(kept);
}

/// The largest squared distance of a far sample, or `allowed` if all are below it.
double MixedStates::farthest(const PatchState& patch, const Rim& rim, double allowed, const Scratch& scratch) const {
    const DrawnLevel& around = scratch.around;
    double farthest = allowed;
    for (const uint32_t i : scratch.far) {
        const Sample& sample = patch.samples[i];
        NearTriangle near = walkFrom(sample, rim, farthest, scratch);
        for (uint32_t t = 0; t < around.count() && near.squared > farthest; ++t) {
            near.squared = std::min(near.squared, squaredTo(around, t, sample.point));
        }
        if (around.count() > 0) farthest = std::max(farthest, near.squared);
    }
    return farthest;
}

double MixedStates::measure(uint32_t patch, const Rim& rim, double own, Scratch& scratch) {
    double allowed = std::max(own, input_.floor);
    for (const uint32_t q : patches_[patch].adjacent) {
        if (q != patch) allowed = std::max(allowed, rim.errors[q]);
    }
    listFar(patches_[patch], rim, allowed, scratch);
    if (scratch.far.empty()) return own;
    drawPatch(patch, rim, scratch);
    leaveFar(patches_[patch], rim, allowed, scratch);
    if (scratch.far.empty()) return own;
    drawOthers(patch, rim, scratch);
    const double found = farthest(patches_[patch], rim, allowed, scratch);
    return found > allowed ? found * kBetweenSamples : own;
}

void MixedStates::listGone(uint32_t level, const std::vector<uint8_t>& isDrawnComponent) {
    std::vector<uint8_t> goes(isGone_.size(), 0);
    for (uint32_t c = 0; c < goes.size(); ++c) {
        goes[c] = !isDrawnComponent[c] && !isGone_[c];
        isGone_[c] |= goes[c];
    }
    if (std::find(goes.begin(), goes.end(), 1) == goes.end()) return;
    for (uint32_t f = 0; f < input_.mesh.faceCount(); ++f) {
        if (!goes[input_.topology.faceComponent[f]]) continue;
        const glm::uvec3 corners = input_.mesh.facePositions(f);
        std::vector<Gone>& gone = patches_[input_.hierarchy.facePatch[f]].gone;
        for (int k = 0; k < 3; ++k) gone.push_back({corners[k], level});
    }
    for (PatchState& patch : patches_) {
        std::stable_sort(patch.gone.begin(), patch.gone.end());
        const auto same = [](const Gone& a, const Gone& b) { return a.position == b.position; };
        patch.gone.erase(std::unique(patch.gone.begin(), patch.gone.end(), same), patch.gone.end());
    }
}

/// Where the distance from what is gone to the drawn surface lies beyond the errors of the patches around, which are at
/// this level, the patch's own has to promise it, at whatever level it stands.
void MixedStates::raiseForGone(uint32_t p, const DrawnLevel& drawn, std::vector<std::vector<double>>& errors) const {
    const PatchState& patch = patches_[p];
    const size_t level = errors.size() - 1;
    double allowed = input_.floor;
    for (const uint32_t q : patch.adjacent) {
        if (q != p) allowed = std::max(allowed, errors[level][q]);
    }
    for (const Gone& gone : patch.gone) {
        const double own = errors[gone.level][p];
        const uint32_t place = map_[gone.position].triangle;
        const glm::dvec3 point = input_.point(gone.position);
        const Allowance allowance{nullptr, std::max(allowed, own), input_.floor};
        const NearTriangle near =
            walkNear(drawn, point, {place, squaredTo(drawn, place, point)}, drawn.triangles[place], allowance);
        if (allowance.covers(p, near.squared)) continue;
        for (size_t l = gone.level; l <= level; ++l) errors[l][p] = std::max(errors[l][p], near.squared);
    }
}

void MixedStates::advance(const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                          std::vector<std::vector<double>>& errors) {
    const auto level = uint32_t(errors.size() - 1);
    std::vector<double> raised = errors[level];
    tbb::parallel_for(uint32_t(0), uint32_t(patches_.size()), [&](uint32_t p) {
        PatchState& patch = patches_[p];
        if (patch.boundary.empty()) return;
        Scratch& scratch = scratch_.local();
        follow(patch, level);
        if (patch.faces.size() * kFewFaces > patch.faceCount) return;
        // The coarsest first: the triangles left there are left in the others.
        for (size_t r = rims_.size(); r-- > 0;) raised[p] = measure(p, rims_[r], raised[p], scratch);
    });
    errors[level] = std::move(raised);
    listGone(level, isDrawnComponent);
    for (uint32_t p = 0; p < patches_.size(); ++p) raiseForGone(p, drawn, errors);
    rims_.push_back(rimOf(level, drawn, isDrawnComponent, errors[level]));
    if (rims_.size() > 1 + kMostSteps) rims_.erase(rims_.begin() + 1);
}

} // namespace xgc::bake
