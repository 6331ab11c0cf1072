#include <xgc/bake/export.h>

#include "export/writers.h"

#include <xgc/bake/asset_writer.h>

#include <fmt/format.h>

#include <algorithm>

namespace xgc::bake {
namespace {

std::string lowerExtension(const std::filesystem::path& file) {
    std::string text = file.extension().string();
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    }
    return text;
}

Status writeText(const std::filesystem::path& file, const std::string& text) {
    return writeFileAtomically(file, std::as_bytes(std::span(text)));
}

Status writeObj(const Model& model, const std::filesystem::path& file) {
    const bool named = std::any_of(model.materials.begin(), model.materials.end(),
                                   [](const Material& material) { return !material.name.empty(); });
    if (!named) return writeText(file, exports::objText(model, {}));
    std::filesystem::path library = file;
    library.replace_extension(".mtl");
    const Status status = writeText(file, exports::objText(model, library.filename().string()));
    return status.ok() ? writeText(library, exports::mtlText(model)) : status;
}

} // namespace

Status checkExportName(const std::filesystem::path& file) {
    const std::string extension = lowerExtension(file);
    if (extension == ".glb" || extension == ".obj" || extension == ".ply") return {};
    return usageError(fmt::format("{}: cannot write this kind of file; name it .glb, .obj or .ply", file.string()));
}

Status exportModel(const Model& model, const std::filesystem::path& file) {
    if (Status status = checkExportName(file); !status.ok()) return status;
    if (model.triangles.empty()) return badInput(fmt::format("{}: nothing to write, no faces", file.string()));
    const std::string extension = lowerExtension(file);
    if (extension == ".obj") return writeObj(model, file);
    exports::Bytes bytes;
    if (extension == ".ply") {
        bytes = exports::plyBytes(model);
    } else if (Status status = exports::glbBytes(model, bytes); !status.ok()) {
        return {status.outcome, fmt::format("{}: {}", file.string(), status.message)};
    }
    return writeFileAtomically(file, bytes);
}

} // namespace xgc::bake
