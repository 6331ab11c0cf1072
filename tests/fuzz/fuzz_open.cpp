// Opens whatever bytes it is given, with their checksums made right so that the deep checks are reached, and draws
// and poses what opens. The corpus holds small assets: one with made vertices, one with shapes, contours and merges of
// its parts, one that is cut into pages, one with a skin and blend shapes.
#include "meshes/hostile.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    xgc::test::ExactBytes bytes(std::as_bytes(std::span(data, size)));
    xgc::AssetView asset;
    (void)xgc::openAll(bytes.span(), asset);
    xgc::test::fixChecksums(bytes.span());
    (void)xgc::openTables(bytes.span(), asset);
    if (!xgc::openAll(bytes.span(), asset).ok()) return 0;
    if (!xgc::test::drawsSafely(asset, 2, uint32_t(size))) std::abort();
    xgc::test::posesSafely(asset);
    return 0;
}
