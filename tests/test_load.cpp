#include "meshes/hostile.h"
#include "meshes/toy_asset.h"

#include <xgc/bake/compress.h>
#include <xgc/bake/models.h>
#include <xgc/bake/thesis_hierarchy.h>
#include <xgc/load.h>

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>

using namespace xgc;
using namespace xgc::format;

namespace {

using Bytes = std::vector<std::byte>;

Bytes compressedOf(std::span<const std::byte> image) {
    Bytes out;
    const bake::Status s = bake::compressAsset(image, {}, out);
    REQUIRE_MESSAGE(s.ok(), s.message);
    return out;
}

/// Decodes into buffers of the exact sizes, so that a sanitizer sees any step outside them.
xgc::Status decodeExactly(std::span<const std::byte> file, Bytes& out) {
    test::ExactBytes bytes(file);
    DecodedSize size;
    if (xgc::Status s = decodedSize(bytes.span(), size); !s.ok()) return s;
    if (size.imageBytes > (1u << 26) || size.scratchBytes > (1u << 26)) return {StatusCode::outOfCapacity, "large"};
    test::ExactBytes image(Bytes(size.imageBytes, std::byte(0xcd))), scratch(Bytes(size.scratchBytes, std::byte(0xcd)));
    xgc::Status s = decode(bytes.span(), scratch.span(), image.span());
    if (s.ok()) out.assign(image.span().begin(), image.span().end());
    return s;
}

void checkRoundTrip(std::span<const std::byte> image) {
    const Bytes file = compressedOf(image);
    CHECK(file.size() < image.size());
    Bytes back;
    const xgc::Status s = decodeExactly(file, back);
    REQUIRE_MESSAGE(s.ok(), s.message);
    CHECK(std::equal(back.begin(), back.end(), image.begin(), image.end()));
}

using test::plain;
using test::withMadeVertices;

/// A mesh with every attribute that a file can hold, all different in each row.
bake::Model decorated(bake::Model model) {
    std::mt19937 random(3);
    const auto unit = [&] { return float(random() & 0xffffff) / 0xffffff; };
    bake::Attributes& a = model.attributes;
    const size_t rows = model.positions.size();
    for (size_t i = 0; i < rows; ++i) {
        a.normals.push_back(glm::normalize(model.positions[i] + glm::vec3(0.01f)));
        a.tangents.push_back({unit(), unit(), unit(), i % 2 ? 1.0f : -1.0f});
        a.uvs[0].push_back({unit() * 4 - 2, unit()});
        a.uvs[1].push_back({float(random() % 64) / 64, -unit()});
        a.colors[0].push_back({unit(), unit(), unit(), unit()});
        a.joints[0].push_back({random() & 255, random() & 255, random() & 7, 0});
        a.weights[0].push_back({unit(), unit(), 0, -unit()});
    }
    return model;
}

} // namespace

TEST_CASE("toy assets survive compression bit for bit, with made vertices, all attributes and few or many patches") {
    for (const bool made : {false, true}) {
        for (const uint32_t patches : {1u, 3u, 40u}) {
            test::ToyOptions options;
            options.makeVertices = made;
            options.seed = patches;
            const test::ToyAsset a = test::toyAsset(test::sphere(16), patches, options);
            REQUIRE_MESSAGE(a.error.empty(), a.error);
            checkRoundTrip(a.bytes);
        }
    }
    test::ToyOptions options;
    options.wedgeIdsAsUvs = false;
    const test::ToyAsset a = test::toyAsset(decorated(test::sphere(12)), 4, options);
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    checkRoundTrip(a.bytes);
}

TEST_CASE("patches of narrow and of wide slots survive compression") {
    bake::Model model = test::grid(300);
    test::ToyOptions options;
    options.levelCount = 3;
    const test::ToyAsset one = test::toyAsset(model, 1, options);
    REQUIRE_MESSAGE(one.error.empty(), one.error);
    REQUIRE(!one.asset.cornersWide.empty());
    checkRoundTrip(one.bytes);
}

