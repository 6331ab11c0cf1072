// Size and speed of compressed assets: bench_load [FILE.xgc]. Without a file, a torus of 1.5 M faces in patches of
// 2,048. Decoding stands beside a copy of the decoded image and zstd's decoding of the same image compressed as a
// whole, in turns, on one thread, by its processor time; the medians are printed.

#include "meshes/patched_torus.h"

#include <xgc/bake/compress.h>
#include <xgc/load.h>

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <ctime>

namespace {

using namespace xgc;
using Bytes = std::vector<std::byte>;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// Of this thread: other programs on the machine do not count.
double threadSeconds() {
    timespec now = {};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

template <typename Work>
double seconds(const Work& work) {
    const double start = threadSeconds();
    work();
    return threadSeconds() - start;
}

const char* codecName(format::Codec codec) {
    constexpr const char* kNames[] = {"none", "zstd", "meshopt", "rows", "faces", "parents"};
    return uint32_t(codec) < std::size(kNames) ? kNames[uint32_t(codec)] : "?";
}

void printStreams(std::span<const std::byte> file, double faces) {
    const auto* header = reinterpret_cast<const format::FileHeader*>(file.data());
    const auto* sections = reinterpret_cast<const format::SectionRecord*>(header + 1);
    uint64_t tables = 0, rawTables = 0;
    fmt::print("{:>12} {:>4} {:>8} {:>12} {:>12}\n", "stream", "set", "codec", "bytes/face", "of raw");
    for (uint32_t i = 0; i < header->sectionCount; ++i) {
        tables += sections[i].storedBytes;
        rawTables += sections[i].rawBytes;
        if (sections[i].id != format::SectionId::streams) continue;
        const auto* streams = reinterpret_cast<const format::StreamRecord*>(file.data() + sections[i].offset);
        for (uint32_t k = 0; k < sections[i].count; ++k) {
            const format::StreamRecord& s = streams[k];
            fmt::print("{:>12} {:>4} {:>8} {:>12.3f} {:>12.3f}\n", uint32_t(s.kind), s.set, codecName(s.codec),
                       double(s.storedBytes) / faces, double(s.rawBytes) / faces);
        }
    }
    fmt::print("{:>12} {:>4} {:>8} {:>12.3f} {:>12.3f}\n", "tables", "", "", double(tables) / faces,
               double(rawTables) / faces);
    fmt::print("{:>12} {:>4} {:>8} {:>12.3f}\n", "file", "", "", double(file.size()) / faces);
}

int measure(const AssetView& asset) {
    const std::span<const std::byte> image = asset.bytes;
    Bytes compressed;
    if (const bake::Status s = bake::compressAsset(image, {}, compressed); !s.ok()) {
        fmt::print(stderr, "bench_load: {}\n", s.message);
        return 4;
    }
    printStreams(compressed, asset.record->faceCount);
    const bake::AlignedBytes file = bake::alignedCopy(compressed);
    DecodedSize size;
    if (!decodedSize(file.span(), size).ok()) return 4;
    bake::AlignedBytes out = bake::alignedBytes(size.imageBytes), scratch = bake::alignedBytes(size.scratchBytes);
    Bytes whole(ZSTD_compressBound(image.size()));
    whole.resize(ZSTD_compress(whole.data(), whole.size(), image.data(), image.size(), 12));

    std::vector<double> decoding, opening, copying, inflating;
    bool ok = true;
    for (int run = 0; run < 15; ++run) {
        decoding.push_back(seconds([&] { ok &= decode(file.span(), scratch.writable(), out.writable()).ok(); }));
        AssetView view;
        opening.push_back(seconds([&] { ok &= openAll(out.span(), view).ok(); }));
        copying.push_back(seconds([&] { std::memcpy(out.writable().data(), image.data(), image.size()); }));
        inflating.push_back(seconds([&] {
            ok &= ZSTD_decompress(out.writable().data(), image.size(), whole.data(), whole.size()) == image.size();
        }));
    }
    if (!ok) return 4;
    const auto row = [&](const char* name, const std::vector<double>& times, size_t bytes) {
        fmt::print("{:>22} {:>8.2f} GB/s of image, {:>12} bytes stored\n", name,
                   double(image.size()) / median(times) / 1e9, bytes);
    };
    fmt::print("{} faces, image {} bytes, scratch {} bytes\n", asset.record->faceCount, image.size(),
               size.scratchBytes);
    row("xgc::decode", decoding, compressed.size());
    row("zstd of the image", inflating, whole.size());
    row("memcpy", copying, image.size());
    row("openAll afterwards", opening, image.size());
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        const auto torus = test::openBuilt(test::patchedTorus({.patches = 27, .levels = 5}));
        if (!torus.failure.empty()) fmt::print(stderr, "bench_load: {}\n", torus.failure);
        return torus.failure.empty() ? measure(torus.view) : 4;
    }
    bake::AlignedBytes image;
    AssetView asset;
    if (const bake::Status s = bake::readImage(argv[1], image); !s.ok()) {
        fmt::print(stderr, "bench_load: {}\n", s.message);
        return 3;
    }
    if (const Status s = openAll(image.span(), asset); !s.ok()) {
        fmt::print(stderr, "bench_load: {}: {}\n", argv[1], s.message);
        return 3;
    }
    return measure(asset);
}
