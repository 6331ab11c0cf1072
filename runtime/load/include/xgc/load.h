#pragma once

#include <xgc/asset.h>

/// Decodes compressed `.xgc` files (`xgc bake --compress`) and joins those that are cut into pages (`--tiers`): a file
/// becomes the image that `openAll` opens. Other files need none of this: they are opened, or mapped, where they lie.
///
///     xgc::DecodedSize size;
///     if (xgc::Status s = xgc::decodedSize(file, size); !s.ok()) return fail(s.message, s.element);
///     ... size.imageBytes, aligned to 64, and size.scratchBytes, from an allocator of yours ...
///     if (xgc::Status s = xgc::decode(file, scratch, image); !s.ok()) return fail(s.message, s.element);
///     if (xgc::Status s = xgc::openAll(image, asset); !s.ok()) return fail(s.message, s.element);
///
/// No exceptions, no globals: any number of threads may decode at once, each into buffers of its own. `decode`
/// allocates one zstd context (about 160 KB, by malloc) and nothing else.
namespace xgc {

struct DecodedSize {
    uint64_t imageBytes = 0;   ///< of the decoded file
    uint64_t scratchBytes = 0; ///< that `decode` needs beside it; free to go afterwards
    bool isCompressed = false; ///< or cut into pages; false: `openAll` takes the file as it is
};

/// How large the buffers for `decode` must be. `file` holds a whole file, aligned to format::kAlignment; compressed or
/// not. The header and tables are checked, the page is not. A hostile file of a few hundred bytes can ask for up to a
/// TiB: refuse what is more than you would load. On failure `out` is untouched.
Status decodedSize(std::span<const std::byte> file, DecodedSize& out);

/// Decodes a file into `image`, of imageBytes or more and aligned to format::kAlignment: a file of codec `none`, bit
/// for bit what was compressed, save for what the writer rounded. `scratch` is aligned to 4 at least. Whatever the
/// bytes of the file are, nothing outside the two buffers is written; what is decoded is checked by `openAll`, as for
/// any file. On failure both buffers hold bytes of no meaning.
Status decode(std::span<const std::byte> file, std::span<std::byte> scratch, std::span<std::byte> image);

/// Decodes one page of a file that is cut into pages, as a Residency's reader must where the file is compressed; copies
/// what is not. `stored`: the page's storedBytes, whose checksum is tested; `out`: its rawBytes, aligned to 64.
/// Allocates as `decode`.
Status decodePage(const AssetView& tables, uint32_t page, std::span<const std::byte> stored, std::span<std::byte> out);

} // namespace xgc
