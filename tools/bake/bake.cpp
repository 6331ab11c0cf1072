#include "importance.h"
#include "sample_levels.h"
#include "stage_clock.h"
#include "verdicts.h"

#include <xgc/bake/bake.h>
#include <xgc/bake/error.h>
#include <xgc/bake/import.h>
#include <xgc/bake/normals.h>
#include <xgc/bake/snap.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace xgc::bake {
namespace {

/// What a bake makes on its way.
struct Work {
    Model model;
    Mesh mesh;
    bool hasNormals = false; ///< the input's, not made here
    Topology topology;
    Segmentation parts;
    Hierarchy hierarchy;
    PatchErrors errors;
    std::vector<std::byte> bytes;
};

bool isCancelled(const BakeOptions& options) {
    return options.cancelled && options.cancelled->load();
}

Status cancelledStatus(const BakeOptions& options) {
    return systemError(fmt::format("interrupted: {} is untouched", options.output.string()));
}

Status prepareMesh(const BakeOptions& options, Work& work, BakeReport& report) {
    if (options.normals == NormalSource::smooth) work.model.attributes.normals.clear();
    if (options.positionBits > 0) report.positionStep = snapStep(work.model, options.positionBits);
    if (report.positionStep > 0) report.snapDistance = snapPositions(work.model, report.positionStep);
    if (Status s = weld(work.model, options.weld, work.mesh, report.weld); !s.ok()) return s;
    work.model = Model{};
    work.topology = buildTopology(work.mesh);
    work.hasNormals = !work.mesh.attributes.normals.empty();
    addMissingNormals(work.mesh, work.topology);
    report.faces = work.mesh.faceCount();
    report.vertices = uint32_t(work.mesh.wedgePosition.size());
    report.positions = uint32_t(work.mesh.positions.size());
    glm::vec3 low(work.mesh.positions[0]), high = low;
    for (const glm::vec3& p : work.mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    report.diagonal = glm::distance(low, high);
    return {};
}

Status segment(const BakeOptions& options, Work& work, BakeReport& report) {
    switch (options.parts) {
    case PartSource::perceptual: {
        const PerceptualSegmenter segmenter(work.mesh, work.topology);
        work.parts = segmenter.parts(options.perceptual);
        work.parts.merges = segmenter.merges(work.parts);
        report.perceptual = segmenter.trace();
        break;
    }
    case PartSource::thesis:
        work.parts = segmentThesis(work.mesh, work.topology, options.segment, &report.segment);
        break;
    case PartSource::none:
        work.parts = segmentNone(work.mesh);
        break;
    case PartSource::material:
        work.parts = segmentByMaterial(work.mesh);
        break;
    case PartSource::component:
        work.parts = segmentByComponent(work.mesh, work.topology);
        break;
    case PartSource::labels: {
        std::vector<uint32_t> labels;
        if (Status s = readSegFile(options.labels, work.mesh.inputFaceCount, labels); !s.ok()) return s;
        work.parts = segmentByLabels(work.mesh, labels);
        break;
    }
    }
    if (options.parts != PartSource::perceptual && work.parts.partCount() > 1)
        work.parts.merges = PerceptualSegmenter(work.mesh, work.topology).merges(work.parts);
    report.parts = work.parts.partCount();
    report.partNames = work.parts.partNames;
    return {};
}

Status buildHierarchy(const BakeOptions& options, Work& work, BakeReport& report) {
    if (options.preset == Preset::thesis) {
        work.hierarchy = buildThesisHierarchy(work.mesh, work.topology, work.parts, options.thesis, &report.levels);
    } else {
        HierarchyOptions hierarchy = options.hierarchy;
        if (!work.hasNormals) hierarchy.normalWeight = 0; // made from the shape, which counts already
        if (Status s = findImportances(options, work.mesh, work.parts, hierarchy); !s.ok()) return s;
        const PatchAssignment patches = splitPatches(work.mesh, work.topology, work.parts, options.patchFaces);
        work.hierarchy = buildDefaultHierarchy(work.mesh, work.topology, patches, hierarchy, &report.levels);
        report.floor = findFloor(work.mesh, work.hierarchy, hierarchy);
    }
    report.patches = work.hierarchy.patchCount();
    return checkHierarchy(work.mesh, work.hierarchy);
}

/// What is measured is the way from the snapped mesh: that from the input is longer by no more than the snapping.
void addSnapDistance(const BakeReport& report, PatchErrors& errors) {
    if (report.positionStep == 0) return;
    errors.positionStep = report.positionStep;
    for (float& e : errors.values) {
        const double sum = double(e) + double(report.snapDistance);
        e = float(sum) < sum ? std::nextafter(float(sum), std::numeric_limits<float>::infinity()) : float(sum);
    }
}

Status measure(const BakeOptions& options, Work& work, BakeReport& report) {
    work.errors = measureErrors(work.mesh, work.topology, work.hierarchy, [&](double fraction) {
        if (options.progress) options.progress("measure", fraction);
        return !isCancelled(options);
    });
    if (isCancelled(options)) return cancelledStatus(options);
    addSnapDistance(report, work.errors);
    const uint32_t levelCount = work.hierarchy.levelCount;
    report.levelErrors.assign(levelCount, 0.0f);
    for (size_t i = 0; i < work.errors.values.size(); ++i) {
        float& largest = report.levelErrors[i % levelCount];
        largest = std::max(largest, work.errors.values[i]);
    }
    return {};
}

Status sample(const BakeOptions& options, Work& work, BakeReport& report) {
    report.levelRms = sampleLevels(work.mesh, work.hierarchy, options.rmsSamples, [&](double fraction) {
        if (options.progress) options.progress("sample", fraction);
        return !isCancelled(options);
    });
    return isCancelled(options) ? cancelledStatus(options) : Status{};
}

/// XXH64 of the model file's bytes; empty where it cannot be read again.
std::string hashOf(const std::filesystem::path& file) {
    AlignedBytes bytes;
    if (!readFile(file, bytes).ok()) return {};
    return fmt::format("{:016x}", XXH64(bytes.span().data(), bytes.size, 0));
}

/// Settings, hash of the input and tool version, without paths, times or thread counts: the same bake gives the same
/// bytes.
std::string provenance(const BakeOptions& options) {
    nlohmann::ordered_json json;
    json["tool"] = "xgc " XGC_VERSION;
    json["preset"] = options.preset == Preset::thesis ? "thesis" : "default";
    constexpr const char* kSources[] = {"perceptual", "thesis", "none", "material", "component", "file"};
    json["parts"] = kSources[int(options.parts)];
    if (options.parts == PartSource::perceptual) {
        json["partsCount"] = options.perceptual.partsCount;
        json["detail"] = fmt::format("{}", options.perceptual.detail);
    }
    if (options.parts == PartSource::thesis) {
        json["partsCount"] = options.segment.partsCount;
        json["flatTolerance"] = fmt::format("{}", options.segment.flatTolerance);
    }
    json["input"] = options.input.filename().string();
    json["inputHash"] = hashOf(options.input);
    json["weldTolerance"] = options.weld.tolerance;
    json["normals"] = options.normals == NormalSource::smooth ? "smooth" : "keep";
    if (options.preset == Preset::thesis) {
        json["lockCurvature"] = options.thesis.lockCurvature;
        constexpr const char* kNorms[] = {"trace", "sum", "frobenius"};
        json["curvature"] = kNorms[int(options.thesis.curvature)];
    } else {
        constexpr const char* kPlacements[] = {"subset", "optimal", "midpoint"};
        json["placement"] = kPlacements[int(options.hierarchy.placement)];
        json["normalWeight"] = options.hierarchy.normalWeight;
        json["uvWeight"] = options.hierarchy.uvWeight;
        json["colorWeight"] = options.hierarchy.colorWeight;
        json["patchFaces"] = options.patchFaces;
        json["maxLevels"] = options.hierarchy.maxLevels;
        json["firstError"] = options.hierarchy.firstError;
        for (const PartImportance& i : options.importance) json["importance"][i.part] = fmt::format("{}", i.factor);
        if (options.importanceChannel >= 0) json["importanceChannel"] = options.importanceChannel;
    }
    if (options.pages.tiers > 1) json["tiers"] = options.pages.tiers;
    if (options.positionBits > 0) json["positionBits"] = options.positionBits;
    if (options.rounding.normalBits < 16) json["normalBits"] = options.rounding.normalBits;
    if (options.rounding.uvBits > 0) json["uvBits"] = options.rounding.uvBits;
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Status layOut(const BakeOptions& options, Work& work, BakeReport& report) {
    Status s = layOutAsset(work.mesh, work.parts, work.hierarchy, work.errors, report.weld.closed(),
                           provenance(options), work.bytes, options.pages.tiers);
    const bool rounds = options.rounding.normalBits < 16 || options.rounding.uvBits > 0;
    if (s.ok() && rounds) s = roundAttributes(options.rounding, work.bytes);
    report.fileBytes = report.imageBytes = work.bytes.size();
    return s;
}

Status compress(const BakeOptions& options, Work& work, BakeReport& report) {
    std::vector<std::byte> image = std::move(work.bytes);
    Status s = compressAsset(image, options.compression, work.bytes);
    report.fileBytes = work.bytes.size();
    return s;
}

Status cutPages(const BakeOptions& options, Work& work, BakeReport& report) {
    const std::vector<std::byte> image = std::move(work.bytes);
    PageOptions pages = options.pages;
    pages.compress = options.compress;
    pages.zstdLevel = options.compression.zstdLevel;
    Status s = cutIntoPages(image, pages, work.bytes);
    report.fileBytes = work.bytes.size();
    return s;
}

/// Refuses to write what its report warns of.
Status obey(const BakeOptions& options, const BakeReport& report) {
    const uint32_t warnings = report.warningCount();
    if (!options.strict || warnings == 0) return {};
    return {Outcome::promiseBroken, fmt::format("strict: {} {}: {} is untouched", warnings,
                                                warnings == 1 ? "warning" : "warnings", options.output.string())};
}

} // namespace

uint32_t BakeReport::warningCount() const {
    return uint32_t(std::count_if(verdicts.begin(), verdicts.end(),
                                  [](const Verdict& v) { return v.severity == Severity::warning; }));
}

Status bake(const BakeOptions& options, BakeReport& report) {
    report = {};
    Work work;
    const auto stage = [&](const char* name, auto&& step) -> Status {
        if (isCancelled(options)) return cancelledStatus(options);
        if (options.progress) options.progress(name, 0);
        const StageClock clock(name);
        Status status = step();
        report.stages.push_back(clock.stop());
        if (options.progress) options.progress(name, 1);
        return status;
    };
    Status s = stage("import", [&] { return importModel(options.input, work.model); });
    if (s.ok()) s = stage("weld", [&] { return prepareMesh(options, work, report); });
    if (s.ok()) s = stage("segment", [&] { return segment(options, work, report); });
    if (s.ok()) s = stage("build", [&] { return buildHierarchy(options, work, report); });
    if (s.ok()) s = stage("measure", [&] { return measure(options, work, report); });
    if (s.ok() && options.rmsSamples > 0) s = stage("sample", [&] { return sample(options, work, report); });
    if (s.ok()) s = stage("lay out", [&] { return layOut(options, work, report); });
    if (s.ok() && options.pages.tiers > 1) {
        s = stage("cut", [&] { return cutPages(options, work, report); });
    } else if (s.ok() && options.compress) {
        s = stage("compress", [&] { return compress(options, work, report); });
    }
    if (s.ok()) report.sizes = sizesOf(work.bytes);
    if (s.ok()) judge(options, report);
    if (s.ok()) s = obey(options, report);
    if (s.ok()) s = stage("write", [&] { return writeFileAtomically(options.output, work.bytes); });
    return s;
}

} // namespace xgc::bake
