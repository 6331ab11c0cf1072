#pragma once

#include <xgc/bake/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string_view>

/// Small meshes for tests and benchmarks, and the way to the real ones.
namespace xgc::test {

/// Folder of the real meshes: $XGC_DATA, else ../shared/data beside the source tree. Empty path where absent:
/// the caller says aloud that it skips.
inline std::filesystem::path dataDir(std::string_view sourceDir) {
    const char* env = std::getenv("XGC_DATA");
    const std::filesystem::path dir = env ? env : std::filesystem::path(sourceDir) / "../shared/data";
    return std::filesystem::is_directory(dir) ? dir : std::filesystem::path{};
}

/// A model of bare triangles, each its own input face.
inline bake::Model modelOf(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
    bake::Model model;
    model.file = "test";
    model.positions = std::move(positions);
    model.triangles = std::move(triangles);
    const auto n = uint32_t(model.triangles.size());
    for (uint32_t i = 0; i < n; ++i) model.triangleFace.push_back(i);
    model.triangleMaterial.assign(n, 0);
    model.triangleNode.assign(n, bake::kNone);
    model.inputFaceCount = n;
    model.materials.resize(1);
    return model;
}

/// Axis-aligned unit cube around the origin, `n` x `n` quads a side, outward, welded by construction order
/// only (sides repeat their rim's positions: weld it).
inline bake::Model cube(uint32_t n) {
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const auto base = uint32_t(p.size());
            for (uint32_t j = 0; j <= n; ++j) {
                for (uint32_t i = 0; i <= n; ++i) {
                    glm::vec3 q(0);
                    q[axis] = side ? 0.5f : -0.5f;
                    q[(axis + 1) % 3] = float(i) / float(n) - 0.5f;
                    q[(axis + 2) % 3] = float(j) / float(n) - 0.5f;
                    p.push_back(q);
                }
            }
            for (uint32_t j = 0; j < n; ++j) {
                for (uint32_t i = 0; i < n; ++i) {
                    const uint32_t a = base + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
                    const glm::uvec3 u(a, b, d), v(a, d, c);
                    t.push_back(side ? u : glm::uvec3(u.x, u.z, u.y));
                    t.push_back(side ? v : glm::uvec3(v.x, v.z, v.y));
                }
            }
        }
    }
    return modelOf(std::move(p), std::move(t));
}

/// Closed sphere of radius 1 as a subdivided and projected cube.
inline bake::Model sphere(uint32_t n) {
    bake::Model model = cube(n);
    for (glm::vec3& p : model.positions) p = glm::normalize(p);
    return model;
}

/// Open square of n x n quads in the plane z = 0, facing +z.
inline bake::Model grid(uint32_t n) {
    std::vector<glm::vec3> p;
    std::vector<glm::uvec3> t;
    for (uint32_t j = 0; j <= n; ++j) {
        for (uint32_t i = 0; i <= n; ++i) p.emplace_back(float(i) / float(n), float(j) / float(n), 0.0f);
    }
    for (uint32_t j = 0; j < n; ++j) {
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = j * (n + 1) + i;
            t.emplace_back(a, a + 1, a + n + 2);
            t.emplace_back(a, a + n + 2, a + n + 1);
        }
    }
    return modelOf(std::move(p), std::move(t));
}

/// The model welded by exact position.
inline bake::Mesh welded(const bake::Model& model) {
    bake::Mesh mesh;
    bake::WeldReport report;
    if (!bake::weld(model, {}, mesh, report).ok()) std::abort(); // a test's own mesh is broken
    return mesh;
}

} // namespace xgc::test
