#pragma once

#include <xgc/draw_list.h>
#include <xgc/pages.h>

#include <memory>

namespace xgc {

/// A page that a Residency asks its host for.
struct PageRequest {
    uint64_t ticket = 0;                  ///< for Residency::complete
    uint32_t asset = 0;                   ///< the Residency's id
    uint32_t page = 0;                    ///< AssetView::pages
    uint64_t offset = 0, storedBytes = 0; ///< in the file
    std::span<std::byte> out; ///< the page's rawBytes go here (xgc::decodePage, where streams are compressed)
};

/// The host's reader. `read` is called within `update`; it starts a read and returns, or reads at once. Each request is
/// answered once by Residency::complete, in any order, from any thread, whenever it likes; until then `out` is the
/// reader's to write to.
struct PageReader {
    void (*read)(void* user, const PageRequest& request) = nullptr;
    void* user = nullptr;
};

struct ResidencyConfig {
    uint64_t budgetBytes = 64ull << 20; ///< of the pool, which is all that pages take
    uint32_t pageBytes = 128 * 1024;    ///< largest page of the assets (pageLimits)
    uint32_t pageRows = 8192;           ///< most rows of one
    uint32_t pageCapacity = 65536;      ///< sum of the pages of all assets
    uint32_t assetCapacity = 16;
    uint32_t framesInFlight = 2;        ///< memory that was drawn from is reused so many frames later; at least 1
    uint64_t readBytes = 4ull << 20;    ///< most bytes that are being read at once; at least a page
    uint64_t installBytes = 1ull << 20; ///< most bytes that an update checks and installs; at least a page
    uint32_t retries = 4;               ///< a page that fails more often is given up, until `retry`
    uint32_t retryFrames = 8;           ///< to the first retry; twice as many to each further one
    uint32_t patienceFrames = 600;      ///< a read that takes longer is reported, and no more counted in readBytes
    PageReader reader;
};

/// The largest page of an asset: what ResidencyConfig must allow for.
struct PageLimits {
    uint32_t bytes = 0;
    uint32_t rows = 0;
};
PageLimits pageLimits(const AssetView& tables);

/// What went wrong with a page; its status names the remedy.
struct PageError {
    uint32_t asset = 0;
    uint32_t page = 0;
    Status status;
    uint32_t failures = 0;
    bool givenUp = false; ///< it is not asked for any more, until `retry`
};

/// A page that came, for a renderer that keeps rows of its own.
struct InstalledPage {
    uint32_t asset = 0;
    uint32_t page = 0;
    uint32_t firstRow = 0; ///< of the pool's, as index lists name them
    uint32_t rowCount = 0;
};

struct ResidencyStats {
    uint32_t slots = 0; ///< pages that the budget holds
    uint32_t residentPages = 0;
    uint64_t residentBytes = 0;
    uint32_t readingPages = 0;
    uint32_t wantedPages = 0; ///< that are not there
    float worstMissing = 0;   ///< error of what is drawn for want of a page, in multiples of the error asked for
    uint32_t givenUpPages = 0;
    // Since create.
    uint64_t readBytes = 0; ///< stored bytes that were asked for
    uint64_t installs = 0, evictions = 0, failures = 0;
};

/// Streams assets in pages within a budget of bytes: says what to read, installs what comes, evicts, and tells
/// Selections how fine each patch may be meanwhile, so that what is drawn is whole, without a crack, at any moment.
///
/// A frame:
///     want(..)          for each view, what it asks for
///     update()          installs, evicts, asks the reader
///     Selection::update, DrawList::update   of a scene with view(asset): no finer than what is there
///     drawn(..)         for each draw list
/// Before `update` the frame framesInFlight before this one has left the GPU, as for IndexCache::beginFrame.
///
/// The pool is of slots, a page each: its bytes as they come from the reader, read in place. A row's number in index
/// lists is slot * pageRows + its place in the page. Pages of tier 0 are read first and stay; until all are there an
/// asset is not `ready`, and its instances must not be visible. What is wanted most is what errs most on the screen
/// without it; pages that nobody wants go first, then those that matter least. A page that is drawn goes in two steps:
/// first selections must do without it, and when no draw list has it any more, its memory is reused.
///
/// `create` and `addAsset` allocate, nothing else does. One thread at a time, but for `complete`. Starts no threads and
/// reads no files.
class Residency {
public:
    Residency();
    ~Residency();
    Residency(Residency&&) noexcept;
    Residency& operator=(Residency&&) noexcept;

    Status create(const ResidencyConfig& config);
    const ResidencyConfig& config() const;

    /// `tables`: opened by openTables, of several tiers; outlives its id here. On failure nothing changes, and the
    /// status' element is the value that would have sufficed.
    Status addAsset(const AssetView& tables, uint32_t& id);
    /// Nothing draws it any more, nor did in the last framesInFlight frames.
    void removeAsset(uint32_t asset);
    /// For scenes, selections and caches: at one address until the asset is removed. Its rows are the pool's; it has no
    /// positions and vertexStreams (`row` and `bytes` have them).
    const AssetView& view(uint32_t asset) const;
    bool ready(uint32_t asset) const;

    // What a view asks for: the error of each patch within `pixels`.
    void want(uint32_t asset, const Placement& placement, const View& view, float pixels,
              std::span<const uint8_t> visible = {});
    /// Of all instances of a scene: what is out of sight counts a tenth.
    void want(const Scene& scene, const Selection& selection, const SelectionDesc& desc);

    // What is drawn: those pages stay.
    void drawn(uint32_t asset, Levels levels);
    void drawn(const Scene& scene, const DrawList& draws);

    void update();

    /// Answers a request; a ticket that was answered is ignored. Any thread; does not wait.
    void complete(uint64_t ticket, bool ok);
    /// Asks again for pages that were given up.
    void retry(uint32_t asset);

    // Of the latest update.
    std::span<const InstalledPage> installed() const;
    std::span<const PageError> errors() const; ///< the first 64
    ResidencyStats stats() const;

    /// Bytes of a page that is there, its streams as they lie uncompressed; else none.
    std::span<const std::byte> bytes(uint32_t asset, uint32_t page) const;
    /// A stream of its rows, of those of `bytes`; empty where the page is not there or has no such stream.
    std::span<const std::byte> rows(uint32_t asset, uint32_t page, format::StreamKind kind, uint32_t set) const;
    /// An element of a stream of rows; null where the row is not there or has no such stream.
    const std::byte* row(uint32_t asset, format::StreamKind kind, uint32_t set, uint32_t row) const;

    struct Impl; ///< private

private:
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc
