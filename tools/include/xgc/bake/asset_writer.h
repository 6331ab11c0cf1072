#pragma once

#include <xgc/bake/hierarchy.h>

#include <cstddef>
#include <filesystem>

namespace xgc::bake {

/// E of each patch and level: entry patch * levelCount + level, mesh units, never falling with the level.
struct PatchErrors {
    std::vector<float> values;
    bool estimate = false; ///< the values are guesses, not bounds: the file says so
    /// Positions were snapped to its multiples before the mesh was built, and `values` include how far; 0: they were
    /// not.
    float positionStep = 0;
};

/// Lays an asset out as runtime/FORMAT.md says: the bytes of an `.xgc` file, uncompressed. The same input gives
/// the same bytes on any machine. `provenance` is stored as it is (JSON). With a `tierCount` above 1 rows and face
/// lists are laid out so that cutIntoPages (pages.h) finds up to so many tiers; the file is opened as any other.
Status layOutAsset(const Mesh& mesh, const Segmentation& parts, const Hierarchy& hierarchy, const PatchErrors& errors,
                   bool inputIsClosed, std::string_view provenance, std::vector<std::byte>& out,
                   uint32_t tierCount = 1);

/// Writes bytes beside the target and renames, so that the target is whole or untouched.
Status writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Reads a whole file, aligned for `xgc::openAll`.
struct AlignedBytes {
    struct Block {
        alignas(64) std::byte bytes[64];
    };
    std::vector<Block> blocks;
    size_t size = 0;
    std::span<const std::byte> span() const { return {reinterpret_cast<const std::byte*>(blocks.data()), size}; }
    std::span<std::byte> writable() { return {reinterpret_cast<std::byte*>(blocks.data()), size}; }
};
Status readFile(const std::filesystem::path& file, AlignedBytes& out);
AlignedBytes alignedBytes(size_t size);
AlignedBytes alignedCopy(std::span<const std::byte> bytes);

/// The image that `xgc::openAll` opens: the file itself, or what it decodes to where it is compressed.
Status decodeImage(AlignedBytes&& file, AlignedBytes& out);
/// Reads a file and decodes it so. The message names the file.
Status readImage(const std::filesystem::path& file, AlignedBytes& out);

} // namespace xgc::bake
