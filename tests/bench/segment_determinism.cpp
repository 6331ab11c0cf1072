#include "perceptual_run.h"
#include "segment_sections.h"
#include "subjects.h"

namespace xgc::bench {
namespace {

std::vector<Source> everything(const Flags& flags) {
    constexpr uint32_t kFaces = 60'000;
    std::vector<Source> sources;
    for (const char* name : {"creature", "shaft", "terrain", "temple", "tree"})
        sources.push_back({name, {}, kFaces, true});
    if (flags.data.empty()) return sources;
    for (Source& s : princetonAll(flags.data)) {
        s.plain = true;
        sources.push_back(std::move(s));
    }
    return sources;
}

} // namespace

int sweepDeterminism(const Flags& flags) {
    constexpr std::array<uint32_t, 3> kThreads{1, 2, 4};
    std::vector<uint32_t> all; // labels of every model
    uint32_t differ = 0, models = 0;
    const int failed = forSubjects(flags, everything(flags), [&](const Subject& subject) {
        const PerceptualRun first = segmentOnce(subject.mesh, kThreads[0]);
        bool same = true;
        for (size_t i = 1; i < kThreads.size(); ++i)
            same &= segmentOnce(subject.mesh, kThreads[i]).parts.facePart == first.parts.facePart;
        fmt::print("{:<8} {:016x}{}", subject.name, hashOf(first.parts.facePart), same ? "  " : "! ");
        if (++models % 4 == 0) fmt::print("\n");
        differ += !same;
        all.insert(all.end(), first.parts.facePart.begin(), first.parts.facePart.end());
    });
    fmt::print("\n{} models, {:016x} over all; with 1, 2 and 4 threads {} differ\n", models, hashOf(all), differ);
    return failed != 0 ? failed : differ > 0 ? 1 : 0;
}

} // namespace xgc::bench
