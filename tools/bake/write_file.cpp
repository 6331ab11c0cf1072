#include <xgc/bake/asset_writer.h>

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

// A target is whole or untouched: the bytes go to a new file beside it, which takes its name once they are on the
// disk. Whatever interrupts the write leaves the target as it was, at worst with a stray `.tmp` file beside it.

namespace xgc::bake {
namespace {

Status failed(const char* what, const std::filesystem::path& file, int error) {
    return systemError(fmt::format("{} {}: {}", what, file.string(), std::strerror(error)));
}

/// An open file descriptor.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { (void)close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    /// 0 or the error: a full disk may show only now.
    int close() {
        const int fd = fd_;
        fd_ = -1;
        return fd >= 0 && ::close(fd) != 0 ? errno : 0;
    }

private:
    int fd_;
};

/// Returns 0 or the error.
int writeAll(int fd, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(fd, bytes.data(), std::min<size_t>(bytes.size(), size_t(1) << 30));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        bytes = bytes.subspan(size_t(count));
    }
    return 0;
}

/// Writes to a descriptor to the disk. Devices such as /dev/full know no fsync.
int writeThrough(Descriptor& out, std::span<const std::byte> bytes) {
    if (const int error = writeAll(out.get(), bytes)) return error;
    if (::fsync(out.get()) != 0 && errno != EINVAL && errno != EROFS) return errno;
    return out.close();
}

/// A device or a pipe is written in place: there is nothing to keep whole, and it must not be replaced by a file.
Status writeInPlace(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    Descriptor out(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
    if (out.get() < 0) return failed("cannot write", file, errno);
    const int error = writeThrough(out, bytes);
    return error ? failed("cannot write", file, error) : Status{};
}

/// A new file beside the target, of a name that no other process uses.
Descriptor createBeside(const std::filesystem::path& target, std::filesystem::path& temporary) {
    for (unsigned attempt = 0;; ++attempt) {
        temporary = target;
        temporary += fmt::format(".{}-{}.tmp", ::getpid(), attempt);
        const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0 || errno != EEXIST) return Descriptor(fd);
    }
}

/// Makes the new name last through a power cut, where the folder can be synchronised at all.
void syncFolder(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (fd.get() >= 0) (void)::fsync(fd.get());
}

Status replace(const std::filesystem::path& target, const struct stat* old, std::span<const std::byte> bytes) {
    std::filesystem::path temporary;
    Descriptor out = createBeside(target, temporary);
    if (out.get() < 0) return failed("cannot write beside", target, errno);
    if (old) (void)::fchmod(out.get(), old->st_mode & 07777);
    int error = writeThrough(out, bytes);
    if (!error && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error) {
        (void)::unlink(temporary.c_str());
        return failed("cannot write", target, error);
    }
    syncFolder(target);
    return {};
}

} // namespace

Status writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    struct stat info = {};
    const bool exists = ::stat(file.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode)) return failed("cannot write", file, EISDIR);
    if (exists && !S_ISREG(info.st_mode)) return writeInPlace(file, bytes);
    // A link keeps pointing to what it points to: the file behind it is the one to replace.
    std::error_code error;
    const std::filesystem::path target = exists ? std::filesystem::canonical(file, error) : file;
    return replace(error ? file : target, exists ? &info : nullptr, bytes);
}

namespace {

Status unreadable(const std::filesystem::path& file, int error) {
    return badInput(fmt::format("cannot read {}: {}", file.string(), std::strerror(error)));
}

/// Returns 0 or the error; `size` says how much there was.
int readAll(int fd, std::span<std::byte> bytes, size_t& size) {
    size = 0;
    while (size < bytes.size()) {
        const ssize_t count = ::read(fd, bytes.data() + size, std::min<size_t>(bytes.size() - size, size_t(1) << 30));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return errno;
        if (count == 0) break;
        size += size_t(count);
    }
    return 0;
}

} // namespace

Status readFile(const std::filesystem::path& file, AlignedBytes& out) {
    const Descriptor in(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat info = {};
    if (in.get() < 0 || ::fstat(in.get(), &info) != 0) return unreadable(file, errno);
    if (S_ISDIR(info.st_mode)) return unreadable(file, EISDIR);
    if (!S_ISREG(info.st_mode)) return badInput(fmt::format("cannot read {}: not a regular file", file.string()));
    if (info.st_size == 0) return badInput(fmt::format("cannot read {}: the file is empty", file.string()));
    AlignedBytes bytes;
    bytes.blocks.resize((size_t(info.st_size) + sizeof(AlignedBytes::Block) - 1) / sizeof(AlignedBytes::Block));
    const std::span<std::byte> memory(reinterpret_cast<std::byte*>(bytes.blocks.data()), size_t(info.st_size));
    if (const int error = readAll(in.get(), memory, bytes.size)) return unreadable(file, error);
    out = std::move(bytes);
    return {};
}

} // namespace xgc::bake
