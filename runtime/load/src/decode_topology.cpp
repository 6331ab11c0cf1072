#include "decode.h"

#include <algorithm>
#include <utility>

// Faces in the order of a vertex cache mostly share an edge with one of the last few. A patch is decoded face by face:
//
//   code     high 4 bits: 0..14, how many edges ago the shared edge was met; 15, none is shared
//            low 4 bits:  the third corner: 0 a new slot, 1..14 how many vertices ago it was met, 15 far
//   misses   where no edge is shared: first and second corner, coded as the third is
//   far      zigzag difference to the far corner before, in order of first use
//
// A new slot comes from one of the patch's runs: interior slots that are first used in rising order. Rows of one
// collapse level are, so that the run, a byte, tells the slot. Slots in no run are stray and stored.

namespace xgc::load {
namespace {

using namespace format;

constexpr uint32_t kStray = 255;
constexpr uint32_t kHistory = 16;

uint32_t unzigzag(uint32_t z) {
    return (z >> 1) ^ (0u - (z & 1));
}

/// Numbers whose bytes of equal weight lie together.
template <typename Slot>
struct Planes {
    const uint8_t* bytes = nullptr;
    size_t count = 0;

    uint32_t operator[](size_t i) const {
        uint32_t value = 0;
        for (size_t p = 0; p < sizeof(Slot); ++p) value |= uint32_t(bytes[p * count + i]) << (8 * p);
        return value;
    }
};

/// The unpacked parts of a stream of Codec::faces.
template <typename Slot>
struct FaceCodes {
    std::span<const uint8_t> codes, misses, runs, runTable, rotations;
    Planes<Slot> far, strays;
};

template <typename Slot>
uint64_t faceWorkBytes(const FacesHeader& h, uint64_t faceCount, uint64_t slotCount) {
    const uint64_t rotations = h.flags & kRotations ? faceCount : 0;
    return faceCount + h.missCount + slotCount + h.runBytes + rotations +
           (uint64_t(h.farCount) + h.strayCount) * sizeof(Slot);
}

template <typename Slot>
FaceCodes<Slot> split(std::span<const std::byte> work, const FacesHeader& h, size_t faceCount, size_t slotCount) {
    const auto* at = reinterpret_cast<const uint8_t*>(work.data());
    const auto take = [&](size_t size) { return std::span(std::exchange(at, at + size), size); };
    FaceCodes<Slot> c;
    c.codes = take(faceCount);
    c.misses = take(h.missCount);
    c.far = {take(h.farCount * sizeof(Slot)).data(), h.farCount};
    c.runs = take(slotCount);
    c.strays = {take(h.strayCount * sizeof(Slot)).data(), h.strayCount};
    c.runTable = take(h.runBytes);
    c.rotations = take(h.flags & kRotations ? faceCount : 0);
    return c;
}

/// Decodes patch after patch; the first damage sticks.
template <typename Slot>
class FaceDecoder {
public:
    explicit FaceDecoder(const FaceCodes<Slot>& codes) : c_(codes) {}

    /// `slots` receives the patch's slots in order of first use.
    bool patch(uint32_t interiorSlot, std::span<uint32_t> slots, std::span<Slot> corners) {
        slots_ = slots;
        used_ = 0;
        lastFar_ = 0;
        std::fill(std::begin(edges_), std::end(edges_), Edge{0, 0});
        std::fill(std::begin(vertices_), std::end(vertices_), 0u);
        edgeCount_ = vertexCount_ = 0;
        if (!readRuns(interiorSlot)) return false;
        for (size_t i = 0; i < corners.size(); i += 3) {
            if (!face(&corners[i])) return false;
        }
        while (used_ < slots_.size()) {
            if (!isNumber(newSlot())) return false;
        }
        return true;
    }

    bool isFinished() const {
        return miss_ == c_.misses.size() && far_ == c_.far.count && stray_ == c_.strays.count &&
               table_ == c_.runTable.size();
    }

private:
    struct Edge {
        uint32_t a, b;
    };
    static constexpr uint32_t kDamaged = 0xffffffffu;
    static bool isNumber(uint32_t slot) { return slot != kDamaged; }

    bool readRuns(uint32_t first) {
        if (table_ == c_.runTable.size()) return false;
        const uint32_t count = c_.runTable[table_++];
        if (count == kStray || c_.runTable.size() - table_ < count * sizeof(Slot)) return false;
        std::fill(std::begin(cursor_), std::end(cursor_), 0u);
        std::fill(std::begin(end_), std::end(end_), 0u);
        uint64_t end = first;
        for (uint32_t run = 0; run < count; ++run) {
            Slot length = 0;
            std::memcpy(&length, c_.runTable.data() + table_, sizeof length);
            table_ += sizeof length;
            cursor_[run] = uint32_t(end);
            end += length;
            if (end > slots_.size()) return false;
            end_[run] = uint32_t(end);
        }
        return true;
    }

