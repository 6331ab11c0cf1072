#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

/// The nearest of a set of positions; of equally near ones the lowest (a k-d tree).
class NearestPosition {
public:
    /// `chosen` are indices into `positions`, which stay the caller's.
    NearestPosition(std::span<const glm::vec3> positions, std::vector<uint32_t> chosen);
    /// An index into positions. There must be one.
    uint32_t of(const glm::vec3& point) const;

private:
    struct Best;
    void build(size_t begin, size_t end, int axis);
    void search(size_t begin, size_t end, int axis, const glm::dvec3& point, const glm::dvec3& away, Best& best) const;

    std::span<const glm::vec3> positions_;
    std::vector<uint32_t> order_; ///< the middle of a range parts it
};

} // namespace xgc::bake
