#include <xgc/bake/asset_writer.h>
#include <xgc/bake/image.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace xgc::bake {

Status writePng(const Image& image, const std::filesystem::path& file) {
    std::vector<std::byte> bytes;
    const auto append = [](void* context, void* data, int size) {
        const auto* first = static_cast<const std::byte*>(data);
        static_cast<std::vector<std::byte>*>(context)->insert(static_cast<std::vector<std::byte>*>(context)->end(),
                                                              first, first + size);
    };
    const int made = stbi_write_png_to_func(append, &bytes, int(image.width), int(image.height), 4, image.pixels.data(),
                                            int(image.width * 4));
    if (made == 0 || bytes.empty()) return systemError(file.string() + ": the picture could not be encoded");
    return writeFileAtomically(file, bytes);
}

} // namespace xgc::bake