TEST_CASE("the bundled models survive compression bit for bit") {
    using bake::BundledModel;
    for (const BundledModel which : {BundledModel::creature, BundledModel::shaft, BundledModel::terrain,
                                     BundledModel::temple, BundledModel::tree}) {
        bake::Model model = bake::makeModel(which, 6000);
        std::fill(model.triangleMaterial.begin(), model.triangleMaterial.end(), 0u); // slabs know no materials
        test::ToyOptions options;
        options.wedgeIdsAsUvs = false;
        const test::ToyAsset a = test::toyAsset(model, 5, options);
        REQUIRE_MESSAGE(a.error.empty(), a.error);
        checkRoundTrip(a.bytes);
    }
}

TEST_CASE("faces that start at any corner survive compression") {
    // The layout starts faces at their lowest slot; other writers need not.
    test::ExactBytes bytes(plain().bytes);
    const AssetView& v = plain().asset;
    const size_t at = size_t(reinterpret_cast<const std::byte*>(v.cornersNarrow.data()) - v.bytes.data());
    for (size_t face = 0; face < v.cornersNarrow.size() / 3; ++face) {
        for (size_t k = 0; k < 3; ++k) {
            const uint16_t corner = v.cornersNarrow[3 * face + (k + face) % 3];
            test::store(bytes.span(), at + (3 * face + k) * sizeof corner, corner);
        }
    }
    test::fixChecksums(bytes.span());
    checkRoundTrip(bytes.span());
}

TEST_CASE("uncompressed files are told apart, and copied by decode") {
    DecodedSize size;
    test::ExactBytes file(plain().bytes);
    REQUIRE(decodedSize(file.span(), size).ok());
    CHECK(!size.isCompressed);
    CHECK(size.scratchBytes == 0);
    Bytes back;
    REQUIRE(decodeExactly(plain().bytes, back).ok());
    CHECK(back == plain().bytes);
    const Bytes compressed = compressedOf(plain().bytes);
    test::ExactBytes exact(compressed);
    REQUIRE(decodedSize(exact.span(), size).ok());
    CHECK(size.isCompressed);
    AssetView view;
    const xgc::Status s = openAll(exact.span(), view);
    CHECK(s.code == StatusCode::unsupported);
    CHECK_MESSAGE(std::string_view(s.message).find("xgc::load") != std::string_view::npos, s.message);
}

TEST_CASE("buffers that are too small or misaligned are refused") {
    const Bytes compressed = compressedOf(plain().bytes);
    test::ExactBytes file(compressed);
    DecodedSize size;
    REQUIRE(decodedSize(file.span(), size).ok());
    REQUIRE(size.scratchBytes > 0);
    test::ExactBytes image(Bytes(size.imageBytes + 64)), scratch(Bytes(size.scratchBytes + 4));
    const auto code = [&](std::span<std::byte> s, std::span<std::byte> i) { return decode(file.span(), s, i).code; };
    CHECK(code(scratch.span(), image.span().first(size.imageBytes - 1)) == StatusCode::badArgument);
    CHECK(code(scratch.span().first(size.scratchBytes - 1), image.span()) == StatusCode::badArgument);
    CHECK(code(scratch.span(), image.span().subspan(8)) == StatusCode::badArgument);
    CHECK(code(scratch.span().subspan(1), image.span()) == StatusCode::badArgument);
    CHECK(code(scratch.span(), image.span()) == StatusCode::ok);
}

TEST_CASE("no truncation of a compressed file decodes") {
    for (const test::ToyAsset* a : {&plain(), &withMadeVertices()}) {
        const Bytes file = compressedOf(a->bytes);
        Bytes out;
        for (size_t size = 0; size < file.size(); ++size) {
            const StatusCode code = decodeExactly(std::span<const std::byte>(file).first(size), out).code;
            if (code != StatusCode::truncated) CHECK((size < 8 && code == StatusCode::notAnAsset));
            test::ExactBytes cut(std::span<const std::byte>(file).first(size));
            test::fixChecksums(cut.span());
            if (decodeExactly(cut.span(), out).ok()) FAIL_CHECK("decoded at " << size << " bytes");
        }
    }
}

TEST_CASE("no flipped bit of a compressed file decodes") {
    const Bytes file = compressedOf(plain().bytes);
    Bytes out;
    for (size_t i = 0; i < file.size(); ++i) {
        Bytes flipped = file;
        flipped[i] ^= std::byte(1u << (i * 5 % 8));
        if (decodeExactly(flipped, out).ok()) FAIL_CHECK("decoded with a flipped bit in byte " << i);
    }
}

