#include "../runtime/src/xxh64.h"
#include "meshes/hostile.h"
#include "meshes/toy_asset.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <sys/resource.h>
#include <unistd.h>

using namespace xgc;
using namespace xgc::format;

namespace {
size_t allocations = 0;
}

[[gnu::noinline]] void* operator new(size_t size) {
    ++allocations;
    if (void* p = std::malloc(size ? size : 1)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(size_t size, const std::nothrow_t&) noexcept {
    ++allocations;
    return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
    std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, size_t) noexcept {
    std::free(p);
}

namespace {

using test::plain;
using test::withMadeVertices;

xgc::Status open(test::ExactBytes& bytes) {
    AssetView view;
    return openAll(bytes.span(), view);
}

size_t sectionAt(std::span<const std::byte> bytes, SectionId id) {
    const auto header = test::load<FileHeader>(bytes, 0);
    for (uint32_t i = 0; i < header.sectionCount; ++i) {
        const size_t at = sizeof header + i * sizeof(SectionRecord);
        if (test::load<SectionRecord>(bytes, at).id == id) return at;
    }
    FAIL("the asset has no such section");
    return 0;
}

/// Offset of an element of a section.
size_t elementAt(std::span<const std::byte> bytes, SectionId id, size_t index) {
    const auto s = test::load<SectionRecord>(bytes, sectionAt(bytes, id));
    REQUIRE(index < s.count);
    return s.offset + index * s.stride;
}

/// Offset of a stream's first element.
size_t streamAt(std::span<const std::byte> bytes, StreamKind kind) {
    const auto page = test::load<PageRecord>(bytes, elementAt(bytes, SectionId::pages, 0));
    for (uint32_t i = 0; i < page.streamCount; ++i) {
        const auto s = test::load<StreamRecord>(bytes, elementAt(bytes, SectionId::streams, i));
        if (s.kind == kind) return page.offset + s.offset;
    }
    FAIL("the asset has no such stream");
    return 0;
}

/// Alters one record of a section.
template <typename T, typename Change>
auto record(SectionId id, size_t index, Change change) {
    return [=](std::span<std::byte> bytes) {
        const size_t at = elementAt(bytes, id, index);
        auto value = test::load<T>(bytes, at);
        change(value);
        test::store(bytes, at, value);
    };
}

/// Alters one element of a stream.
template <typename T, typename Change>
auto element(StreamKind kind, size_t index, Change change) {
    return [=](std::span<std::byte> bytes) {
        const size_t at = streamAt(bytes, kind) + index * sizeof(T);
        auto value = test::load<T>(bytes, at);
        change(value);
        test::store(bytes, at, value);
    };
}

/// Alters, makes the checksums right, and expects a refusal that says `message`.
template <typename Damage>
void expect(StatusCode code, const char* message, const Damage& damage) {
    CAPTURE(message);
    test::ExactBytes bytes(plain().bytes);
    damage(bytes.span());
    test::fixChecksums(bytes.span());
    AssetView view;
    view.levels = plain().asset.levels;
    const xgc::Status s = openAll(bytes.span(), view);
    CHECK(s.code == code);
    CHECK_MESSAGE(std::string_view(s.message).find(message) != std::string_view::npos, s.message);
    CHECK(view.levels.data() == plain().asset.levels.data());
    CHECK(view.record == nullptr);
}

template <typename Damage>
void expectCorrupt(const char* message, const Damage& damage) {
    expect(StatusCode::corrupt, message, damage);
}

const float kNaN = std::numeric_limits<float>::quiet_NaN();

} // namespace

TEST_CASE("the core's XXH64 is that of libxxhash") {
    std::vector<std::byte> bytes(300);
    std::mt19937 random(1);
    for (std::byte& b : bytes) b = std::byte(random() & 255);
    for (size_t size = 0; size <= bytes.size(); ++size) {
        const auto run = std::span<const std::byte>(bytes).first(size);
        CHECK(xxh64(run) == XXH64(run.data(), run.size(), 0));
        if (size >= 64) CHECK(xxh64(run.first(64), run.subspan(64)) == XXH64(run.data(), run.size(), 0));
    }
}

TEST_CASE("an asset opens in place, with every table, and without allocating") {
    REQUIRE_MESSAGE(plain().error.empty(), plain().error);
    const test::ToyAsset& a = plain();
    test::ExactBytes bytes(a.bytes);
    AssetView view;
    const size_t before = allocations;
    const xgc::Status s = openAll(bytes.span(), view);
    CHECK(allocations == before);
    REQUIRE_MESSAGE(s.ok(), s.message);
    CHECK(view.patches.size() == 3);
    CHECK(view.nodes.size() == 2);
    CHECK(view.text(view.nodes[1].name) == "child");
    CHECK(view.provenance == R"({"tool":"toy"})");
    CHECK(view.record->faceCount == a.mesh.faces.size());
    CHECK(view.error(2, 3) == a.asset.error(2, 3));
    CHECK(withMadeVertices().asset.birthLevels.size() == withMadeVertices().asset.record->vertexCount);
    CHECK(view.birthLevels.empty());
}

TEST_CASE("tables open without the pages") {
    const test::ToyAsset& a = plain();
    const auto header = test::load<FileHeader>(a.bytes, 0);
    test::ExactBytes bytes(std::span(a.bytes).first(header.tableBytes));
    AssetView view;
    const xgc::Status s = openTables(bytes.span(), view);
    REQUIRE_MESSAGE(s.ok(), s.message);
    CHECK(view.patches.size() == 3);
    CHECK(view.positions.empty());
    CHECK(openAll(bytes.span(), view).code == StatusCode::truncated);
}

TEST_CASE("no truncation opens") {
    for (const test::ToyAsset* a : {&plain(), &withMadeVertices()}) {
        for (size_t size = 0; size < a->bytes.size(); ++size) {
            test::ExactBytes cut(std::span(a->bytes).first(size));
            const StatusCode code = open(cut).code;
            if (code != StatusCode::truncated) CHECK((size < 8 && code == StatusCode::notAnAsset));
            test::fixChecksums(cut.span());
            if (open(cut).ok()) FAIL_CHECK("opened at " << size << " bytes");
        }
    }
}

TEST_CASE("no flipped bit opens") {
    const std::vector<std::byte>& bytes = plain().bytes;
    for (size_t i = 0; i < bytes.size(); ++i) {
        test::ExactBytes flipped(bytes);
        flipped.span()[i] ^= std::byte(1u << (i * 5 % 8));
        if (open(flipped).ok()) FAIL_CHECK("opened with a flipped bit in byte " << i);
    }
}

TEST_CASE("whatever opens draws within its capacities, however it was damaged") {
    std::mt19937 random(11);
    uint32_t opened = 0, refused = 0;
    for (uint32_t round = 0; round < 20000; ++round) {
        const test::ToyAsset& a = round % 2 ? plain() : withMadeVertices();
        test::ExactBytes bytes(a.bytes);
        const std::span<std::byte> b = bytes.span();
        const uint32_t changes = 1 + random() % 4;
        for (uint32_t i = 0; i < changes; ++i) {
            const size_t at = random() % b.size(), word = at / 4 * 4;
            const auto value = test::load<uint32_t>(b, word);
            switch (random() % 6) {
            case 0:
                b[at] = std::byte(random() & 255);
                break;
            case 1:
                b[at] ^= std::byte(1u << random() % 8);
                break;
            case 2:
                test::store(b, word, value + 1);
                break;
            case 3:
                test::store(b, word, value - 1);
                break;
            case 4:
                test::store(b, word, random() % 2 ? 0xffffffffu : 0u);
                break;
            default:
                test::store(b, word, test::load<uint32_t>(b, random() % b.size() / 4 * 4));
                break;
            }
        }
        test::fixChecksums(b);
        AssetView view;
        if (openAll(b, view).ok()) {
            ++opened;
            if (!test::drawsSafely(view, 3, round)) FAIL_CHECK("unsafe in round " << round);
        } else {
            ++refused;
        }
    }
    CHECK(opened > 500); // normals, names, padding of levels and the like are not rules
    CHECK(refused > 5000);
}

TEST_CASE("header and sections: each rule is enforced") {
    const auto header = [](auto change) {
        return [=](std::span<std::byte> b) {
            auto h = test::load<FileHeader>(b, 0);
            change(h);
            test::store(b, 0, h);
        };
    };
    const auto section = [](SectionId id, auto change) {
        return [=](std::span<std::byte> b) {
            const size_t at = sectionAt(b, id);
            auto s = test::load<SectionRecord>(b, at);
            change(s);
            test::store(b, at, s);
        };
    };
    expect(StatusCode::notAnAsset, "do not start", header([](FileHeader& h) { h.magic[0] = 'x'; }));
    expect(StatusCode::badVersion, "another format version",
           header([](FileHeader& h) { h.version = format::kVersion + 1; }));
    expect(StatusCode::unsupported, "flags", header([](FileHeader& h) { h.flags = 1; }));
    expect(StatusCode::truncated, "within its tables", header([](FileHeader& h) { h.tableBytes = 1u << 30; }));
    expectCorrupt("sizes in the header", header([](FileHeader& h) { h.fileBytes = 64; }));
    expectCorrupt("sizes in the header", header([](FileHeader& h) { h.sectionCount = 0xffffffff; }));
    expectCorrupt("not in order", section(SectionId::domains, [](SectionRecord& s) { s.id = SectionId::levels; }));
    expectCorrupt("does not start behind", section(SectionId::domains, [](SectionRecord& s) { s.offset += 64; }));
    expectCorrupt("reaches past", section(SectionId::provenance, [](SectionRecord& s) { s.storedBytes = ~0ull - 64; }));
    expectCorrupt("another size", section(SectionId::domains, [](SectionRecord& s) { s.count += 1; }));
    expectCorrupt("another size", section(SectionId::domains, [](SectionRecord& s) { s.stride = 8; }));
    expect(StatusCode::unsupported, "compressed",
           section(SectionId::domains, [](SectionRecord& s) { s.codec = Codec::zstd; }));
}

namespace {

/// The first patch that has a second face list.
uint32_t patchWithLists(const AssetView& v) {
    for (uint32_t p = 0; p < v.patchCount(); ++p) {
        if (v.record->listCount > 1 && v.listsOf(p)[1].faceCount > 0) return p;
    }
    FAIL("no patch has a second face list");
    return 0;
}

} // namespace

TEST_CASE("tables: each rule is enforced") {
    const auto asset = [](auto change) { return record<AssetRecord>(SectionId::asset, 0, change); };
    const auto patch = [](auto change) { return record<PatchRecord>(SectionId::patches, 1, change); };
    expectCorrupt("patchPages has another count", asset([](AssetRecord& r) { r.tierCount = 2; }));
    expectCorrupt("level count", asset([](AssetRecord& r) { r.levelCount = 255; }));
    expectCorrupt("another count", asset([](AssetRecord& r) { r.levelCount = 5; }));
    expectCorrupt("another count", asset([](AssetRecord& r) { r.domainCount += 1; }));
    expectCorrupt("vertex ranges do not end", asset([](AssetRecord& r) { r.vertexCount += 1; }));
    expectCorrupt("capacities", asset([](AssetRecord& r) { r.maxPatchSlots -= 1; }));
    expectCorrupt("capacities", asset([](AssetRecord& r) { r.maxPatchFaces += 1; }));
    expectCorrupt("another count of faces", asset([](AssetRecord& r) { r.faceCount += 1; }));
    expectCorrupt("not finite", asset([](AssetRecord& r) { r.sphereRadius = kNaN; }));
    expectCorrupt("level with an error", record<LevelRecord>(SectionId::levels, 1, [](auto& r) { r.maxError = kNaN; }));
    const auto list = [](size_t index, auto change) { return record<FaceList>(SectionId::faceLists, index, change); };
    const uint32_t lists = plain().asset.record->listCount;
    const uint32_t second = patchWithLists(plain().asset) * lists + 1;
    expectCorrupt("face list count", asset([](AssetRecord& r) { r.listCount = 0; }));
    expectCorrupt("another count", asset([](AssetRecord& r) { r.listCount += 1; }));
    expectCorrupt("not that of level 0", list(lists, [](FaceList& l) { l.level = 1; }));
    expectCorrupt("not that of level 0", list(lists, [](FaceList& l) { l.faceCount -= 1; }));
    expectCorrupt("levels do not rise", list(second, [](FaceList& l) { l.level = 0; }));
    expectCorrupt("levels do not rise", list(second, [](FaceList& l) { l.level = 4; }));
    expectCorrupt("lists that grow", list(second, [](FaceList& l) { l.level = kNever; }));
    expectCorrupt("lists that grow", list(second, [](FaceList& l) { l.faceCount = 1u << 20; }));
    expectCorrupt("do not end at its count", list(second, [](FaceList& l) { l.faceCount -= 1; }));
    expectCorrupt("wrong run of patches",
                  record<DomainRecord>(SectionId::domains, 1, [](auto& d) { d.firstPatch += 1; }));
    expectCorrupt("out of order or range", record<uint32_t>(SectionId::domainPatches, 1, [](auto& p) { p = 3; }));
    expectCorrupt("gap or overlaps", record<VertexRange>(SectionId::vertexRanges, 1, [](auto& r) { r.first -= 1; }));
    expectCorrupt("part or material", patch([](PatchRecord& r) { r.part = 3; }));
    expectCorrupt("part or material", patch([](PatchRecord& r) { r.material = 1; }));
    expectCorrupt("wrong run of domains", patch([](PatchRecord& r) { r.firstDomain += 1; }));
    expectCorrupt("slot count", patch([](PatchRecord& r) { r.slotCount -= 1; }));
    expectCorrupt("first corner", patch([](PatchRecord& r) { r.firstCorner -= 3; }));
    expectCorrupt("first corner", patch([](PatchRecord& r) { r.firstParent += 1; }));
    expect(StatusCode::unsupported, "unknown flags", patch([](PatchRecord& r) { r.flags |= 2; }));
    expectCorrupt("first corner", patch([](PatchRecord& r) { r.flags |= kWideSlots; }));
    expectCorrupt("not that of level 0", patch([](PatchRecord& r) { r.faceCount += 1; }));
    expectCorrupt("do not end at its count", patch([](PatchRecord& r) { r.listedFaceCount += 1; }));
    expectCorrupt("bounds that are not finite", patch([](PatchRecord& r) { r.boxMin[2] = kNaN; }));
    expectCorrupt("normal cone", patch([](PatchRecord& r) { r.coneCosine = 2; }));
    expectCorrupt("normal cone", patch([](PatchRecord& r) { r.coneLevel = 4; }));
    expectCorrupt("patch with domains", record<uint32_t>(SectionId::patchDomains, 0, [](auto& d) { d = 99; }));
    expectCorrupt("first slot", record<uint32_t>(SectionId::patchSlots, 1, [](auto& s) { s += 1; }));
    expectCorrupt("error that falls", record<float>(SectionId::patchErrors, 2, [](auto& e) { e = -1; }));
    expectCorrupt("error that falls", record<float>(SectionId::patchErrors, 3, [](auto& e) { e = kNaN; }));
    expectCorrupt("name past", record<PartRecord>(SectionId::parts, 0, [](auto& p) { p.name.offset = 0xfffffff0; }));
    expectCorrupt("does not hold", record<PartRecord>(SectionId::parts, 0, [](auto& p) { p.patchCount = 2; }));
    expectCorrupt("neighbours", record<uint32_t>(SectionId::partNeighbours, 0, [](auto& n) { n = 3; }));
    expectCorrupt("contour", record<float>(SectionId::contours, 1, [](auto& c) { c = kNaN; }));
    expectCorrupt("contour", record<float>(SectionId::contours, 0, [](auto& c) { c = -1; }));
    expectCorrupt("counts of triangles", record<uint32_t>(SectionId::patchFaceCounts, 0, [](auto& c) { ++c; }));
    expectCorrupt("counts of triangles", record<uint32_t>(SectionId::patchFaceCounts, 2, [](auto& c) { c = kNone; }));
    const auto shape = [](auto change) { return record<PartShape>(SectionId::partShapes, 1, change); };
    expectCorrupt("box that is not finite", shape([](auto& s) { s.boxCenter[2] = kNaN; }));
    expectCorrupt("box that is not finite", shape([](auto& s) { s.boxAxes[2][1] = kNaN; }));
    expectCorrupt("box that is not finite", shape([](auto& s) { s.boxHalfSizes[0] = kNaN; }));
    expectCorrupt("negative size", shape([](auto& s) { s.boxHalfSizes[1] = -1; }));
    expectCorrupt("salience", shape([](auto& s) { s.salience = 1.5f; }));
    expectCorrupt("salience", shape([](auto& s) { s.salience = kNaN; }));
    // The merges are {1, 2} and {0, 1}.
    REQUIRE(plain().asset.merges.size() == 2);
    expectCorrupt("names a merge", shape([](auto& s) { s.joinedBy = 0; }));
    expectCorrupt("names a merge", shape([](auto& s) { s.joinedBy = 2; }));
    expectCorrupt("joins in another", shape([](auto& s) { s.joinedBy = kNone; }));
    const auto merge = [](size_t i, auto change) { return record<MergeRecord>(SectionId::mergeTree, i, change); };
    expectCorrupt("merge with parts out of order", merge(0, [](auto& m) { m.a = 2; }));
    expectCorrupt("names a merge", merge(1, [](auto& m) { m.b = 3; }));
    expectCorrupt("wrong cost", merge(1, [](auto& m) { m.cost = kNaN; }));
    expectCorrupt("wrong cost", merge(0, [](auto& m) { m.cost = -0.5f; }));
    expectCorrupt("has joined another", [&](std::span<std::byte> bytes) { // 1 joins 0, and then 2 joins 1
        merge(0, [](auto& m) { m.a = 0, m.b = 1; })(bytes);
        merge(1, [](auto& m) { m.a = 1, m.b = 2; })(bytes);
        record<PartShape>(SectionId::partShapes, 1, [](auto& s) { s.joinedBy = 0; })(bytes);
        record<PartShape>(SectionId::partShapes, 2, [](auto& s) { s.joinedBy = 1; })(bytes);
    });
    const auto section = [](SectionId id, auto change) {
        return [=](std::span<std::byte> b) {
            const size_t at = sectionAt(b, id);
            auto s = test::load<SectionRecord>(b, at);
            change(s);
            test::store(b, at, s);
        };
    };
    expectCorrupt("without partShapes", section(SectionId::partShapes, [](auto& s) { s.id = SectionId(70); }));
    expectCorrupt("material with", record<MaterialRecord>(SectionId::materials, 0, [](auto& m) { m.metallic = kNaN; }));
    expectCorrupt("before its parent", record<NodeRecord>(SectionId::nodes, 1, [](auto& n) { n.parent = 1; }));
    const auto page = [](auto change) { return record<PageRecord>(SectionId::pages, 0, change); };
    expect(StatusCode::unsupported, "page is compressed", page([](PageRecord& p) { p.codec = Codec::meshopt; }));
    expectCorrupt("tier, group", page([](PageRecord& p) { p.tier = 1; }));
    expectCorrupt("fill the file", page([](PageRecord& p) { p.storedBytes -= 64; }));
    expectCorrupt("run of streams", page([](PageRecord& p) { p.streamCount -= 1; }));
}

TEST_CASE("pages: each rule is enforced") {
    const auto stream = [](size_t index, auto change) {
        return record<StreamRecord>(SectionId::streams, index, change);
    };
    expectCorrupt("stream out of order", stream(1, [](auto& s) { s.kind = StreamKind::position; }));
    expectCorrupt("wrong offset", stream(1, [](auto& s) { s.offset += 64; }));
    expectCorrupt("another size", stream(0, [](auto& s) { s.stride = 16; }));
    expect(StatusCode::unsupported, "compressed", stream(0, [](auto& s) { s.codec = Codec::zstd; }));
    expect(StatusCode::unsupported, "format", stream(0, [](auto& s) { s.format = StreamFormat::u16x4; }));
    expect(StatusCode::unsupported, "format", stream(1, [](auto& s) { s.format = StreamFormat(99); }));
    expectCorrupt("another stride", stream(1, [](auto& s) { s.format = StreamFormat::f32x4; }));
    expectCorrupt("position that is not finite", element<float>(StreamKind::position, 4, [](auto& x) { x = kNaN; }));

    const AssetView& v = plain().asset;
    const VertexRange range = v.interiorRange(1);
    const uint32_t last = range.first + range.count - 1;
    const auto level = [](uint32_t row, uint8_t to) {
        return element<uint8_t>(StreamKind::collapseLevel, row, [to](auto& l) { l = to; });
    };
    expectCorrupt("collapse level out of range", level(last, 0));
    expectCorrupt("collapse level out of range", level(last, 4));
    REQUIRE(v.collapseLevels[range.first + 1] > 1);
    expectCorrupt("does not fall", level(range.first, 1));

    // The last row of an interior collapses: it has a parent.
    const PatchRecord& patch = v.patches[1];
    const uint32_t lastSlot = patch.slotCount - 1;
    const auto parent = [&](uint32_t slot, uint32_t to) {
        return element<uint16_t>(StreamKind::parentNarrow, patch.firstParent + slot,
                                 [to](auto& p) { p = uint16_t(to); });
    };
    REQUIRE(v.collapseLevels[last] != kNever);
    expectCorrupt("wrong parent slot", parent(lastSlot, lastSlot));
    expectCorrupt("wrong parent slot", parent(lastSlot - 1, lastSlot));
    expectCorrupt("three corners", stream(v.streams.size() - 1, [](auto& s) {
                      s.count -= 1, s.stride = 2, s.storedBytes -= 2, s.rawBytes -= 2;
                  }));
    expectCorrupt("corner past", element<uint16_t>(StreamKind::cornerNarrow, 3, [](auto& c) { c = 65535; }));
    // The second list of a patch names no interior slot that is dead at its level, as the last one is at any.
    const uint32_t p = patchWithLists(v);
    REQUIRE(v.collapseLevels[v.interiorRange(p).first + v.interiorRange(p).count - 1] == 1);
    const auto dead = uint16_t(v.patches[p].slotCount - 1);
    expectCorrupt("corner past",
                  element<uint16_t>(StreamKind::cornerNarrow, v.patches[p].firstCorner + 3 * v.patches[p].faceCount,
                                    [=](auto& c) { c = dead; }));
}

TEST_CASE("a genealogy on which patches differ, or that leaves the domain, is refused") {
    const AssetView& v = plain().asset;
    uint32_t differing = 0, narrower = 0;
    for (uint32_t p = 0; p < v.patches.size(); ++p) {
        for (uint32_t slot = 0; slot < v.patches[p].slotCount; ++slot) {
            for (uint32_t to = 0; to < slot; ++to) {
                test::ExactBytes bytes(plain().bytes);
                element<uint16_t>(StreamKind::parentNarrow, v.patches[p].firstParent + slot,
                                  [to](auto& x) { x = uint16_t(to); })(bytes.span());
                test::fixChecksums(bytes.span());
                const std::string_view message = open(bytes).message;
                differing += message.find("two patches differ") != std::string_view::npos;
                narrower += message.find("no wider domain") != std::string_view::npos;
            }
        }
    }
    CHECK(differing > 0);
    CHECK(narrower > 0);
}

TEST_CASE("sections and streams of later versions are skipped") {
    test::ExactBytes bytes(withMadeVertices().bytes);
    const std::span<std::byte> b = bytes.span();
    const std::pair<SectionId, uint32_t> later[] = {{SectionId::mergeTree, 63},
                                                    {SectionId::contours, 68},
                                                    {SectionId::provenance, 1000},
                                                    {SectionId::partShapes, 1001},
                                                    {SectionId::patchFaceCounts, 1002}};
    for (const auto& [id, unknown] : later) {
        const size_t at = sectionAt(b, id);
        auto s = test::load<SectionRecord>(b, at);
        s.id = SectionId(unknown);
        s.codec = Codec(7);
        test::store(b, at, s);
    }
    bool found = false;
    for (uint32_t i = 0; i < withMadeVertices().asset.streams.size(); ++i) {
        const size_t where = elementAt(b, SectionId::streams, i);
        auto stream = test::load<StreamRecord>(b, where);
        if (stream.kind != StreamKind::birthLevel) continue;
        stream.kind = StreamKind(12);
        stream.format = StreamFormat(50);
        test::store(b, where, stream);
        found = true;
    }
    REQUIRE(found);
    test::fixChecksums(b);
    AssetView view;
    const xgc::Status status = openAll(b, view);
    REQUIRE_MESSAGE(status.ok(), status.message);
    CHECK(view.provenance.empty());
    CHECK(view.partShapes.empty());
    CHECK(view.patchFaceCounts.empty());
    CHECK(view.contoursOf(1).empty());
    CHECK(view.merges.empty());
    CHECK(view.birthLevels.empty());
}

TEST_CASE("misaligned bytes are a mistake of the caller, and told so") {
    bake::AlignedBytes file = test::aligned(plain().bytes);
    AssetView view;
    CHECK(openAll(file.span().subspan(8), view).code == StatusCode::badArgument);
}

TEST_CASE("the same input gives the same bytes, on any compiler") {
    const test::ToyAsset again = test::smallAsset(false);
    CHECK(again.bytes == plain().bytes);
    std::ifstream golden(std::filesystem::path(XGC_SOURCE_DIR) / "tests/golden/small_asset.txt");
    std::string name;
    uint64_t expected = 0;
    uint32_t count = 0;
    while (golden >> name >> std::hex >> expected) {
        const test::ToyAsset& a = name == "plain" ? plain() : withMadeVertices();
        const uint64_t hash = xxh64(a.bytes);
        CHECK_MESSAGE(hash == expected,
                      fmt::format("{} is now {:016x}: a change of layout edits FORMAT.md and this golden, and bumps "
                                  "kVersion where old readers would misread it",
                                  name, hash));
        ++count;
    }
    CHECK(count == 2);
}

namespace {

/// A folder of its own for files, removed at the end.
struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("xgc_test_format_" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    size_t fileCount() const {
        size_t count = 0;
        for (const auto& entry : std::filesystem::directory_iterator(path)) count += entry.exists();
        return count;
    }
};

bool says(const bake::Status& s, bake::Outcome outcome, const char* text) {
    INFO(s.message);
    return s.outcome == outcome && s.message.find(text) != std::string::npos;
}

} // namespace

TEST_CASE("a file is written whole and read back aligned") {
    const Folder folder;
    const std::filesystem::path file = folder.path / "a.xgc";
    for (int i = 0; i < 2; ++i) REQUIRE(bake::writeFileAtomically(file, plain().bytes).ok());
    CHECK(folder.fileCount() == 1);
    bake::AlignedBytes read;
    REQUIRE(bake::readFile(file, read).ok());
    CHECK(std::equal(read.span().begin(), read.span().end(), plain().bytes.begin(), plain().bytes.end()));
    AssetView view;
    CHECK(openAll(read.span(), view).ok());
}

TEST_CASE("a failed write leaves the target as it was, and nothing beside it") {
    const Folder folder;
    const std::filesystem::path file = folder.path / "a.xgc";
    const std::vector<std::byte> before(100, std::byte(7));
    REQUIRE(bake::writeFileAtomically(file, before).ok());
    struct rlimit old = {};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &old) == 0);
    const struct rlimit tight = {4096, old.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &tight) == 0);
    const std::vector<std::byte> large(100000, std::byte(1));
    const bake::Status s = bake::writeFileAtomically(file, large);
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    CHECK(says(s, bake::Outcome::system, "File too large"));
    CHECK(s.message.find(file.string()) != std::string::npos);
    CHECK(folder.fileCount() == 1);
    bake::AlignedBytes read;
    REQUIRE(bake::readFile(file, read).ok());
    CHECK(read.size == 100);
}

