#pragma once

#include <xgc/bake/asset_writer.h>
#include <xgc/draw_list.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace xgc::bake {

/// What a frame came to: XXH64 over what a renderer was given.
struct FlightHashes {
    uint64_t levels = 0; ///< kinds, levels and visible patches of all instances
    uint64_t draws = 0;  ///< draw commands, their sources, batches and instances
    uint64_t copies = 0; ///< copy ranges, and the bytes that they copy

    bool operator==(const FlightHashes&) const = default;
};

/// A flight that was recorded: assets, where they stand, what each frame asked for, and what it came to. Made to tell
/// whether another build, machine or version does the same, and to play a user's trouble again.
struct Flight {
    struct Asset {
        std::string file;  ///< as given, or beside the flight
        uint64_t hash = 0; ///< XXH64 of its image
    };
    struct Instance {
        uint32_t asset = 0;
        glm::mat4x3 toWorld{1};
    };
    struct Frame {
        SelectionDesc desc; ///< without reference and jobs; its bands are in `bands`
        std::vector<float> bands;
        FlightHashes hashes;
        uint64_t triangles = 0;
    };

    std::vector<Asset> assets;
    std::vector<Instance> instances;
    uint32_t arenaBytes = 64u << 20;   ///< IndexCacheConfig::arenaBytes
    uint32_t stagingBytes = 16u << 20; ///< of each frame: the cap of its uploads
    std::vector<Frame> frames;
};

/// XXH64 of the image that an asset was opened from.
uint64_t imageHash(const AssetView& asset);

/// JSON. Reading checks everything, and the message names file, element and remedy.
Status writeFlight(const Flight& flight, const std::filesystem::path& file);
Status readFlight(const std::filesystem::path& file, Flight& out);

/// The runtime without a renderer, frame by frame: what recording hashes, and replaying compares.
class FlightPlayer {
public:
    FlightPlayer();
    ~FlightPlayer();
    FlightPlayer(FlightPlayer&&) noexcept;

    /// `views`: of the flight's assets, which outlive the player. The flight's frames are not looked at.
    Status create(const Flight& flight, std::span<const AssetView* const> views);
    /// Hashes and triangles of one more frame.
    FlightHashes play(const SelectionDesc& desc, uint64_t& triangles);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Plays all frames. `differing`: numbers of those whose hashes are others than recorded.
Status replayFlight(const Flight& flight, std::span<const AssetView* const> views, std::vector<uint32_t>& differing);

} // namespace xgc::bake
