#include <xgc/bake/import.h>

#include <array>
#include <cstdlib>
#include <string>

/// Assimp 5.2.5 itself leaks the mesh at hand when it refuses a file.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libassimp.so";
}

/// The first byte picks the reader, the rest is the file. What is read must also weld or be refused.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const std::array<std::string, 5> kExtensions = {".glb", ".gltf", ".obj", ".ply", ".off"};
    if (size == 0) return 0;
    // Letters, so that a corpus can be written by hand.
    const std::string extension = data[0] == 's' ? ".stl" : kExtensions[data[0] % kExtensions.size()];
    xgc::bake::ImportLimits limits;
    limits.maxFaces = limits.maxVertices = 1u << 18;
    xgc::bake::Model model;
    const auto bytes = std::as_bytes(std::span(data + 1, size - 1));
    if (!xgc::bake::importModelFromMemory(bytes, extension, model, limits).ok()) return 0;
    if (model.triangles.empty() || model.triangleFace.back() >= model.inputFaceCount) std::abort();
    xgc::bake::Mesh mesh;
    xgc::bake::WeldReport report;
    const xgc::bake::Status status = xgc::bake::weld(model, {}, mesh, report);
    if (!status.ok() && status.message.empty()) std::abort();
    return 0;
}
