#include <xgc/asset.h>
#include <xgc/load.h>

#include <cstdio>
#include <vector>

// Links the decoder as an application does: opens a file, compressed or not.
namespace {

struct alignas(64) Block {
    std::byte bytes[64];
};

std::vector<Block> blocksFor(uint64_t size) {
    return std::vector<Block>(size / sizeof(Block) + 1);
}

std::span<std::byte> bytesOf(std::vector<Block>& blocks, uint64_t size) {
    return std::as_writable_bytes(std::span(blocks)).first(size);
}

int complain(const xgc::Status& status) {
    std::printf("refused: %s\n", status.message);
    return 3;
}

int show(std::span<const std::byte> file) {
    xgc::DecodedSize size;
    if (const xgc::Status s = xgc::decodedSize(file, size); !s.ok()) return complain(s);
    std::vector<Block> image = blocksFor(size.imageBytes), scratch = blocksFor(size.scratchBytes);
    const std::span<std::byte> bytes = bytesOf(image, size.imageBytes);
    if (const xgc::Status s = xgc::decode(file, bytesOf(scratch, size.scratchBytes), bytes); !s.ok())
        return complain(s);
    xgc::AssetView asset;
    if (const xgc::Status s = xgc::openAll(bytes, asset); !s.ok()) return complain(s);
    std::printf("%u faces, %s\n", asset.record->faceCount, size.isCompressed ? "compressed" : "not compressed");
    return 0;
}

} // namespace

/// Opens the asset that is named; without one, checks that what is no asset is refused.
int main(int argc, char** argv) {
    std::vector<Block> blocks(1);
    size_t size = 0;
    if (argc <= 1) return show(bytesOf(blocks, sizeof(Block))) == 3 ? 0 : 1;
    std::FILE* file = std::fopen(argv[1], "rb");
    if (!file) return 4;
    blocks.pop_back();
    do {
        blocks.emplace_back();
        size += std::fread(blocks.back().bytes, 1, sizeof(Block), file);
    } while (size == blocks.size() * sizeof(Block));
    std::fclose(file);
    return show(bytesOf(blocks, size));
}
