#pragma once

#include "near_walk.h"
#include "tracked_map.h"

#include <tbb/enumerable_thread_specific.h>

#include <deque>

namespace xgc::bake {

/// Raises errors for states in which one patch is coarser than all others: there its interior stands on boundary
/// vertices that the uniform state has collapsed, and may lie farther from its faces than in either uniform state.
/// (Beside coarser patches the uniform errors serve: those patches' are in the promise.)
///
/// The other way round, what has vanished stays where the patches that stand for it get coarser still.
///
/// A patch at a level is tried with the others at level 0 and at a few levels below its own. Its faces are sampled: the
/// distance changes no faster than the point, and these states differ from uniform ones where patches are down to a few
/// triangles, larger than the space between samples, and are tried there alone. What lies around a patch is the
/// triangles that the others draw at its boundary, so what is found may be too large, not too small.
class MixedStates {
public:
    MixedStates(const MeasuredInput& input, const TrackedMap& map, const DrawnLevel& base);

    /// `drawn`: the uniform state of the next level, in which the last of `errors` (squared, a patch each, for the
    /// levels from 0 on) have been measured.
    void advance(const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
                 std::vector<std::vector<double>>& errors);

private:
    /// What a uniform state draws at the patches' boundaries.
    struct Rim {
        std::vector<uint32_t> representatives;    ///< position of each boundary vertex
        std::vector<glm::uvec3> triangles;        ///< positions
        std::vector<uint32_t> patches;            ///< of the triangles
        std::vector<uint32_t> starOffsets, stars; ///< triangles at each boundary vertex that is drawn
        std::vector<uint8_t> isDrawnComponent;
        std::vector<double> errors; ///< squared, a patch each
    };
    struct Sample {
        glm::dvec3 point;
        glm::uvec3 corners; ///< of its face or one found near it since, as drawn by the patch alone
        uint32_t component;
    };
    struct Gone {
        uint32_t position;
        uint32_t level; ///< at which its component vanished
        bool operator<(const Gone& other) const { return position < other.position; }
    };
    struct PatchState {
        std::vector<uint32_t> boundary; ///< its boundary vertices, as numbered
        std::vector<uint32_t> adjacent; ///< patches that it shares a domain with
        size_t faceCount = 0;           ///< of the input
        std::vector<glm::uvec3> faces;  ///< drawn by the patch alone: positions
        std::vector<Sample> samples;
        std::vector<Gone> gone; ///< by position
    };
    struct Scratch {
        DrawnLevel around;
        std::vector<uint32_t> number;   ///< vertex in `around` of each position; kNone
        std::vector<uint32_t> far;      ///< samples that are not near what their corners draw
        std::vector<uint32_t> standing; ///< representatives of the patch's boundary, rising
    };

    void listBoundary();
    void listFaces();
    Rim rimOf(uint32_t level, const DrawnLevel& drawn, const std::vector<uint8_t>& isDrawnComponent,
              const std::vector<double>& errors) const;
    uint32_t alone(uint32_t position, uint32_t level) const;
    void follow(PatchState& patch, uint32_t level) const;
    double measure(uint32_t patch, const Rim& rim, double allowed, Scratch& scratch);
    void listFar(const PatchState& patch, const Rim& rim, double allowed, Scratch& scratch) const;
    void listGone(uint32_t level, const std::vector<uint8_t>& isDrawnComponent);
    void raiseForGone(uint32_t patch, const DrawnLevel& drawn, std::vector<std::vector<double>>& errors) const;
    void addTriangle(glm::uvec3 positions, uint32_t owner, Scratch& scratch) const;
    void drawPatch(uint32_t patch, const Rim& rim, Scratch& scratch) const;
    void drawOthers(uint32_t patch, const Rim& rim, Scratch& scratch) const;
    void leaveFar(PatchState& patch, const Rim& rim, double allowed, Scratch& scratch) const;
    double farthest(const PatchState& patch, const Rim& rim, double allowed, const Scratch& scratch) const;
    NearTriangle walkFrom(const Sample& sample, const Rim& rim, double allowed, const Scratch& scratch) const;
    uint32_t standing(uint32_t position, const Rim& rim) const {
        return number_[position] == kNone ? position : rim.representatives[number_[position]];
    }
    glm::uvec3 standing(const glm::uvec3& corners, const Rim& rim) const {
        return {standing(corners.x, rim), standing(corners.y, rim), standing(corners.z, rim)};
    }

    const MeasuredInput& input_;
    const TrackedMap& map_;
    const std::vector<uint32_t> parent_;
    std::vector<uint32_t> number_;   ///< of each position among the boundary vertices; kNone: inside a patch
    std::vector<uint32_t> boundary_; ///< position of each boundary vertex
    std::vector<PatchState> patches_;
    std::vector<uint8_t> isGone_; ///< a component each
    std::deque<Rim> rims_;        ///< level 0, then the last levels
    tbb::enumerable_thread_specific<Scratch> scratch_;
};

} // namespace xgc::bake
