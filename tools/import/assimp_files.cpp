#include <import/assimp_files.h>

#include <import/input_file.h>

#include <assimp/IOStream.hpp>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

namespace xgc::bake {

namespace {

class ByteStream : public Assimp::IOStream {
public:
    explicit ByteStream(std::span<const std::byte> bytes) : bytes_(bytes) {}
    explicit ByteStream(std::vector<std::byte>&& bytes) : owned_(std::move(bytes)), bytes_(owned_) {}

    size_t Read(void* to, size_t size, size_t count) override {
        if (size == 0) return 0;
        const size_t whole = std::min(count, (bytes_.size() - at_) / size);
        if (whole > 0) std::memcpy(to, bytes_.data() + at_, whole * size);
        at_ += whole * size;
        return whole;
    }
    size_t Write(const void*, size_t, size_t) override { return 0; }
    aiReturn Seek(size_t offset, aiOrigin origin) override {
        const size_t base = origin == aiOrigin_CUR ? at_ : origin == aiOrigin_END ? bytes_.size() : 0;
        if (origin == aiOrigin_END ? offset > base : offset > bytes_.size() - base) return aiReturn_FAILURE;
        at_ = origin == aiOrigin_END ? base - offset : base + offset;
        return aiReturn_SUCCESS;
    }
    size_t Tell() const override { return at_; }
    size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

private:
    std::vector<std::byte> owned_;
    std::span<const std::byte> bytes_;
    size_t at_ = 0;
};

} // namespace

bool AssimpFiles::Exists(const char* file) const {
    std::error_code error;
    return file == mainName_ || (source_.siblings && std::filesystem::is_regular_file(file, error));
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
    if (file == mainName_) return new ByteStream(source_.bytes);
    std::vector<std::byte> bytes;
    if (!source_.siblings || !readInputFile(file, bytes).ok()) return nullptr;
    return new ByteStream(std::move(bytes));
}

void AssimpFiles::Close(Assimp::IOStream* stream) {
    delete stream;
}

} // namespace xgc::bake
