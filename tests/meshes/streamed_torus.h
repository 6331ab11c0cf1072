#pragma once

#include "patched_torus.h"

#include <xgc/bake/pages.h>
#include <xgc/residency.h>

#include <algorithm>
#include <array>
#include <deque>
#include <random>

namespace xgc::test {

using Triangle = std::array<float, 9>; ///< three positions, the least first, orientation kept

inline Triangle triangleOf(std::array<glm::vec3, 3> t) {
    const auto less = [](const glm::vec3& a, const glm::vec3& b) {
        return std::lexicographical_compare(&a.x, &a.x + 3, &b.x, &b.x + 3);
    };
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
    return {t[0].x, t[0].y, t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z};
}

/// A torus in pages, and the same as it is without.
struct StreamedTorus {
    OpenAsset plain;
    bake::AlignedBytes file;
    AssetView tables;
    std::string failure;

    explicit StreamedTorus(const TorusShape& shape, const bake::PageOptions& options) {
        const Patched built = patchedTorus(shape);
        plain = openBuilt(built);
        const OpenAsset tiered = openBuilt(built, options.tiers);
        failure = plain.failure + tiered.failure;
        if (!failure.empty()) return;
        std::vector<std::byte> bytes;
        failure = bake::cutIntoPages(tiered.bytes.span(), options, bytes).message;
        if (!failure.empty()) return;
        file = bake::alignedCopy(bytes);
        if (const Status s = openTables(file.span(), tables); !s.ok()) failure = s.message;
    }
    StreamedTorus(const StreamedTorus&) = delete;
    StreamedTorus& operator=(const StreamedTorus&) = delete;
};

/// A reader of bytes in memory: late, in any order, failing and damaging as it is told.
class FakeReader {
public:
    std::span<const std::byte> file;
    uint32_t latest = 0; ///< frames that an answer may take
    uint32_t failPercent = 0, corruptPercent = 0, silentPercent = 0;
    uint64_t reads = 0, bytes = 0;

    PageReader reader() {
        return {[](void* user, const PageRequest& r) { static_cast<FakeReader*>(user)->take(r); }, this};
    }
    /// Answers what is due.
    void step(Residency& residency) {
        for (Pending& p : pending_) p.wait -= p.wait > 0;
        for (size_t i = 0; i < count_;) {
            if (pending_[i].wait > 0) {
                ++i;
                continue;
            }
            const Pending p = pending_[i];
            pending_[i] = pending_[--count_];
            const uint32_t luck = uint32_t(random_() % 100);
            if (luck < silentPercent) continue;
            const bool ok = luck >= silentPercent + failPercent;
            if (ok) std::copy_n(file.data() + p.request.offset, p.request.storedBytes, p.request.out.data());
            if (ok && luck < silentPercent + failPercent + corruptPercent)
                p.request.out[random_() % p.request.out.size()] ^= std::byte(1u << random_() % 8);
            residency.complete(p.request.ticket, ok);
        }
    }
    size_t pending() const { return count_; }

private:
    struct Pending {
        PageRequest request;
        uint32_t wait = 0;
    };
    void take(const PageRequest& request) {
        ++reads;
        bytes += request.storedBytes;
        pending_.at(count_++) = {request, latest ? uint32_t(random_() % (latest + 1)) : 0};
    }
    std::array<Pending, 1024> pending_{}; // frames allocate nothing
    size_t count_ = 0;
    std::minstd_rand random_{31};
};

} // namespace xgc::test
