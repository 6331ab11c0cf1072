#include <xgc/bake/segment.h>

#include <cstdlib>

/// Any bytes as a `.seg` file: refused with a message that starts with the name, or read in full.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr uint32_t kFaces = 4;
    constexpr uint32_t kUntouched = 77;
    std::vector<uint32_t> labels{kUntouched};
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const xgc::bake::Status status = xgc::bake::parseSeg(text, "fuzz.seg", kFaces, labels);
    const bool whole = status.ok()
                           ? labels.size() == kFaces && status.message.empty()
                           : labels == std::vector<uint32_t>{kUntouched} && status.message.starts_with("fuzz.seg");
    if (!whole) std::abort();
    return 0;
}
