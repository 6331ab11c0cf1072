#include "meshes/builders.h"
#include "meshes/toy_asset.h"

#include <xgc/bake/error.h>
#include <xgc/bake/thesis_hierarchy.h>
#include <xgc/bake/verify.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace xgc;
using namespace xgc::bake;

namespace {

/// An asset in memory and what it was made of.
struct Baked {
    Mesh mesh;
    AlignedBytes bytes;
    AssetView view;
};

void layOut(Baked& baked, const Segmentation& parts, const Hierarchy& hierarchy, const PatchErrors& errors) {
    std::vector<std::byte> bytes;
    const bake::Status status = layOutAsset(baked.mesh, parts, hierarchy, errors, true, "{}", bytes);
    REQUIRE_MESSAGE(status.ok(), status.message);
    baked.bytes = test::aligned(bytes);
    REQUIRE(openAll(baked.bytes.span(), baked.view).ok());
}

/// The thesis's hierarchy of a bumpy sphere in three parts.
void bakeSphere(Baked& baked, bool honest) {
    Model model = test::sphere(10);
    for (glm::vec3& p : model.positions) p *= 1 + 0.1f * p.x * p.y;
    baked.mesh = test::welded(model);
    const Segmentation parts = test::slabs(baked.mesh, 3);
    const Topology topology = buildTopology(baked.mesh);
    const Hierarchy h = buildThesisHierarchy(baked.mesh, topology, parts, {});
    PatchErrors errors = measureErrors(baked.mesh, topology, h);
    if (!honest) std::fill(errors.values.begin(), errors.values.end(), 0.0f);
    layOut(baked, parts, h, errors);
}

/// A hierarchy whose boundaries collapse too, and which cares for no flips.
void bakeToy(Baked& baked, const Model& model) {
    baked.mesh = test::welded(model);
    const Segmentation parts = test::slabs(baked.mesh, 4);
    const Hierarchy h = test::toyHierarchy(baked.mesh, parts, {});
    layOut(baked, parts, h, measureErrors(baked.mesh, buildTopology(baked.mesh), h));
}

VerifyReport verify(const AssetView& view) {
    VerifyOptions options;
    options.states = 30;
    options.errorStates = 6;
    options.errorSamples = 3000;
    VerifyReport report;
    verifyAsset(view, options, report);
    return report;
}

} // namespace

TEST_CASE("an honest asset keeps every promise") {
    Baked baked;
    bakeSphere(baked, true);
    VerifyReport report = verify(baked.view);
    verifySource(baked.view, baked.mesh, report);
    CHECK(report.ok());
    CHECK(report.states == 30 + baked.view.levelCount());
    CHECK(report.errorSamples == 6 * 2 * 3000);
    CHECK(report.worstErrorRatio > 0.3);
}

TEST_CASE("the tightness of errors is measured where it is asked for") {
    Baked baked;
    bakeSphere(baked, true);
    CHECK(verify(baked.view).errorTightness == 0.0);
    VerifyOptions options;
    options.states = 0;
    options.tightnessSamples = 2000;
    VerifyReport report;
    verifyAsset(baked.view, options, report);
    CHECK(report.errorTightness > 0.99);
    CHECK(report.errorTightness < 1.5);
}

TEST_CASE("errors that are too small are found") {
    Baked baked;
    bakeSphere(baked, false);
    const VerifyReport report = verify(baked.view);
    CHECK(report.errorViolations > 0);
    CHECK(report.flips + report.oddEdges + report.mismatches == 0);
    CHECK_FALSE(report.ok());
}

TEST_CASE("flips are found, and boundaries that collapse open no crack, on closed and open meshes") {
    for (const Model& model : {test::sphere(10), test::grid(12)}) {
        Baked baked;
        bakeToy(baked, model);
        const VerifyReport report = verify(baked.view);
        CHECK(report.flips > 0);
        CHECK(report.oddEdges == 0);
        CHECK(report.mismatches == 0);
        CHECK_FALSE(report.ok());
    }
}

TEST_CASE("a patch that collapses a shared vertex elsewhere than its neighbour is found as a crack") {
    Baked baked;
    bakeToy(baked, test::sphere(10));
    // Patches keep their own copy of the parents of shared vertices: make one of them differ.
    std::vector<uint16_t> parents(baked.view.parentsNarrow.begin(), baked.view.parentsNarrow.end());
    const format::PatchRecord& patch = baked.view.patches[1];
    uint32_t sharedSlots = 0;
    for (const uint32_t d : baked.view.domainsOf(1)) sharedSlots += baked.view.domainRange(d).count;
    uint32_t changed = 0;
    for (uint32_t slot = 1; slot < sharedSlots; ++slot) {
        uint16_t& parent = parents[patch.firstParent + slot];
        if (parent == slot || parent == 0) continue;
        parent = 0;
        ++changed;
    }
    REQUIRE(changed > 0);
    baked.view.parentsNarrow = parents;
    const VerifyReport report = verify(baked.view);
    CHECK(report.oddEdges > 0);
    CHECK(report.mismatches > 0);
    CHECK_FALSE(report.ok());
}

TEST_CASE("a source that differs by a face or a bit is found") {
    Baked baked;
    bakeSphere(baked, true);
    Mesh fewer = baked.mesh;
    fewer.faces.pop_back();
    VerifyReport report;
    verifySource(baked.view, fewer, report);
    CHECK(report.sourceMismatches == 1);
    Mesh moved = baked.mesh;
    moved.positions[0].x = std::nextafter(moved.positions[0].x, 10.0f);
    report = {};
    verifySource(baked.view, moved, report);
    CHECK(report.sourceMismatches > 0);
    CHECK_FALSE(report.ok());
}

TEST_CASE("the counts do not depend on the number of calls or the threads") {
    Baked baked;
    bakeToy(baked, test::sphere(8));
    const VerifyReport a = verify(baked.view), b = verify(baked.view);
    CHECK(a.flips == b.flips);
    CHECK(a.faces == b.faces);
    CHECK(a.fourUseEdges == b.fourUseEdges);
    CHECK(a.errorViolations == b.errorViolations);
    CHECK(a.worstErrorRatio == b.worstErrorRatio);
}
