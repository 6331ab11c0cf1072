#pragma once

#include <xgc/bake/mesh.h>
#include <xgc/bake/segment.h>

#include <filesystem>
#include <string>
#include <vector>

namespace xgc::bench {

/// A mesh to measure with, its parts made by HPO unless its source is plain.
struct Subject {
    std::string name;
    bake::Mesh mesh;
    bake::WeldReport weld;
    bake::Topology topology;
    bake::Segmentation parts;
};

/// Where a subject comes from: a file, or a bundled model.
struct Source {
    std::string name;
    std::filesystem::path file; ///< empty: the bundled model `name`
    uint32_t faces = 0;         ///< of the bundled model
    bool plain = false;         ///< positions alone, one part: for what is timed
    bool normals = false;       ///< with smooth ones, as a bake makes them, where the file has none
};

/// One model of each category of the Princeton segmentation benchmark, and one more: 20 files below `data`.
std::vector<Source> princetonSample(const std::filesystem::path& data);
/// All of that benchmark's models below `data`, by number.
std::vector<Source> princetonAll(const std::filesystem::path& data);
/// FlightHelmet below `data`: UV seams, several materials.
Source helmet(const std::filesystem::path& data);
/// The Stanford dragon as `tools/dev bench` fetches it, where it has.
std::vector<Source> dragon();

/// Reads, welds and cuts into parts.
bake::Status load(const Source& source, Subject& out);

/// `count` connected pieces of a mesh around random seeds, evened out by Lloyd's iterations on the graph of faces; a
/// component without a seed is a piece of its own. Deterministic.
bake::Segmentation randomPieces(const bake::Mesh& mesh, const bake::Topology& topology, uint32_t count);

} // namespace xgc::bench
