#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace xgc {

/// XXH64 (Yann Collet) with seed 0, the checksum of sections and pages.
uint64_t xxh64(std::span<const std::byte> bytes);

/// XXH64 of two runs as if they were one. `head` holds a multiple of 32 bytes.
uint64_t xxh64(std::span<const std::byte> head, std::span<const std::byte> tail);

} // namespace xgc
