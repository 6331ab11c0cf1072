#include "open_asset.h"

#include <xgc/load.h>

#include <fmt/format.h>

namespace xgc::tool {
namespace {

/// The stream records of a file whose directory was checked.
std::vector<format::StreamRecord> storedStreams(std::span<const std::byte> file) {
    const auto* header = reinterpret_cast<const format::FileHeader*>(file.data());
    const std::span sections(reinterpret_cast<const format::SectionRecord*>(header + 1), header->sectionCount);
    for (const format::SectionRecord& s : sections) {
        if (s.id != format::SectionId::streams) continue;
        const auto* first = reinterpret_cast<const format::StreamRecord*>(file.data() + s.offset);
        return {first, first + s.count};
    }
    return {};
}

} // namespace

bake::Status openAsset(const std::string& file, OpenAsset& out) {
    bake::AlignedBytes bytes;
    if (bake::Status s = bake::readFile(file, bytes); !s.ok()) return s;
    const auto refuse = [&](const Status& s) {
        return bake::badInput(fmt::format("{}: {} (element {})", file, s.message, s.element));
    };
    DecodedSize size;
    if (const Status s = decodedSize(bytes.span(), size); !s.ok()) return refuse(s);
    out.fileBytes = bytes.size;
    out.streams = storedStreams(bytes.span());
    if (bake::Status s = bake::decodeImage(std::move(bytes), out.bytes); !s.ok()) {
        s.message = fmt::format("{}: {}", file, s.message);
        return s;
    }
    const Status s = openAll(out.bytes.span(), out.view);
    return s.ok() ? bake::Status{} : refuse(s);
}

} // namespace xgc::tool
