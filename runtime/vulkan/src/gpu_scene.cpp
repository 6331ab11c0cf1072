#include "gpu_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <numeric>

namespace xgc::vulkan {
namespace {

constexpr VkDeviceSize kAlignment = 64;

VkDeviceSize aligned(VkDeviceSize bytes) {
    return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

/// Lays tables one behind the other: first to learn their size, then to write them.
class Tables {
public:
    Tables() = default;
    Tables(std::byte* to, VkDeviceAddress address) : to_(to), address_(address) {}

    template <typename T>
    shader::Address put(std::span<const T> table) {
        const VkDeviceSize at = bytes_;
        if (to_ && !table.empty()) std::memcpy(to_ + at, table.data(), table.size_bytes());
        bytes_ += aligned(table.size_bytes());
        return address_ + at;
    }
    VkDeviceSize bytes() const { return bytes_; }

private:
    std::byte* to_ = nullptr;
    VkDeviceAddress address_ = 0;
    VkDeviceSize bytes_ = 0;
};

/// What is made for the shaders, beside what the file has.
struct MadeTables {
    std::vector<shader::GpuPatch> patches;
    std::vector<shader::GpuDomain> domains;
    std::vector<float> wholeErrors;
    std::vector<uint8_t> wholeLevels;
    std::vector<uint32_t> wholeFinest;
    std::vector<uint32_t> order;
};

shader::GpuPatch patchRecord(const AssetView& asset, uint32_t patch, const PatchBounds& bounds, uint32_t firstMaterial,
                             std::span<const uint8_t> partColors) {
    const format::PatchRecord& from = asset.patches[patch];
    const format::VertexRange interior = asset.interiorRange(patch);
    shader::GpuPatch out{};
    out.sphere = bounds.sphere;
    out.cone = glm::vec4(bounds.coneAxis, bounds.coneSine);
    out.importance = bounds.importance;
    out.coneLevel = bounds.coneLevel;
    out.part = bounds.part;
    out.material = firstMaterial + from.material;
    out.firstDomain = from.firstDomain;
    out.domainCount = from.domainCount;
    out.firstCorner = from.firstCorner;
    out.firstParent = from.firstParent;
    out.slotCount = from.slotCount;
    out.firstRow = interior.first;
    out.rowCount = interior.count;
    out.wide = from.flags & format::kWideSlots;
    out.partColor = partColors[from.part];
    return out;
}

void makeStates(const Scene& scene, uint32_t id, MadeTables& out) {
    const uint32_t patchCount = scene.asset(id).asset->patchCount();
    std::vector<uint8_t> levels(patchCount);
    for (uint32_t state = 0; state < scene.wholeStateCount(id); ++state) {
        scene.wholeLevels(id, state, levels);
        out.wholeErrors.push_back(scene.wholeError(id, state));
        out.wholeLevels.insert(out.wholeLevels.end(), levels.begin(), levels.end());
        out.wholeFinest.push_back(levels.empty() ? 0 : *std::min_element(levels.begin(), levels.end()));
    }
}

MadeTables makeTables(const Scene& scene, uint32_t id, std::span<const uint8_t> partColors) {
    const AssetDesc& desc = scene.asset(id);
    const AssetView& asset = *desc.asset;
    MadeTables out;
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        out.patches.push_back(patchRecord(asset, p, scene.patchBounds(id)[p], desc.firstMaterial, partColors));
    }
    for (uint32_t d = 0; d < asset.record->domainCount; ++d) {
        const format::VertexRange rows = asset.domainRange(d);
        out.domains.push_back({rows.first, rows.count, asset.domains[d].firstPatch, asset.domains[d].patchCount});
    }
    makeStates(scene, id, out);
    return out;
}

/// Writes all tables of an asset, or only sums their sizes.
shader::GpuAsset layOut(const AssetView& asset, const MadeTables& made, Tables& tables) {
    shader::GpuAsset out{};
    out.sphere = {asset.record->sphereCenter[0], asset.record->sphereCenter[1], asset.record->sphereCenter[2],
                  asset.record->sphereRadius};
    out.patches = tables.put(std::span(std::as_const(made.patches)));
    out.domains = tables.put(std::span(std::as_const(made.domains)));
    out.domainPatches = tables.put(asset.domainPatches);
    out.patchDomains = tables.put(asset.patchDomains);
    out.patchSlots = tables.put(asset.patchSlots);
    out.errors = tables.put(asset.patchErrors);
    out.lists = tables.put(asset.faceLists);
    out.collapseLevels = tables.put(asset.collapseLevels);
    out.parentsNarrow = tables.put(asset.parentsNarrow);
    out.parentsWide = tables.put(asset.parentsWide);
    out.cornersNarrow = tables.put(asset.cornersNarrow);
    out.cornersWide = tables.put(asset.cornersWide);
    out.wholeErrors = tables.put(std::span(std::as_const(made.wholeErrors)));
    out.wholeLevels = tables.put(std::span(std::as_const(made.wholeLevels)));
    out.wholeFinest = tables.put(std::span(std::as_const(made.wholeFinest)));
    out.order = tables.put(std::span(std::as_const(made.order)));
    out.skinErrors = tables.put(asset.skinErrors);
    out.morphErrors = tables.put(asset.morphErrors);
    out.patchCount = asset.patchCount();
    out.levelCount = asset.levelCount();
    out.listCount = asset.record->listCount;
    out.stateCount = uint32_t(made.wholeErrors.size());
    return out;
}

void setRows(glm::vec4 (&rows)[3], const glm::mat4x3& m) {
    for (int row = 0; row < 3; ++row) rows[row] = {m[0][row], m[1][row], m[2][row], m[3][row]};
}

shader::GpuControl controlRecord(const PartControl& control) {
    const auto level = [](uint32_t l) { return std::min<uint32_t>(l, shader::kNoLevel); };
    shader::GpuControl out{};
    out.importance = control.importance;
    out.bias = std::clamp(control.bias, -int32_t(shader::kNoLevel), int32_t(shader::kNoLevel));
    out.finest = level(control.finest);
    out.coarsest = level(control.coarsest);
    out.hidden = control.hidden;
    return out;
}

} // namespace

static_assert(sizeof(format::FaceList) == 2 * sizeof(uint32_t));
static_assert(sizeof(PosedPatch) == sizeof(shader::GpuPosedPatch) &&
              offsetof(PosedPatch, added) == offsetof(shader::GpuPosedPatch, added));
static_assert(shader::kNone == format::kNone && shader::kNoLevel == format::kNever);

Status GpuScene::create(const Context& context, const RendererConfig& config) {
    assetCapacity_ = config.assetCapacity;
    framesInFlight_ = config.framesInFlight;
    runCapacity_ = config.gpu.runCapacity;
    const VkDeviceSize units = std::max<VkDeviceSize>(config.gpu.tableBytes / kAlignment, 1);
    constexpr VkBufferUsageFlags kUsage =
        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    Status status = tables_.create(context, units * kAlignment, kUsage, Residence::upload);
    if (!status.ok()) return status;
    tableRanges_.create(units);
    instancesAt_ = aligned(config.assetCapacity * sizeof(shader::GpuAsset));
    controlsAt_ = instancesAt_ + aligned(config.instanceCapacity * sizeof(shader::GpuInstance));
    runsAt_ = controlsAt_ + aligned(config.steeredPartCapacity * sizeof(shader::GpuControl));
    posedAt_ = runsAt_ + aligned(runCapacity_ * sizeof(shader::GpuRun));
    weightsAt_ = posedAt_ + aligned(config.patchCapacity * sizeof(shader::GpuPosedPatch));
    bytesPerFrame_ = weightsAt_ + aligned(config.morphWeightCapacity * sizeof(float));
    status = frames_.create(context, bytesPerFrame_ * framesInFlight_, kUsage, Residence::upload);
    assets_.resize(assetCapacity_);
    instances_.resize(config.instanceCapacity);
    runs_.reserve(runCapacity_);
    writtenRuns_.assign(framesInFlight_, 0);
    return status;
}

// Assets ------------------------------------------------------------------------------------------------------------

/// Patches by material, and where each material's begin.
void GpuScene::orderPatches(const Scene& scene, uint32_t id, std::vector<uint32_t>& order) {
    const AssetDesc& desc = scene.asset(id);
    const auto patches = desc.asset->patches;
    order.resize(patches.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return patches[a].material < patches[b].material; });
    const bool posable = !desc.asset->joints.empty() || !desc.asset->morphTargets.empty(); // as AssetStore::kindOf
    std::vector<Group>& groups = assets_[id].groups;
    groups.clear();
    for (uint32_t i = 0; i < order.size(); ++i) {
        const uint32_t material = patches[order[i]].material;
        const bool masked = (desc.asset->materials[material].flags & format::kAlphaMask) != 0;
        const uint32_t kind = (masked ? shader::kDrawMasked : 0) | (posable ? shader::kDrawPosable : 0);
        const uint32_t rank = (kind << kKindBit) + desc.firstMaterial + material;
        if (groups.empty() || groups.back().rank != rank) groups.push_back({rank, i, 0});
        ++groups.back().count;
    }
}