TEST_CASE("what cannot be written or read is named with the reason") {
    const Folder folder;
    const std::vector<std::byte> bytes(100, std::byte(7));
    CHECK(says(bake::writeFileAtomically("/dev/full", bytes), bake::Outcome::system, "No space left"));
    CHECK(std::filesystem::exists("/dev/full"));
    CHECK(says(bake::writeFileAtomically(folder.path, bytes), bake::Outcome::system, "Is a directory"));
    CHECK(says(bake::writeFileAtomically(folder.path / "no" / "a.xgc", bytes), bake::Outcome::system, "No such file"));
    bake::AlignedBytes read;
    CHECK(says(bake::readFile(folder.path / "none.xgc", read), bake::Outcome::badInput, "No such file"));
    CHECK(says(bake::readFile(folder.path, read), bake::Outcome::badInput, "Is a directory"));
    std::ofstream(folder.path / "empty.xgc").flush();
    CHECK(says(bake::readFile(folder.path / "empty.xgc", read), bake::Outcome::badInput, "empty"));
    CHECK(read.size == 0);
    if (::geteuid() == 0) {
        MESSAGE("SKIPPED: no permission (running as root)");
        return;
    }
    std::filesystem::permissions(folder.path, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    CHECK(says(bake::writeFileAtomically(folder.path / "a.xgc", bytes), bake::Outcome::system, "Permission denied"));
    std::filesystem::permissions(folder.path, std::filesystem::perms::owner_all);
}

TEST_CASE("a link keeps its target's name, and the target is replaced") {
    const Folder folder;
    const std::vector<std::byte> bytes(100, std::byte(7));
    REQUIRE(bake::writeFileAtomically(folder.path / "real.xgc", std::span(bytes).first(10)).ok());
    std::filesystem::create_symlink("real.xgc", folder.path / "link.xgc");
    REQUIRE(bake::writeFileAtomically(folder.path / "link.xgc", bytes).ok());
    CHECK(std::filesystem::is_symlink(folder.path / "link.xgc"));
    CHECK(std::filesystem::file_size(folder.path / "real.xgc") == 100);
}
