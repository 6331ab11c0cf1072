#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>
#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/bake/models.h>

#include <filesystem>
#include <string>
#include <unistd.h>

namespace xgc::test {

/// A bundled model through the whole pipeline, opened.
struct BakedModel {
    bake::AlignedBytes bytes;
    AssetView view;
    std::string failure; ///< empty where it opened

    BakedModel(bake::BundledModel which, uint32_t faces, uint32_t patchFaces,
               bake::Placement placement = bake::Placement::subset) {
        namespace fs = std::filesystem;
        const fs::path folder = fs::temp_directory_path() / ("xgc_baked_model_" + std::to_string(getpid()));
        fs::create_directories(folder);
        bake::BakeOptions options;
        options.input = folder / "in.glb";
        options.output = folder / "out.xgc";
        options.patchFaces = patchFaces;
        options.hierarchy.placement = placement;
        bake::BakeReport report;
        bake::Status status = bake::exportModel(bake::makeModel(which, faces), options.input);
        if (status.ok()) status = bake::bake(options, report);
        if (status.ok()) status = bake::readImage(options.output, bytes);
        failure = status.message;
        if (status.ok()) {
            const Status opened = openAll(bytes.span(), view);
            if (!opened.ok()) failure = opened.message;
        }
        fs::remove_all(folder);
    }
    BakedModel(const BakedModel&) = delete;
    BakedModel& operator=(const BakedModel&) = delete;
};

} // namespace xgc::test
