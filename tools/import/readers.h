#pragma once

#include <xgc/bake/import.h>

namespace xgc::bake {

/// The bytes of a model file and where it lies.
struct Source {
    std::string name;             ///< for messages
    std::filesystem::path folder; ///< of the siblings that it may name
    bool siblings = false;        ///< whether those may be opened
    std::string extension;        ///< lower case, with its dot
    std::span<const std::byte> bytes;
};

Status readGltf(const Source& source, const ImportLimits& limits, Model& out);
Status readWithAssimp(const Source& source, const ImportLimits& limits, Model& out);

} // namespace xgc::bake
