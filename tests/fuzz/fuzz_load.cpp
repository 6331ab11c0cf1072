// Decodes whatever bytes it is given, with their checksums made right so that the codecs are reached, and draws and
// poses what opens. The corpus holds small compressed assets, and some with frames that zstd stores as they are: their
// codes can be altered without breaking the frame.
#include "meshes/hostile.h"

#include <xgc/load.h>

#include <cstdlib>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    xgc::test::ExactBytes file(std::as_bytes(std::span(data, size)));
    xgc::DecodedSize decoded;
    (void)xgc::decodedSize(file.span(), decoded);
    xgc::test::fixChecksums(file.span());
    constexpr uint64_t kMost = 1u << 24;
    if (!xgc::decodedSize(file.span(), decoded).ok()) return 0;
    if (decoded.imageBytes > kMost || decoded.scratchBytes > kMost) return 0;
    const std::vector<std::byte> fill(std::max(decoded.imageBytes, decoded.scratchBytes), std::byte(0xcd));
    xgc::test::ExactBytes image(std::span<const std::byte>(fill).first(decoded.imageBytes));
    xgc::test::ExactBytes scratch(std::span<const std::byte>(fill).first(decoded.scratchBytes));
    if (!xgc::decode(file.span(), scratch.span(), image.span()).ok()) return 0;
    xgc::AssetView asset;
    if (!xgc::openAll(image.span(), asset).ok()) return 0;
    if (!xgc::test::drawsSafely(asset, 2, uint32_t(size))) std::abort();
    xgc::test::posesSafely(asset);
    return 0;
}
