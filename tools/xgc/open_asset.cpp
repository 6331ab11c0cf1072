#include "open_asset.h"

#include <fmt/format.h>

namespace xgc::tool {

bake::Status openAsset(const std::string& file, OpenAsset& out) {
    if (bake::Status s = bake::readImage(file, out.bytes); !s.ok()) return s;
    const Status status = openAll(out.bytes.span(), out.view);
    if (status.ok()) return {};
    return bake::badInput(fmt::format("{}: {} (element {})", file, status.message, status.element));
}

} // namespace xgc::tool
