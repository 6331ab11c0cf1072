#include "export/writers.h"

#include <fmt/format.h>

#include <iterator>

namespace xgc::bake::exports {
namespace {

/// Names are single words in these formats.
std::string word(const std::string& name, const char* kind, uint32_t index) {
    if (name.empty()) return fmt::format("{}{}", kind, index);
    std::string out = name;
    for (char& c : out) {
        if (static_cast<unsigned char>(c) <= ' ') c = '_';
    }
    return out;
}

} // namespace

// Numbers are written with the fewest digits that read back to the same float.
std::string objText(const Model& model, const std::string& materialLibrary) {
    std::string text = "# xgc\n";
    auto out = std::back_inserter(text);
    if (!materialLibrary.empty()) fmt::format_to(out, "mtllib {}\n", materialLibrary);
    for (const glm::vec3 p : model.positions) fmt::format_to(out, "v {} {} {}\n", p.x, p.y, p.z);
    const bool hasUv = !model.attributes.uvs[0].empty();
    const bool hasNormal = !model.attributes.normals.empty();
    // The V axis of an OBJ points up, ours down.
    for (const glm::vec2 uv : model.attributes.uvs[0]) fmt::format_to(out, "vt {} {}\n", uv.x, 1 - uv.y);
    for (const glm::vec3 n : model.attributes.normals) fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);

    uint32_t node = kNone;
    for (const Group& group : groupTriangles(model)) {
        if (group.node != node) fmt::format_to(out, "o {}\n", word(model.nodes[group.node].name, "node", group.node));
        node = group.node;
        if (!materialLibrary.empty()) {
            const std::string& name = model.materials[group.material].name;
            fmt::format_to(out, "usemtl {}\n", word(name, "material", group.material));
        }
        for (const uint32_t t : group.triangles) {
            text += 'f';
            for (int k = 0; k < 3; ++k) {
                const uint32_t i = model.triangles[t][k] + 1;
                if (hasUv && hasNormal) {
                    fmt::format_to(out, " {}/{}/{}", i, i, i);
                } else if (hasNormal) {
                    fmt::format_to(out, " {}//{}", i, i);
                } else if (hasUv) {
                    fmt::format_to(out, " {}/{}", i, i);
                } else {
                    fmt::format_to(out, " {}", i);
                }
            }
            text += '\n';
        }
    }
    return text;
}

std::string mtlText(const Model& model) {
    std::string text = "# xgc\n";
    auto out = std::back_inserter(text);
    for (uint32_t i = 0; i < model.materials.size(); ++i) {
        const Material& m = model.materials[i];
        fmt::format_to(out, "newmtl {}\nKd {} {} {}\nd {}\n", word(m.name, "material", i), m.baseColor.x, m.baseColor.y,
                       m.baseColor.z, m.baseColor.w);
        fmt::format_to(out, "Ke {} {} {}\nPm {}\nPr {}\n", m.emissive.x, m.emissive.y, m.emissive.z, m.metallic,
                       m.roughness);
    }
    return text;
}

} // namespace xgc::bake::exports