    uint32_t newSlot() {
        if (used_ == slots_.size()) return kDamaged;
        const uint8_t run = c_.runs[symbol_++];
        uint32_t slot = 0;
        if (run != kStray) {
            if (cursor_[run] == end_[run]) return kDamaged;
            slot = cursor_[run]++;
        } else {
            if (stray_ == c_.strays.count) return kDamaged;
            slot = c_.strays[stray_++];
            if (slot >= slots_.size()) return kDamaged;
        }
        slots_[used_++] = slot;
        return slot;
    }

    uint32_t farSlot() {
        if (far_ == c_.far.count) return kDamaged;
        lastFar_ += unzigzag(c_.far[far_++]);
        if (lastFar_ >= used_) return kDamaged;
        return slots_[lastFar_];
    }

    uint32_t vertex(uint32_t code) {
        if (code - 1 < 14) return vertices_[(vertexCount_ - code) % kHistory];
        const uint32_t slot = code == 0 ? newSlot() : farSlot();
        vertices_[vertexCount_++ % kHistory] = slot;
        return slot;
    }

    void meet(uint32_t a, uint32_t b) { edges_[edgeCount_++ % kHistory] = {a, b}; }

    bool face(Slot* out) {
        const uint8_t code = c_.codes[face_];
        uint32_t a = 0, b = 0, c = 0;
        if (code < 0xf0) {
            const Edge shared = edges_[(edgeCount_ - 1 - (code >> 4)) % kHistory];
            a = shared.a;
            b = shared.b;
            c = vertex(code & 15);
        } else {
            if (miss_ == c_.misses.size()) return false;
            const uint8_t pair = c_.misses[miss_++];
            a = vertex(pair >> 4);
            b = vertex(pair & 15);
            c = vertex(code & 15);
            meet(b, a);
            if (!isNumber(a) || !isNumber(b)) return false;
        }
        if (!isNumber(c)) return false;
        meet(c, b);
        meet(a, c);
        store(a, b, c, out);
        ++face_;
        return true;
    }

    void store(uint32_t a, uint32_t b, uint32_t c, Slot* out) const {
        const uint32_t low = std::min(a, std::min(b, c));
        uint32_t turn = low == a ? 0 : low == b ? 1 : 2;
        if (!c_.rotations.empty()) turn = c_.rotations[face_] % 3;
        const uint32_t corners[5] = {a, b, c, a, b};
        for (uint32_t k = 0; k < 3; ++k) out[k] = Slot(corners[turn + k]);
    }