Status GpuScene::addAsset(const Scene& scene, uint32_t id, std::span<const uint8_t> partColors) {
    const AssetView& asset = *scene.asset(id).asset;
    if (asset.residence) return {StatusCode::unsupported, "the compute path draws no streamed assets", 0};
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        if (asset.patches[p].domainCount <= shader::kMaxPatchDomains) continue;
        return {StatusCode::unsupported, "the compute path draws no patch of more than 1024 domains", p};
    }
    MadeTables made = makeTables(scene, id, partColors);
    orderPatches(scene, id, made.order);
    Asset& stored = assets_[id];
    if (runsNeeded_ + runsOf(stored, uint32_t(made.wholeErrors.size())) > runCapacity_) {
        return {StatusCode::outOfCapacity, "too many runs: raise GpuPathConfig::runCapacity",
                runsNeeded_ + runsOf(stored, uint32_t(made.wholeErrors.size()))};
    }
    Tables sizes;
    layOut(asset, made, sizes);
    if (!tableRanges_.allocate(sizes.bytes() / kAlignment, stored.bytes)) {
        return {StatusCode::outOfCapacity, "the tables are full: raise GpuPathConfig::tableBytes", sizes.bytes()};
    }
    const VkDeviceSize at = stored.bytes.first * kAlignment;
    Tables tables(tables_.mapped().data() + at, tables_.address() + at);
    stored.record = layOut(asset, made, tables);
    runsNeeded_ += runsOf(stored, stored.record.stateCount);
    assetEnd_ = std::max(assetEnd_, id + 1);
    runsStale_ = true;
    return {};
}

