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
constexpr uint32_t kFar = 15;
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

/// The faces of one patch, from its slots in order of first use. What kind a corner is cannot be foreseen, so that
/// branches would be missed: all kinds are looked up and one is chosen. Lookups may read a few elements past a table
/// (`kSlack`) before the damage is noticed. An object of its own in `decodePatch`, so that it lives in registers.
template <typename Slot>
struct FaceLoop {
    struct Edge {
        uint32_t a, b;
    };

    const uint32_t* slots;
    const uint8_t* misses;
    const uint8_t* farBytes;
    size_t farCount;
    uint32_t used = 0, far = 0, lastFar = 0, edgeCount = 0, vertexCount = 0;
    uint32_t isDamaged = 0;
    Edge edges[kHistory] = {};
    uint32_t vertices[kHistory] = {};

    uint32_t vertex(uint32_t code) {
        // All ones where the vertex is new, or far; compilers make branches of anything but masks.
        const auto isNew = uint32_t(int32_t(code - 1) >> 31), isFar = uint32_t(int32_t(kFar - 1 - code) >> 31);
        uint32_t z = farBytes[far];
        for (size_t p = 1; p < sizeof(Slot); ++p) z |= uint32_t(farBytes[p * farCount + far]) << (8 * p);
        const uint32_t farRank = lastFar + (unzigzag(z) & isFar);
        const auto isKnown = uint32_t((int64_t(farRank) - int64_t(used)) >> 63);
        const uint32_t rank = (used & isNew) | (farRank & isFar & isKnown), isListed = isNew | isFar;
        const uint32_t recent = vertices[(vertexCount - code) % kHistory];
        const uint32_t slot = recent ^ ((recent ^ slots[rank]) & isListed);
        isDamaged |= isFar & ~isKnown;
        lastFar = farRank;
        used -= isNew;
        far -= isFar;
        vertices[vertexCount % kHistory] = slot; // the next takes its place where it is an old one
        vertexCount -= isListed;
        return slot;
    }

    void meet(uint32_t a, uint32_t b) { edges[edgeCount++ % kHistory] = {a, b}; }

    glm::uvec3 face(uint8_t code) {
        uint32_t a = 0, b = 0;
        if (code < 0xf0) {
            const Edge shared = edges[(edgeCount - 1 - (code >> 4)) % kHistory];
            a = shared.a;
            b = shared.b;
        } else {
            const uint8_t pair = *misses++;
            a = vertex(pair >> 4);
            b = vertex(pair & 15);
            meet(b, a);
        }
        const uint32_t c = vertex(code & 15);
        meet(c, b);
        meet(a, c);
        return {a, b, c};
    }
};

/// The corners from the `by`-th on.
template <typename Slot>
void store(const glm::uvec3& f, bool fromSecond, bool fromThird, Slot* out) {
    out[0] = Slot(fromThird ? f.z : fromSecond ? f.y : f.x);
    out[1] = Slot(fromThird ? f.x : fromSecond ? f.z : f.y);
    out[2] = Slot(fromThird ? f.y : fromSecond ? f.x : f.z);
}

/// Decodes patch after patch.
template <typename Slot>
class FaceDecoder {
public:
    explicit FaceDecoder(const FaceCodes<Slot>& codes) : c_(codes) {}

    /// `slots` receives the patch's slots in order of first use.
    bool patch(uint32_t interiorSlot, std::span<uint32_t> slots, std::span<Slot> corners) {
        return readRuns(interiorSlot, uint32_t(slots.size())) && orderSlots(slots) && faces(slots, corners);
    }

    bool isFinished() const {
        return miss_ == c_.misses.size() && far_ == c_.far.count && stray_ == c_.strays.count &&
               table_ == c_.runTable.size();
    }

private:
    bool readRuns(uint32_t first, uint32_t slotCount) {
        if (table_ == c_.runTable.size()) return false;
        const uint32_t count = c_.runTable[table_++];
        if (count == kStray || c_.runTable.size() - table_ < count * sizeof(Slot)) return false;
        std::fill(std::begin(cursor_), std::end(cursor_), slotCount); // no slot: damaged if it is asked for
        uint64_t start = first;
        for (uint32_t run = 0; run < count; ++run) {
            Slot length = 0;
            std::memcpy(&length, c_.runTable.data() + table_, sizeof length);
            table_ += sizeof length;
            cursor_[run] = uint32_t(start);
            start += length;
            if (start > slotCount) return false;
        }
        return true;
    }

