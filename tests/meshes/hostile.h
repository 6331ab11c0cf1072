#pragma once

#include <xgc/indices.h>
#include <xgc/skin.h>

#include <xxhash.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

/// Helpers to attack `openAll`: damage past the checksums, and a harmless reader's use of what was accepted.
namespace xgc::test {

/// Bytes at an aligned address with nothing behind them, so that a sanitizer sees any read past the end.
class ExactBytes {
public:
    explicit ExactBytes(std::span<const std::byte> bytes) : size_(bytes.size()) {
        void* memory = nullptr;
        if (::posix_memalign(&memory, format::kAlignment, size_) != 0) std::abort();
        data_.reset(static_cast<std::byte*>(memory));
        if (!bytes.empty()) std::memcpy(data_.get(), bytes.data(), bytes.size());
    }
    std::span<std::byte> span() { return {data_.get(), size_}; }

private:
    struct Free {
        void operator()(std::byte* p) const { std::free(p); }
    };
    size_t size_;
    std::unique_ptr<std::byte, Free> data_;
};

template <typename T>
T load(std::span<const std::byte> bytes, size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

template <typename T>
void store(std::span<std::byte> bytes, size_t offset, const T& value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
}

inline bool inside(std::span<const std::byte> bytes, uint64_t offset, uint64_t size) {
    return offset <= bytes.size() && size <= bytes.size() - offset;
}

/// Makes all checksums right that lie within the bytes: pages first, then the sections (the page table is one), then
/// the header.
inline void fixChecksums(std::span<std::byte> bytes) {
    using namespace format;
    if (!inside(bytes, 0, sizeof(FileHeader))) return;
    auto header = load<FileHeader>(bytes, 0);
    const uint64_t directoryEnd = sizeof header + uint64_t(header.sectionCount) * sizeof(SectionRecord);
    if (!inside(bytes, 0, directoryEnd)) return;
    for (const bool pages : {true, false}) {
        for (uint64_t at = sizeof header; at < directoryEnd; at += sizeof(SectionRecord)) {
            auto section = load<SectionRecord>(bytes, at);
            if (!inside(bytes, section.offset, section.storedBytes)) continue;
            if (!pages) {
                section.checksum = XXH64(bytes.data() + section.offset, section.storedBytes, 0);
                store(bytes, at, section);
            } else if (section.id == SectionId::pages && section.storedBytes >= sizeof(PageRecord)) {
                auto page = load<PageRecord>(bytes, section.offset);
                if (!inside(bytes, page.offset, page.storedBytes)) continue;
                page.checksum = XXH64(bytes.data() + page.offset, page.storedBytes, 0);
                store(bytes, section.offset, page);
            }
        }
    }
    header.headerChecksum = 0;
    store(bytes, 0, header);
    header.headerChecksum = XXH64(bytes.data(), directoryEnd, 0);
    store(bytes, 0, header);
}

/// Builds the indices of every patch in some states, within the promised capacities. False where one is written past
/// a capacity or names no vertex row.
inline bool drawsSafely(const AssetView& asset, uint32_t states, uint32_t seed) {
    constexpr uint32_t kGuard = 0xfeedbeef;
    std::mt19937 random(seed);
    std::vector<uint8_t> levels(asset.patchCount());
    std::vector<uint32_t> scratch(scratchCapacity(asset) + 1, kGuard);
    for (uint32_t state = 0; state < states; ++state) {
        for (uint8_t& l : levels) l = uint8_t(random() % asset.levelCount());
        for (uint32_t p = 0; p < asset.patchCount(); ++p) {
            const uint32_t capacity = indexCapacity(asset, p, levels);
            std::vector<uint32_t> out(size_t(capacity) + 1, kGuard);
            const uint32_t count = buildIndices(asset, p, levels, std::span(scratch).first(scratch.size() - 1),
                                                std::span(out).first(capacity));
            if (count > capacity || out.back() != kGuard || scratch.back() != kGuard) return false;
            for (uint32_t i = 0; i < count; ++i) {
                if (out[i] >= asset.record->vertexCount) return false;
            }
        }
    }
    return true;
}

/// Poses an asset and reads all that a pose tells of it; a sanitizer watches.
inline void posesSafely(const AssetView& asset) {
    if (asset.joints.empty() && asset.morphTargets.empty()) return;
    std::vector<glm::mat4> rest(asset.nodes.size()), nodes(asset.nodes.size());
    restNodes(asset, rest);
    nodesToMesh(asset, rest, nodes);
    std::vector<glm::mat4x3> joints(asset.joints.size());
    jointMatrices(asset, nodes, joints);
    const std::vector<float> weights(asset.morphTargets.size(), 1.5f);
    const Pose pose{joints, weights};
    for (uint32_t row = 0; row < asset.record->vertexCount; ++row) static_cast<void>(posedPosition(asset, pose, row));
    std::vector<PosedPatch> patches(asset.patchCount());
    static_cast<void>(posePatches(asset, pose, patches));
    for (uint32_t p = 0; p < asset.patchCount(); ++p) {
        for (uint32_t level = 0; level < asset.levelCount(); ++level)
            static_cast<void>(posedError(asset, p, level, patches[p], weights));
    }
}

} // namespace xgc::test
