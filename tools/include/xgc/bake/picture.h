#pragma once

#include <xgc/bake/image.h>
#include <xgc/bake/mesh.h>
#include <xgc/bake/segment.h>

#include <array>
#include <span>

namespace xgc::bake {

/// A colour for a part or patch, linear RGB: the first 24 differ well from each other, later ones are their lighter
/// and darker tones. The same in every picture of the project.
glm::vec3 partColor(uint32_t part);
inline constexpr uint32_t kPartColorCount = 72; ///< partColor comes round after so many

/// sRGB encoding of linear values in [0,1] and back, by square roots and Newton's steps: within a step of 8 bits
/// of the standard's curves, and the same on any machine.
glm::vec3 encodeSrgb(glm::vec3 linear);
glm::vec3 decodeSrgb(glm::vec3 srgb);

/// A line on the surface, mesh space; hidden where the surface is in front of it.
struct PictureLine {
    glm::vec3 from{0};
    glm::vec3 to{0};
    glm::vec3 color{0}; ///< linear
};

struct PictureOptions {
    uint32_t width = 1200; ///< pixels
    uint32_t height = 900;
    uint32_t samples = 3;               ///< per pixel and axis
    glm::vec3 viewFrom{0.45f, 0.3f, 1}; ///< direction from the mesh to the eye, any length
    glm::vec3 up{0, 1, 0};
    float tanHalfFov = 0.22f;                  ///< vertical
    float margin = 0.06f;                      ///< left free around the mesh, as a part of the picture's half
    float creaseCosine = 0.7f;                 ///< faces whose normals differ more are not shaded as one smooth surface
    float lineWidth = 1.5f;                    ///< pixels
    glm::vec3 background{0.92f, 0.93f, 0.94f}; ///< linear
};

/// Draws a mesh into a picture on the CPU: perspective camera fitted to the mesh, one neutral light with a weak fill,
/// both sides of a face alike. `faceColors`: linear, one a face. Later lines cover earlier ones. The same bytes on
/// any machine. One thread; memory: 10 bytes a sample.
Image drawPicture(const Mesh& mesh, const Topology& topology, std::span<const glm::vec3> faceColors,
                  std::span<const PictureLine> lines, const PictureOptions& options);

/// A face's colour by its part: partColor's, or a later one where a lower part at a common edge has it.
std::vector<glm::vec3> partColors(const Topology& topology, const Segmentation& parts);

/// The thesis's figure 3.4 of any mesh: edges by kind (convex blue, concave red, flat grey) over grey triangles; the
/// regions as they were filled; the parts after merging. `options.lineWidth` is the widest that an edge gets; it is
/// thinner where the mesh is finer.
std::array<Image, 3> drawThesisStages(const Mesh& mesh, const Topology& topology, const ThesisSegmentTrace& trace,
                                      const Segmentation& parts, const PictureOptions& options);

} // namespace xgc::bake
