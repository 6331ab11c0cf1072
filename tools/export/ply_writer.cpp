#include "export/writers.h"

#include <fmt/format.h>

namespace xgc::bake::exports {
namespace {

unsigned char toByte(float x) {
    return static_cast<unsigned char>(glm::clamp(x, 0.0f, 1.0f) * 255 + 0.5f);
}

std::string header(const Model& model) {
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment xgc\n";
    text += fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
                        model.positions.size());
    if (!model.attributes.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
    if (!model.attributes.colors[0].empty()) {
        for (const char* channel : {"red", "green", "blue", "alpha"})
            text += fmt::format("property uchar {}\n", channel);
    }
    return text + fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                              model.triangles.size());
}

} // namespace

Bytes plyBytes(const Model& model) {
    const std::string text = header(model);
    Bytes out;
    out.reserve(text.size() + model.positions.size() * 28 + model.triangles.size() * 13);
    append(out, text.data(), text.size());
    for (size_t row = 0; row < model.positions.size(); ++row) {
        append(out, &model.positions[row], 12);
        if (!model.attributes.normals.empty()) append(out, &model.attributes.normals[row], 12);
        if (!model.attributes.colors[0].empty()) {
            const glm::vec4 c = model.attributes.colors[0][row];
            const unsigned char bytes[4] = {toByte(c.x), toByte(c.y), toByte(c.z), toByte(c.w)};
            append(out, bytes, 4);
        }
    }
    for (const glm::uvec3 t : model.triangles) {
        const unsigned char three = 3;
        append(out, &three, 1);
        append(out, &t, 12);
    }
    return out;
}

} // namespace xgc::bake::exports
