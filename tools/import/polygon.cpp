#include <import/polygon.h>

#include <algorithm>

namespace xgc::bake {

namespace {

/// The polygon seen along its mean normal (Newell), so that it runs counter-clockwise.
std::vector<glm::dvec2> project(std::span<const glm::vec3> corners) {
    glm::dvec3 normal(0);
    const glm::dvec3 origin(corners[0]);
    for (size_t i = 0; i < corners.size(); ++i) {
        normal += glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[(i + 1) % corners.size()]) - origin);
    }
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<glm::dvec2> flat;
    flat.reserve(corners.size());
    for (const glm::vec3& c : corners) {
        const glm::dvec3 p = glm::dvec3(c) - origin;
        flat.emplace_back(normal[axis] < 0 ? -p[u] : p[u], p[v]);
    }
    return flat;
}

double doubleArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// True where all triangles of the fan have a positive area: then it covers the polygon once.
bool fanCovers(const std::vector<glm::dvec2>& p, size_t from) {
    for (size_t i = 1; i + 1 < p.size(); ++i) {
        if (!(doubleArea(p[from], p[(from + i) % p.size()], p[(from + i + 1) % p.size()]) > 0)) return false;
    }
    return true;
}

void appendFan(size_t corners, size_t from, std::vector<glm::uvec3>& out) {
    for (size_t i = 1; i + 1 < corners; ++i) {
        out.emplace_back(uint32_t(from), uint32_t((from + i) % corners), uint32_t((from + i + 1) % corners));
    }
}

class EarClipper {
public:
    explicit EarClipper(const std::vector<glm::dvec2>& points)
        : p_(points), next_(points.size()), previous_(points.size()), testsLeft_(uint64_t(points.size()) * 4000) {
        for (uint32_t i = 0; i < p_.size(); ++i) {
            next_[i] = uint32_t((i + 1) % p_.size());
            previous_[i] = uint32_t((i + p_.size() - 1) % p_.size());
        }
    }

    void run(std::vector<glm::uvec3>& out) {
        uint32_t at = 0;
        for (size_t left = p_.size(); left >= 3; --left) {
            const uint32_t ear = findEar(at, left);
            out.emplace_back(previous_[ear], ear, next_[ear]);
            next_[previous_[ear]] = next_[ear];
            previous_[next_[ear]] = previous_[ear];
            at = next_[ear];
        }
    }

private:
    /// The next proper ear; where there is none, or where looking for it costs too much (polygons that cross
    /// themselves, thousands of corners), the corner at hand.
    uint32_t findEar(uint32_t at, size_t left) {
        uint32_t corner = at;
        for (size_t i = 0; i < left && testsLeft_ > 0; ++i, corner = next_[corner]) {
            if (isEar(corner)) return corner;
        }
        return at;
    }

    bool isEar(uint32_t corner) {
        const uint32_t a = previous_[corner], c = next_[corner];
        testsLeft_ -= testsLeft_ > 0;
        if (!(doubleArea(p_[a], p_[corner], p_[c]) > 0)) return false;
        for (uint32_t i = next_[c]; i != a; i = next_[i]) {
            if (testsLeft_ == 0) return false;
            --testsLeft_;
            if (p_[i] == p_[a] || p_[i] == p_[c] || p_[i] == p_[corner]) continue; // bridges of holes touch themselves
            if (doubleArea(p_[a], p_[corner], p_[i]) >= 0 && doubleArea(p_[corner], p_[c], p_[i]) >= 0 &&
                doubleArea(p_[c], p_[a], p_[i]) >= 0)
                return false;
        }
        return true;
    }

    const std::vector<glm::dvec2>& p_;
    std::vector<uint32_t> next_;
    std::vector<uint32_t> previous_;
    uint64_t testsLeft_;
};

} // namespace

void triangulatePolygon(std::span<const glm::vec3> corners, std::vector<glm::uvec3>& out) {
    if (corners.size() == 3) return appendFan(3, 0, out);
    const std::vector<glm::dvec2> flat = project(corners);
    constexpr size_t kFansTried = 8;
    for (size_t from = 0; from < std::min(corners.size(), kFansTried); ++from) {
        if (fanCovers(flat, from)) return appendFan(corners.size(), from, out);
    }
    EarClipper(flat).run(out);
}

} // namespace xgc::bake
