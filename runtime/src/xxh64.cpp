#include "xxh64.h"

#include <bit>
#include <cassert>
#include <cstring>

namespace xgc {
namespace {

constexpr uint64_t kPrime1 = 0x9E3779B185EBCA87, kPrime2 = 0xC2B2AE3D27D4EB4F, kPrime3 = 0x165667B19E3779F9,
                   kPrime4 = 0x85EBCA77C2B2AE63, kPrime5 = 0x27D4EB2F165667C5;
constexpr size_t kStripe = 32;

static_assert(std::endian::native == std::endian::little, "the format is read in place, little-endian");

template <typename T>
T load(const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

uint64_t round(uint64_t lane, uint64_t input) {
    return std::rotl(lane + input * kPrime2, 31) * kPrime1;
}

struct Lanes {
    uint64_t lane[4] = {kPrime1 + kPrime2, kPrime2, 0, 0 - kPrime1};

    /// Consumes the whole stripes; returns how many bytes they are.
    size_t consume(std::span<const std::byte> bytes) {
        size_t at = 0;
        for (; at + kStripe <= bytes.size(); at += kStripe) {
            for (size_t i = 0; i < 4; ++i) lane[i] = round(lane[i], load<uint64_t>(bytes.data() + at + 8 * i));
        }
        return at;
    }

    uint64_t merged() const {
        uint64_t hash = std::rotl(lane[0], 1) + std::rotl(lane[1], 7) + std::rotl(lane[2], 12) + std::rotl(lane[3], 18);
        for (const uint64_t l : lane) hash = (hash ^ round(0, l)) * kPrime1 + kPrime4;
        return hash;
    }
};

/// Mixes in the bytes behind the last whole stripe, and finishes.
uint64_t finish(uint64_t hash, std::span<const std::byte> rest) {
    size_t at = 0;
    for (; at + 8 <= rest.size(); at += 8) {
        hash = std::rotl(hash ^ round(0, load<uint64_t>(rest.data() + at)), 27) * kPrime1 + kPrime4;
    }
    if (at + 4 <= rest.size()) {
        hash = std::rotl(hash ^ (load<uint32_t>(rest.data() + at) * kPrime1), 23) * kPrime2 + kPrime3;
        at += 4;
    }
    for (; at < rest.size(); ++at) hash = std::rotl(hash ^ (uint64_t(rest[at]) * kPrime5), 11) * kPrime1;
    hash = (hash ^ (hash >> 33)) * kPrime2;
    hash = (hash ^ (hash >> 29)) * kPrime3;
    return hash ^ (hash >> 32);
}

} // namespace

uint64_t xxh64(std::span<const std::byte> bytes) {
    return xxh64({}, bytes);
}

uint64_t xxh64(std::span<const std::byte> head, std::span<const std::byte> tail) {
    assert(head.size() % kStripe == 0);
    Lanes lanes;
    lanes.consume(head);
    const size_t used = lanes.consume(tail);
    const uint64_t total = head.size() + tail.size();
    return finish((total >= kStripe ? lanes.merged() : kPrime5) + total, tail.subspan(used));
}

} // namespace xgc
