#pragma once

#include <xgc/bake/hierarchy.h>

#include <filesystem>
#include <vector>

namespace xgc::bench {

/// Triangles over rows, as a renderer draws them. Normals and UVs are empty or have an entry a row.
struct Surface {
    std::vector<glm::vec3> points;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::uvec3> triangles;

    uint32_t faceCount() const { return uint32_t(triangles.size()); }
};

/// The whole mesh, a row each wedge.
Surface surfaceOf(const bake::Mesh& mesh);
/// What a hierarchy draws in a state, over all its wedges.
Surface surfaceOf(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy, std::span<const uint8_t> levels);
/// All patches at one level.
Surface surfaceAt(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy, uint32_t level);
/// A model read from a file.
Surface surfaceOf(const bake::Model& model);

/// Binary PLY with exact floats (x y z, then nx ny nz and s t where the surface has them): how surfaces travel to other
/// programs and back.
bake::Status writePly(const std::filesystem::path& file, const Surface& surface);
/// Reads what writePly wrote.
bake::Status readPly(const std::filesystem::path& file, Surface& out);

} // namespace xgc::bench
