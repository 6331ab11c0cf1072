#pragma once

#include <xgc/bake/asset_writer.h>
#include <xgc/residency.h>

#include <deque>
#include <filesystem>
#include <fstream>
#include <vector>

namespace xgc::scene_sample {

/// Files that are read page by page, no more bytes a frame than a disk of that speed gives. An engine reads in a thread
/// and calls Residency::complete from there.
class Pages {
public:
    /// Opens the tables of the files; `share` of the bytes of all their pages is the residency's budget.
    bake::Status open(const std::vector<std::filesystem::path>& files, double share);

    Residency& residency() { return residency_; }
    const Residency& residency() const { return residency_; }
    /// The residency's asset of a file.
    uint32_t asset(size_t file) const { return files_[file].asset; }
    uint64_t sceneBytes() const { return sceneBytes_; }

    /// Answers as many requests as a frame's bytes allow.
    void read(uint64_t bytes);

private:
    struct File {
        std::ifstream in;
        bake::AlignedBytes bytes; ///< of its tables
        AssetView tables;
        uint32_t asset = 0;
    };
    static bake::Status openTables(const std::filesystem::path& path, File& file);
    bool readPage(const PageRequest& request);

    std::vector<File> files_;
    Residency residency_;
    std::deque<PageRequest> queue_;
    std::vector<std::byte> stored_;
    uint64_t sceneBytes_ = 0, credit_ = 0;
};

} // namespace xgc::scene_sample
