#include "camera.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace xgc::bake {

namespace {

/// Samples of the picture: linear colour, and 1 / depth (0: nothing there).
struct Canvas {
    uint32_t width, height;
    std::vector<glm::u16vec3> color;
    std::vector<float> nearness;

    Canvas(const PictureOptions& options)
        : width(options.width * options.samples), height(options.height * options.samples),
          color(size_t(width) * height, pack(options.background)), nearness(size_t(width) * height, 0.0f) {}

    static glm::u16vec3 pack(const glm::vec3& c) { return glm::u16vec3(glm::clamp(c, 0.0f, 1.0f) * 65535.0f + 0.5f); }
};

/// First and one past the last sample whose centre can lie in [low, high].
struct Span {
    uint32_t begin, end;
};

Span sampleSpan(double low, double high, uint32_t size) {
    const double begin = std::clamp(std::ceil(low - 0.5), 0.0, double(size));
    const double end = std::clamp(std::floor(high - 0.5) + 1, begin, double(size));
    return {uint32_t(begin), uint32_t(end)};
}

/// A neutral key light from the upper left, a weak fill from the right, a sky a little brighter than the ground, and
/// a soft highlight. View space, y up, z into the picture.
glm::vec3 shade(const glm::vec3& color, const glm::vec3& normal) {
    static const glm::vec3 key = glm::normalize(glm::vec3(-0.45f, 0.65f, -0.8f));
    static const glm::vec3 fill = glm::normalize(glm::vec3(0.8f, 0.1f, -0.4f));
    static const glm::vec3 halfway = glm::normalize(key + glm::vec3(0, 0, -1));
    const float ambient = 0.25f + 0.09f * normal.y;
    const float diffuse =
        0.72f * std::max(0.0f, glm::dot(normal, key)) + 0.13f * std::max(0.0f, glm::dot(normal, fill));
    float highlight = std::max(0.0f, glm::dot(normal, halfway));
    for (int i = 0; i < 5; ++i) highlight *= highlight;
    return color * (ambient + diffuse) + 0.07f * highlight;
}

class Painter {
public:
    Painter(const Mesh& mesh, const Topology& topology, const PictureOptions& options)
        : mesh_(mesh), topology_(topology), options_(options), camera_(mesh, options), canvas_(options) {
        areaNormals_.reserve(mesh.faces.size());
        for (uint32_t f = 0; f < mesh.faceCount(); ++f) areaNormals_.push_back(areaNormal(f));
    }

    void drawFace(uint32_t f, const glm::vec3& color) {
        const glm::uvec3 corners = mesh_.facePositions(f);
        std::array<glm::dvec3, 3> screen;
        for (int k = 0; k < 3; ++k) screen[k] = camera_.toScreen(camera_.toView(mesh_.positions[corners[k]]));
        const double area = cross(screen[0], screen[1], screen[2]);
        if (area == 0) return;
        std::array<glm::vec3, 3> normals = cornerNormals(f);
        const glm::dvec3 a = camera_.toView(mesh_.positions[corners.x]);
        const bool away = glm::dot(a, camera_.directionToView(areaNormals_[f])) > 0;
        for (int k = 0; k < 3; ++k) normals[k] *= float(away ? -screen[k].z : screen[k].z);
        fillTriangle(screen, area, normals, color);
    }

    void drawLine(const PictureLine& line) {
        const glm::dvec3 a = camera_.toScreen(camera_.toView(line.from)), b = camera_.toScreen(camera_.toView(line.to));
        const double reach = double(options_.lineWidth) * options_.samples * 0.5;
        // A line lies on the surface: half its width would sink into the faces beside it.
        const double lift = 1 + 4 * reach * camera_.relativeSampleSize();
        const glm::dvec2 along(b - a);
        const double length2 = glm::dot(along, along);
        const glm::u16vec3 color = Canvas::pack(line.color);
        const Span rows = sampleSpan(std::min(a.y, b.y) - reach, std::max(a.y, b.y) + reach, canvas_.height);
        const Span columns = sampleSpan(std::min(a.x, b.x) - reach, std::max(a.x, b.x) + reach, canvas_.width);
        for (uint32_t y = rows.begin; y < rows.end; ++y) {
            for (uint32_t x = columns.begin; x < columns.end; ++x) {
                const glm::dvec2 at = glm::dvec2(x + 0.5, y + 0.5) - glm::dvec2(a);
                const double t = length2 > 0 ? std::clamp(glm::dot(at, along) / length2, 0.0, 1.0) : 0.0;
                const glm::dvec2 off = at - along * t;
                if (glm::dot(off, off) > reach * reach) continue;
                const size_t i = size_t(y) * canvas_.width + x;
                if (float((a.z + (b.z - a.z) * t) * lift) >= canvas_.nearness[i]) canvas_.color[i] = color;
            }
        }
    }

