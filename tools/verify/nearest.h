#pragma once

#include <embree3/rtcore.h>
#include <glm/glm.hpp>

#include <vector>

namespace xgc::bake {

/// Nearest-point queries against triangles through Embree's point queries. Any number of threads.
class Nearest {
public:
    Nearest(std::vector<glm::vec3> points, std::vector<glm::uvec3> triangles);
    ~Nearest();
    Nearest(const Nearest&) = delete;
    Nearest& operator=(const Nearest&) = delete;

    /// Distance from `p` to the surface; infinite where there is no triangle.
    double distance(const glm::vec3& p) const;

private:
    std::vector<glm::vec3> points_;
    std::vector<glm::uvec3> triangles_;
    RTCDevice device_;
    RTCScene scene_;
};

} // namespace xgc::bake
