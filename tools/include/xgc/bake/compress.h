#pragma once

#include <xgc/bake/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

struct CompressOptions {
    int zstdLevel = 12; ///< 1..19; higher ones are slower to write and decode more slowly too
};

/// Compresses an asset section by section and stream by stream (runtime/FORMAT.md, "Codecs"): `xgc::decode` gives back
/// `image` bit for bit, which is tried before anything is handed out. `image`: a file of codec `none` that opens. The
/// same image gives the same bytes on any machine that has the same version of zstd.
Status compressAsset(std::span<const std::byte> image, const CompressOptions& options, std::vector<std::byte>& out);

/// Fewer bits for attributes that nothing else in an asset depends on, so that they compress better.
struct RoundingOptions {
    uint32_t normalBits = 16; ///< 8..16 of each octahedral coordinate
    uint32_t uvBits = 0;      ///< UVs become multiples of 2^-uvBits, 1..23; 0: as they are
};

/// Rounds the attributes of an asset of codec `none` in place and makes its checksums right.
Status roundAttributes(const RoundingOptions& options, std::vector<std::byte>& image);

} // namespace xgc::bake
