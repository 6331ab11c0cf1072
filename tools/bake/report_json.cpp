#include "segment/trace_json.h"

#include <xgc/bake/bake.h>
#include <xgc/bake/error_plot.h>

#include <cmath>

namespace xgc::bake {
namespace {

using Json = nlohmann::ordered_json;

Json weldJson(const WeldReport& weld) {
    return {{"inputFaces", weld.inputFaces},
            {"inputVertices", weld.inputVertices},
            {"repeatedPositionFaces", weld.repeatedPositionFaces},
            {"duplicateFaces", weld.duplicateFaces},
            {"zeroAreaFaces", weld.zeroAreaFaces},
            {"backToBackPairs", weld.backToBackPairs},
            {"components", weld.components},
            {"borderEdges", weld.borderEdges},
            {"nonManifoldEdges", weld.nonManifoldEdges},
            {"inconsistentEdges", weld.inconsistentEdges},
            {"nonManifoldVertices", weld.nonManifoldVertices},
            {"closed", weld.closed()}};
}

Json segmentJson(const ThesisSegmentTrace& trace) {
    return {{"noisy", trace.noisy},
            {"noisyAfterSmoothing", trace.noisyAfterSmoothing},
            {"smoothingRounds", trace.smoothingRounds},
            {"filledRegions", trace.filledCount},
            {"equationCount", trace.equationCount},
            {"triangleTypes", trace.triangleTypes},
            {"firstHistogram", trace.firstHistogram},
            {"histogram", trace.histogram}};
}

Json levelJson(const HierarchyLevelReport& level, float error) {
    return {{"faces", level.faces},
            {"error", error},
            {"collapses", level.collapses},
            {"linkRefused", level.linkRefused},
            {"flipRefused", level.flipRefused},
            {"wedgeRefused", level.wedgeRefused},
            {"area", level.area},
            {"sheetArea", level.sheetArea},
            {"seconds", level.seconds}};
}

Json heldJson(const std::array<uint32_t, kHoldCount>& held) {
    Json json = Json::object();
    for (uint32_t h = 0; h < kHoldCount; ++h) json[holdName(Hold(h))] = held[h];
    return json;
}

Json floorJson(const BakeReport& report) {
    Json parts = Json::array();
    for (const PartFloor& p : report.floor.parts) {
        parts.push_back({{"id", p.part},
                         {"name", report.partNames[p.part]},
                         {"baseFaces", p.baseFaces},
                         {"faces", p.faces},
                         {"held", heldJson(p.held)},
                         {"place", {p.place.x, p.place.y, p.place.z}}});
    }
    return {{"faces", report.floor.faces},
            {"components", report.floor.components},
            {"held", heldJson(report.floor.held)},
            {"parts", parts}};
}

Json sizesJson(const std::vector<SizeReport>& sizes, bool sets) {
    Json json = Json::array();
    for (const SizeReport& s : sizes) {
        json.push_back({{"name", s.name}});
        if (sets) json.back()["set"] = s.set;
        json.back()["rawBytes"] = s.rawBytes;
        json.back()["storedBytes"] = s.storedBytes;
    }
    return json;
}

} // namespace

std::string reportJson(const BakeOptions& options, const BakeReport& report) {
    Json json;
    json["input"] = options.input.string();
    json["output"] = options.output.string();
    json["stages"] = Json::array();
    for (const StageReport& s : report.stages) {
        json["stages"].push_back({{"name", s.name}, {"seconds", s.seconds}, {"peakBytes", s.peakBytes}});
    }
    json["faces"] = report.faces;
    json["vertices"] = report.vertices;
    json["positions"] = report.positions;
    json["parts"] = report.parts;
    json["patches"] = report.patches;
    json["fileBytes"] = report.fileBytes;
    json["imageBytes"] = report.imageBytes;
    json["positionStep"] = report.positionStep;
    json["snapDistance"] = report.snapDistance;
    json["sections"] = sizesJson(report.sizes.sections, false);
    json["streams"] = sizesJson(report.sizes.streams, true);
    json["levels"] = Json::array();
    for (size_t l = 0; l < report.levels.size(); ++l) {
        json["levels"].push_back(
            levelJson(report.levels[l], l < report.levelErrors.size() ? report.levelErrors[l] : 0));
        if (l < report.levelRms.size() && std::isfinite(report.levelRms[l]))
            json["levels"].back()["rms"] = report.levelRms[l];
    }
    if (options.preset == Preset::standard) json["floor"] = floorJson(report);
    json["weld"] = weldJson(report.weld);
    if (options.parts == PartSource::perceptual) json["segment"] = {{"components", traceJson(report.perceptual)}};
    if (options.parts == PartSource::thesis) json["segment"] = segmentJson(report.segment);
    json["verdicts"] = Json::array();
    for (const Verdict& v : report.verdicts) {
        json["verdicts"].push_back({{"severity", v.severity == Severity::warning ? "warning" : "note"},
                                    {"what", v.what},
                                    {"where", v.where},
                                    {"remedy", v.remedy}});
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string reportPlot(const BakeOptions& options, const BakeReport& report) {
    std::vector<PlotLevel> levels;
    for (size_t l = 0; l < report.levels.size(); ++l) {
        levels.push_back({double(report.levels[l].faces), l < report.levelErrors.size() ? report.levelErrors[l] : 0.0,
                          l < report.levelRms.size() ? report.levelRms[l] : 0.0});
    }
    return errorPlotSvg(options.input.filename().string(), report.diagonal, levels);
}

} // namespace xgc::bake
