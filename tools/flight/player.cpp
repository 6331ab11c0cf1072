#include <xgc/bake/flight.h>

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>

namespace xgc::bake {
namespace {

class Hash {
public:
    Hash() : state_(XXH64_createState()) { XXH64_reset(state_, 0); }
    ~Hash() { XXH64_freeState(state_); }
    Hash(const Hash&) = delete;
    Hash& operator=(const Hash&) = delete;

    void add(const void* bytes, size_t count) {
        if (count > 0) XXH64_update(state_, bytes, count);
    }
    template <typename T>
    void add(std::span<const T> values) {
        add(values.data(), values.size_bytes());
    }
    void add(uint32_t value) { add(&value, sizeof(value)); }
    uint64_t value() const { return XXH64_digest(state_); }

private:
    XXH64_state_t* state_;
};

Status fromRuntime(const xgc::Status& status) {
    if (status.ok()) return {};
    return systemError(fmt::format("{} ({})", status.message, status.element));
}

} // namespace

uint64_t imageHash(const AssetView& asset) {
    return XXH64(asset.bytes.data(), asset.bytes.size(), 0);
}

struct FlightPlayer::Impl {
    Scene scene;
    Selection selection;
    IndexCache cache;
    DrawList list;
    std::vector<uint32_t> instances;
    std::vector<uint32_t> staging;

    Status allocate(const Flight& flight, std::span<const AssetView* const> views);
    uint64_t hashLevels() const;
    uint64_t hashDraws() const;
    uint64_t hashCopies() const;
};

FlightPlayer::FlightPlayer() = default;
FlightPlayer::~FlightPlayer() = default;
FlightPlayer::FlightPlayer(FlightPlayer&&) noexcept = default;

Status FlightPlayer::Impl::allocate(const Flight& flight, std::span<const AssetView* const> views) {
    SceneConfig config;
    config.assetCapacity = std::max<uint32_t>(uint32_t(views.size()), 1);
    config.instanceCapacity = std::max<uint32_t>(uint32_t(flight.instances.size()), 1);
    config.assetPatchCapacity = config.patchCapacity = 0;
    DrawListConfig draws;
    IndexCacheConfig ranges;
    ranges.arenaBytes = flight.arenaBytes;
    ranges.assetCapacity = config.assetCapacity;
    uint32_t materials = 0;
    for (const AssetView* view : views) {
        config.assetPatchCapacity += view->patchCount();
        materials += view->record->materialCount;
        draws.domainCapacity = std::max(draws.domainCapacity, view->record->domainCount);
        ranges.slotCapacity = std::max(ranges.slotCapacity, scratchCapacity(*view));
        ranges.faceCapacity = std::max(ranges.faceCapacity, view->record->maxPatchFaces);
    }
    for (const Flight::Instance& instance : flight.instances)
        config.patchCapacity += views[instance.asset]->patchCount();
    ranges.rangeCapacity = std::max(ranges.rangeCapacity, 2 * config.patchCapacity);
    ranges.keyBytes = std::max(ranges.keyBytes, 64 * ranges.rangeCapacity);
    draws.scene = config;
    draws.materialCapacity = std::max(materials, 1u);
    staging.resize(flight.stagingBytes / sizeof(uint32_t));
    Status status = fromRuntime(scene.create(config));
    if (status.ok()) status = fromRuntime(selection.create(config));
    if (status.ok()) status = fromRuntime(cache.create(ranges));
    if (status.ok()) status = fromRuntime(list.create(draws));
    return status;
}

Status FlightPlayer::create(const Flight& flight, std::span<const AssetView* const> views) {
    auto impl = std::make_unique<Impl>();
    Status status = impl->allocate(flight, views);
    std::vector<uint32_t> ids(views.size());
    uint32_t materials = 0;
    for (size_t i = 0; i < views.size() && status.ok(); ++i) {
        status = fromRuntime(impl->scene.addAsset({.asset = views[i], .firstMaterial = materials}, ids[i]));
        materials += views[i]->record->materialCount;
        if (status.ok()) status = fromRuntime(impl->cache.addAsset(ids[i], *views[i]));
    }
    for (const Flight::Instance& instance : flight.instances) {
        uint32_t id = 0;
        if (!status.ok()) break;
        status =
            fromRuntime(impl->scene.addInstance(ids[instance.asset], makePlacement(glm::mat4(instance.toWorld)), id));
        impl->instances.push_back(id);
    }
    if (status.ok()) impl_ = std::move(impl);
    return status;
}

uint64_t FlightPlayer::Impl::hashLevels() const {
    Hash hash;
    for (const uint32_t id : instances) {
        const InstanceKind kind = selection.kind(id);
        hash.add(uint32_t(kind));
        if (kind == InstanceKind::whole) hash.add(selection.wholeState(id));
        if (kind != InstanceKind::mixed) continue;
        hash.add(selection.levels(id));
        hash.add(selection.visible(id));
        hash.add(selection.fractions(id));
    }
    return hash.value();
}

uint64_t FlightPlayer::Impl::hashDraws() const {
    Hash hash;
    hash.add(list.draws());
    hash.add(list.sources());
    hash.add(list.batches());
    hash.add(list.drawInstances());
    return hash.value();
}

uint64_t FlightPlayer::Impl::hashCopies() const {
    Hash hash;
    hash.add(cache.copies());
    const auto bytes = std::as_bytes(std::span(staging));
    for (const CopyRange& copy : cache.copies()) hash.add(bytes.subspan(copy.staging, copy.bytes));
    return hash.value();
}

FlightHashes FlightPlayer::play(const SelectionDesc& desc, uint64_t& triangles) {
    Impl& p = *impl_;
    p.selection.update(p.scene, desc);
    p.cache.beginFrame(std::as_writable_bytes(std::span(p.staging)));
    p.list.update(p.scene, p.selection, p.cache);
    p.cache.endFrame();
    triangles = p.list.stats().triangles;
    return {p.hashLevels(), p.hashDraws(), p.hashCopies()};
}

Status replayFlight(const Flight& flight, std::span<const AssetView* const> views, std::vector<uint32_t>& differing) {
    FlightPlayer player;
    const Status status = player.create(flight, views);
    if (!status.ok()) return status;
    differing.clear();
    for (uint32_t f = 0; f < flight.frames.size(); ++f) {
        SelectionDesc desc = flight.frames[f].desc;
        desc.bands = flight.frames[f].bands;
        uint64_t triangles = 0;
        if (player.play(desc, triangles) != flight.frames[f].hashes) differing.push_back(f);
    }
    return {};
}

} // namespace xgc::bake