TEST_CASE("a damaged compressed file decodes to what openAll judges, or not at all") {
    const Bytes files[2] = {compressedOf(plain().bytes), compressedOf(withMadeVertices().bytes)};
    std::mt19937 random(5);
    uint32_t opened = 0, decoded = 0, refused = 0;
    for (uint32_t round = 0; round < 20000; ++round) {
        test::ExactBytes bytes(files[round % 2]);
        const std::span<std::byte> b = bytes.span();
        for (auto changes = 1 + random() % 3; changes > 0; --changes) {
            const size_t at = random() % b.size(), word = at / 4 * 4;
            if (random() % 2)
                b[at] = std::byte(random() & 255);
            else if (word + 4 <= b.size())
                test::store(b, word, test::load<uint32_t>(b, word) + (random() % 2 ? 1u : 0xffffffffu));
        }
        test::fixChecksums(b);
        Bytes out;
        if (!decodeExactly(b, out).ok()) {
            ++refused;
            continue;
        }
        ++decoded;
        test::ExactBytes image(out);
        AssetView view;
        if (!openAll(image.span(), view).ok()) continue;
        ++opened;
        if (!test::drawsSafely(view, 2, round)) FAIL_CHECK("unsafe in round " << round);
    }
    CHECK(refused > 2000);
    CHECK(decoded > 2000);
    CHECK(opened > 200);
}

namespace {

/// The codes within a stream of a compressed file are reached past zstd's own checks: unpacked, altered, packed again.
struct StreamAttack {
    Bytes file;
    size_t record = 0; ///< offset of its StreamRecord
    uint64_t pageOffset = 0;
    size_t headerBytes = 0;
};

StreamAttack findStream(const Bytes& file, StreamKind kind) {
    StreamAttack attack{file, 0, 0, 0};
    const auto header = test::load<FileHeader>(file, 0);
    attack.pageOffset = header.tableBytes;
    for (uint32_t i = 0; i < header.sectionCount; ++i) {
        const auto s = test::load<SectionRecord>(file, sizeof header + i * sizeof(SectionRecord));
        if (s.id != SectionId::streams) continue;
        for (uint32_t k = 0; k < s.count; ++k) {
            const size_t at = s.offset + k * sizeof(StreamRecord);
            const auto stream = test::load<StreamRecord>(file, at);
            if (stream.kind != kind) continue;
            attack.record = at;
            attack.headerBytes = stream.codec == Codec::rows    ? sizeof(RowsHeader)
                                 : stream.codec == Codec::faces ? sizeof(FacesHeader)
                                                                : 0;
        }
    }
    REQUIRE(attack.record != 0);
    return attack;
}

/// The file with the stream's unpacked codes changed. The stream must keep its place: codes are packed without
/// compression where the frame would be longer, which the 64-byte steps may not allow; such rounds return nothing.
Bytes withCodes(const StreamAttack& attack, std::mt19937& random) {
    Bytes file = attack.file;
    auto stream = test::load<StreamRecord>(file, attack.record);
    const size_t at = attack.pageOffset + stream.offset + attack.headerBytes;
    const size_t frame = stream.storedBytes - attack.headerBytes;
    const uint64_t size = ZSTD_getFrameContentSize(file.data() + at, frame);
    Bytes codes(size);
    REQUIRE(ZSTD_decompress(codes.data(), codes.size(), file.data() + at, frame) == size);
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
        codes[random() % codes.size()] = std::byte(random() % 3 ? random() & 255 : random() & 15);
    }
    const size_t room = (stream.storedBytes + 63) / 64 * 64 - attack.headerBytes;
    Bytes packed(ZSTD_compressBound(codes.size()));
    const size_t packedSize = ZSTD_compress(packed.data(), packed.size(), codes.data(), codes.size(), 19);
    if (packedSize > room) return {};
    std::copy_n(packed.begin(), packedSize, file.begin() + ptrdiff_t(at));
    stream.storedBytes = attack.headerBytes + packedSize;
    if ((stream.storedBytes + 63) / 64 != (attack.headerBytes + frame + 63) / 64) return {};
    test::store(std::span(file), attack.record, stream);
    test::fixChecksums(file);
    return file;
}

} // namespace

