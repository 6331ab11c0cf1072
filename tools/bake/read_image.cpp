#include <xgc/bake/asset_writer.h>
#include <xgc/load.h>

#include <fmt/format.h>

#include <cstring>

namespace xgc::bake {
namespace {

Status asStatus(const xgc::Status& s) {
    return badInput(fmt::format("{} (element {})", s.message, s.element));
}

} // namespace

AlignedBytes alignedBytes(size_t size) {
    AlignedBytes bytes;
    bytes.blocks.resize((size + sizeof(AlignedBytes::Block) - 1) / sizeof(AlignedBytes::Block));
    bytes.size = size;
    return bytes;
}

AlignedBytes alignedCopy(std::span<const std::byte> bytes) {
    AlignedBytes copy = alignedBytes(bytes.size());
    if (!bytes.empty()) std::memcpy(copy.blocks.data(), bytes.data(), bytes.size());
    return copy;
}

Status decodeImage(AlignedBytes&& file, AlignedBytes& out) {
    DecodedSize size;
    if (const xgc::Status s = decodedSize(file.span(), size); !s.ok()) return asStatus(s);
    if (!size.isCompressed) {
        out = std::move(file);
        return {};
    }
    AlignedBytes image = alignedBytes(size.imageBytes);
    AlignedBytes scratch = alignedBytes(size.scratchBytes);
    if (const xgc::Status s = decode(file.span(), scratch.writable(), image.writable()); !s.ok()) return asStatus(s);
    out = std::move(image);
    return {};
}

Status readImage(const std::filesystem::path& file, AlignedBytes& out) {
    AlignedBytes bytes;
    if (Status s = readFile(file, bytes); !s.ok()) return s;
    Status s = decodeImage(std::move(bytes), out);
    if (!s.ok()) s.message = fmt::format("{}: {}", file.string(), s.message);
    return s;
}

} // namespace xgc::bake
