#include "perceptual_run.h"

#include "meshes/builders.h"

#include <xgc/bake/perceptual.h>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <ctime>

namespace xgc::bench {

PerceptualRun segmentOnce(bake::Mesh mesh, uint32_t threads) {
    PerceptualRun run;
    run.mesh = std::move(mesh);
    const int wanted = threads > 0 ? int(threads) : tbb::info::default_concurrency();
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(wanted));
    tbb::task_arena arena(wanted); // more than there are cores, too
    arena.execute([&] {
        const std::clock_t start = std::clock();
        run.topology = bake::buildTopology(run.mesh);
        run.parts = bake::segmentPerceptual(run.mesh, run.topology, {});
        run.seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    });
    return run;
}

bake::Status segmentOnce(const bake::Model& model, uint32_t threads, PerceptualRun& out) {
    bake::Mesh mesh;
    bake::WeldReport report;
    if (bake::Status s = bake::weld(model, {}, mesh, report); !s.ok()) return s;
    out = segmentOnce(std::move(mesh), threads);
    return {};
}

bake::Model bareModel(const Surface& surface) {
    return test::modelOf(surface.points, surface.triangles);
}

uint64_t hashOf(std::span<const uint32_t> labels) {
    uint64_t hash = 0xcbf29ce484222325ull;
    for (const uint32_t label : labels) {
        for (int byte = 0; byte < 4; ++byte) hash = (hash ^ (label >> (8 * byte) & 0xff)) * 0x100000001b3ull;
    }
    return hash;
}

} // namespace xgc::bench
