#pragma once

#include <xgc/bake/model.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace xgc::bake {

/// An OBJ file cut down to one run of faces. Assimp sorts faces by object, group and material, and gives the faces
/// before the first `usemtl` that material too; so those statements are kept here, and what is left for
/// it has the file's order.
struct ObjText {
    std::string text; ///< v, vt, vn, f and mtllib statements
    std::vector<std::string> groups;
    std::vector<std::string> materials;
    std::vector<uint32_t> faceGroup;    ///< per `f`: in groups, or kNone
    std::vector<uint32_t> faceMaterial; ///< per `f`: in materials, or kNone
};

ObjText splitObj(std::span<const std::byte> bytes);

} // namespace xgc::bake
