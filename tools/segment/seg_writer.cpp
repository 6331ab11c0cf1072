#include <xgc/bake/asset_writer.h>
#include <xgc/bake/segment.h>

namespace xgc::bake {

Status writeSegFile(const std::filesystem::path& file, std::span<const uint32_t> inputLabels) {
    std::string text;
    for (const uint32_t label : inputLabels) {
        text += std::to_string(label);
        text += '\n';
    }
    return writeFileAtomically(file, std::as_bytes(std::span(text)));
}

} // namespace xgc::bake
