// The runtime without a graphics API: opens an asset, flies a camera away from it, and prints what it would copy and
// draw in each frame. Usage: xgc_hello FILE.xgc

#include <xgc/draw_list.h>
#include <xgc/select.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace {

constexpr uint32_t kFramesInFlight = 2;

/// The bytes of a file, aligned as `openAll` wants them. The core opens memory, never files: map, stream or embed
/// them as you like, but keep them as long as the view.
class FileBytes {
public:
    bool read(const char* path) {
        std::FILE* file = std::fopen(path, "rb");
        if (!file) return false;
        Block block;
        while (const size_t got = std::fread(block.bytes, 1, sizeof(block), file)) {
            blocks_.push_back(block);
            size_ += got;
        }
        const bool ok = !std::ferror(file);
        std::fclose(file);
        return ok;
    }
    std::span<const std::byte> span() const { return std::as_bytes(std::span(blocks_)).first(size_); }

private:
    struct Block {
        alignas(xgc::format::kAlignment) std::byte bytes[xgc::format::kAlignment];
    };
    std::vector<Block> blocks_;
    size_t size_ = 0;
};

/// Prints a failed status.
bool succeeded(const xgc::Status& status) {
    if (!status.ok()) {
        std::fprintf(stderr, "xgc_hello: %s (element %llu)\n", status.message,
                     static_cast<unsigned long long>(status.element));
    }
    return status.ok();
}

/// A draw list with room for one instance: all it draws, and what frames in flight still draw.
bool createFor(const xgc::AssetView& asset, xgc::DrawList& list, uint32_t& instance) {
    const xgc::format::AssetRecord& record = *asset.record;
    xgc::DrawListConfig config;
    config.instanceCapacity = 1;
    config.patchCapacity = record.patchCount;
    config.materialCapacity = record.materialCount;
    config.slotCapacity = xgc::scratchCapacity(asset);
    config.domainCapacity = std::max(record.domainCount, 1u);
    config.indexCapacity = uint32_t(std::min<uint64_t>(3ull * record.faceCount * (kFramesInFlight + 1), UINT32_MAX));
    config.framesInFlight = kFramesInFlight;
    return succeeded(list.create(config)) && succeeded(list.addInstance({.asset = &asset}, instance));
}

void printRow(double distance, const std::vector<uint8_t>& levels, float error, const xgc::DrawList& list) {
    const auto [finest, coarsest] = std::minmax_element(levels.begin(), levels.end());
    const xgc::FrameStats& stats = list.stats();
    std::printf("%9.2f  %6d  %8d  %8.3f  %10u  %6zu  %8zu  %9u  %7zu  %12u\n", distance, *finest, *coarsest,
                double(error), stats.triangles, list.draws().size(), list.batches().size(), stats.patchesRebuilt,
                list.copies().size(), stats.uploadBytes);
}

/// One frame: choose levels, turn them into copies and draws.
bool frame(const xgc::AssetView& asset, uint32_t instance, const xgc::View& view, xgc::DrawList& list,
           std::vector<uint8_t>& levels, std::span<uint32_t> staging) {
    xgc::select(asset, xgc::Placement{}, view, xgc::ErrorPixels{1}, levels);
    list.beginFrame(staging);
    const bool ok = succeeded(list.setLevels(instance, levels));
    list.endFrame();
    // A renderer now copies list.copies() from staging into its index buffer, and for each of list.batches() binds the
    // material and draws its run of list.draws().
    return ok;
}

/// Flies away from the asset, from its surface to 500 of its radii.
bool fly(const xgc::AssetView& asset) {
    xgc::DrawList list;
    uint32_t instance = 0;
    if (!createFor(asset, list, instance)) return false;
    std::vector<uint8_t> levels(asset.patchCount());
    std::vector<uint32_t> staging(size_t(3) * asset.record->faceCount);

    std::printf(
        " distance  finest  coarsest  error px   triangles   draws   batches    rebuilt   copies  upload bytes\n");
    const float* center = asset.record->sphereCenter;
    for (float radii = 1; radii < 500; radii *= 1.6f) {
        const float distance = radii * asset.record->sphereRadius;
        const xgc::View view = xgc::makeView({center[0], center[1], center[2] + distance}, 1.0f, 1080);
        if (!frame(asset, instance, view, list, levels, staging)) return false;
        printRow(double(distance), levels, xgc::projectedError(asset, {}, view, levels), list);
    }
    return true;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: xgc_hello FILE.xgc\n");
        return 2;
    }
    FileBytes bytes;
    if (!bytes.read(argv[1])) {
        std::fprintf(stderr, "xgc_hello: %s: cannot read it\n", argv[1]);
        return 3;
    }
    xgc::AssetView asset;
    if (!succeeded(xgc::openAll(bytes.span(), asset))) return 3;
    std::printf("%s: %u faces, %u parts, %u patches, %u levels\n", argv[1], asset.record->faceCount,
                asset.record->partCount, asset.record->patchCount, asset.record->levelCount);
    return fly(asset) ? 0 : 4;
}
