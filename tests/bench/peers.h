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
/// - programs outside, through the exchange folder: <model>.<count>.<program>.ply.
class Peers {
public:
    Peers(const Flags& flags, std::string model, const Surface& surface);

    /// Results of at most about `faces` faces each; a program may stop short of that.
    std::vector<Peer> at(uint32_t faces) const;
    /// Asks programs outside for a count.
    void request(uint32_t faces) const;

private:
    Surface meshoptimizer(uint32_t faces) const;
    bool gltfpack(uint32_t faces, Surface& out) const;

    const Flags& flags_;
    std::string model_;
    const Surface& surface_;
    std::filesystem::path work_; ///< files for gltfpack
};

} // namespace xgc::bench
