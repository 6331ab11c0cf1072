#include "asset.h"

#include <cstring>

namespace xgc::bench {

bake::Status layOut(const Subject& subject, const bake::Segmentation& parts, const bake::Hierarchy& hierarchy,
                    const bake::PatchErrors& errors, OpenAsset& out) {
    std::vector<std::byte> bytes;
    if (bake::Status s = bake::layOutAsset(subject.mesh, parts, hierarchy, errors, subject.weld.closed(), "{}", bytes);
        !s.ok())
        return s;
    out.bytes.blocks.resize((bytes.size() + 63) / 64);
    out.bytes.size = bytes.size();
    std::memcpy(out.bytes.blocks.data(), bytes.data(), bytes.size());
    const Status opened = openAll(out.bytes.span(), out.view);
    return opened.ok() ? bake::Status{} : bake::badInput(subject.name + ": " + opened.message);
}

bake::Status layOut(const Subject& subject, const bake::Segmentation& parts, const bake::Hierarchy& hierarchy,
                    OpenAsset& out) {
    bake::PatchErrors errors;
    errors.values.assign(size_t(hierarchy.patchCount()) * hierarchy.levelCount, 0);
    return layOut(subject, parts, hierarchy, errors, out);
}

} // namespace xgc::bench
