#pragma once

#include <xgc/bake/status.h>

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace xgc::headless {

struct CameraKey {
    glm::vec3 eye;
    glm::vec3 target;
};

/// A smooth way through keys, evenly timed.
class CameraPath {
public:
    /// `name`: orbit (once around), flyby (from afar, close by, and away), or a file of keys, a line each: six numbers,
    /// eye and target; empty lines and # comments are skipped. `center` and `radius` bound the scene.
    static bake::Status make(const std::string& name, const glm::vec3& center, float radius, CameraPath& out);

    /// The camera at a time of 0..1.
    CameraKey at(float time) const;

private:
    std::vector<CameraKey> keys_; ///< at least one
};

} // namespace xgc::headless
