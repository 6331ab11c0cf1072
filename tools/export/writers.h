#pragma once

#include <xgc/bake/model.h>
#include <xgc/bake/status.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

/// The bytes of exported files, one writer a format.
namespace xgc::bake::exports {

using Bytes = std::vector<std::byte>;

Status glbBytes(const Model& model, Bytes& out);
/// `materialLibrary` names the .mtl file that the text refers to; empty where there is none.
std::string objText(const Model& model, const std::string& materialLibrary);
std::string mtlText(const Model& model);
Bytes plyBytes(const Model& model);

/// Triangles of one node and one material, rising.
struct Group {
    uint32_t node;
    uint32_t material;
    std::vector<uint32_t> triangles;
};

/// By node, then material; triangles without a node come last.
std::vector<Group> groupTriangles(const Model& model);

/// Rows that triangles use, rising, and the triangles over them.
struct UsedRows {
    std::vector<uint32_t> rows;
    std::vector<uint32_t> indices;
};
UsedRows usedRows(const Model& model, std::span<const uint32_t> triangles);

inline void append(Bytes& out, const void* data, size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    out.insert(out.end(), first, first + size);
}

} // namespace xgc::bake::exports
