#include "asset_store.h"

#include "part_colors.h"

#include <utility>

namespace xgc::vulkan {
namespace {

/// Units of kAlignment that a stream takes.
uint64_t unitsOf(std::span<const std::byte> stream) {
    return (stream.size() + AssetStore::kAlignment - 1) / AssetStore::kAlignment;
}

std::span<const VertexStream> streamsOf(const AssetView& view) {
    return {view.vertexStreams.data(), view.vertexStreamCount};
}

/// What shaders read: anything else is stored for the host's own passes, or refused.
Status checkStreams(const AssetView& view) {
    if (view.residence)
        return {StatusCode::badArgument, "addAsset: the asset is streamed: see Renderer::addStreamedAsset", 0};
    bool hasPositions = false;
    for (const VertexStream& s : streamsOf(view)) {
        if (s.kind != format::StreamKind::position) continue;
        hasPositions = s.format == format::StreamFormat::f32x3 && s.stride == 12;
    }
    if (hasPositions) return {};
    return {StatusCode::unsupported, "the backend draws float3 positions without gaps: bake them so", 0};
}

bool drawableColor(const VertexStream& s) {
    return (s.format == format::StreamFormat::unorm8x4 && s.stride == 4) ||
           (s.format == format::StreamFormat::f32x4 && s.stride == 16);
}

/// What targets add, row by row: beside the streams.
std::array<std::span<const std::byte>, 2> targetsOf(const AssetView& view) {
    return {std::as_bytes(view.morphRows), std::as_bytes(view.morphDeltas)};
}

void noteAddress(StoredAsset& asset, const VertexStream& stream, VkDeviceAddress address) {
    // Of an asset without a skin no shader follows them.
    const bool skinned = !asset.view.joints.empty() && stream.set < 2;
    if (skinned && stream.kind == format::StreamKind::joints) asset.joints[stream.set] = address;
    if (skinned && stream.kind == format::StreamKind::weights) asset.weights[stream.set] = address;
    if (stream.set != 0) return;
    switch (stream.kind) {
    case format::StreamKind::position:
        asset.positions = address;
        break;
    case format::StreamKind::normal:
        if (stream.format == format::StreamFormat::snorm16x2 && stream.stride == 4) asset.normals = address;
        break;
    case format::StreamKind::color:
        if (drawableColor(stream)) asset.colors = address;
        asset.colorFormat = stream.format;
        break;
    default:
        break;
    }
}

} // namespace

static_assert(shader::kMorphRows == kMorphRows);

Status AssetStore::create(const Context& context, const RendererConfig& config) {
    const VkDeviceSize units = std::max<VkDeviceSize>(config.vertexArenaBytes / kAlignment, 1);
    Status status = arena_.create(context, units * kAlignment,
                                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                      VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                                  Residence::device);
    if (!status.ok()) return status;
    status = materials_.create(context, config.materialCapacity * sizeof(shader::MaterialRecord),
                               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                               Residence::upload);
    if (!status.ok()) return status;
    arenaRanges_.create(units);
    materialRanges_.create(config.materialCapacity);
    kinds_.resize(config.materialCapacity);
    uploads_.create(config.assetCapacity);
    morphs_ = config.morphGroupCapacity > 0;
    assets_.resize(config.assetCapacity);
    return {};
}

uint64_t AssetStore::bytesOf(const AssetView& view, bool morphs) {
    uint64_t units = 0;
    for (const VertexStream& stream : streamsOf(view)) units += unitsOf(stream.bytes);
    for (const std::span<const std::byte> bytes : targetsOf(view)) units += unitsOf(bytes);
    if (morphs) units += (view.record->vertexCount * sizeof(MorphRow) + kAlignment - 1) / kAlignment;
    return units * kAlignment;
}

Status AssetStore::place(StoredAsset& asset) {
    const AssetView& view = asset.view;
    const uint64_t units = view.residence ? 0 : bytesOf(view, morphs_) / kAlignment;
    if (units > 0 && !arenaRanges_.allocate(units, asset.bytes)) {
        return {StatusCode::outOfCapacity, "the vertex arena is full: raise RendererConfig::vertexArenaBytes",
                units * kAlignment};
    }
    if (!materialRanges_.allocate(view.materials.size(), asset.materials)) {
        arenaRanges_.free(asset.bytes);
        return {StatusCode::outOfCapacity, "too many materials: raise RendererConfig::materialCapacity",
                view.materials.size()};
    }
    return {};
}

void AssetStore::queueStreams(StoredAsset& asset, uint32_t index) {
    VkDeviceSize offset = asset.bytes.first * kAlignment;
    for (const VertexStream& stream : streamsOf(asset.view)) {
        uploads_.add({index, stream.bytes, offset});
        noteAddress(asset, stream, arena_.address() + offset);
        offset += unitsOf(stream.bytes) * kAlignment;
    }
    if (!asset.view.morphTargets.empty()) {
        VkDeviceAddress* addresses[] = {&asset.targetRows, &asset.targetDeltas};
        for (int i = 0; i < 2; ++i) {
            const std::span<const std::byte> bytes = targetsOf(asset.view)[size_t(i)];
            if (bytes.empty()) continue; // no row has a displacement
            uploads_.add({index, bytes, offset});
            *addresses[i] = arena_.address() + offset;
            offset += unitsOf(bytes) * kAlignment;
        }
    }
    if (asset.morphRows.empty()) return;
    asset.morphs = arena_.address() + offset;
    uploads_.add({index, std::as_bytes(std::span(asset.morphRows)), offset});
}

void AssetStore::writeMaterials(const StoredAsset& asset) {
    auto* out = reinterpret_cast<shader::MaterialRecord*>(materials_.mapped().data()) + asset.materials.first;
    for (uint32_t i = 0; i < asset.view.materials.size(); ++i) {
        const format::MaterialRecord& m = asset.view.materials[i];
        kinds_[asset.materials.first + i] = {(m.flags & format::kAlphaMask) != 0,
                                             !asset.view.joints.empty() || !asset.view.morphTargets.empty()};
        shader::MaterialRecord record{};
        record.baseColor = {m.baseColor[0], m.baseColor[1], m.baseColor[2], m.baseColor[3]};
        record.emissive = {m.emissive[0], m.emissive[1], m.emissive[2], 0};
        record.metallic = m.metallic;
        record.roughness = m.roughness;
        record.flags = m.flags;
        const bool masked = kinds_[asset.materials.first + i].masked;
        record.alphaCutoff = masked ? asset.view.alphaCutoff(i) : 0; // nothing of an opaque one is below
        *out++ = record;
    }
}

Status AssetStore::enter(StoredAsset&& asset, AssetHandle& handle) {
    const auto slot = std::find_if(assets_.begin(), assets_.end(), [](const StoredAsset& a) { return !a.alive(); });
    if (slot == assets_.end()) {
        return {StatusCode::outOfCapacity, "too many assets: raise RendererConfig::assetCapacity", assets_.size() + 1};
    }
    asset.generation = slot->generation + 1;
    const Status status = place(asset);
    if (!status.ok()) return status;
    const auto index = uint32_t(slot - assets_.begin());
    if (!asset.view.residence) queueStreams(asset, index);
    writeMaterials(asset);
    asset.partColors = colorParts(asset.view, shader::kPartColorCount);
    *slot = std::move(asset);
    handle = {index, slot->generation};
    return {};
}

Status AssetStore::add(const AssetView& view, AssetHandle& handle) {
    const Status usable = checkStreams(view);
    if (!usable.ok()) return usable;
    StoredAsset asset;
    asset.view = view;
    if (morphs_) {
        asset.morphRows.resize(view.record->vertexCount);
        const Status listed = morphRows(view, asset.morphRows);
        if (!listed.ok()) return listed;
    }
    return enter(std::move(asset), handle);
}

Status AssetStore::addStreamed(const AssetView& view, uint32_t residencyAsset, const StreamedRows& rows,
                               AssetHandle& handle) {
    const Status usable = rows.check(view);
    if (!usable.ok()) return usable;
    StoredAsset asset;
    asset.view = view;
    asset.streamed = residencyAsset;
    asset.positions = rows.address(view, format::StreamKind::position, 0);
    asset.normals = rows.address(view, format::StreamKind::normal, 0);
    asset.colors = rows.address(view, format::StreamKind::color, 0);
    asset.colorFormat = format::StreamFormat::unorm8x4;
    for (uint32_t set = 0; !view.joints.empty() && set < 2; ++set) {
        asset.joints[set] = rows.address(view, format::StreamKind::joints, set);
        asset.weights[set] = rows.address(view, format::StreamKind::weights, set);
    }
    return enter(std::move(asset), handle);
}

Status AssetStore::remove(AssetHandle handle, uint64_t frame) {
    StoredAsset* asset = find(handle);
    if (!asset) return {StatusCode::badArgument, "removeAsset: no such asset", handle.index};
    if (asset->instanceCount > 0) {
        return {StatusCode::badArgument, "removeAsset: remove its instances first", asset->instanceCount};
    }
    uploads_.cancel(handle.index);
    retired_.push_back({frame, asset->bytes, asset->materials});
    const uint32_t generation = asset->generation + 1;
    *asset = {};
    asset->generation = generation;
    return {};
}

void AssetStore::reclaim(uint64_t frame, uint32_t framesInFlight) {
    auto at = retired_.begin();
    for (; at != retired_.end() && at->frame + framesInFlight <= frame; ++at) {
        arenaRanges_.free(at->bytes);
        materialRanges_.free(at->materials);
    }
    retired_.erase(retired_.begin(), at);
}

const StoredAsset* AssetStore::find(AssetHandle handle) const {
    if (handle.index >= assets_.size()) return nullptr;
    const StoredAsset& asset = assets_[handle.index];
    return asset.alive() && asset.generation == handle.generation ? &asset : nullptr;
}

} // namespace xgc::vulkan
