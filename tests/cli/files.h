#pragma once

#include "process.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// Folders, files and the subcommands that read them, for the tests of the command line.
namespace xgc::test {

/// An empty folder for one test case; removed at the end.
class Folder {
public:
    explicit Folder(const std::string& name);
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::string file(const std::string& name) const { return (path_ / name).string(); }
    /// Names of all that is in it, in order.
    std::vector<std::string> names() const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::string readText(const std::string& file);
void writeText(const std::string& file, std::string_view text);

/// A closed model of 12 n^2 triangles as OBJ text.
std::string cubeObj(uint32_t n);
/// The bytes of that model, baked; made once.
const std::string& bakedCube();

/// A way to call xgc that reads one file: "{in}" stands for it, "{out}" for a file to write, "{model}" and "{asset}"
/// for good ones.
struct Call {
    std::vector<std::string> arguments;
    std::string outputExtension; ///< "" where nothing is written
};

/// Calls whose {in} is a model file, an asset, or labels of faces.
std::span<const Call> modelCalls();
std::span<const Call> assetCalls();
std::span<const Call> labelCalls();

/// Runs a call in a folder. The model and the asset are made in it when the call names them.
RunResult runCall(const Call& call, const Folder& folder, const std::string& in, const std::string& out = "",
                  const RunOptions& options = {});

/// The call must fail with `exitCode`, name `file` on stderr, print nothing on stdout and leave its output alone.
void checkRefused(const Call& call, const std::string& in, const Folder& folder, int exitCode = 3);

} // namespace xgc::test
