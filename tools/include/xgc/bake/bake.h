#pragma once

#include <xgc/bake/asset_sizes.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/compress.h>
#include <xgc/bake/default_hierarchy.h>
#include <xgc/bake/floor.h>
#include <xgc/bake/mesh.h>
#include <xgc/bake/pages.h>
#include <xgc/bake/perceptual.h>
#include <xgc/bake/segment.h>
#include <xgc/bake/thesis_hierarchy.h>

#include <atomic>
#include <functional>

namespace xgc::bake {

/// Where parts come from.
enum class PartSource { perceptual, thesis, none, material, component, labels };

/// How the hierarchy is built.
enum class Preset {
    standard, ///< `default` on the command line: quadrics, error levels, boundaries that coarsen (default_hierarchy.h)
    thesis    ///< as the thesis's chapter 4 (thesis_hierarchy.h)
};

/// An artist's word on a part; the name is one of the segmentation's, or a part's number.
struct PartImportance {
    std::string part;
    float factor = 1; ///< its error counts that many times; infinity: locked
};

/// What becomes of the input's normals. Missing ones are made in any case.
enum class NormalSource {
    keep,  ///< as they are: normals that differ at a position split it into wedges, which the preset thesis locks
    smooth ///< made anew, with creases at 60 degrees
};

struct BakeOptions {
    std::filesystem::path input;
    std::filesystem::path output;
    PartSource parts = PartSource::perceptual;
    std::filesystem::path labels; ///< the .seg file of PartSource::labels
    WeldOptions weld;
    NormalSource normals = NormalSource::keep;
    PerceptualOptions perceptual; ///< of PartSource::perceptual
    ThesisSegmentOptions segment; ///< of PartSource::thesis
    Preset preset = Preset::standard;
    ThesisHierarchyOptions thesis; ///< of Preset::thesis
    HierarchyOptions hierarchy;    ///< of Preset::standard; the importances come from the next three
    uint32_t patchFaces = kDefaultPatchFaces;
    std::vector<PartImportance> importance;
    /// Channel 0..3 of the first vertex colours in which artists paint importance: c counts 1 / (1 - c) times, 1 locks.
    /// -1: none.
    int importanceChannel = -1;
    uint32_t positionBits = 0; ///< snap positions to a grid of so many bits along the longest side; 0: keep them
    RoundingOptions rounding;
    bool compress = false; ///< false: the file can be mapped and opened where it lies
    CompressOptions compression;
    PageOptions pages;       ///< of more than one tier: the file is for streaming, and `compress` compresses its pages
    bool strict = false;     ///< a warning among the verdicts fails the bake before it writes
    uint32_t rmsSamples = 0; ///< points each way by which the report's RMS of each level is measured; 0: it is not
    /// Told a stage's name and finished fraction, on the calling thread.
    std::function<void(const char* stage, double fraction)> progress;
    /// Set from anywhere (a signal handler) to stop at the next step; the target is then untouched.
    const std::atomic<bool>* cancelled = nullptr;
};

struct StageReport {
    const char* name = "";
    double seconds = 0;
    uint64_t peakBytes = 0; ///< resident memory of the process at its highest within the stage; 0 where unknown
};

enum class Severity { note, warning };

/// Something about the asset that its maker should know, and what to do about it.
struct Verdict {
    Severity severity = Severity::note;
    std::string what;
    std::string where;
    std::string remedy;
};

struct BakeReport {
    std::vector<StageReport> stages;
    WeldReport weld;
    std::vector<PerceptualTrace> perceptual; ///< of PartSource::perceptual
    ThesisSegmentTrace segment;              ///< of PartSource::thesis
    std::vector<HierarchyLevelReport> levels;
    std::vector<float> levelErrors; ///< largest E of each level, mesh units
    std::vector<float> levelRms;    ///< sampled, both ways, mesh units; empty without BakeOptions::rmsSamples
    float diagonal = 0;             ///< of the mesh's bounds
    FloorReport floor;              ///< of Preset::standard
    std::vector<std::string> partNames;
    uint32_t faces = 0;
    uint32_t vertices = 0; ///< wedges
    uint32_t positions = 0;
    uint32_t parts = 0;
    uint32_t patches = 0;
    uint64_t fileBytes = 0;
    float positionStep = 0;  ///< of the grid, mesh units; 0: none
    float snapDistance = 0;  ///< largest way that a position moved to the grid, mesh units
    uint64_t imageBytes = 0; ///< of the file before it was compressed
    AssetSizes sizes;        ///< what the file's bytes are
    std::vector<Verdict> verdicts;
    uint32_t warningCount() const;
};

/// From a model file to an `.xgc` file: import, weld, segment, build, measure, lay out, write. The target is whole or
/// untouched. With `strict`, warnings make it `Outcome::promiseBroken`. The same input and options give the same bytes
/// on any machine at any number of threads (TBB's).
Status bake(const BakeOptions& options, BakeReport& report);

/// The report as JSON, as documented in tools/README.md.
std::string reportJson(const BakeOptions& options, const BakeReport& report);

/// A picture of faces against error by level, bound and RMS (error_plot.h).
std::string reportPlot(const BakeOptions& options, const BakeReport& report);

} // namespace xgc::bake
