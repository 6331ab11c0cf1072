#include <import/input_file.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace xgc::bake {

namespace {

/// Only regular files are opened: a pipe or a device could keep the reader waiting for ever.
Status checkRegular(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    using std::filesystem::file_type;
    if (status.type() == file_type::not_found)
        return badInput(fmt::format("{}: no such file; check the path", file.string()));
    if (status.type() == file_type::none)
        return badInput(fmt::format("{}: {}; check the path and its permissions", file.string(), error.message()));
    if (status.type() == file_type::directory)
        return badInput(fmt::format("{}: this is a directory; give a model file in it", file.string()));
    if (status.type() != file_type::regular)
        return badInput(fmt::format("{}: not a regular file; copy its contents to one", file.string()));
    return {};
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

} // namespace

Status readInputFile(const std::filesystem::path& file, std::vector<std::byte>& out) {
    if (Status s = checkRegular(file); !s.ok()) return s;
    const std::unique_ptr<std::FILE, CloseFile> stream(std::fopen(file.c_str(), "rb"));
    if (!stream)
        return badInput(
            fmt::format("{}: cannot be opened ({}); check its permissions", file.string(), std::strerror(errno)));
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) return systemError(fmt::format("{}: {}", file.string(), error.message()));
    if (size == 0) return badInput(fmt::format("{}: the file is empty; export it again", file.string()));
    std::vector<std::byte> bytes(size);
    if (std::fread(bytes.data(), 1, bytes.size(), stream.get()) != bytes.size())
        return systemError(fmt::format("{}: reading stopped before its end; check the disk", file.string()));
    out = std::move(bytes);
    return {};
}

} // namespace xgc::bake
