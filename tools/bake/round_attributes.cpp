#include "bake/layout.h"
#include "bake/octahedral.h"

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/compress.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace xgc::bake {
namespace {

using namespace format;

void roundNormals(uint32_t bits, std::span<std::byte> bytes) {
    for (size_t at = 0; at < bytes.size(); at += sizeof(glm::i16vec2)) {
        glm::i16vec2 code;
        std::memcpy(&code, bytes.data() + at, sizeof code);
        code = octahedralEncode(octahedralDecode(code), bits);
        std::memcpy(bytes.data() + at, &code, sizeof code);
    }
}

void roundUvs(uint32_t bits, std::span<std::byte> bytes) {
    const double cells = double(1u << bits);
    for (size_t at = 0; at < bytes.size(); at += sizeof(float)) {
        float value = 0;
        std::memcpy(&value, bytes.data() + at, sizeof value);
        value = float(std::floor(double(value) * cells + 0.5) / cells) + 0.0f; // no -0
        std::memcpy(bytes.data() + at, &value, sizeof value);
    }
}

template <typename T>
void put(std::span<std::byte> image, uint64_t offset, const T& value) {
    std::memcpy(image.data() + offset, &value, sizeof value);
}

/// Of the page, of the section that holds its record, and of the header.
void makeChecksumsRight(const AssetView& asset, std::span<std::byte> image) {
    PageRecord page = asset.pages[0];
    page.checksum = layout::hash(image.subspan(page.offset, page.storedBytes));
    const auto pageAt = uint64_t(reinterpret_cast<const std::byte*>(asset.pages.data()) - asset.bytes.data());
    put(image, pageAt, page);
    FileHeader header;
    std::memcpy(&header, image.data(), sizeof header);
    for (uint32_t i = 0; i < header.sectionCount; ++i) {
        const uint64_t at = sizeof header + i * sizeof(SectionRecord);
        SectionRecord section;
        std::memcpy(&section, image.data() + at, sizeof section);
        section.checksum = layout::hash(image.subspan(section.offset, section.storedBytes));
        put(image, at, section);
    }
    header.headerChecksum = 0;
    put(image, 0, header);
    header.headerChecksum = layout::hash(image.first(sizeof header + header.sectionCount * sizeof(SectionRecord)));
    put(image, 0, header);
}

} // namespace

Status roundAttributes(const RoundingOptions& options, std::vector<std::byte>& image) {
    if (options.normalBits < 8 || options.normalBits > 16)
        return usageError(fmt::format("normals of {} bits: expected 8 to 16", options.normalBits));
    if (options.uvBits > 23) return usageError(fmt::format("UVs of {} bits: expected 1 to 23", options.uvBits));
    const AlignedBytes copy = alignedCopy(image);
    AssetView asset;
    if (const xgc::Status s = openAll(copy.span(), asset); !s.ok())
        return badInput(fmt::format("round: {} (element {})", s.message, s.element));
    for (const StreamRecord& s : asset.streams) {
        const std::span<std::byte> bytes = std::span(image).subspan(asset.pages[0].offset + s.offset, s.storedBytes);
        if (s.kind == StreamKind::normal && options.normalBits < 16) roundNormals(options.normalBits, bytes);
        if (s.kind == StreamKind::uv && options.uvBits > 0) roundUvs(options.uvBits, bytes);
    }
    makeChecksumsRight(asset, image);
    return {};
}

} // namespace xgc::bake
