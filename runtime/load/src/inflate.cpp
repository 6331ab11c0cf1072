#include "decode.h"

#include <zstd.h>

namespace xgc::load {

Inflater::~Inflater() {
    ZSTD_freeDCtx(context_);
}

bool Inflater::inflate(std::span<const std::byte> frame, std::span<std::byte> out) {
    if (!context_) context_ = ZSTD_createDCtx();
    if (!context_) return false;
    return ZSTD_decompressDCtx(context_, out.data(), out.size(), frame.data(), frame.size()) == out.size();
}

} // namespace xgc::load
