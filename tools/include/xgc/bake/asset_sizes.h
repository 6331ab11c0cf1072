#pragma once

#include <xgc/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace xgc::bake {

/// Bytes of one section or stream of an asset file.
struct SizeReport {
    const char* name = "";
    uint32_t set = 0; ///< of streams: UV, colour and joint sets count from 0
    uint64_t rawBytes = 0;
    uint64_t storedBytes = 0; ///< in the file, compressed or not
};

struct AssetSizes {
    std::vector<SizeReport> sections; ///< in the order of the file
    std::vector<SizeReport> streams;  ///< by kind and set, summed over pages
};

/// What each section and stream of a file takes. `file`: whole, as bake writes it, compressed or not; it is trusted.
AssetSizes sizesOf(std::span<const std::byte> file);

/// Names as in the JSON of the command line, e.g. "position"; "unknown" for what this version does not know.
const char* streamName(format::StreamKind kind);
const char* sectionName(format::SectionId id);

} // namespace xgc::bake
