#include "asset.h"
#include "process_memory.h"
#include "sections.h"

#include <fmt/format.h>

namespace xgc::bench {
namespace {

/// Of the asset in memory without the streams that only a renderer reads, and without room between sections.
double runtimeBytes(const AssetView& asset) {
    size_t bytes = asset.bytes.size();
    for (uint32_t s = 0; s < asset.vertexStreamCount; ++s) {
        if (asset.vertexStreams[s].kind != format::StreamKind::position) bytes -= asset.vertexStreams[s].bytes.size();
    }
    return double(bytes);
}

int measure(const Source& source, Csv& csv) {
    Subject subject;
    const uint64_t before = residentBytes();
    if (const bake::Status s = load(source, subject); !s.ok()) {
        fmt::print(stderr, "{}\n", s.message);
        return int(s.outcome);
    }
    const uint64_t loaded = residentBytes();
    resetPeak();
    const bake::Hierarchy h = build(subject, subject.parts);
    const uint64_t built = peakBytes();
    OpenAsset asset;
    if (const bake::Status s = layOut(subject, subject.parts, h, asset); !s.ok()) {
        fmt::print(stderr, "{}\n", s.message);
        return int(s.outcome);
    }
    const double faces = subject.mesh.faceCount();
    const double builder = double(built - loaded) / faces, all = double(built - before) / faces;
    const double plain = (12.0 * double(subject.mesh.positions.size()) + 12 * faces) / faces;
    const double runtime = runtimeBytes(asset.view) / faces;
    fmt::print(
        "{:<10} {:>8} faces: at the build's peak {:>6.1f} with the mesh, {:>6.1f} the builder; at run time {:>5.2f}, "
        "the plain mesh {:>5.2f}\n",
        source.name, subject.mesh.faceCount(), all, builder, runtime, plain);
    csv.row(fmt::format("{},{},{:.2f},{:.2f},{:.3f},{:.3f}", source.name, subject.mesh.faceCount(), all, builder,
                        runtime, plain));
    return 0;
}

} // namespace

int benchMemory(const Flags& flags) {
    Csv csv(flags, "memory",
            "model,faces,peak_bytes_a_face,builder_bytes_a_face,runtime_bytes_a_face,plain_bytes_a_face");
    fmt::print(
        "bytes a face (run time: positions and topology with all levels; plain: float3 positions, u32 indices)\n");
    std::vector<Source> sources{{"terrain1M", {}, 1'000'000, true}};
    for (const Source& s : dragon()) sources.push_back({s.name, s.file, 0, true});
    if (!flags.data.empty()) {
        for (const Source& s : princetonSample(flags.data)) sources.push_back(s);
        sources.push_back(helmet(flags.data));
    }
    for (const Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        if (const int failed = measure(source, csv); failed != 0) return failed;
    }
    return 0;
}

} // namespace xgc::bench
