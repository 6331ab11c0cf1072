#include "commands.h"
#include "part_options.h"

#include <xgc/bake/asset_writer.h>
#include <xgc/bake/import.h>
#include <xgc/bake/picture.h>
#include <xgc/bake/segment.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

namespace xgc::tool {
namespace {

struct SegmentArguments {
    std::string input, output, report, stages;
    PartOptions parts;
    std::vector<float> viewFrom, up;
    std::string size = "1200x900";
    bool noConvexSeeds = false, noMerge = false, quiet = false;
    bake::ThesisSegmentOptions options;
    bake::PerceptualOptions perceptual;
    bake::PictureOptions picture;
};

bake::Status checkReports(const SegmentArguments& arguments) {
    const bake::PartSource source = arguments.parts.source;
    const bool isThesis = source == bake::PartSource::thesis, isPerceptual = source == bake::PartSource::perceptual;
    if (!arguments.report.empty() && !isThesis && !isPerceptual) {
        return bake::usageError("--report shows how --parts perceptual or thesis came about; leave it out here");
    }
    if (!arguments.stages.empty() && !isThesis) {
        return bake::usageError("--stages shows how --parts thesis came about; leave it out here");
    }
    return {};
}

bake::Status parsePicture(SegmentArguments& arguments) {
    const auto toVector = [](const std::vector<float>& v) { return glm::vec3(v[0], v[1], v[2]); };
    if (!arguments.viewFrom.empty()) arguments.picture.viewFrom = toVector(arguments.viewFrom);
    if (!arguments.up.empty()) arguments.picture.up = toVector(arguments.up);
    constexpr uint32_t kLargest = 8192;
    uint32_t& width = arguments.picture.width;
    uint32_t& height = arguments.picture.height;
    char rest = 0;
    const bool read = std::sscanf(arguments.size.c_str(), "%5ux%5u%c", &width, &height, &rest) == 2;
    if (read && width >= 1 && height >= 1 && width <= kLargest && height <= kLargest) return {};
    return bake::usageError(fmt::format(
        "--size {}: expected WIDTHxHEIGHT in pixels, each 1 to {}, for example 1200x900", arguments.size, kLargest));
}

bake::Status parse(SegmentArguments& arguments) {
    if (bake::Status s = parse(arguments.parts); !s.ok()) return s;
    if (bake::Status s = checkReports(arguments); !s.ok()) return s;
    if (bake::Status s = parsePicture(arguments); !s.ok()) return s;
    arguments.options.seedFromConvexEdges = !arguments.noConvexSeeds;
    arguments.options.merge = !arguments.noMerge;
    arguments.options.partsCount = arguments.perceptual.partsCount = arguments.parts.count;
    arguments.perceptual.detail = arguments.parts.detail;
    if (std::filesystem::path(arguments.output).extension() != ".seg") {
        return bake::usageError(fmt::format("{}: the output must end in .seg", arguments.output));
    }
    return {};
}

/// How the parts came about, of the preset that found them.
struct Traces {
    bake::ThesisSegmentTrace thesis;
    std::vector<bake::PerceptualTrace> perceptual;
};

bake::Status findParts(const SegmentArguments& arguments, const bake::Mesh& mesh, const bake::Topology& topology,
                       Traces& traces, bake::Segmentation& parts) {
    switch (arguments.parts.source) {
    case bake::PartSource::perceptual: {
        const bake::PerceptualSegmenter segmenter(mesh, topology);
        parts = segmenter.parts(arguments.perceptual);
        traces.perceptual = segmenter.trace();
        break;
    }
    case bake::PartSource::thesis:
        parts = bake::segmentThesis(mesh, topology, arguments.options, &traces.thesis);
        break;
    case bake::PartSource::none:
        parts = bake::segmentNone(mesh);
        break;
    case bake::PartSource::material:
        parts = bake::segmentByMaterial(mesh);
        break;
    case bake::PartSource::component:
        parts = bake::segmentByComponent(mesh, topology);
        break;
    case bake::PartSource::labels: {
        std::vector<uint32_t> labels;
        const std::string& file = arguments.parts.parts;
        if (bake::Status s = bake::readSegFile(file, mesh.inputFaceCount, labels); !s.ok()) return s;
        parts = bake::segmentByLabels(mesh, labels);
        break;
    }
    }
    return {};
}

bake::Status writeStages(const SegmentArguments& arguments, const bake::Mesh& mesh, const bake::Topology& topology,
                         const bake::ThesisSegmentTrace& trace, const bake::Segmentation& parts) {
    std::error_code error;
    std::filesystem::create_directories(arguments.stages, error);
    if (error) return bake::systemError(fmt::format("{}: {}; name a folder", arguments.stages, error.message()));
    const std::array<bake::Image, 3> images = bake::drawThesisStages(mesh, topology, trace, parts, arguments.picture);
    constexpr std::array<const char*, 3> kNames = {"1-edges.png", "2-regions.png", "3-parts.png"};
    for (size_t i = 0; i < images.size(); ++i) {
        if (bake::Status s = bake::writePng(images[i], std::filesystem::path(arguments.stages) / kNames[i]); !s.ok())
            return s;
    }
    return {};
}

void printSummary(const SegmentArguments& arguments, const bake::ThesisSegmentTrace& trace, uint32_t faces,
                  uint32_t parts) {
    fmt::print(stderr, "{}: {} faces, {} {}\n", arguments.output, faces, parts, parts == 1 ? "part" : "parts");
    if (arguments.parts.source != bake::PartSource::thesis || !trace.noisy) return;
    fmt::print(stderr, "note: the mesh is noisy: smoothed {} times to find its parts{}\n", trace.smoothingRounds,
               trace.noisyAfterSmoothing ? ", and noisy still" : "");
}

bake::Status runSegment(SegmentArguments& arguments) {
    if (bake::Status s = parse(arguments); !s.ok()) return s;
    bake::Model model;
    if (bake::Status s = bake::importModel(arguments.input, model); !s.ok()) return s;
    bake::Mesh mesh;
    bake::WeldReport weldReport;
    if (bake::Status s = bake::weld(model, {}, mesh, weldReport); !s.ok()) return s;
    const bake::Topology topology = bake::buildTopology(mesh);
    Traces traces;
    bake::Segmentation parts;
    if (bake::Status s = findParts(arguments, mesh, topology, traces, parts); !s.ok()) return s;
    const std::vector<uint32_t> labels = bake::inputLabels(mesh, parts);
    if (bake::Status s = bake::writeSegFile(arguments.output, labels); !s.ok()) return s;
    if (!arguments.report.empty()) {
        const std::string json =
            arguments.parts.source == bake::PartSource::thesis
                ? bake::thesisReportJson(arguments.input, mesh, arguments.options, traces.thesis, parts)
                : bake::perceptualReportJson(arguments.input, mesh, arguments.perceptual, traces.perceptual, parts);
        if (bake::Status s = bake::writeFileAtomically(arguments.report, std::as_bytes(std::span(json))); !s.ok())
            return s;
    }
    if (!arguments.stages.empty()) {
        if (bake::Status s = writeStages(arguments, mesh, topology, traces.thesis, parts); !s.ok()) return s;
    }
    if (!arguments.quiet) printSummary(arguments, traces.thesis, mesh.inputFaceCount, parts.partCount());
    return {};
}

void addThesisOptions(CLI::App& command, SegmentArguments& arguments) {
    bake::ThesisSegmentOptions& options = arguments.options;
    command
        .add_option("--flat-tolerance", options.flatTolerance,
                    "An edge is flat where |D| is at most this times |P1 P2|")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command
        .add_option("--noise-ratio", options.noiseRatio,
                    "The mesh is noisy where small regions hold this many times the area of the largest other bin")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command.add_option("--smoothing-rounds", options.smoothingRounds, "Rounds of smoothing while noisy, at most")
        ->check(CLI::Range(0u, 10000u))
        ->capture_default_str();
    command.add_flag("--no-convex-seeds", arguments.noConvexSeeds,
                     "Start saliences at triangles with a convex and a concave edge only");
    command.add_flag("--no-merge", arguments.noMerge, "Stop after filling: every region is a part");
}

} // namespace

void addSegment(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<SegmentArguments>();
    CLI::App* command = app.add_subcommand("segment", "Find the parts of a model: a label for each of its faces");
    command->add_option("IN", arguments->input, "Model: glTF, GLB, OBJ, PLY, OFF, STL, ...")->required();
    command->add_option("-o,--output", arguments->output, "Labels to write, ending in .seg: a line a face")->required();
    addPartOptions(*command, arguments->parts);
    addThesisOptions(*command, *arguments);
    command->add_option("--report", arguments->report, "Write a report as JSON");
    command->add_option("--stages", arguments->stages, "Folder for pictures of the edges, the regions and the parts");
    command->add_option("--view", arguments->viewFrom, "Direction from the model to the eye in those pictures: x,y,z")
        ->delimiter(',')
        ->expected(3);
    command->add_option("--up", arguments->up, "Upwards in those pictures: x,y,z")->delimiter(',')->expected(3);
    command->add_option("--size", arguments->size, "Of those pictures, pixels")->capture_default_str();
    command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
    command->footer("Example: xgc segment teddy.off -o teddy.seg --report teddy.json");
    command->callback([arguments, &run] { run = [arguments] { return runSegment(*arguments); }; });
}

} // namespace xgc::tool
