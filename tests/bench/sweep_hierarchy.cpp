#include "asset.h"
#include "flags.h"

#include <xgc/bake/verify.h>

#include <fmt/format.h>

#include <algorithm>

/// The default hierarchy over the Princeton segmentation benchmark, cut into HPO parts and into 40 and 200 random
/// pieces, and over meshes with UV seams and materials: faces that the coarsest level keeps, and every promise of
/// `verify` but the errors over uniform and random states.
namespace {

using namespace xgc;
using namespace xgc::bench;

/// How meshes are cut into parts: HPO where there is no count of random pieces.
struct Division {
    const char* name;
    uint32_t pieces;
};
constexpr Division kParts{"HPO parts", 0};
constexpr std::array<Division, 3> kDivisions{kParts, {"40 pieces", 40}, {"200 pieces", 200}};

struct Outcome {
    uint32_t patches = 0, faces = 0, coarsest = 0;
    bake::VerifyReport verify;
    double percent() const { return 100.0 * coarsest / faces; }
};

bake::Status tryOne(const Flags& flags, const Subject& subject, const Division& division, Outcome& outcome) {
    const bake::Segmentation parts =
        division.pieces == 0 ? subject.parts : randomPieces(subject.mesh, subject.topology, division.pieces);
    const bake::Hierarchy h = build(subject, parts);
    outcome.patches = h.patchCount();
    outcome.faces = subject.mesh.faceCount();
    const std::vector<uint8_t> coarsest(h.patchCount(), uint8_t(h.levelCount - 1));
    outcome.coarsest = uint32_t(bake::drawSurface(subject.mesh, h, coarsest).triangles.size());
    if (bake::Status s = bake::checkHierarchy(subject.mesh, h); !s.ok()) return s;
    OpenAsset asset;
    if (bake::Status s = layOut(subject, parts, h, asset); !s.ok()) return s;
    bake::VerifyOptions options;
    options.states = flags.states;
    options.errorStates = 0;
    bake::verifyAsset(asset.view, options, outcome.verify);
    return {};
}

struct Totals {
    std::string division;
    std::vector<double> percents;
    uint32_t failed = 0;
    bake::VerifyReport sum;

    void add(const Outcome& o) {
        percents.push_back(o.percent());
        failed += !o.verify.ok();
        sum.states += o.verify.states;
        sum.faces += o.verify.faces;
        sum.mismatches += o.verify.mismatches;
        sum.degenerate += o.verify.degenerate;
        sum.flips += o.verify.flips;
        sum.oddEdges += o.verify.oddEdges;
        sum.fourUseEdges += o.verify.fourUseEdges;
    }
};

void printCounts(const bake::VerifyReport& v) {
    fmt::print("{:>7} {:>12} {:>6} {:>6} {:>6} {:>6} {:>8}\n", v.states, v.faces, v.flips, v.oddEdges, v.degenerate,
               v.mismatches, v.fourUseEdges);
}

void sweep(const Flags& flags, const std::vector<Source>& sources, std::span<const Division> divisions, Csv& csv,
           std::vector<Totals>& totals) {
    const size_t first = totals.size();
    for (const Division& d : divisions) totals.push_back({d.name, {}, 0, {}});
    for (const Source& source : sources) {
        if (!flags.wantsModel(source.name)) continue;
        Subject subject;
        if (const bake::Status s = load(source, subject); !s.ok()) {
            fmt::print("{:<10} FAILED: {}\n", source.name, s.message);
            ++totals[first].failed;
            continue;
        }
        for (size_t d = 0; d < divisions.size(); ++d) {
            Outcome o;
            if (const bake::Status s = tryOne(flags, subject, divisions[d], o); !s.ok()) {
                fmt::print("{:<10} {:<10} FAILED: {}\n", source.name, divisions[d].name, s.message);
                ++totals[first + d].failed;
                continue;
            }
            totals[first + d].add(o);
            const bake::VerifyReport& v = o.verify;
            csv.row(fmt::format("{},{},{},{},{},{:.4f},{},{},{},{},{},{},{}", source.name, divisions[d].name, o.patches,
                                o.faces, o.coarsest, o.percent(), v.states, v.faces, v.flips, v.oddEdges, v.degenerate,
                                v.mismatches, v.fourUseEdges));
            if (!flags.each && v.ok()) continue;
            fmt::print("{:<10} {:<10} {:>5} {:>8} {:>8} {:>7.3f} {}", source.name, divisions[d].name, o.patches,
                       o.faces, o.coarsest, o.percent(), v.ok() ? "     " : "BROKE");
            printCounts(v);
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    Flags flags;
    if (!parseFlags(argc, argv, {}, flags)) return 2;
    Csv csv(
        flags, "states",
        "model,division,patches,faces,coarsest_faces,coarsest_percent,states,drawn_faces,flips,odd_edges,degenerate,"
        "mismatches,four_use_edges");
    fmt::print("{:<10} {:<10} {:>5} {:>8} {:>8} {:>7} {:>5}{:>7} {:>12} {:>6} {:>6} {:>6} {:>6} {:>8}\n", "model",
               "division", "patch", "faces", "coarsest", "%", "", "states", "drawn", "flips", "odd", "degen.", "mism.",
               "four-use");
    std::vector<Totals> totals;
    if (flags.data.empty())
        fmt::print("SKIPPED: real meshes (no XGC_DATA)\n");
    else
        sweep(flags, princetonAll(flags.data), kDivisions, csv, totals);
    std::vector<Source> seamed{{"temple", {}, 60'000}};
    if (!flags.data.empty()) seamed.push_back(helmet(flags.data));
    sweep(flags, seamed, std::span(&kParts, 1), csv, totals);

    fmt::print("\n{:<10} {:>6} {:>8} {:>8} {:>6} {:>7} {:>12} {:>6} {:>6} {:>6} {:>6} {:>8}\n", "division", "meshes",
               "mean %", "worst %", "broke", "states", "drawn", "flips", "odd", "degen.", "mism.", "four-use");
    bool broke = false;
    for (const Totals& t : totals) {
        broke |= t.failed > 0;
        if (t.percents.empty()) continue;
        fmt::print("{:<10} {:>6} {:>8.3f} {:>8.3f} {:>6} ", t.division, t.percents.size(), mean(t.percents),
                   std::ranges::max(t.percents), t.failed);
        printCounts(t.sum);
    }
    return broke ? 1 : 0;
}