    const FaceCodes<Slot>& c_;
    size_t face_ = 0, miss_ = 0, far_ = 0, stray_ = 0, symbol_ = 0, table_ = 0;
    std::span<uint32_t> slots_; // of this patch
    uint32_t used_ = 0, lastFar_ = 0, edgeCount_ = 0, vertexCount_ = 0;
    uint32_t cursor_[256], end_[256];
    Edge edges_[kHistory];
    uint32_t vertices_[kHistory];
};

constexpr bool isWidth(const PatchRecord& patch, size_t slotBytes) {
    return bool(patch.flags & kWideSlots) == (slotBytes == 4);
}

uint64_t faceCountOf(const PatchRecord& patch) {
    return uint64_t(patch.interiorFaceCount) + patch.boundaryFaceCount;
}

} // namespace

template <typename Slot>
bool decodeFaces(const Decoding& d, std::span<const std::byte> stored, std::span<uint32_t> slots,
                 std::span<Slot> corners) {
    FacesHeader header;
    if (!readHeader(stored, header) || corners.size() % 3 != 0) return false;
    const uint64_t size = faceWorkBytes<Slot>(header, corners.size() / 3, slots.size());
    if (size > d.work.size() || !d.inflater.inflate(stored, d.work.first(size))) return false;
    const FaceCodes<Slot> codes = split<Slot>(d.work, header, corners.size() / 3, slots.size());
    FaceDecoder<Slot> decoder(codes);
    for (uint32_t p = 0; p < d.view.patchCount(); ++p) {
        const PatchRecord& patch = d.view.patches[p];
        if (!isWidth(patch, sizeof(Slot))) continue;
        const uint64_t count = 3 * faceCountOf(patch);
        if (patch.firstCorner + count > corners.size() || uint64_t(patch.firstParent) + patch.slotCount > slots.size())
            return false;
        const uint32_t interior = patch.slotCount - d.view.interiorRange(p).count;
        if (!decoder.patch(interior, slots.subspan(patch.firstParent, patch.slotCount),
                           corners.subspan(patch.firstCorner, count)))
            return false;
    }
    return decoder.isFinished();
}

template <typename Slot>
bool decodeParents(const Decoding& d, std::span<const std::byte> stored, std::span<const uint32_t> slots,
                   std::span<Slot> parents) {
    const uint64_t size = uint64_t(parents.size()) * sizeof(Slot);
    if (parents.size() != slots.size() || size > d.work.size() || !d.inflater.inflate(stored, d.work.first(size)))
        return false;
    const Planes<Slot> distances = {reinterpret_cast<const uint8_t*>(d.work.data()), parents.size()};
    std::fill(parents.begin(), parents.end(), Slot(0)); // slots named twice leave others out
    for (const PatchRecord& patch : d.view.patches) {
        if (!isWidth(patch, sizeof(Slot))) continue;
        if (uint64_t(patch.firstParent) + patch.slotCount > slots.size()) return false;
        const uint32_t* slotAt = slots.data() + patch.firstParent;
        for (uint32_t i = 0; i < patch.slotCount; ++i) {
            const uint32_t parent = i - unzigzag(distances[patch.firstParent + i]);
            if (parent >= patch.slotCount) return false;
            parents[patch.firstParent + slotAt[i]] = Slot(slotAt[parent]);
        }
    }
    return true;
}

uint64_t facesWorkBytes(const StreamRecord& stream, std::span<const std::byte> stored, uint64_t slotCount) {
    FacesHeader header;
    if (!readHeader(stored, header)) return 0;
    return stream.stride == 4 ? faceWorkBytes<uint32_t>(header, stream.count / 3, slotCount)
                              : faceWorkBytes<uint16_t>(header, stream.count / 3, slotCount);
}

template bool decodeFaces(const Decoding&, std::span<const std::byte>, std::span<uint32_t>, std::span<uint16_t>);
template bool decodeFaces(const Decoding&, std::span<const std::byte>, std::span<uint32_t>, std::span<uint32_t>);
template bool decodeParents(const Decoding&, std::span<const std::byte>, std::span<const uint32_t>,
                            std::span<uint16_t>);
template bool decodeParents(const Decoding&, std::span<const std::byte>, std::span<const uint32_t>,
                            std::span<uint32_t>);

namespace {

/// Rows of one patch's slots, group by group.
template <typename Slot>
class PatchReferences {
public:
    PatchReferences(const AssetView& view, uint32_t patch, const Slot* parents, std::span<uint32_t> references)
        : view_(view), patch_(patch), domains_(view.domainsOf(patch)), firstSlots_(view.domainSlotsOf(patch)),
          parents_(parents), references_(references) {}

    bool find() {
        for (uint32_t i = 0; i < domains_.size(); ++i) {
            // All patches of a domain agree on it: one is enough.
            if (view_.patchesOf(domains_[i]).front() != patch_) continue;
            if (!group(firstSlots_[i], view_.domainRange(domains_[i]))) return false;
        }
        const VertexRange interior = view_.interiorRange(patch_);
        return group(view_.patches[patch_].slotCount - interior.count, interior);
    }

private:
    bool group(uint32_t firstSlot, VertexRange range) {
        for (uint32_t i = 0; i < range.count; ++i) {
            const uint32_t row = range.first + i, slot = firstSlot + i, parent = parents_[slot];
            if (parent == slot) {
                references_[row] = row > 0 ? row - 1 : 0;
                continue;
            }
            if (parent > slot) return false;
            const uint32_t reference = parent >= firstSlot ? row - (slot - parent) : rowOf(parent);
            if (reference >= row) return false;
            references_[row] = reference;
        }
        return true;
    }

    /// Of a slot in a domain; only lower slots are asked for.
    uint32_t rowOf(uint32_t slot) const {
        const auto* after = std::upper_bound(firstSlots_.data(), firstSlots_.data() + firstSlots_.size(), slot);
        const auto i = size_t(after - firstSlots_.data()) - 1;
        return view_.domainRange(domains_[i]).first + slot - firstSlots_[i];
    }

    const AssetView& view_;
    uint32_t patch_;
    std::span<const uint32_t> domains_, firstSlots_;
    const Slot* parents_;
    std::span<uint32_t> references_;
};

} // namespace

bool findReferences(const Decoding& d, std::span<const uint16_t> narrow, std::span<const uint32_t> wide) {
    for (uint32_t p = 0; p < d.view.patchCount(); ++p) {
        const PatchRecord& patch = d.view.patches[p];
        const uint64_t end = uint64_t(patch.firstParent) + patch.slotCount;
        if (end > (isWide(patch) ? wide.size() : narrow.size())) return false;
        const bool found = isWide(patch)
                               ? PatchReferences(d.view, p, wide.data() + patch.firstParent, d.references).find()
                               : PatchReferences(d.view, p, narrow.data() + patch.firstParent, d.references).find();
        if (!found) return false;
    }
    return true;
}

} // namespace xgc::load
