#pragma once

#include <xgc/bake/mesh.h>

#include <doctest/doctest.h>

namespace xgc::test {

/// A model welded exactly, with its topology: what most stages start from.
struct Welded {
    bake::Mesh mesh;
    bake::Topology topology;
};

inline Welded weldedWithTopology(const bake::Model& model) {
    Welded w;
    bake::WeldReport report;
    const bake::Status status = bake::weld(model, {}, w.mesh, report);
    REQUIRE_MESSAGE(status.ok(), status.message);
    w.topology = bake::buildTopology(w.mesh);
    return w;
}

} // namespace xgc::test
