#pragma once

#include <xgc/bake/model.h>

#include <string>

namespace xgc::bake::models {

/// Attributes of one corner.
struct Row {
    glm::vec3 position{0};
    glm::vec3 normal{0, 1, 0};
    glm::vec2 uv{0};
    glm::vec3 color{1};
};

/// Gathers triangles of named pieces. Triangles with a repeated position are left out, so that strips may
/// close into a point.
class ModelBuilder {
public:
    /// A counting builder keeps nothing but the number of faces that the same calls would give.
    explicit ModelBuilder(bool counting = false) : counting_(counting) {}
    uint64_t faceCount() const { return counting_ ? count_ : model_.triangles.size(); }

    uint32_t addMaterial(const char* name, glm::vec3 color, float roughness, float metallic);
    /// Starts a named piece.
    void beginNode(const std::string& name);
    void setMaterial(uint32_t material) { material_ = material; }

    uint32_t addRow(const Row& row);
    void addTriangle(uint32_t a, uint32_t b, uint32_t c);

    /// A sheet of nu x nv quads; `corner(i, j)` gives a Row. Its front is where the step in i crossed with the step
    /// in j points.
    template <typename Corner>
    void addGrid(uint32_t nu, uint32_t nv, Corner&& corner) {
        if (counting_) {
            count_ += uint64_t(2) * nu * nv;
            return;
        }
        const auto first = uint32_t(model_.positions.size());
        for (uint32_t j = 0; j <= nv; ++j) {
            for (uint32_t i = 0; i <= nu; ++i) addRow(corner(i, j));
        }
        for (uint32_t j = 0; j < nv; ++j) {
            for (uint32_t i = 0; i < nu; ++i) {
                const uint32_t a = first + j * (nu + 1) + i, b = a + 1, c = a + nu + 1, d = c + 1;
                addTriangle(a, b, d);
                addTriangle(a, d, c);
            }
        }
    }

    /// A disc of n triangles around `center`, `corner(i)` counter-clockwise seen from its front.
    template <typename Corner>
    void addFan(uint32_t n, const Row& center, Corner&& corner) {
        if (counting_) {
            count_ += n;
            return;
        }
        const uint32_t first = addRow(center);
        for (uint32_t i = 0; i <= n; ++i) addRow(corner(i));
        for (uint32_t i = 0; i < n; ++i) addTriangle(first, first + 1 + i, first + 2 + i);
    }

    /// Another model's triangles, turned and scaled about its origin, then moved; one material.
    void addModel(const Model& model, const glm::mat3& turn, float scale, glm::vec3 at);

    /// The model with equal rows merged and unused ones dropped. Columns that the caller does not want are cleared by
    /// it.
    Model finish(const char* name);

private:
    Model model_;
    uint32_t material_ = 0;
    bool counting_;
    uint64_t count_ = 0;
};

} // namespace xgc::bake::models