    /// The patch's slots in order of first use. A run may overrun into the next: what is decoded then is wrong, and
    /// `openAll` will say so, but every slot is one of the patch.
    bool orderSlots(std::span<uint32_t> slots) {
        size_t strays = stray_;
        uint32_t largest = 0;
        for (uint32_t& out : slots) {
            const uint8_t run = c_.runs[symbol_++];
            const bool isStray = run == kStray;
            const uint32_t stray = c_.strays[std::min(strays, c_.strays.count)], inRun = cursor_[run]++;
            const uint32_t slot = isStray ? stray : inRun;
            strays += isStray;
            largest = std::max(largest, slot);
            out = slot;
        }
        stray_ = strays;
        return strays <= c_.strays.count && (slots.empty() || largest < slots.size());
    }

    bool faces(std::span<const uint32_t> slots, std::span<Slot> corners) {
        const size_t missesLeft = c_.misses.size() - miss_, farLeft = c_.far.count - far_, count = corners.size() / 3;
        FaceLoop<Slot> loop{slots.data(), c_.misses.data() + miss_, c_.far.bytes + far_, c_.far.count};
        const uint8_t* const firstMiss = loop.misses;
        const uint8_t* codes = c_.codes.data() + face_;
        Slot* out = corners.data();
        for (size_t i = 0; i < count; ++i, out += 3) {
            const glm::uvec3 f = loop.face(codes[i]);
            const uint32_t low = std::min(f.x, std::min(f.y, f.z));
            if (c_.rotations.empty())
                store(f, low == f.y, low == f.z, out);
            else
                store(f, c_.rotations[face_ + i] == 1, c_.rotations[face_ + i] == 2, out);
            if (loop.used > slots.size() || loop.far > farLeft || size_t(loop.misses - firstMiss) > missesLeft)
                return false;
        }
        face_ += count;
        miss_ += size_t(loop.misses - firstMiss);
        far_ += loop.far;
        return loop.isDamaged == 0;
    }

    const FaceCodes<Slot>& c_;
    size_t face_ = 0, miss_ = 0, far_ = 0, stray_ = 0, symbol_ = 0, table_ = 0;
    uint32_t cursor_[256];
};

constexpr bool isWidth(const PatchRecord& patch, size_t slotBytes) {
    return bool(patch.flags & kWideSlots) == (slotBytes == 4);
}

uint64_t faceCountOf(const PatchRecord& patch) {
    return patch.listedFaceCount;
}

} // namespace

template <typename Slot>
bool decodeFaces(const Decoding& d, std::span<const std::byte> stored, std::span<uint32_t> slots,
                 std::span<Slot> corners) {
    FacesHeader header;
    if (!readHeader(stored, header) || corners.size() % 3 != 0) return false;
    const uint64_t size = faceWorkBytes<Slot>(header, corners.size() / 3, slots.size());
    if (size + kSlack > d.work.size() || !d.inflater.inflate(stored, d.work.first(size))) return false;
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

/// The rows of a patch's slots.
void listRows(const AssetView& view, uint32_t patch, uint32_t* rows) {
    const auto add = [&](VertexRange range) {
        for (uint32_t i = 0; i < range.count; ++i) *rows++ = range.first + i;
    };
    for (const uint32_t domain : view.domainsOf(patch)) add(view.domainRange(domain));
    add(view.interiorRange(patch));
}

template <typename Slot>
bool findReferencesOf(const AssetView& view, uint32_t patch, const Slot* parents, uint32_t* rows,
                      std::span<uint32_t> references) {
    const uint32_t slotCount = view.patches[patch].slotCount;
    listRows(view, patch, rows);
    bool isDamaged = false;
    for (uint32_t slot = 0; slot < slotCount; ++slot) {
        const uint32_t row = rows[slot], parent = parents[slot];
        const bool isRoot = parent == slot;
        const uint32_t before = row - (row > 0), up = rows[parent < slotCount ? parent : 0];
        const uint32_t reference = isRoot ? before : up;
        isDamaged |= reference >= row + isRoot || parent >= slotCount;
        references[row] = reference;
    }
    return !isDamaged;
}

} // namespace

bool findReferences(const Decoding& d, std::span<const uint16_t> narrow, std::span<const uint32_t> wide) {
    auto* rows = reinterpret_cast<uint32_t*>(d.work.data());
    for (uint32_t p = 0; p < d.view.patchCount(); ++p) {
        const PatchRecord& patch = d.view.patches[p];
        const uint64_t end = uint64_t(patch.firstParent) + patch.slotCount;
        if (end > (isWide(patch) ? wide.size() : narrow.size()) || patch.slotCount * sizeof(uint32_t) > d.work.size())
            return false;
        const bool found = isWide(patch)
                               ? findReferencesOf(d.view, p, wide.data() + patch.firstParent, rows, d.references)
                               : findReferencesOf(d.view, p, narrow.data() + patch.firstParent, rows, d.references);
        if (!found) return false;
    }
    return true;
}

} // namespace xgc::load
