#include "camera_path.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace xgc::headless {
namespace {

/// Catmull-Rom: through b at t = 0 and c at t = 1.
glm::vec3 spline(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, float t) {
    return 0.5f * (2.0f * b + t * (c - a + t * (2.0f * a - 5.0f * b + 4.0f * c - d + t * (3.0f * (b - c) + d - a))));
}

std::vector<CameraKey> orbit(const glm::vec3& center, float radius) {
    constexpr int kKeys = 24;
    std::vector<CameraKey> keys;
    for (int i = 0; i <= kKeys; ++i) {
        const float angle = 2 * glm::pi<float>() * float(i) / kKeys;
        const glm::vec3 offset(2.6f * std::sin(angle), 0.9f, 2.6f * std::cos(angle));
        keys.push_back({center + radius * offset, center});
    }
    return keys;
}

std::vector<CameraKey> flyby(const glm::vec3& center, float radius) {
    const glm::vec3 ways[] = {{-9, 2.5f, 16},     {-4, 1.4f, 7}, {-1.2f, 0.6f, 2.2f}, {0.6f, 0.35f, 1.25f},
                              {1.8f, 0.6f, 1.5f}, {5, 1.6f, 5},  {12, 3.5f, 12}};
    std::vector<CameraKey> keys;
    for (const glm::vec3& way : ways) keys.push_back({center + radius * way, center});
    return keys;
}

bake::Status readKeys(const std::string& file, std::vector<CameraKey>& keys) {
    std::ifstream in(file);
    if (!in) {
        return bake::badInput(fmt::format("--path {}: no such file, and neither orbit nor flyby", file));
    }
    std::string line;
    for (size_t number = 1; std::getline(in, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        if ((words >> std::ws).eof()) continue;
        CameraKey key{};
        words >> key.eye.x >> key.eye.y >> key.eye.z >> key.target.x >> key.target.y >> key.target.z;
        if (!words || !(words >> std::ws).eof()) {
            return bake::badInput(fmt::format("{}:{}: expected six numbers, eye and target", file, number));
        }
        keys.push_back(key);
    }
    if (keys.empty()) return bake::badInput(fmt::format("{}: has no line with a camera", file));
    return {};
}

} // namespace

bake::Status CameraPath::make(const std::string& name, const glm::vec3& center, float radius, CameraPath& out) {
    CameraPath path;
    if (name == "orbit") {
        path.keys_ = orbit(center, radius);
    } else if (name == "flyby") {
        path.keys_ = flyby(center, radius);
    } else if (const bake::Status status = readKeys(name, path.keys_); !status.ok()) {
        return status;
    }
    out = std::move(path);
    return {};
}

CameraKey CameraPath::at(float time) const {
    const size_t last = keys_.size() - 1;
    const float place = std::clamp(time, 0.0f, 1.0f) * float(last);
    const size_t i = std::min(size_t(place), last);
    const CameraKey& a = keys_[i > 0 ? i - 1 : 0];
    const CameraKey& b = keys_[i];
    const CameraKey& c = keys_[std::min(i + 1, last)];
    const CameraKey& d = keys_[std::min(i + 2, last)];
    const float t = place - float(i);
    return {spline(a.eye, b.eye, c.eye, d.eye, t), spline(a.target, b.target, c.target, d.target, t)};
}

} // namespace xgc::headless
