#include "bench/thesis_pictures.h"
#include "meshes/builders.h"

#include <xgc/bake/import.h>
#include <xgc/bake/picture.h>

#include <fmt/format.h>

namespace xgc::test {

using namespace bake;

namespace {

struct View {
    glm::vec3 from{0.45f, 0.3f, 1};
    glm::vec3 up{0, 1, 0};
};

struct Subject {
    Mesh mesh;
    Topology topology;
    Segmentation parts;
    Hierarchy hierarchy;
};

Status load(const std::filesystem::path& file, const ThesisHierarchyOptions& options, bool plain, Subject& s) {
    Model model;
    WeldReport report;
    if (Status status = importModel(file, model); !status.ok()) return status;
    if (Status status = weld(model, {}, s.mesh, report); !status.ok()) return status;
    s.topology = buildTopology(s.mesh);
    s.parts = plain ? segmentNone(s.mesh) : segmentThesis(s.mesh, s.topology, {});
    s.hierarchy = buildThesisHierarchy(s.mesh, s.topology, s.parts, options);
    return {};
}

/// A box whose six sides are its parts: the builder makes them one after another.
Status makeBox(Subject& s) {
    constexpr uint32_t kQuads = 24;
    WeldReport report;
    if (Status status = weld(cube(kQuads), {}, s.mesh, report); !status.ok()) return status;
    s.topology = buildTopology(s.mesh);
    std::vector<uint32_t> sides;
    for (uint32_t f = 0; f < s.mesh.faceCount(); ++f) sides.push_back(f / (2 * kQuads * kQuads));
    s.parts = segmentByLabels(s.mesh, sides);
    s.hierarchy = buildThesisHierarchy(s.mesh, s.topology, s.parts, {});
    return {};
}

/// Levels of the patches from levels of the parts; those past the coarsest are the coarsest.
std::vector<uint8_t> patchLevels(const Hierarchy& h, auto&& levelOfPart) {
    std::vector<uint8_t> levels;
    for (const Patch& patch : h.patches)
        levels.push_back(uint8_t(std::min<uint32_t>(levelOfPart(patch.part), h.levelCount - 1)));
    return levels;
}

/// The surface at some levels, drawn with its edges. `size`: of the mesh in the picture, 1 fills it.
Image draw(const Subject& s, std::span<const uint8_t> levels, float size, const View& view = {}) {
    const Hierarchy& h = s.hierarchy;
    const DrawnSurface surface = drawSurface(s.mesh, h, levels);
    Mesh drawn;
    drawn.positions = h.positions;
    drawn.wedgePosition = h.wedgePosition;
    drawn.faces = surface.triangles;
    std::vector<glm::vec3> colors;
    for (const uint32_t f : surface.face) colors.push_back(partColor(s.parts.facePart[f]));
    const Topology topology = buildTopology(drawn);
    std::vector<PictureLine> inner, boundary;
    for (uint32_t e = 0; e < topology.edges.size(); ++e) {
        const std::span<const uint32_t> faces = topology.facesOfEdge(e);
        const bool inside =
            faces.size() == 2 && s.parts.facePart[surface.face[faces[0]]] == s.parts.facePart[surface.face[faces[1]]];
        const glm::uvec2 ends = topology.edges[e];
        (inside ? inner : boundary)
            .push_back({h.positions[ends.x], h.positions[ends.y], inside ? glm::vec3(0.05f) : glm::vec3(0.6f, 0, 0)});
    }
    inner.insert(inner.end(), boundary.begin(), boundary.end());
    PictureOptions options;
    options.width = 900;
    options.height = 900;
    options.lineWidth = 1;
    options.viewFrom = view.from;
    options.up = view.up;
    options.margin = 1 - 0.94f * size;
    return drawPicture(drawn, topology, colors, inner, options);
}

Status write(const Image& image, const std::filesystem::path& folder, std::string_view name) {
    return writePng(image, folder / fmt::format("{}.png", name));
}

/// One picture a level, all parts alike.
Status drawUniform(const std::filesystem::path& file, const std::filesystem::path& folder, std::string_view figure,
                   std::initializer_list<uint32_t> levels, const View& view = {}) {
    Subject s;
    if (Status status = load(file, {}, false, s); !status.ok()) return status;
    for (const uint32_t level : levels) {
        const Image image = draw(s, patchLevels(s.hierarchy, [&](uint32_t) { return level; }), 1, view);
        if (Status status = write(image, folder, fmt::format("{}-level{}", figure, level)); !status.ok()) return status;
    }
    return {};
}

/// The plain mesh nearer and farther, coarser with the distance; edges kept by dihedral angle alone.
Status drawByDistance(const std::filesystem::path& file, const std::filesystem::path& folder) {
    ThesisHierarchyOptions options;
    options.lockCurvature = 9;
    options.lockDihedralCosine = 0.86f; // about 30 degrees
    Subject s;
    if (Status status = load(file, options, true, s); !status.ok()) return status;
    constexpr std::array<std::pair<uint32_t, float>, 3> kViews{{{0, 1.0f}, {2, 0.5f}, {4, 0.25f}}};
    for (const auto& [level, size] : kViews) {
        const Image image = draw(s, patchLevels(s.hierarchy, [l = level](uint32_t) { return l; }), size);
        if (Status status = write(image, folder, fmt::format("figure4.5-level{}", level)); !status.ok()) return status;
    }
    return {};
}

/// Parts at levels of their own, in turn from a list.
Status drawMixed(const Subject& s, const std::filesystem::path& folder, std::string_view name,
                 const std::vector<uint32_t>& levels) {
    const Image image =
        draw(s, patchLevels(s.hierarchy, [&](uint32_t part) { return levels[part % levels.size()]; }), 1);
    return write(image, folder, name);
}

} // namespace

Status drawThesisPictures(const std::filesystem::path& data, const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return systemError(fmt::format("{}: {}", folder.string(), error.message()));
    if (Status s = drawByDistance(data / "psb/off/381.off", folder); !s.ok()) return s;
    if (Status s = drawUniform(data / "psb/off/364.off", folder, "figure4.6", {0, 2, 4}); !s.ok()) return s;
    if (Status s =
            drawUniform(data / "mesh/psb11.off", folder, "figure4.9", {0, 2, 4, 6}, {{0.3f, 1, 0.2f}, {0, 0, 1}});
        !s.ok())
        return s;
    if (Status s = drawUniform(data / "psb/off/101.off", folder, "figure4.10", {0, 2, 4, 6}); !s.ok()) return s;
    Subject airplane, bust, box;
    if (Status s = load(data / "psb/off/61.off", {}, false, airplane); !s.ok()) return s;
    if (Status s = drawMixed(airplane, folder, "figure4.11a", {0, 2, 3, 4}); !s.ok()) return s;
    if (Status s = load(data / "psb/off/304.off", {}, false, bust); !s.ok()) return s;
    if (Status s = drawMixed(bust, folder, "figure4.11b", {0, 2, 4}); !s.ok()) return s;
    if (Status s = makeBox(box); !s.ok()) return s;
    return drawMixed(box, folder, "figure4.11c", {0, 1, 2, 3, 4, 5});
}

} // namespace xgc::test
