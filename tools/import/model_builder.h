#pragma once

#include <xgc/bake/import.h>

#include <span>

namespace xgc::bake {

/// Appends meshes with differing attributes to one model: where a stream is missing, its rows get the defaults that
/// import.h states. Positions are placed by the reader.
class ModelBuilder {
public:
    ModelBuilder(std::string file, const ImportLimits& limits) : limits_(limits) { model_.file = std::move(file); }

    Model& model() { return model_; }
    const std::string& file() const { return model_.file; }

    /// Makes room for `count` rows; returns the first. Columns are brought to length by their functions and `endRows`.
    Status beginRows(uint64_t count, uint32_t& first);
    std::span<glm::vec3> positions() { return std::span(model_.positions).subspan(first_); }
    /// The last rows of a column, made where the model had none of it.
    template <class T>
    std::span<T> column(std::vector<T>& column, const T& missing) {
        column.resize(model_.positions.size(), missing);
        return std::span(column).subspan(first_);
    }
    std::span<glm::vec3> normals() { return column(model_.attributes.normals, glm::vec3(0)); }
    std::span<glm::vec4> tangents() { return column(model_.attributes.tangents, glm::vec4(0, 0, 0, 1)); }
    std::span<glm::vec2> uvs(size_t set) { return column(model_.attributes.uvs[set], glm::vec2(0)); }
    std::span<glm::vec4> colors(size_t set) { return column(model_.attributes.colors[set], glm::vec4(1)); }
    std::span<glm::u16vec4> joints(size_t set) { return column(model_.attributes.joints[set], glm::u16vec4(0)); }
    std::span<glm::vec4> weights(size_t set) {
        return column(model_.attributes.weights[set], set == 0 ? glm::vec4(1, 0, 0, 0) : glm::vec4(0));
    }
    void endRows();

    Status checkFaces(uint64_t more) const;
    void addTriangle(const glm::uvec3& rows, uint32_t face, uint32_t material, uint32_t node);

    /// Adds the default material where a triangle names none, and gives the model out.
    Model finish();

private:
    Model model_;
    ImportLimits limits_;
    uint32_t first_ = 0;
};

} // namespace xgc::bake
