#pragma once

#include "builder.h"

#include <xgc/asset.h>

namespace xgc::bench {

/// A hierarchy laid out and opened, in memory.
struct OpenAsset {
    bake::AlignedBytes bytes;
    AssetView view;
};
bake::Status layOut(const Subject& subject, const bake::Segmentation& parts, const bake::Hierarchy& hierarchy,
                    const bake::PatchErrors& errors, OpenAsset& out);
/// With errors of zero: for what does not look at them.
bake::Status layOut(const Subject& subject, const bake::Segmentation& parts, const bake::Hierarchy& hierarchy,
                    OpenAsset& out);

} // namespace xgc::bench
