#pragma once

#include "hierarchy/quadric.h"
#include "hierarchy/surface_state.h"

#include <xgc/bake/default_hierarchy.h>

namespace xgc::bake {

/// How far normals, UVs and colours come to lie from what they were (Hoppe, "New Quadric Metric for Simplifying Meshes
/// with Appearance Attributes", 1999): over each input face an attribute is linear, and a wedge's quadric sums the
/// squared differences between those and a value at a point, weighted by area. An attribute that varies linearly over
/// the surface costs nothing to thin out. Values are scaled to lengths by their weights.
class AttributeQuadrics {
public:
    AttributeQuadrics(const SurfaceState& state, const HierarchyOptions& options);

    /// No attribute has a weight, or the mesh has none of those.
    bool empty() const { return count_ == 0; }
    /// Of a wedge that goes to `point`, about the state's origin, and takes the values of another.
    double cost(uint32_t wedge, const glm::dvec3& point, uint32_t valuesOf) const;
    /// Of two wedges that meet between each other, `share` of the way to the second.
    double meetingCost(uint32_t first, uint32_t second, const glm::dvec3& point, double share) const;
    void add(uint32_t to, uint32_t from);
    /// A made wedge, drafted: its values and the quadrics of both.
    void make(uint32_t made, const SurfaceState::MadeWedge& of);
    /// Room for wedges up to `wedgeCount`.
    void grow(size_t wedgeCount);

private:
    void addFace(const SurfaceState& state, glm::uvec3 wedges);
    double evaluate(uint32_t wedge, const glm::dvec3& point, uint32_t first, uint32_t second, double share) const;
    float* valuesAt(uint32_t wedge) { return values_.data() + size_t(wedge) * count_; }

    size_t count_ = 0; ///< values a wedge
    std::vector<float> values_;
    std::vector<Quadric> sums_;        ///< what does not depend on the values
    std::vector<glm::vec4> gradients_; ///< a value each: weighted sum of gradients, and of constants
};

} // namespace xgc::bake
