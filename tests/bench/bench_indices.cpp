// Speed of building index lists beside a copy of the same bytes: bench_indices [FILE.xgc]. Without a file, a torus of
// 1.5 M faces in patches of 2,048. Patches are built into one buffer, as a frame does it into staging.

#include "meshes/patched_torus.h"

#include <xgc/indices.h>

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <random>

namespace {

/// Seconds of the fastest of some runs.
double fastest(const std::function<void()>& work) {
    double best = 1e9;
    for (int run = 0; run < 9; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

struct Buffers {
    std::vector<uint32_t> scratch, out, copy;
};

size_t buildAll(const xgc::AssetView& asset, xgc::Levels levels, Buffers& b) {
    size_t used = 0;
    for (uint32_t p = 0; p < asset.patchCount(); ++p)
        used += xgc::buildIndices(asset, p, levels, b.scratch, std::span(b.out).subspan(used));
    return used;
}

void measure(const xgc::AssetView& asset, const std::string& state, xgc::Levels levels, Buffers& b) {
    const size_t count = buildAll(asset, levels, b);
    const double build = fastest([&] { buildAll(asset, levels, b); });
    const double copy = fastest([&] { std::memcpy(b.copy.data(), b.out.data(), count * sizeof(uint32_t)); });
    const double million = double(count) / 3e6;
    fmt::print("{:>8}  {:>10}  {:>9.1f}  {:>9.1f}  {:>8.2f}\n", state, count / 3, million / build, million / copy,
               build / copy);
}

void measureAll(const xgc::AssetView& asset) {
    const size_t capacity = 3 * size_t(asset.record->faceCount);
    Buffers b{std::vector<uint32_t>(xgc::scratchCapacity(asset)), std::vector<uint32_t>(capacity),
              std::vector<uint32_t>(capacity)};
    fmt::print("{} faces, {} patches, {} levels\n", asset.record->faceCount, asset.patchCount(), asset.levelCount());
    fmt::print("   state   triangles     Mtri/s     memcpy     times\n");
    std::vector<uint8_t> levels(asset.patchCount());
    for (uint32_t level = 0; level < asset.levelCount(); ++level) {
        std::fill(levels.begin(), levels.end(), uint8_t(level));
        measure(asset, fmt::format("level {}", level), levels, b);
    }
    std::minstd_rand engine(1);
    for (uint8_t& l : levels) l = uint8_t(engine() % asset.levelCount());
    measure(asset, "random", levels, b);
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        const auto torus = xgc::test::openBuilt(xgc::test::patchedTorus({.patches = 27, .levels = 5}));
        if (torus.failure.empty())
            measureAll(torus.view);
        else
            fmt::print(stderr, "bench_indices: {}\n", torus.failure);
        return torus.failure.empty() ? 0 : 4;
    }
    xgc::bake::AlignedBytes bytes;
    const xgc::bake::Status read = xgc::bake::readFile(argv[1], bytes);
    xgc::AssetView asset;
    const xgc::Status opened = read.ok() ? xgc::openAll(bytes.span(), asset) : xgc::Status{};
    if (!read.ok() || !opened.ok()) {
        fmt::print(stderr, "bench_indices: {}: {}\n", argv[1], read.ok() ? opened.message : read.message);
        return 3;
    }
    measureAll(asset);
    return 0;
}
