#include <xgc/asset.h>
#include <xgc/draw_list.h>
#include <xgc/indices.h>
#include <xgc/parts.h>
#include <xgc/select.h>

#include <glm/gtc/matrix_transform.hpp>

#include <cstdint>
#include <cstdio>
#include <span>
#include <vector>

// Links the runtime core as an application does. The body of `show` is the README's example, word for word, and that of
// `fly` the one of runtime/README.md: the tests readme_code compare them.
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

/// What a host knows of a frame.
struct Frame {
    glm::vec3 eye;
    float fovY, height;
    glm::mat4 worldToClip;
    std::span<std::byte> staging;
};

std::vector<uint32_t> stagingWords(1u << 22);
uint32_t framesLeft = 30;
Frame current;

/// From afar to the surface.
const Frame* nextFrame() {
    if (framesLeft == 0) return nullptr;
    --framesLeft;
    current = {
        {0, 0, 1.0f + float(framesLeft)}, 1.0f, 720.0f, glm::mat4(1), std::as_writable_bytes(std::span(stagingWords))};
    current.worldToClip =
        glm::perspectiveRH_ZO(1.0f, 1.5f, 0.01f, 100.0f) * glm::lookAt(current.eye, glm::vec3(0), glm::vec3(0, 1, 0));
    return &current;
}

size_t copiedBytes = 0, framesDrawn = 0;

void copyAndDraw(std::span<const xgc::CopyRange> copies, std::span<const xgc::DrawBatch> batches,
                 std::span<const xgc::DrawCommand> draws) {
    for (const xgc::CopyRange& copy : copies) copiedBytes += copy.bytes;
    size_t listed = 0;
    for (const xgc::DrawBatch& batch : batches) listed += batch.drawCount;
    framesDrawn += !draws.empty() && listed == draws.size();
}

int fly(std::span<const std::byte> bytes, const glm::mat4& toWorld) {
    xgc::AssetView asset; // bytes: the file, aligned to 64, kept alive
    if (const xgc::Status status = xgc::openAll(bytes, asset); !status.ok()) return complain(status.message);
    xgc::Scene scene;         // once: all memory of the frames to come
    xgc::Selection selection; // one a view
    xgc::DrawList list;       // likewise
    xgc::IndexCache cache;    // one for all views
    if (!scene.create({}).ok() || !selection.create({}).ok() || !list.create({}).ok()) return complain("out of memory");
    if (!cache.create({}).ok()) return complain("out of memory");
    uint32_t id = 0, instance = 0;
    if (!scene.addAsset({.asset = &asset}, id).ok() || !cache.addAsset(id, asset).ok()) return complain("too large");
    if (!scene.addInstance(id, xgc::makePlacement(toWorld), instance).ok()) return complain("too many");
    const uint32_t part = xgc::findPart(asset, "part-3"); // a word of an artist: twice as fine as the rest
    if (part != xgc::format::kNone && !scene.setPart(instance, part, {.importance = 2}).ok())
        return complain("too many");
    while (const Frame* frame = nextFrame()) {
        xgc::SelectionDesc desc;
        desc.view = xgc::makeView(frame->eye, frame->fovY, frame->height);
        desc.frustum = xgc::makeFrustum(frame->worldToClip);
        desc.triangleBudget = 200'000; // or none
        selection.update(scene, desc);
        cache.beginFrame(frame->staging); // mapped memory: its size is the cap of the frame's uploads
        list.update(scene, selection, cache);
        cache.endFrame();
        copyAndDraw(cache.copies(), list.batches(), list.draws());
    }
    std::printf("%zu frames drawn, %zu bytes copied\n", framesDrawn, copiedBytes);
    return framesDrawn == 30 && copiedBytes > 0 ? 0 : 1;
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
    const std::span<const std::byte> bytes(blocks.front().bytes, size);
    const int shown = show(bytes, {0, 0, 5}, 1.0f, 720.0f);
    return shown != 0 ? shown : fly(bytes, glm::mat4(1));
}

} // namespace

/// Draws the asset that is named; without one, checks that what is no asset is refused.
int main(int argc, char** argv) {
    if (argc > 1) return showFile(argv[1]);
    const Block nothing{};
    return show(nothing.bytes, {0, 0, 5}, 1.0f, 720.0f) == 3 ? 0 : 1;
}