void GpuScene::removeAsset(uint32_t id, uint64_t frame) {
    Asset& stored = assets_[id];
    assert(stored.instances == 0);
    runsNeeded_ -= runsOf(stored, stored.record.stateCount);
    retired_.push_back({frame, stored.bytes});
    stored = {};
    runsStale_ = true;
}

// Instances ---------------------------------------------------------------------------------------------------------

Status GpuScene::addInstance(const Scene& scene, uint32_t id, uint32_t generation) {
    Asset& asset = assets_[scene.assetOf(id)];
    if (runsNeeded_ + runsOf(asset, 1) > runCapacity_) {
        return {StatusCode::outOfCapacity, "too many runs: raise GpuPathConfig::runCapacity",
                runsNeeded_ + runsOf(asset, 1)};
    }
    runsNeeded_ += runsOf(asset, 1);
    ++asset.instances;
    runsStale_ = true;
    instanceEnd_ = std::max(instanceEnd_, id + 1);
    instances_[id] = {};
    instances_[id].flags = shader::kInstancePresent;
    instances_[id].generation = generation;
    instances_[id].asset = scene.assetOf(id);
    instances_[id].firstSlot = scene.firstSlot(id);
    setPlacement(id, scene.placement(id));
    return {};
}

void GpuScene::setPlacement(uint32_t id, const Placement& placement) {
    shader::GpuInstance& out = instances_[id];
    setRows(out.toWorld, placement.toWorld);
    out.maxScale = placement.maxScale;
    out.flags &= ~shader::kInstanceInvertible;
    glm::mat3 toMesh;
    if (!inverseOf(placement, toMesh)) return;
    setRows(out.toMesh, glm::mat4x3(toMesh[0], toMesh[1], toMesh[2], glm::vec3(0)));
    out.flags |= shader::kInstanceInvertible;
}

void GpuScene::removeInstance(const Scene& scene, uint32_t id) {
    Asset& asset = assets_[scene.assetOf(id)];
    runsNeeded_ -= runsOf(asset, 1);
    --asset.instances;
    runsStale_ = true;
    instances_[id].flags = 0;
}

