#include <xgc/bake/mesh.h>

#include <mesh/attribute_rows.h>
#include <mesh/classify.h>

#include <fmt/format.h>

#include <bit>
#include <cmath>

namespace xgc::bake {

namespace {

uint64_t mix(uint64_t h) { // splitmix64's finalizer
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

/// Open addressing over indices: the caller hashes and compares. Finding order never reaches the output.
class IndexTable {
public:
    explicit IndexTable(size_t entries) : mask_(std::bit_ceil(entries * 2 + 2) - 1), slots_(mask_ + 1, kNone) {}

    /// The index that is equal to `index`, or `index` itself, now stored.
    template <class Equal>
    uint32_t findOrInsert(uint32_t index, uint64_t hash, const Equal& equal) {
        for (uint64_t i = hash & mask_;; i = (i + 1) & mask_) {
            if (slots_[i] == kNone) return slots_[i] = index;
            if (equal(slots_[i], index)) return slots_[i];
        }
    }

private:
    uint64_t mask_;
    std::vector<uint32_t> slots_;
};

/// First input face that uses a row, for messages.
std::string rowName(const Model& model, uint32_t row) {
    for (size_t t = 0; t < model.triangles.size(); ++t) {
        const glm::uvec3 c = model.triangles[t];
        if (c.x == row || c.y == row || c.z == row)
            return fmt::format("vertex {} (first used by face {})", row, model.triangleFace[t]);
    }
    return fmt::format("vertex {} (used by no face)", row);
}

Status checkSizes(const Model& model) {
    const size_t triangles = model.triangles.size();
    if (triangles == 0) return badInput(fmt::format("{}: it holds no triangle; give a file with faces", model.file));
    if (triangles > kMaxFaces)
        return badInput(
            fmt::format("{}: {} triangles are more than {}; split the model", model.file, triangles, kMaxFaces));
    if (model.positions.size() >= kNone)
        return badInput(fmt::format("{}: {} vertices are more than 32 bits count; split the model", model.file,
                                    model.positions.size()));
    if (model.triangleFace.size() != triangles || model.triangleMaterial.size() != triangles ||
        model.triangleNode.size() != triangles)
        return badInput(fmt::format("{}: the columns of its triangles differ in length", model.file));
    return {};
}

Status checkTriangles(const Model& model) {
    for (size_t t = 0; t < model.triangles.size(); ++t) {
        const glm::uvec3 c = model.triangles[t];
        if (std::max(c.x, std::max(c.y, c.z)) >= model.positions.size())
            return badInput(fmt::format("{}: face {} uses a vertex past the last one, {}", model.file,
                                        model.triangleFace[t], model.positions.size() - 1));
        if (model.triangleFace[t] >= model.inputFaceCount || (t && model.triangleFace[t] < model.triangleFace[t - 1]))
            return badInput(fmt::format("{}: triangle {} is out of the order of input faces", model.file, t));
        if (model.triangleMaterial[t] >= model.materials.size())
            return badInput(fmt::format("{}: face {} names material {} of {}", model.file, model.triangleFace[t],
                                        model.triangleMaterial[t], model.materials.size()));
        if (model.triangleNode[t] != kNone && model.triangleNode[t] >= model.nodes.size())
            return badInput(fmt::format("{}: face {} names node {} of {}", model.file, model.triangleFace[t],
                                        model.triangleNode[t], model.nodes.size()));
    }
    return {};
}

Status checkValues(const Model& model, const AttributeRows& attributes) {
    constexpr const char* kRemedy = "repair the file in a modelling tool, or drop that face";
    for (size_t r = 0; r < model.positions.size(); ++r) {
        const glm::vec3 p = model.positions[r];
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
        return badInput(fmt::format("{}: the position of {} is not finite ({}, {}, {}); {}", model.file,
                                    rowName(model, uint32_t(r)), p.x, p.y, p.z, kRemedy));
    }
    uint32_t row = kNone;
    const std::string wrong = attributes.check(model.positions.size(), row);
    if (wrong.empty()) return {};
    if (row == kNone) return badInput(fmt::format("{}: {}", model.file, wrong));
    return badInput(fmt::format("{}: {}: {}; {}", model.file, rowName(model, row), wrong, kRemedy));
}

/// For each row, the first row of its position.
std::vector<uint32_t> weldPositions(const Model& model, float tolerance) {
    const auto rowCount = uint32_t(model.positions.size());
    std::vector<uint32_t> first(rowCount);
    IndexTable table(rowCount);
    if (tolerance > 0) {
        std::vector<glm::dvec3> cells(rowCount);
        for (uint32_t r = 0; r < rowCount; ++r) {
            cells[r] = glm::floor(glm::dvec3(model.positions[r]) / double(tolerance)) + 0.0; // + 0.0: no -0
        }
        const auto equal = [&](uint32_t a, uint32_t b) { return cells[a] == cells[b]; };
        for (uint32_t r = 0; r < rowCount; ++r) {
            uint64_t h = 0;
            for (int k = 0; k < 3; ++k) h = mix(h ^ std::bit_cast<uint64_t>(cells[r][k]));
            first[r] = table.findOrInsert(r, h, equal);
        }
        return first;
    }
    const auto equal = [&](uint32_t a, uint32_t b) { return model.positions[a] == model.positions[b]; };
    for (uint32_t r = 0; r < rowCount; ++r) {
        const glm::vec3 p = model.positions[r] + 0.0f; // + 0: -0 becomes 0
        const uint64_t xy = uint64_t(std::bit_cast<uint32_t>(p.x)) << 32 | std::bit_cast<uint32_t>(p.y);
        first[r] = table.findOrInsert(r, mix(mix(xy) ^ std::bit_cast<uint32_t>(p.z)), equal);
    }
    return first;
}

/// For each row, the first row of its wedge: same position, same attributes.
std::vector<uint32_t> weldWedges(const AttributeRows& attributes, const std::vector<uint32_t>& positionRow) {
    if (attributes.empty()) return positionRow;
    const auto rowCount = uint32_t(positionRow.size());
    std::vector<uint32_t> first(rowCount);
    IndexTable table(rowCount);
    const auto equal = [&](uint32_t a, uint32_t b) {
        return positionRow[a] == positionRow[b] && attributes.equal(a, b);
    };
    for (uint32_t r = 0; r < rowCount; ++r) {
        first[r] = table.findOrInsert(r, mix(attributes.hash(r) ^ positionRow[r]), equal);
    }
    return first;
}

/// Triangles that stay, rising.
std::vector<uint32_t> keepTriangles(const Model& model, const std::vector<uint32_t>& positionRow, WeldReport& report) {
    const auto corners = [&](uint32_t t) { // rotated so that the lowest comes first
        const glm::uvec3 c = model.triangles[t];
        const glm::uvec3 p(positionRow[c.x], positionRow[c.y], positionRow[c.z]);
        if (p.x <= p.y && p.x <= p.z) return p;
        return p.y <= p.z ? glm::uvec3(p.y, p.z, p.x) : glm::uvec3(p.z, p.x, p.y);
    };
    const auto equal = [&](uint32_t a, uint32_t b) { return corners(a) == corners(b); };
    const auto count = uint32_t(model.triangles.size());
    IndexTable table(count);
    std::vector<uint32_t> kept;
    kept.reserve(count);
    for (uint32_t t = 0; t < count; ++t) {
        const glm::uvec3 c = corners(t);
        if (c.x == c.y || c.y == c.z || c.z == c.x) {
            ++report.repeatedPositionFaces;
        } else if (table.findOrInsert(t, mix(mix(uint64_t(c.x) << 32 | c.y) ^ c.z), equal) != t) {
            ++report.duplicateFaces;
        } else {
            kept.push_back(t);
        }
    }
    return kept;
}

/// Numbers rows densely by first use.
class Numbering {
public:
    explicit Numbering(size_t rowCount) : number_(rowCount, kNone) {}
    uint32_t operator()(uint32_t row) {
        if (number_[row] == kNone) {
            number_[row] = uint32_t(rows.size());
            rows.push_back(row);
        }
        return number_[row];
    }
    std::vector<uint32_t> rows;

private:
    std::vector<uint32_t> number_;
};

Mesh assemble(const Model& model, const std::vector<uint32_t>& positionRow, const std::vector<uint32_t>& wedgeRow,
              const std::vector<uint32_t>& kept) {
    Mesh mesh;
    mesh.inputFaceCount = model.inputFaceCount;
    mesh.materials = model.materials;
    mesh.nodes = model.nodes;
    mesh.skins = model.skins;
    mesh.faces.reserve(kept.size());
    Numbering wedges(model.positions.size()), positions(model.positions.size());
    for (const uint32_t t : kept) {
        glm::uvec3 face;
        for (int k = 0; k < 3; ++k) {
            const uint32_t row = model.triangles[t][k];
            face[k] = wedges(wedgeRow[row]);
            if (face[k] == mesh.wedgePosition.size()) mesh.wedgePosition.push_back(positions(positionRow[row]));
        }
        mesh.faces.push_back(face);
        mesh.faceInput.push_back(model.triangleFace[t]);
        mesh.faceMaterial.push_back(model.triangleMaterial[t]);
        mesh.faceNode.push_back(model.triangleNode[t]);
    }
    mesh.positions.reserve(positions.rows.size());
    for (const uint32_t r : positions.rows) mesh.positions.push_back(model.positions[r] + 0.0f);
    mesh.attributes = gatherAttributes(model.attributes, wedges.rows);
    return mesh;
}

} // namespace

Status weld(const Model& model, const WeldOptions& options, Mesh& out, WeldReport& report) {
    const AttributeRows attributes(model.attributes);
    if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
        return usageError("the welding tolerance must be a finite length of 0 or more");
    if (Status s = checkSizes(model); !s.ok()) return s;
    if (Status s = checkTriangles(model); !s.ok()) return s;
    if (Status s = checkValues(model, attributes); !s.ok()) return s;

    WeldReport found;
    found.inputFaces = model.inputFaceCount;
    found.inputVertices = uint32_t(model.positions.size());
    const std::vector<uint32_t> positionRow = weldPositions(model, options.tolerance);
    const std::vector<uint32_t> kept = keepTriangles(model, positionRow, found);
    if (kept.empty())
        return badInput(fmt::format("{}: every face repeats a position, so nothing is left to draw; {}", model.file,
                                    options.tolerance > 0 ? "lower the welding tolerance" : "check the export"));
    Mesh mesh = assemble(model, positionRow, weldWedges(attributes, positionRow), kept);
    classify(mesh, buildTopology(mesh), found);
    out = std::move(mesh);
    report = found;
    return {};
}

} // namespace xgc::bake
