#include "streamed_rows.h"

#include <algorithm>

namespace xgc::vulkan {
namespace {

using format::StreamFormat;
using format::StreamKind;

constexpr VkDeviceSize kLaneAlignment = 64;

/// A stream of the asset's pages; null where it has none.
const format::StreamRecord* streamOf(const AssetView& tables, StreamKind kind, uint32_t set) {
    const auto found = std::find_if(tables.streams.begin(), tables.streams.end(),
                                    [&](const format::StreamRecord& s) { return s.kind == kind && s.set == set; });
    return found == tables.streams.end() ? nullptr : &*found;
}

} // namespace

Status StreamedRows::create(const Context& context, const RendererConfig& config) {
    residency_ = config.residency;
    if (!residency_) return {};
    const ResidencyConfig& pool = residency_->config();
    if (pool.framesInFlight < config.framesInFlight) {
        return {StatusCode::badArgument, "ResidencyConfig::framesInFlight is less than the renderer's: raise it",
                config.framesInFlight};
    }
    if (residency_->stats().installs > 0)
        return {StatusCode::badArgument, "RendererConfig::residency: create the renderer before its first update", 0};
    // An update installs so many bytes, or a page.
    const uint64_t most = std::max<uint64_t>(pool.installBytes, pool.pageBytes);
    if (most > config.stagingBytes / 2) {
        return {StatusCode::outOfCapacity,
                "an update of the residency does not fit the staging memory: lower ResidencyConfig::installBytes, or "
                "raise RendererConfig::stagingBytes",
                2 * most};
    }
    lanes_ = {{StreamKind::position, 0, StreamFormat::f32x3, 12}, {StreamKind::normal, 0, StreamFormat::snorm16x2, 4}};
    if (config.streamedColors) lanes_.push_back({StreamKind::color, 0, StreamFormat::unorm8x4, 4});
    for (uint32_t set = 0; set < std::min(config.streamedJointSets, 2u); ++set) {
        lanes_.push_back({StreamKind::joints, set, StreamFormat::u16x4, 8});
        lanes_.push_back({StreamKind::weights, set, StreamFormat::f32x4, 16});
    }
    const uint64_t rowCount = uint64_t(residency_->stats().slots) * pool.pageRows;
    VkDeviceSize bytes = 0;
    for (Lane& lane : lanes_) {
        lane.offset = bytes;
        bytes += (rowCount * lane.stride + kLaneAlignment - 1) / kLaneAlignment * kLaneAlignment;
    }
    // Each page that comes has a row at least.
    copies_.reserve(lanes_.size() * std::min<uint64_t>(residency_->stats().slots, most / 12 + 1));
    return rows_.create(context, bytes,
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                            VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                        Residence::device);
}

const StreamedRows::Lane* StreamedRows::find(StreamKind kind, uint32_t set) const {
    const auto lane =
        std::find_if(lanes_.begin(), lanes_.end(), [&](const Lane& l) { return l.kind == kind && l.set == set; });
    return lane == lanes_.end() ? nullptr : &*lane;
}

Status StreamedRows::check(const AssetView& tables) const {
    const format::StreamRecord* positions = streamOf(tables, StreamKind::position, 0);
    if (!positions || positions->format != StreamFormat::f32x3 || positions->stride != 12)
        return {StatusCode::unsupported, "the backend draws float3 positions without gaps: bake them so", 0};
    const bool skinned = !tables.joints.empty();
    const auto lacks = [&](StreamKind kind, uint32_t set) {
        const format::StreamRecord* s = streamOf(tables, kind, set);
        const Lane* lane = find(kind, set);
        return s && !(lane && lane->format == s->format && lane->stride == s->stride);
    };
    if (lacks(StreamKind::color, 0)) {
        return {StatusCode::unsupported,
                "a streamed asset with colours: RendererConfig::streamedColors, and bake them as unorm8x4", 0};
    }
    for (uint32_t set = 0; skinned && set < 2; ++set) {
        if (!lacks(StreamKind::joints, set) && !lacks(StreamKind::weights, set)) continue;
        return {StatusCode::unsupported, "a streamed asset with joints: raise RendererConfig::streamedJointSets",
                set + 1};
    }
    return {};
}

void StreamedRows::update(StagingRing& staging) {
    copies_.clear();
    bytes_ = 0;
    if (!residency_) return;
    residency_->update();
    for (const InstalledPage& page : residency_->installed()) {
        for (const Lane& lane : lanes_) {
            const std::span<const std::byte> stream = residency_->rows(page.asset, page.page, lane.kind, lane.set);
            if (stream.size() != size_t(page.rowCount) * lane.stride || stream.empty()) continue; // no shader reads it
            VkBufferCopy copy{0, lane.offset + VkDeviceSize(page.firstRow) * lane.stride, stream.size()};
            const std::span<std::byte> room = staging.take(stream.size(), copy.srcOffset);
            std::copy_n(stream.data(), stream.size(), room.data());
            copies_.push_back(copy);
            bytes_ += stream.size();
        }
    }
}

VkDeviceAddress StreamedRows::address(const AssetView& tables, StreamKind kind, uint32_t set) const {
    const Lane* lane = find(kind, set);
    const format::StreamRecord* stream = streamOf(tables, kind, set);
    const bool has = lane && stream && stream->format == lane->format && stream->stride == lane->stride;
    return has ? rows_.address() + lane->offset : 0;
}

} // namespace xgc::vulkan