/// By kind and material, then states before instances, by id: the order of the draws.
void GpuScene::listRuns(const Scene& scene) {
    runs_.clear();
    const auto add = [&](uint32_t subject, uint32_t asset) {
        for (const Group& g : assets_[asset].groups) runs_.push_back({g.rank, {subject, asset, g.first, g.count}});
    };
    for (uint32_t asset = 0; asset < assetEnd_; ++asset) {
        if (assets_[asset].instances == 0) continue;
        for (uint32_t s = 0; s < assets_[asset].record.stateCount; ++s) add(asset * shader::kWholeStates + s, asset);
    }
    for (uint32_t id = 0; id < instanceEnd_; ++id) {
        if (instances_[id].flags & shader::kInstancePresent) add(stateCapacity() + id, scene.assetOf(id));
    }
    std::sort(runs_.begin(), runs_.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : a.second.subject < b.second.subject;
    });
    for (uint32_t kind = 1; kind < shader::kDrawKinds; ++kind) {
        const auto first =
            std::find_if(runs_.begin(), runs_.end(), [&](const auto& run) { return run.first >= kind << kKindBit; });
        kindRuns_[kind - 1] = uint32_t(first - runs_.begin());
    }
    ++runsVersion_;
    runsStale_ = false;
}

// A frame -----------------------------------------------------------------------------------------------------------

/// What the scene says of the instance's pose, into the frame's part.
void GpuScene::writePose(const Scene& scene, uint32_t id, std::byte* to, uint32_t& weightCount) {
    shader::GpuInstance& instance = instances_[id];
    const std::span<const PosedPatch> patches = scene.posedPatches(id);
    instance.flags &= ~shader::kInstancePosed;
    if (patches.empty()) return;
    instance.flags |= shader::kInstancePosed;
    instance.posedSphere = scene.posedSphere(id);
    std::memcpy(to + posedAt_ + instance.firstSlot * sizeof(shader::GpuPosedPatch), patches.data(),
                patches.size_bytes());
    const std::span<const float> weights = scene.posedWeights(id);
    instance.firstWeight = weightCount;
    instance.weightCount = uint32_t(weights.size());
    auto* magnitudes = reinterpret_cast<float*>(to + weightsAt_);
    for (const float weight : weights) magnitudes[weightCount++] = std::fabs(weight);
}

void GpuScene::write(const Scene& scene, uint64_t frame) {
    auto done = retired_.begin();
    for (; done != retired_.end() && done->frame + framesInFlight_ <= frame; ++done) tableRanges_.free(done->bytes);
    retired_.erase(retired_.begin(), done);

    const auto part = uint32_t(frame % framesInFlight_);
    begin_ = part * bytesPerFrame_;
    std::byte* to = frames_.mapped().data() + begin_;
    auto* assets = reinterpret_cast<shader::GpuAsset*>(to);
    for (uint32_t id = 0; id < assetEnd_; ++id) assets[id] = assets_[id].record;
    auto* controls = reinterpret_cast<shader::GpuControl*>(to + controlsAt_);
    uint32_t controlCount = 0, weightCount = 0;
    for (uint32_t id = 0; id < instanceEnd_; ++id) {
        shader::GpuInstance& instance = instances_[id];
        if ((instance.flags & shader::kInstancePresent) == 0) continue;
        instance.flags &= ~shader::kInstanceVisible;
        if (scene.visible(id)) instance.flags |= shader::kInstanceVisible;
        writePose(scene, id, to, weightCount);
        instance.firstControl = shader::kNone;
        if (!scene.steered(id)) continue;
        instance.firstControl = controlCount;
        const auto partCount = uint32_t(scene.asset(instance.asset).asset->parts.size());
        for (uint32_t p = 0; p < partCount; ++p) controls[controlCount++] = controlRecord(scene.part(id, p));
    }
    std::memcpy(to + instancesAt_, instances_.data(), instanceEnd_ * sizeof(shader::GpuInstance));
    if (runsStale_) listRuns(scene);
    if (std::exchange(writtenRuns_[part], runsVersion_) == runsVersion_) return;
    auto* runs = reinterpret_cast<shader::GpuRun*>(to + runsAt_);
    for (size_t i = 0; i < runs_.size(); ++i) runs[i] = runs_[i].second;
}

void GpuScene::address(shader::GpuFrame& frame) const {
    const VkDeviceAddress at = frames_.address() + begin_;
    frame.assets = at;
    frame.instances = at + instancesAt_;
    frame.controls = at + controlsAt_;
    frame.runs = at + runsAt_;
    frame.posedPatches = at + posedAt_;
    frame.poseWeights = at + weightsAt_;
    frame.instanceEnd = instanceEnd_;
    frame.assetEnd = assetEnd_;
    frame.stateCapacity = stateCapacity();
    frame.runCount = uint32_t(runs_.size());
    std::copy(kindRuns_.begin(), kindRuns_.end(), frame.kindRuns);
}

} // namespace xgc::vulkan
