#pragma once

#include "flags.h"
#include "surface.h"

namespace xgc::bench {

/// A surface that another program made of a model.
struct Peer {
    std::string program;
    Surface surface;
};

/// The programs that simplify a model beside xgc:
/// - meshopt_simplify of the packaged meshoptimizer, default flags, no limit on the error;
/// - gltfpack as a program (-si, no limit on the error, nothing quantised), where there is one;
/// - whatever the command of --outside runs: given the model as a PLY file, the count and an empty folder, it leaves a
///   PLY file named after each program there, as writePly makes them.
class Peers {
public:
    Peers(const Flags& flags, const std::string& model, const Surface& surface);
    ~Peers();
    Peers(const Peers&) = delete;
    Peers& operator=(const Peers&) = delete;

    /// Results of at most about `faces` faces each; a program may stop short of that.
    std::vector<Peer> at(uint32_t faces) const;

private:
    Surface meshoptimizer(uint32_t faces) const;
    bool gltfpack(uint32_t faces, Surface& out) const;
    void addOutside(uint32_t faces, std::vector<Peer>& peers) const;

    const Flags& flags_;
    const Surface& surface_;
    std::filesystem::path work_; ///< files for the programs, removed at the end
};

} // namespace xgc::bench
