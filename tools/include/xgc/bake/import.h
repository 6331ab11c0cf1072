#pragma once

#include <xgc/bake/mesh.h>
#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <filesystem>
#include <span>

namespace xgc::bake {

/// Bounds on what a file may unfold into: a small file can instance a mesh many times.
struct ImportLimits {
    uint64_t maxFaces = kMaxFaces;      ///< input faces, and triangles
    uint64_t maxVertices = 0xfffffffeu; ///< rows of the model
};

/// Reads a model file: glTF 2.0 and GLB through tinygltf, everything else (OBJ, PLY, OFF, STL, ...)
/// through Assimp, by extension. On failure `out` is untouched and the message names file, element and remedy.
///
/// Scene: the default scene (the first where none is named, all root nodes where there is no scene) is flattened: a
/// mesh instanced by n nodes gives n copies. Normals go by the inverse transpose, mirroring transforms flip the
/// winding. A skinned mesh stays in its bind space and its node's transform is ignored, as glTF says:
/// joint matrices nodes[joint].toMesh * inverseBind take it into mesh space. Cameras, lights, animations and images
/// are not read; an image that is missing is no error.
///
/// Faces: an input face is a face record of the file, counted from 0 in file order (glTF: a triangle of a primitive,
/// in the order of the flattened scene; strips count their degenerate triangles). Points and lines are left out and
/// not counted, except two-corner faces in the face lists of OFF and PLY and on `f` lines, which are counted, so that
/// labels per face keep step, but give no triangle. Polygons are triangulated (fan, or ear clipping where
/// concave). The order of OBJ is the file's whatever its objects, groups and materials do. In formats with several
/// meshes (COLLADA, FBX, ...) Assimp sorts faces into meshes by material: the order is that of Assimp's scene,
/// nodes depth first. Labels per face for such files should come from a conversion to one of the formats above.
///
/// Attributes: primitives may differ in theirs: a row without a stream gets normal 0, tangent (0, 0, 0, 1), UV
/// 0, colour 1, joints 0, weights (1, 0, 0, 0) in the first set and 0 in the second, displacements 0. UVs and colours
/// are as in the file, in its convention. Facet normals of STL are left out. Skins and morph targets come from
/// glTF only. Triangles without a material share one named "default".
Status importModel(const std::filesystem::path& file, Model& out, const ImportLimits& limits = {});

/// As importModel, from memory. `extension` with its dot (".glb") picks the reader; no other file is opened: external
/// buffers of a .gltf are refused, an .mtl file counts as missing. For tests and fuzzing.
Status importModelFromMemory(std::span<const std::byte> bytes, const std::string& extension, Model& out,
                             const ImportLimits& limits = {});

} // namespace xgc::bake
