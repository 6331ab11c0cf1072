#pragma once

#include "open.h"

#include <cstring>

struct ZSTD_DCtx_s;

// The codecs of FORMAT.md, section 6. Each decoder takes what a stream stores, writes its elements, and proves no more
// than that it stays within its buffers: `openAll` judges the result.

namespace xgc::load {

/// A zstd context; makes none before the first frame.
class Inflater {
public:
    Inflater() = default;
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
    ~Inflater();
    /// Decodes one frame to exactly `out`. False where it has another size or is damaged.
    bool inflate(std::span<const std::byte> frame, std::span<std::byte> out);

private:
    ZSTD_DCtx_s* context_ = nullptr;
};

/// Bytes of `work` past what a decoder unpacks, which it may read, never believing them.
inline constexpr uint64_t kSlack = 64;

/// What decoders share. The tables of `view` have been opened, in the image; its streams hold nothing yet.
struct Decoding {
    const AssetView& view;
    Inflater& inflater;
    std::span<uint32_t> references;             ///< a row each: the row that it is coded against, itself for the first
    std::span<uint32_t> narrowSlots, wideSlots; ///< slots of the patches of one width in order of first use
    std::span<std::byte> work; ///< aligned as the slots are; holds the rows of any patch, and what a stream unpacks to
};

/// Bytes that decodeFaces unpacks into `work`.
uint64_t facesWorkBytes(const format::StreamRecord& stream, std::span<const std::byte> stored, uint64_t slotCount);

template <typename Header>
bool readHeader(std::span<const std::byte>& stored, Header& out) {
    if (stored.size() < sizeof(Header)) return false;
    std::memcpy(&out, stored.data(), sizeof out);
    stored = stored.subspan(sizeof out);
    return true;
}

inline bool isWide(const format::PatchRecord& patch) {
    return patch.flags & format::kWideSlots;
}

/// Codec::faces. Slot is uint16_t or uint32_t. Fills `slots` for Codec::parents.
template <typename Slot>
bool decodeFaces(const Decoding& d, std::span<const std::byte> stored, std::span<uint32_t> slots,
                 std::span<Slot> corners);

/// Codec::parents.
template <typename Slot>
bool decodeParents(const Decoding& d, std::span<const std::byte> stored, std::span<const uint32_t> slots,
                   std::span<Slot> parents);

/// The reference of each row, from the parents of all patches. False where one does not precede its row.
bool findReferences(const Decoding& d, std::span<const uint16_t> narrow, std::span<const uint32_t> wide);

/// Codec::rows.
bool decodeRows(const Decoding& d, const format::StreamRecord& stream, std::span<const std::byte> stored,
                std::span<std::byte> out);

} // namespace xgc::load
