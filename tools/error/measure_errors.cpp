#include "coverage.h"
#include "direct_bound.h"
#include "drawn_level.h"
#include "mixed_states.h"

#include <xgc/bake/error.h>

#include <cmath>

namespace xgc::bake {
namespace {

constexpr double kFloor = 1e-7; ///< of the diagonal: distances too small to care about
constexpr uint32_t kDirectChunk = 32;
/// Times what a patch with neighbours measures: of the states in which levels differ only some are tried.
constexpr double kMixedMargin = 1.05;

double diagonal(const Mesh& mesh) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    return mesh.positions.empty() ? 0 : glm::length(high - low);
}

/// The least float at or above a double.
float roundedUp(double value) {
    const auto f = float(value);
    return double(f) < value ? std::nextafter(f, INFINITY) : f;
}

/// Per patch: what its errors are multiplied by.
std::vector<double> margins(const Hierarchy& hierarchy) {
    std::vector<double> margin(hierarchy.patchCount(), 1.0);
    for (const std::vector<uint32_t>& patches : hierarchy.domainPatches) {
        if (patches.size() < 2) continue;
        for (const uint32_t p : patches) margin[p] = kMixedMargin;
    }
    return margin;
}

class Measurement {
public:
    Measurement(const Mesh& mesh, const Topology& topology, const Hierarchy& hierarchy)
        : input_{mesh, topology, hierarchy, std::pow(kFloor * diagonal(mesh), 2)}, walk_(mesh, hierarchy),
          map_(input_, walk_.drawn()), mixed_(input_, map_, walk_.drawn()), paths_(input_, map_),
          coverage_(input_, map_, paths_), inputTarget_(input_),
          errors_(1, std::vector<double>(hierarchy.patchCount(), 0.0)), diagonal_(diagonal(mesh)) {}

    /// Measures the next level; may raise the errors of those before.
    void advance() {
        const auto level = uint32_t(errors_.size());
        errors_.push_back(errors_.back());
        if (!walk_.advance()) return;
        const DrawnLevel& drawn = walk_.drawn();
        std::vector<double>& errors = errors_.back();
        if (drawn.count() == 0) { // nothing is drawn: no distance would do
            errors.assign(errors.size(), diagonal_ * diagonal_);
            return;
        }
        std::vector<uint8_t> isDrawnComponent(input_.topology.componentCount, 0);
        for (const uint32_t f : drawn.faces) isDrawnComponent[input_.topology.faceComponent[f]] = 1;
        map_.advance(level, drawn, isDrawnComponent, errors);
        paths_.advance(level, drawn, isDrawnComponent, errors);
        coverage_.advance(level, drawn, isDrawnComponent, errors);
        measureLoose(drawn, errors);
        measureStrained(drawn, errors);
        measureBare(drawn, errors);
        mixed_.advance(drawn, isDrawnComponent, errors_);
    }

    /// Squared, a patch each, for the levels measured.
    const std::vector<std::vector<double>>& errors() const { return errors_; }

private:
    /// From faces whose image is unknown to the drawn surface.
    void measureLoose(const DrawnLevel& drawn, std::vector<double>& errors) {
        const DrawnTarget target(drawn);
        const std::vector<uint32_t>& faces = coverage_.looseFaces();
        const auto measure = [&](RunningErrors& running, uint32_t, uint32_t first, uint32_t last) {
            DirectBound bound(target, input_.floor);
            for (uint32_t i = first; i < last; ++i) {
                measureFace(faces[i], bound, running);
            }
        };
        forChunks(faces.size(), errors, measure, kDirectChunk);
    }

