#include "surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace xgc::bench {
namespace {

/// Floats of a row.
uint32_t rowFloats(const Surface& s) {
    return 3 + (s.normals.empty() ? 0 : 3) + (s.uvs.empty() ? 0 : 2);
}

std::string headerOf(const Surface& s) {
    std::string header = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", s.points.size());
    for (const char* name : {"x", "y", "z"}) header += fmt::format("property float {}\n", name);
    if (!s.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!s.uvs.empty()) header += "property float s\nproperty float t\n";
    return header +
           fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", s.triangles.size());
}

/// Sizes the arrays of `s` by a header.
bool readHeader(std::istream& in, Surface& s) {
    std::string line;
    size_t vertices = 0, faces = 0;
    bool normals = false, uvs = false;
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        std::string key, what, name;
        words >> key >> what >> name;
        if (key == "element" && what == "vertex") vertices = std::strtoull(name.c_str(), nullptr, 10);
        if (key == "element" && what == "face") faces = std::strtoull(name.c_str(), nullptr, 10);
        normals |= name == "nx";
        uvs |= name == "s";
    }
    s.points.resize(vertices);
    s.normals.resize(normals ? vertices : 0);
    s.uvs.resize(uvs ? vertices : 0);
    s.triangles.resize(faces);
    return bool(in);
}

} // namespace

Surface surfaceOf(const bake::Mesh& mesh) {
    Surface s;
    for (const uint32_t p : mesh.wedgePosition) s.points.push_back(mesh.positions[p]);
    s.normals = mesh.attributes.normals;
    s.uvs = mesh.attributes.uvs[0];
    s.triangles = mesh.faces;
    return s;
}

Surface surfaceOf(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy, std::span<const uint8_t> levels) {
    Surface s;
    for (const uint32_t p : hierarchy.wedgePosition) s.points.push_back(hierarchy.positions[p]);
    s.normals = hierarchy.attributes.normals;
    s.uvs = hierarchy.attributes.uvs[0];
    s.triangles = bake::drawSurface(mesh, hierarchy, levels).triangles;
    return s;
}

Surface surfaceAt(const bake::Mesh& mesh, const bake::Hierarchy& hierarchy, uint32_t level) {
    return surfaceOf(mesh, hierarchy, std::vector<uint8_t>(hierarchy.patchCount(), uint8_t(level)));
}

Surface surfaceOf(const bake::Model& model) {
    return {model.positions, model.attributes.normals, model.attributes.uvs[0], model.triangles};
}

bake::Status writePly(const std::filesystem::path& file, const Surface& s) {
    std::ofstream out(file, std::ios::binary);
    out << headerOf(s);
    std::vector<float> row(rowFloats(s));
    for (size_t v = 0; v < s.points.size(); ++v) {
        float* at = row.data();
        const auto put = [&](const float* values, size_t count) { at = std::copy_n(values, count, at); };
        put(&s.points[v].x, 3);
        if (!s.normals.empty()) put(&s.normals[v].x, 3);
        if (!s.uvs.empty()) put(&s.uvs[v].x, 2);
        out.write(reinterpret_cast<const char*>(row.data()), std::streamsize(row.size() * sizeof(float)));
    }
    for (const glm::uvec3& t : s.triangles) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(&t), sizeof t);
    }
    return out.flush() ? bake::Status{} : bake::systemError(fmt::format("{}: cannot be written", file.string()));
}

bake::Status readPly(const std::filesystem::path& file, Surface& out) {
    std::ifstream in(file, std::ios::binary);
    Surface s;
    if (!readHeader(in, s))
        return bake::badInput(fmt::format("{}: not a PLY file as writePly makes it", file.string()));
    std::vector<float> row(rowFloats(s));
    for (size_t v = 0; v < s.points.size(); ++v) {
        in.read(reinterpret_cast<char*>(row.data()), std::streamsize(row.size() * sizeof(float)));
        std::copy_n(row.data(), 3, &s.points[v].x);
        if (!s.normals.empty()) std::copy_n(row.data() + 3, 3, &s.normals[v].x);
        if (!s.uvs.empty()) std::copy_n(row.data() + row.size() - 2, 2, &s.uvs[v].x);
    }
    for (glm::uvec3& t : s.triangles) {
        const int corners = in.get();
        in.read(reinterpret_cast<char*>(&t), sizeof t);
        const bool good = in && corners == 3 && std::max({t.x, t.y, t.z}) < s.points.size();
        if (!good) return bake::badInput(fmt::format("{}: cut short, or not of triangles", file.string()));
    }
    out = std::move(s);
    return {};
}

} // namespace xgc::bench
