#include <xgc/asset.h>
#include <xgc/draw_list.h>
#include <xgc/indices.h>
#include <xgc/select.h>

#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

// Links the runtime core as an application does. The body of `show` is the README's example, word for word: the test
// readme_code compares them.
namespace {

size_t drawnTriangles = 0;

int complain(const char* message) {
    std::printf("refused: %s\n", message);
    return 3;
}

void draw(std::span<const glm::vec3> positions, const std::vector<uint32_t>& indices, uint32_t) {
    for (const uint32_t index : indices) {
        if (index >= positions.size()) drawnTriangles = SIZE_MAX / 2;
    }
    drawnTriangles += indices.size() / 3;
}

int show(std::span<const std::byte> fileBytes, const glm::vec3& eye, float fovY, float viewportHeight) {
    xgc::AssetView asset;
    if (const xgc::Status status = xgc::openAll(fileBytes, asset); !status.ok()) return complain(status.message);

    std::vector<uint8_t> levels(asset.patchCount());
    std::vector<uint32_t> scratch(xgc::scratchCapacity(asset)), indices;
    xgc::select(asset, xgc::Placement{}, xgc::makeView(eye, fovY, viewportHeight), xgc::ErrorPixels{1.0f}, levels);
    for (uint32_t patch = 0; patch < asset.patchCount(); ++patch) {
        indices.resize(xgc::indexCapacity(asset, patch, levels));
        indices.resize(xgc::buildIndices(asset, patch, levels, scratch, indices));
        draw(asset.positions, indices, asset.patches[patch].material);
    }
    std::printf("%zu triangles of %u\n", drawnTriangles, asset.record->faceCount);
    return drawnTriangles > 0 && drawnTriangles <= asset.record->faceCount ? 0 : 1;
}

/// A file as 64-byte aligned bytes.
struct alignas(64) Block {
    std::byte bytes[64];
};

int showFile(const char* name) {
    std::FILE* file = std::fopen(name, "rb");
    if (!file) return 4;
    std::vector<Block> blocks;
    size_t size = 0;
    do {
        blocks.emplace_back();
        size += std::fread(blocks.back().bytes, 1, sizeof(Block), file);
    } while (size == blocks.size() * sizeof(Block));
    std::fclose(file);
    return show({blocks.front().bytes, size}, {0, 0, 5}, 1.0f, 720.0f);
}

} // namespace

/// Draws the asset that is named; without one, checks that what is no asset is refused.
int main(int argc, char** argv) {
    if (argc > 1) return showFile(argv[1]);
    const Block nothing{};
    return show(nothing.bytes, {0, 0, 5}, 1.0f, 720.0f) == 3 ? 0 : 1;
}