    /// Faces whose image is known but far: from the face to the drawn surface, and from the image to the input.
    void measureStrained(const DrawnLevel& drawn, std::vector<double>& errors) {
        const std::vector<uint32_t>& faces = coverage_.strainedFaces();
        if (faces.empty()) return;
        inputTarget_.prepare();
        const DrawnTarget surface(drawn);
        const auto measure = [&](RunningErrors& running, uint32_t, uint32_t first, uint32_t last) {
            DirectBound toSurface(surface, input_.floor), toInput(inputTarget_, input_.floor);
            for (uint32_t i = first; i < last; ++i) {
                measureFace(faces[i], toSurface, running);
                for (const Coverage::Region& r : coverage_.imageOf(faces[i], drawn)) {
                    const uint32_t patch = drawn.patches[r.triangle];
                    running.raise(patch,
                                  toInput.ofHull(r.points, drawn.normal(r.triangle), faces[i], running.of(patch)));
                }
            }
        };
        forChunks(faces.size(), errors, measure, kDirectChunk);
    }

    void measureFace(uint32_t face, DirectBound& bound, RunningErrors& running) const {
        const glm::uvec3 p = input_.mesh.facePositions(face);
        const uint32_t patch = input_.hierarchy.facePatch[face];
        running.raise(patch, bound.of({input_.point(p.x), input_.point(p.y), input_.point(p.z)},
                                      {map_[p.x].triangle, map_[p.y].triangle, map_[p.z].triangle}, running.of(patch)));
    }

    /// From drawn triangles that are not known to be covered to the input.
    void measureBare(const DrawnLevel& drawn, std::vector<double>& errors) {
        std::vector<uint8_t> wasMeasured(drawn.count(), 0);
        for (uint32_t t = 0; t < measured_.size(); ++t) {
            const uint32_t now = drawn.newTriangle[t];
            if (measured_[t] && now != kNone && !drawn.isFresh[now]) wasMeasured[now] = 1;
        }
        measured_ = std::move(wasMeasured);
        std::vector<uint32_t> bare;
        for (const uint32_t t : coverage_.bareTriangles()) {
            if (!measured_[t]) bare.push_back(t);
            measured_[t] = 1;
        }
        if (bare.empty()) return;
        inputTarget_.prepare();
        const auto measure = [&](RunningErrors& running, uint32_t, uint32_t first, uint32_t last) {
            DirectBound bound(inputTarget_, input_.floor);
            for (uint32_t i = first; i < last; ++i) {
                const glm::uvec3& c = drawn.triangles[bare[i]];
                const uint32_t patch = drawn.patches[bare[i]];
                uint32_t hints[3];
                for (int k = 0; k < 3; ++k) {
                    const uint32_t position = drawn.positions[c[k]];
                    hints[k] = position < input_.mesh.positions.size() ? input_.topology.facesOfVertex(position).front()
                                                                       : kNone;
                }
                running.raise(patch, bound.of({drawn.points[c.x], drawn.points[c.y], drawn.points[c.z]},
                                              {hints[0], hints[1], hints[2]}, running.of(patch)));
            }
        };
        forChunks(bare.size(), errors, measure, kDirectChunk);
    }

    const MeasuredInput input_;
    LevelWalk walk_;
    TrackedMap map_;
    MixedStates mixed_;
    EdgePaths paths_;
    Coverage coverage_;
    InputTarget inputTarget_;
    std::vector<std::vector<double>> errors_; ///< by level
    std::vector<uint8_t> measured_;
    const double diagonal_;
};

} // namespace

PatchErrors measureErrors(const Mesh& mesh, const Topology& topology, const Hierarchy& hierarchy,
                          const std::function<bool(double)>& progress) {
    const uint32_t patchCount = hierarchy.patchCount(), levelCount = hierarchy.levelCount;
    PatchErrors errors;
    errors.values.assign(size_t(patchCount) * levelCount, 0.0f);
    const std::vector<double> margin = margins(hierarchy);
    Measurement measurement(mesh, topology, hierarchy);
    for (uint32_t level = 1; level < levelCount; ++level) {
        measurement.advance();
        if (progress && !progress(double(level) / (levelCount - 1))) break;
    }
    const std::vector<std::vector<double>>& squared = measurement.errors();
    for (uint32_t level = 1; level < squared.size(); ++level) {
        for (uint32_t p = 0; p < patchCount; ++p) {
            errors.values[size_t(p) * levelCount + level] = roundedUp(std::sqrt(squared[level][p]) * margin[p]);
        }
    }
    return errors;
}

} // namespace xgc::bake
