// Streams an asset that is larger than the memory it is given, with no graphics API: flies a camera around in it, and
// writes what was drawn as a table (FILE.csv) and as a picture (FILE.svg).
//
//     xgc model terrain --faces 2000000 -o terrain.glb
//     xgc bake terrain.glb -o terrain.xgc --patch-faces 512 --tiers 8 --page-kb 32
//     xgc_streaming terrain.xgc [OUTPUT without ending] [budget, of the scene's bytes: 0.1]

#include "chart.h"
#include "disk.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <cstdlib>

namespace {

constexpr uint32_t kFrames = 600;
constexpr uint64_t kDiskBytes = 20'000'000 / 60; ///< a frame

bool succeeded(const xgc::Status& status) {
    if (!status.ok()) {
        std::fprintf(stderr, "xgc_streaming: %s (element %llu)\n", status.message,
                     static_cast<unsigned long long>(status.element));
    }
    return status.ok();
}

/// The tables of a file: its beginning, up to where the header says.
class Tables {
public:
    bool read(std::FILE* file) {
        xgc::format::FileHeader header{};
        if (std::fread(&header, 1, sizeof header, file) != sizeof header || header.tableBytes > (1u << 30))
            return false;
        blocks_.resize((header.tableBytes + sizeof(Block) - 1) / sizeof(Block));
        std::rewind(file);
        size_ = std::fread(blocks_.data(), 1, size_t(header.tableBytes), file);
        return size_ == header.tableBytes;
    }
    std::span<const std::byte> span() const { return std::as_bytes(std::span(blocks_)).first(size_); }

private:
    struct Block {
        alignas(xgc::format::kAlignment) std::byte bytes[xgc::format::kAlignment];
    };
    std::vector<Block> blocks_;
    size_t size_ = 0;
};

/// All that is kept from frame to frame.
struct World {
    xgc::Residency residency;
    xgc::Scene scene;
    xgc::Selection selection;
    xgc::DrawList list;
    xgc::IndexCache cache;
    std::vector<std::byte> staging = std::vector<std::byte>(16u << 20);
    uint32_t asset = 0, instance = 0;
};

bool create(World& world, Disk& disk, const xgc::AssetView& tables, uint64_t budget) {
    const xgc::PageLimits limits = xgc::pageLimits(tables);
    xgc::ResidencyConfig config;
    config.budgetBytes = budget;
    config.pageBytes = limits.bytes;
    config.pageRows = limits.rows;
    config.reader = disk.reader();
    xgc::DrawListConfig list;
    list.domainCapacity = std::max(list.domainCapacity, tables.record->domainCount);
    list.scene.assetPatchCapacity = list.scene.patchCapacity = std::max(list.scene.patchCapacity, tables.patchCount());
    return succeeded(world.residency.create(config)) && succeeded(world.residency.addAsset(tables, world.asset)) &&
           succeeded(world.scene.create(list.scene)) && succeeded(world.selection.create(list.scene)) &&
           succeeded(world.list.create(list)) && succeeded(world.cache.create({.arenaBytes = 256u << 20}));
}

/// The first pages: what is drawn until others come.
bool waitForFirst(World& world, Disk& disk) {
    for (uint32_t frame = 0; !world.residency.ready(world.asset); ++frame) {
        world.residency.update();
        for (const xgc::PageError& error : world.residency.errors()) (void)succeeded(error.status);
        if (frame > 10000) return false;
        disk.read(world.residency, kDiskBytes);
    }
    const xgc::AssetView& view = world.residency.view(world.asset);
    uint32_t id = 0;
    return succeeded(world.scene.addAsset({&view}, id)) && succeeded(world.cache.addAsset(id, view)) &&
           succeeded(world.scene.addInstance(id, {}, world.instance));
}

/// Round within the asset, nearer and farther, looking ahead.
xgc::SelectionDesc viewAt(const xgc::format::AssetRecord& asset, uint32_t frame) {
    const float t = 6.2831853f * float(frame) / float(kFrames), radius = asset.sphereRadius;
    const float far = 0.45f + 0.25f * std::sin(3 * t);
    const glm::vec3 center(asset.sphereCenter[0], asset.sphereCenter[1], asset.sphereCenter[2]);
    const glm::vec3 eye = center + far * radius * glm::vec3(std::cos(t), 0.25f, std::sin(t));
    const glm::vec3 ahead(-std::sin(t), -0.1f, std::cos(t));
    xgc::SelectionDesc desc;
    desc.view = xgc::makeView(eye, 1, 1080);
    desc.view.nearest = 0.01f * radius;
    desc.frustum = xgc::makeFrustum(glm::perspectiveRH_ZO(1.0f, 16.0f / 9, desc.view.nearest, 10 * radius) *
                                    glm::lookAtRH(eye, eye + ahead, glm::vec3(0, 1, 0)));
    return desc;
}

void drawFrame(World& world, Disk& disk, const xgc::SelectionDesc& desc) {
    world.residency.want(world.scene, world.selection, desc);
    world.residency.update();
    for (const xgc::PageError& error : world.residency.errors()) (void)succeeded(error.status);
    disk.read(world.residency, kDiskBytes);
    world.selection.update(world.scene, desc);
    world.cache.beginFrame(world.staging);
    world.list.update(world.scene, world.selection, world.cache);
    world.cache.endFrame();
    world.residency.drawn(world.scene, world.list);
}

Sample measure(const World& world, const xgc::SelectionDesc& desc) {
    const xgc::AssetView& view = world.residency.view(world.asset);
    const xgc::ResidencyStats stats = world.residency.stats();
    Sample sample;
    sample.residentBytes = double(stats.residentBytes);
    sample.readBytes = double(stats.readBytes);
    sample.triangles = double(world.list.stats().triangles);
    if (world.list.kind(world.instance) != xgc::InstanceKind::mixed) return sample;
    const xgc::Levels levels = world.list.levels(world.instance);
    for (uint32_t p = 0; p < levels.size(); ++p) {
        if (!world.selection.visible(world.instance)[p]) continue;
        const glm::vec4& sphere = world.scene.patchBounds(world.scene.assetOf(world.instance))[p].sphere;
        const float away = glm::distance(glm::vec3(sphere), desc.view.eye) - sphere.w;
        const float error = view.error(p, levels[p]) * desc.view.pixelsPerUnit / std::max(away, desc.view.nearest);
        sample.errorPixels = std::max(sample.errorPixels, double(error));
    }
    return sample;
}

bool writeTable(const std::string& path, const std::vector<Sample>& samples) {
    std::FILE* out = std::fopen(path.c_str(), "wb");
    if (!out) return false;
    std::fprintf(out, "frame,error_px,resident_bytes,read_bytes,triangles\n");
    for (size_t i = 0; i < samples.size(); ++i) {
        const Sample& s = samples[i];
        std::fprintf(out, "%zu,%.4f,%.0f,%.0f,%.0f\n", i, s.errorPixels, s.residentBytes, s.readBytes, s.triangles);
    }
    return std::fclose(out) == 0;
}

int run(std::FILE* file, const std::string& output, double share) {
    Tables tables;
    xgc::AssetView asset;
    if (!tables.read(file))
        return std::fprintf(stderr, "xgc_streaming: this is no .xgc file: bake the model with --tiers 6\n"), 1;
    if (!succeeded(xgc::openTables(tables.span(), asset))) return 1;
    if (asset.tierCount() < 2) return std::fprintf(stderr, "xgc_streaming: bake the file with --tiers 6\n"), 1;
    uint64_t sceneBytes = 0;
    for (const xgc::format::PageRecord& page : asset.pages) sceneBytes += page.rawBytes;
    const auto budget = uint64_t(share * double(sceneBytes));

    Disk disk(file);
    World world;
    if (!create(world, disk, asset, budget) || !waitForFirst(world, disk)) return 1;
    std::vector<Sample> samples;
    double sum = 0, worst = 0;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const xgc::SelectionDesc desc = viewAt(*asset.record, frame);
        drawFrame(world, disk, desc);
        samples.push_back(measure(world, desc));
        sum += samples.back().errorPixels;
        worst = std::max(worst, samples.back().errorPixels);
    }
    if (!writeTable(output + ".csv", samples) ||
        !writeChart(output + ".svg", samples, double(budget), double(sceneBytes)))
        return std::fprintf(stderr, "xgc_streaming: cannot write %s\n", output.c_str()), 1;
    const xgc::ResidencyStats stats = world.residency.stats();
    std::printf(
        "%.1f MB of pages in %.1f MB: read %.1f MB, installed %llu, evicted %llu; error %.2f pixels in the mean "
        "of frames, %.2f at most\n",
        double(sceneBytes) / 1e6, double(budget) / 1e6, double(stats.readBytes) / 1e6,
        static_cast<unsigned long long>(stats.installs), static_cast<unsigned long long>(stats.evictions),
        sum / kFrames, worst);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: xgc_streaming FILE.xgc [OUTPUT without ending] [budget, of the scene's bytes]\n");
        return 2;
    }
    std::FILE* file = std::fopen(argv[1], "rb");
    if (!file) return std::fprintf(stderr, "xgc_streaming: cannot read %s\n", argv[1]), 1;
    const int code = run(file, argc > 2 ? argv[2] : "streaming", argc > 3 ? std::atof(argv[3]) : 0.1);
    std::fclose(file);
    return code;
}
