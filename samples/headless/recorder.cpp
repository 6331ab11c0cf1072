#include "recorder.h"

#include <algorithm>

namespace xgc::headless {

bake::Status Recorder::begin(const AssetGrid& scene, const std::vector<std::filesystem::path>& files) {
    std::vector<const AssetView*> views;
    for (size_t i = 0; i < files.size(); ++i) {
        views.push_back(&scene.assets()[i]->view);
        flight_.assets.push_back({std::filesystem::absolute(files[i]).string(), bake::imageHash(*views.back())});
    }
    for (const SceneInstance& instance : scene.instances()) {
        const auto asset = std::find(views.begin(), views.end(), instance.asset) - views.begin();
        flight_.instances.push_back({uint32_t(asset), instance.placement.toWorld});
    }
    return player_.create(flight_, views);
}

void Recorder::add(const SelectionDesc& desc) {
    bake::Flight::Frame& frame = flight_.frames.emplace_back();
    frame.desc = desc;
    frame.bands.assign(desc.bands.begin(), desc.bands.end());
    frame.hashes = player_.play(desc, frame.triangles);
}

} // namespace xgc::headless
