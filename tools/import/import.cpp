#include <xgc/bake/import.h>

#include <import/input_file.h>
#include <import/readers.h>

#include <fmt/format.h>

#include <exception>
#include <new>

namespace xgc::bake {

namespace {

std::string lowerCase(std::string text) {
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    }
    return text;
}

Status readSource(const Source& source, const ImportLimits& limits, Model& out) {
    if (source.bytes.empty()) return badInput(fmt::format("{}: the file is empty; export it again", source.name));
    try {
        Model model;
        const bool gltf = source.extension == ".gltf" || source.extension == ".glb";
        const Status s = gltf ? readGltf(source, limits, model) : readWithAssimp(source, limits, model);
        if (!s.ok()) return s;
        if (model.triangles.empty())
            return badInput(fmt::format("{}: it holds no triangle; give a file with faces", source.name));
        out = std::move(model);
        return {};
    } catch (const std::bad_alloc&) {
        return systemError(fmt::format("{}: not enough memory to read it; split the model", source.name));
    } catch (const std::exception& e) {
        return badInput(fmt::format("{}: {}; export it again", source.name, e.what()));
    }
}

} // namespace

Status importModel(const std::filesystem::path& file, Model& out, const ImportLimits& limits) {
    std::vector<std::byte> bytes;
    if (Status s = readInputFile(file, bytes); !s.ok()) return s;
    return readSource({file.string(), file.parent_path(), true, lowerCase(file.extension().string()), bytes}, limits,
                      out);
}

Status importModelFromMemory(std::span<const std::byte> bytes, const std::string& extension, Model& out,
                             const ImportLimits& limits) {
    return readSource({"memory" + extension, {}, false, lowerCase(extension), bytes}, limits, out);
}

} // namespace xgc::bake
