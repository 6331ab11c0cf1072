#include "perceptual_run.h"
#include "process_memory.h"
#include "sdf_peer.h"
#include "segment_stages.h"
#include "subjects.h"

#include <tbb/global_control.h>

#include <algorithm>

/// Time and memory of the perceptual segmentation on one thread: stage by stage on bundled models of 10,000 to 4
/// million faces and the dragon, then whole on the Princeton benchmark, each model in turn with CGAL's shape diameter
/// segmentation where that was built. Times are of the processor: what a loaded machine changes least.
namespace {

using namespace xgc;
using namespace xgc::bench;

void printStages(const Flags& flags, const Subject& subject) {
    const uint64_t before = residentBytes();
    std::array<std::vector<double>, kSegmentStages.size()> seconds;
    uint64_t peak = 0;
    for (uint32_t run = 0; run < flags.runs; ++run) {
        const StageCosts costs = segmentInStages(subject.mesh);
        for (size_t i = 0; i < costs.size(); ++i) {
            seconds[i].push_back(costs[i].seconds);
            if (run == 0) peak = std::max(peak, costs[i].peak - std::min(costs[i].peak, before));
        }
    }
    std::vector<double> whole;
    for (uint32_t run = 0; run < flags.runs; ++run) whole.push_back(segmentOnce(subject.mesh, 1).seconds);
    fmt::print("{:<8} {:>8}", subject.name, subject.mesh.faceCount());
    for (const std::vector<double>& s : seconds) fmt::print(" {:>8.2f}", 1e3 * median(s));
    const double faces = subject.mesh.faceCount();
    fmt::print(" {:>8.1f} {:>7.3f} {:>7.1f} {:>5.0f}\n", 1e3 * median(whole), 1e6 * median(whole) / faces,
               double(peak) / 1048576, double(peak) / faces);
}

int benchStages(const Flags& flags) {
    fmt::print("Milliseconds a stage, and all of it with the labels; memory beyond the mesh's:\n{:<8} {:>8}", "",
               "faces");
    for (const char* stage : kSegmentStages) fmt::print(" {:>8}", stage);
    fmt::print(" {:>8} {:>7} {:>7} {:>5}\n", "whole", "us/face", "MiB", "B/f.");
    std::vector<Source> sources;
    for (const char* name : {"creature", "terrain"}) {
        for (const uint32_t faces : {10'000u, 40'000u, 160'000u, 640'000u, 1'000'000u, 4'000'000u})
            sources.push_back({name, {}, faces, true});
    }
    for (Source& source : dragon()) {
        source.plain = true;
        sources.push_back(std::move(source));
    }
    return forSubjects(flags, sources, [&](const Subject& subject) { printStages(flags, subject); });
}

/// Of every model, in step.
struct PrincetonTimes {
    std::vector<double> seconds, faces;
    std::vector<double> sdfSeconds, ratios; ///< of those that CGAL segmented: its time, and that over ours
};

void timePrinceton(const Flags& flags, const Source& source, const Subject& subject, const SdfPeer& sdf,
                   PrincetonTimes& times) {
    std::vector<double> runs;
    for (uint32_t run = 0; run < flags.runs; ++run) runs.push_back(segmentOnce(subject.mesh, 1).seconds);
    times.seconds.push_back(median(runs));
    times.faces.push_back(double(subject.mesh.faceCount()));
    const double peer = sdf.isThere() ? sdf.seconds(source.file) : -1;
    if (peer > 0) {
        times.sdfSeconds.push_back(peer);
        times.ratios.push_back(peer / times.seconds.back());
    }
    if (!flags.each) return;
    fmt::print("{:<8} {:>8} faces {:>8.1f} ms", source.name, times.faces.back(), 1e3 * times.seconds.back());
    if (peer > 0) fmt::print(", CGAL {:>8.1f} ms: {:.1f} times", 1e3 * peer, times.ratios.back());
    fmt::print("\n");
}

void printPrinceton(const PrincetonTimes& times, const SdfPeer& sdf) {
    fmt::print("Princeton benchmark: {} models of {:.0f} faces in the mean, {:.1f} ms in the mean, {:.1f} the slowest: "
               "{:.1f} ms for 20,000 faces\n",
               times.seconds.size(), mean(times.faces), 1e3 * mean(times.seconds),
               1e3 * *std::ranges::max_element(times.seconds), 1e3 * mean(times.seconds) / mean(times.faces) * 20'000);
    if (!sdf.isThere()) {
        fmt::print("SKIPPED: CGAL's SDF segmentation beside it (peer_sdf was not built: CGAL is missing)\n");
    } else if (!times.ratios.empty()) {
        fmt::print("CGAL's SDF segmentation in the same run: {} models, {:.1f} ms in the mean; perceptual is {:.1f} "
                   "times faster in the mean, {:.1f} in the median, {:.1f} at least\n",
                   times.ratios.size(), 1e3 * mean(times.sdfSeconds), mean(times.ratios), median(times.ratios),
                   *std::ranges::min_element(times.ratios));
    }
}

int benchPrinceton(const Flags& flags, const SdfPeer& sdf) {
    if (flags.data.empty()) return 0;
    PrincetonTimes times;
    for (Source& source : princetonAll(flags.data)) {
        source.plain = true;
        const int failed = forSubjects(
            flags, {source}, [&](const Subject& subject) { timePrinceton(flags, source, subject, sdf, times); });
        if (failed != 0) return failed;
    }
    if (!times.seconds.empty()) printPrinceton(times, sdf);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    Flags flags;
    if (!parseFlags(argc, argv, {"stages", "princeton"}, flags)) return 2;
    if (flags.data.empty()) fmt::print("SKIPPED: real meshes (no XGC_DATA)\n");
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    int failed = 0;
    if (flags.wants("stages")) failed = benchStages(flags);
    if (failed == 0 && flags.wants("princeton")) failed = benchPrinceton(flags, SdfPeer(argv[0]));
    return failed;
}
