#pragma once

#include <xgc/bake/mesh.h>

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace xgc::bake {

/// One step of joining parts: `b` joins `a`, a lower one, which goes by its own number from then on.
struct PartMerge {
    uint32_t a, b;
    float cost; ///< how much is lost: about .5 and more where people see two parts
};

/// Parts of a mesh: an id per face, dense, ordered by area descending, ties by lowest face.
struct Segmentation {
    std::vector<uint32_t> facePart;
    std::vector<std::string> partNames; ///< one a part, unique
    /// How they would join, one by one (PerceptualSegmenter::merges); empty where nobody asked.
    std::vector<PartMerge> merges = {};
    uint32_t partCount() const { return uint32_t(partNames.size()); }
};

/// Constants of the thesis's segmentation (chapter 3) and the choices that its text leaves open. Fixed choices:
/// - Faces are first wound alike: nearly closed components outwards, others as most of their faces are.
/// - Borders, edges of more than two faces and those across which winding cannot agree are closed: no region crosses
///   them. Regions still count as neighbours there when merging.
/// - N1 and P1 belong to the edge's first face. A face without area takes its plane from the one across its longest
///   edge.
/// - Saliences come first, then recesses, then saliences of what is left: so a wholly convex body is one part. The
///   order of seeds does not matter: regions of a kind are connected components.
/// - Merging takes the smallest region at its original area; equal areas and equal boundaries go to the lower region.
///   An island stays, so a mesh has at least as many parts as components.
struct ThesisSegmentOptions {
    /// An edge is flat where |D| <= flatTolerance * |P1 P2| (point membership test).
    float flatTolerance = 6e-3f;
    /// Seed saliences also from triangles that have a convex edge but are no boundary triangles (one convex and one
    /// concave edge): or rims of triangles with a single concave edge fall to the recesses.
    bool seedFromConvexEdges = true;
    /// The mesh is noisy where the bin [0,1[ of the area histogram holds at least this many times the largest other.
    float noiseRatio = 2;
    /// Rounds of uniform Laplacian smoothing while noisy, at most: it need not end by itself.
    uint32_t smoothingRounds = 200;
    /// Parts wanted; 0: Eq. 3.1, with a_i the mean area of a bin's regions: the regions of 1 % of the original area or
    /// more, at least 2 where the mesh has them.
    uint32_t partsCount = 0;
    bool merge = true; ///< false stops after filling
};

enum class EdgeKind : uint8_t { flat, convex, concave, closed };

/// What the thesis's segmentation saw on its way: for the report and for pictures of its stages.
struct ThesisSegmentTrace {
    std::vector<EdgeKind> edgeKinds;          ///< per topology edge, original positions
    std::array<uint32_t, 10> triangleTypes{}; ///< faces per type of definition 1, in its order
    std::vector<uint32_t> filledRegions;      ///< per face, after filling (last round)
    uint32_t filledCount = 0;
    std::array<double, 100> histogram{};      ///< relative area per bin, percent, last round
    std::array<double, 100> firstHistogram{}; ///< of the unsmoothed mesh
    bool noisy = false;                       ///< of the unsmoothed mesh
    bool noisyAfterSmoothing = false;         ///< the bound on rounds was met first
    uint32_t smoothingRounds = 0;
    uint32_t equationCount = 0; ///< n of Eq. 3.1
};

Segmentation segmentThesis(const Mesh& mesh, const Topology& topology, const ThesisSegmentOptions& options,
                           ThesisSegmentTrace* trace = nullptr);

/// What a run of segmentThesis did, as JSON: documented in tools/README.md. `input` names the model.
std::string thesisReportJson(const std::string& input, const Mesh& mesh, const ThesisSegmentOptions& options,
                             const ThesisSegmentTrace& trace, const Segmentation& parts);

/// One part, "all"; a part each material, named after it (made unique); a part each edge-connected component,
/// "component-0" the largest.
Segmentation segmentNone(const Mesh& mesh);
Segmentation segmentByMaterial(const Mesh& mesh);
Segmentation segmentByComponent(const Mesh& mesh, const Topology& topology);

/// A `.seg` file: one id a line, a line for each face of the input, in its order. Blanks around an id, CRLF and
/// empty lines at the end are accepted. On failure `inputLabels` is untouched and the message names the line.
Status readSegFile(const std::filesystem::path& file, uint32_t inputFaceCount, std::vector<uint32_t>& inputLabels);
/// As readSegFile, from memory; `name` is for messages.
Status parseSeg(std::string_view text, const std::string& name, uint32_t inputFaceCount,
                std::vector<uint32_t>& inputLabels);
/// Parts from labels of the input's faces, "label-N" after them.
Segmentation segmentByLabels(const Mesh& mesh, std::span<const uint32_t> inputLabels);
/// Labels for the input's faces. Of a polygon's triangles the first decides; faces that welding dropped take the
/// label of the nearest kept face in order, of two the one before.
std::vector<uint32_t> inputLabels(const Mesh& mesh, const Segmentation& parts);
/// Written beside the target and renamed.
Status writeSegFile(const std::filesystem::path& file, std::span<const uint32_t> inputLabels);

} // namespace xgc::bake