TEST_CASE("altered codes of every stream stay within the buffers, and what opens of them draws") {
    test::ToyOptions options;
    options.wedgeIdsAsUvs = false;
    const test::ToyAsset a = test::toyAsset(decorated(test::sphere(9)), 3, options);
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    const Bytes file = compressedOf(a.bytes);
    std::mt19937 random(7);
    for (const StreamKind kind : {StreamKind::position, StreamKind::normal, StreamKind::parentNarrow,
                                  StreamKind::cornerNarrow, StreamKind::collapseLevel}) {
        CAPTURE(uint32_t(kind));
        const StreamAttack attack = findStream(file, kind);
        uint32_t tried = 0, decoded = 0;
        for (uint32_t round = 0; round < 2000; ++round) {
            const Bytes damaged = withCodes(attack, random);
            if (damaged.empty()) continue;
            ++tried;
            Bytes out;
            if (!decodeExactly(damaged, out).ok()) continue;
            ++decoded;
            test::ExactBytes image(out);
            AssetView view;
            if (openAll(image.span(), view).ok() && !test::drawsSafely(view, 1, round))
                FAIL_CHECK("unsafe in round " << round);
        }
        CHECK(tried > 100);
        CHECK(decoded > 10);
    }
}

TEST_CASE("rounded attributes are near what they were, and nothing else changes") {
    test::ToyOptions options;
    options.wedgeIdsAsUvs = false;
    const test::ToyAsset a = test::toyAsset(decorated(test::sphere(12)), 3, options);
    REQUIRE_MESSAGE(a.error.empty(), a.error);
    Bytes rounded = a.bytes;
    const bake::Status s = bake::roundAttributes({.normalBits = 10, .uvBits = 12}, rounded);
    REQUIRE_MESSAGE(s.ok(), s.message);
    const bake::AlignedBytes copy = bake::alignedCopy(rounded);
    AssetView view;
    REQUIRE(openAll(copy.span(), view).ok());
    for (uint32_t i = 0; i < view.vertexStreamCount; ++i) {
        const VertexStream &now = view.vertexStreams[i], &before = a.asset.vertexStreams[i];
        const bool same = std::equal(now.bytes.begin(), now.bytes.end(), before.bytes.begin(), before.bytes.end());
        const bool isRounded = now.kind == StreamKind::normal || now.kind == StreamKind::uv;
        CHECK(same != isRounded);
        if (now.kind != StreamKind::uv) continue;
        for (size_t at = 0; at < now.bytes.size(); at += 4) {
            const float x = test::load<float>(now.bytes, at), y = test::load<float>(before.bytes, at);
            CHECK(std::abs(x - y) <= 1.0f / 8192);
            CHECK(x * 4096 == std::floor(x * 4096));
        }
    }
    CHECK(compressedOf(rounded).size() < compressedOf(a.bytes).size());
    checkRoundTrip(rounded);
    Bytes again = rounded;
    REQUIRE(bake::roundAttributes({.normalBits = 10, .uvBits = 12}, again).ok());
    CHECK(again == rounded);
    CHECK(!bake::roundAttributes({.normalBits = 7}, again).ok());
}

TEST_CASE("compression gives the same bytes wherever zstd is the same") {
    const Bytes once = compressedOf(plain().bytes);
    CHECK(once == compressedOf(plain().bytes));
    std::ifstream golden(std::filesystem::path(XGC_SOURCE_DIR) / "tests/golden/compressed_asset.txt");
    unsigned version = 0;
    uint64_t expected = 0;
    golden >> version >> std::hex >> expected;
    REQUIRE(bool(golden));
    if (version != ZSTD_versionNumber()) {
        MESSAGE("SKIPPED: the golden was made with zstd " << version << ", this is " << ZSTD_versionNumber());
        return;
    }
    const uint64_t hash = XXH64(once.data(), once.size(), 0);
    CHECK_MESSAGE(hash == expected, fmt::format("the compressed asset is now {:016x}", hash));
}
