#include "frustum_lines.h"

#include <array>
#include <cmath>
#include <utility>

namespace xgc::viewer {

std::vector<Line> project(const vulkan::Camera& camera, const glm::vec3& from, const glm::vec3& to) {
    const glm::mat4 worldToClip = camera.worldToClip();
    glm::vec4 a = worldToClip * glm::vec4(from, 1), b = worldToClip * glm::vec4(to, 1);
    const float nearest = camera.nearPlane; // w is the distance along the view
    if (a.w < nearest && b.w < nearest) return {};
    if (a.w < nearest) std::swap(a, b);
    if (b.w < nearest) {
        b = a + (b - a) * ((a.w - nearest) / (a.w - b.w));
    }
    const auto place = [](const glm::vec4& p) { return glm::vec2(0.5f + 0.5f * p.x / p.w, 0.5f + 0.5f * p.y / p.w); };
    return {{place(a), place(b)}};
}

std::vector<Line> frustumLines(const vulkan::Camera& seenBy, const vulkan::Camera& of, float depth) {
    const vulkan::Camera::Basis basis = of.basis();
    const float y = depth * std::tan(of.fovY / 2), x = y * of.aspect;
    const glm::vec3 middle = of.eye + depth * basis.forward;
    const std::array corners = {middle - x * basis.right - y * basis.up, middle + x * basis.right - y * basis.up,
                                middle + x * basis.right + y * basis.up, middle - x * basis.right + y * basis.up};
    std::vector<Line> out;
    const auto add = [&](const glm::vec3& from, const glm::vec3& to) {
        for (const Line& line : project(seenBy, from, to)) out.push_back(line);
    };
    for (size_t i = 0; i < 4; ++i) {
        add(of.eye, corners[i]);
        add(corners[i], corners[(i + 1) % 4]);
    }
    const glm::vec3 tip = middle + 1.3f * y * basis.up;
    add(middle + y * basis.up - 0.25f * x * basis.right, tip);
    add(middle + y * basis.up + 0.25f * x * basis.right, tip);
    return out;
}

} // namespace xgc::viewer
