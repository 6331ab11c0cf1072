#pragma once

#include "builders.h"

#include <filesystem>
#include <fstream>
#include <string>

namespace xgc::test {

/// A triangle mesh from a plain OFF file, without the importer: tests of a stage need not depend on it. A model
/// without faces where the file is not one.
inline bake::Model readOff(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string magic;
    size_t vertices = 0, faces = 0, edges = 0;
    in >> magic >> vertices >> faces >> edges;
    if (!in || magic != "OFF") return {};
    std::vector<glm::vec3> positions(vertices);
    std::vector<glm::uvec3> triangles(faces);
    for (glm::vec3& p : positions) in >> p.x >> p.y >> p.z;
    for (glm::uvec3& t : triangles) {
        int corners = 0;
        in >> corners >> t.x >> t.y >> t.z;
        if (corners != 3) return {};
    }
    return in ? modelOf(std::move(positions), std::move(triangles)) : bake::Model{};
}

} // namespace xgc::test
