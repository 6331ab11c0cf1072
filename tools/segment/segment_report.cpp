#include "part_order.h"
#include "trace_json.h"

#include <fmt/format.h>

#include <cstdlib>

namespace xgc::bake {

namespace {

using Json = nlohmann::ordered_json;

/// The double that prints as the float does: 0.006, not 0.006000000052154064.
double asPrinted(float value) {
    return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

Json partsJson(const Mesh& mesh, const Segmentation& parts) {
    const std::vector<double> areas = faceAreas(mesh);
    std::vector<uint32_t> faces(parts.partCount(), 0);
    std::vector<double> area(parts.partCount(), 0.0);
    double total = 0;
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
        ++faces[parts.facePart[f]];
        area[parts.facePart[f]] += areas[f];
        total += areas[f];
    }
    Json json = Json::array();
    for (uint32_t p = 0; p < parts.partCount(); ++p) {
        json.push_back({{"name", parts.partNames[p]},
                        {"faces", faces[p]},
                        {"areaPercent", total > 0 ? 100 * (area[p] / total) : 0.0}});
    }
    return json;
}

} // namespace

std::string thesisReportJson(const std::string& input, const Mesh& mesh, const ThesisSegmentOptions& options,
                             const ThesisSegmentTrace& trace, const Segmentation& parts) {
    Json json;
    json["input"] = input;
    json["preset"] = "thesis";
    json["faces"] = mesh.faceCount();
    json["options"] = {{"flatTolerance", asPrinted(options.flatTolerance)},
                       {"seedFromConvexEdges", options.seedFromConvexEdges},
                       {"noiseRatio", asPrinted(options.noiseRatio)},
                       {"smoothingRounds", options.smoothingRounds},
                       {"partsCount", options.partsCount},
                       {"merge", options.merge}};
    json["triangleTypeNames"] = {"+3", "+2", "+1", "flat", "-3", "-2", "-1", "+2-1", "+1-2", "+1-1"};
    json["triangleTypes"] = trace.triangleTypes;
    json["noisy"] = trace.noisy;
    json["noisyAfterSmoothing"] = trace.noisyAfterSmoothing;
    json["smoothingRounds"] = trace.smoothingRounds;
    json["firstHistogram"] = trace.firstHistogram;
    json["histogram"] = trace.histogram;
    json["filledRegions"] = trace.filledCount;
    json["equationCount"] = trace.equationCount;
    json["parts"] = partsJson(mesh, parts);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

nlohmann::ordered_json traceJson(std::span<const PerceptualTrace> traces) {
    Json json = Json::array();
    for (const PerceptualTrace& trace : traces) {
        json.push_back({{"faces", trace.faces},
                        {"cells", trace.cells},
                        {"superfacets", trace.superfacets},
                        {"noise", asPrinted(trace.noise)},
                        {"noisy", trace.noisy},
                        {"naturalCount", trace.naturalCount},
                        {"lastCosts", Json::array()}});
        for (const float cost : trace.lastCosts) json.back()["lastCosts"].push_back(asPrinted(cost));
    }
    return json;
}

std::string perceptualReportJson(const std::string& input, const Mesh& mesh, const PerceptualOptions& options,
                                 std::span<const PerceptualTrace> trace, const Segmentation& parts) {
    Json json;
    json["input"] = input;
    json["preset"] = "perceptual";
    json["faces"] = mesh.faceCount();
    json["options"] = {{"partsCount", options.partsCount}, {"detail", asPrinted(options.detail)}};
    json["components"] = traceJson(trace);
    json["parts"] = partsJson(mesh, parts);
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace xgc::bake