    Image resolve() const {
        Image image{options_.width, options_.height, {}};
        image.pixels.reserve(size_t(image.width) * image.height);
        const uint32_t n = options_.samples;
        for (uint32_t y = 0; y < image.height; ++y) {
            for (uint32_t x = 0; x < image.width; ++x) {
                glm::uvec3 sum(0);
                for (uint32_t i = 0; i < n * n; ++i) {
                    sum += glm::uvec3(canvas_.color[size_t(y * n + i / n) * canvas_.width + x * n + i % n]);
                }
                const glm::vec3 srgb = encodeSrgb(glm::vec3(sum) / (65535.0f * float(n * n)));
                image.pixels.emplace_back(glm::u8vec3(srgb * 255.0f + 0.5f), 255);
            }
        }
        return image;
    }

private:
    static double cross(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    }

    glm::dvec3 areaNormal(uint32_t f) const {
        const glm::uvec3 c = mesh_.facePositions(f);
        const glm::dvec3 a(mesh_.positions[c.x]), b(mesh_.positions[c.y]), d(mesh_.positions[c.z]);
        return glm::cross(b - a, d - a);
    }

    /// View space, unit: of the faces around each corner that turn little from this one, whatever their winding.
    std::array<glm::vec3, 3> cornerNormals(uint32_t f) const {
        std::array<glm::vec3, 3> normals;
        const glm::dvec3 own = areaNormals_[f];
        const double ownLength = glm::length(own);
        for (int k = 0; k < 3; ++k) {
            glm::dvec3 sum(0);
            for (const uint32_t g : topology_.facesOfVertex(mesh_.facePositions(f)[k])) {
                const glm::dvec3 other = areaNormals_[g];
                const double d = glm::dot(own, other);
                const bool smooth = std::abs(d) >= double(options_.creaseCosine) * ownLength * glm::length(other);
                if (smooth) sum += d < 0 ? -other : other;
            }
            const double length = glm::length(sum);
            normals[k] = length > 0 ? glm::vec3(camera_.directionToView(sum / length)) : glm::vec3(0, 0, -1);
        }
        return normals;
    }

    /// `normals` are divided by depth, so that they interpolate on the screen.
    void fillTriangle(const std::array<glm::dvec3, 3>& p, double area, const std::array<glm::vec3, 3>& normals,
                      const glm::vec3& color) {
        const Span rows =
            sampleSpan(std::min({p[0].y, p[1].y, p[2].y}), std::max({p[0].y, p[1].y, p[2].y}), canvas_.height);
        const Span columns =
            sampleSpan(std::min({p[0].x, p[1].x, p[2].x}), std::max({p[0].x, p[1].x, p[2].x}), canvas_.width);
        for (uint32_t y = rows.begin; y < rows.end; ++y) {
            for (uint32_t x = columns.begin; x < columns.end; ++x) {
                const glm::dvec3 at(x + 0.5, y + 0.5, 0);
                const double u = cross(p[1], p[2], at) / area, v = cross(p[2], p[0], at) / area, w = 1 - u - v;
                if (u < 0 || v < 0 || w < -1e-12) continue;
                const auto nearness = float(u * p[0].z + v * p[1].z + w * p[2].z);
                const size_t i = size_t(y) * canvas_.width + x;
                if (nearness <= canvas_.nearness[i]) continue;
                canvas_.nearness[i] = nearness;
                const glm::vec3 n = float(u) * normals[0] + float(v) * normals[1] + float(w) * normals[2];
                const float length = glm::length(n);
                canvas_.color[i] = Canvas::pack(shade(color, length > 0 ? n / length : glm::vec3(0, 0, -1)));
            }
        }
    }

    const Mesh& mesh_;
    const Topology& topology_;
    const PictureOptions& options_;
    FittedCamera camera_;
    Canvas canvas_;
    std::vector<glm::dvec3> areaNormals_;
};

} // namespace

Image drawPicture(const Mesh& mesh, const Topology& topology, std::span<const glm::vec3> faceColors,
                  std::span<const PictureLine> lines, const PictureOptions& options) {
    Painter painter(mesh, topology, options);
    for (uint32_t f = 0; f < mesh.faceCount(); ++f) painter.drawFace(f, faceColors[f]);
    for (const PictureLine& line : lines) painter.drawLine(line);
    return painter.resolve();
}

} // namespace xgc::bake
