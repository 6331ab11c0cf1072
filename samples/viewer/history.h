#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace xgc::viewer {

/// The latest values of something that is measured each frame, the oldest first.
template <uint32_t kCapacity>
class History {
public:
    void add(float value) {
        values_[next_] = value;
        next_ = (next_ + 1) % kCapacity;
        count_ = std::min(count_ + 1, kCapacity);
    }
    uint32_t count() const { return count_; }
    /// i-th oldest, below count().
    float at(uint32_t i) const { return values_[(next_ + kCapacity - count_ + i) % kCapacity]; }
    float latest() const { return count_ > 0 ? at(count_ - 1) : 0; }
    float largest() const {
        float out = 0;
        for (uint32_t i = 0; i < count_; ++i) out = std::max(out, at(i));
        return out;
    }

private:
    std::array<float, kCapacity> values_{};
    uint32_t next_ = 0;
    uint32_t count_ = 0;
};

/// The least of 1, 2 and 5 times a power of ten that holds the value: the top of a graph that does not wobble.
inline float niceCeiling(float value) {
    float power = 1;
    while (power < value && power < 1e30f) power *= 10;
    if (0.2f * power >= value && power > 1) return 0.2f * power;
    if (0.5f * power >= value && power > 1) return 0.5f * power;
    return power;
}

} // namespace xgc::viewer
