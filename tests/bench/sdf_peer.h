#pragma once

#include <filesystem>

namespace xgc::bench {

/// CGAL's shape diameter segmentation, timed in a program of its own (cgal/peer_sdf.cpp says why).
class SdfPeer {
public:
    /// `bench`: the program that asks; peer_sdf was built into the same folder, or is not there.
    explicit SdfPeer(const std::filesystem::path& bench) : program_(bench.parent_path() / "peer_sdf") {}

    bool isThere() const { return std::filesystem::exists(program_); }
    /// Of the processor, on one thread, without reading and writing; below 0 where it fails.
    double seconds(const std::filesystem::path& off) const;

private:
    std::filesystem::path program_;
};

} // namespace xgc::bench
