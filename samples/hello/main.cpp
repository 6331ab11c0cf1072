// The runtime without a graphics API: opens an asset, flies a camera away from it, and prints what it would copy and
// draw in each frame. Usage: xgc_hello FILE.xgc

#include <xgc/draw_list.h>

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

/// All that is kept from frame to frame, with room for one instance of one asset.
struct World {
    xgc::Scene scene;
    xgc::Selection selection; // one a view
    xgc::DrawList list;       // likewise
    xgc::IndexCache cache;    // one for all views
    std::vector<std::byte> staging;
    uint32_t instance = 0;
};

bool create(World& world, const xgc::AssetView& asset) {
    const xgc::format::AssetRecord& record = *asset.record;
    xgc::SceneConfig scene;
    scene.assetCapacity = scene.instanceCapacity = 1;
    scene.assetPatchCapacity = scene.patchCapacity = record.patchCount;
    xgc::DrawListConfig draws;
    draws.scene = scene;
    draws.materialCapacity = record.materialCount;
    draws.domainCapacity = std::max(record.domainCount, 1u);
    xgc::IndexCacheConfig cache;
    cache.arenaBytes = uint32_t(std::min<uint64_t>(24ull * record.faceCount * (kFramesInFlight + 1), UINT32_MAX));
    cache.assetCapacity = 1;
    cache.slotCapacity = xgc::scratchCapacity(asset);
    cache.faceCapacity = record.maxPatchFaces;
    cache.patchCapacity = record.patchCount;
    cache.framesInFlight = kFramesInFlight;
    world.staging.resize(24ull * record.faceCount); // the most that one frame may upload
    uint32_t id = 0;
    return succeeded(world.scene.create(scene)) && succeeded(world.selection.create(scene)) &&
           succeeded(world.list.create(draws)) && succeeded(world.cache.create(cache)) &&
           succeeded(world.scene.addAsset({.asset = &asset}, id)) && succeeded(world.cache.addAsset(id, asset)) &&
           succeeded(world.scene.addInstance(id, {}, world.instance));
}

/// One frame: choose levels, turn them into copies and draws.
void frame(World& world, const xgc::View& view) {
    xgc::SelectionDesc desc;
    desc.view = view;
    world.selection.update(world.scene, desc);
    world.cache.beginFrame(world.staging);
    world.list.update(world.scene, world.selection, world.cache);
    world.cache.endFrame();
    // A renderer now copies world.cache.copies() from staging into its index buffer, and for each of list.batches()
    // binds the material and the index buffer at its size of index, and draws the batch's run of list.draws().
}

void printRow(double distance, const World& world) {
    const xgc::DrawList& list = world.list;
    const bool whole = list.kind(world.instance) == xgc::InstanceKind::whole;
    uint32_t finest = UINT32_MAX, coarsest = 0;
    for (const xgc::DrawSource& source : list.sources()) {
        finest = std::min(finest, source.level);
        coarsest = std::max(coarsest, source.level);
    }
    const xgc::IndexCacheStats built = world.cache.stats();
    std::printf("%9.2f  %-5s  %6u  %8u  %10llu  %6zu  %6u  %7zu  %12u\n", distance, whole ? "whole" : "mixed", finest,
                coarsest, static_cast<unsigned long long>(list.stats().triangles), list.draws().size(), built.misses,
                world.cache.copies().size(), built.uploadBytes);
}

/// Flies away from the asset, from its surface to 500 of its radii.
bool fly(const xgc::AssetView& asset) {
    World world;
    if (!create(world, asset)) return false;
    std::printf(" distance  kind   finest  coarsest   triangles   draws   built   copies  upload bytes\n");
    const float* center = asset.record->sphereCenter;
    for (float radii = 1; radii < 500; radii *= 1.6f) {
        const float distance = radii * asset.record->sphereRadius;
        frame(world, xgc::makeView({center[0], center[1], center[2] + distance}, 1.0f, 1080));
        printRow(double(distance), world);
        if (!succeeded(world.list.refusal())) return false;
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
