#include "pages.h"

#include <xgc/load.h>

#include <fmt/format.h>

#include <algorithm>

namespace xgc::scene_sample {

bake::Status Pages::openTables(const std::filesystem::path& path, File& file) {
    file.in.open(path, std::ios::binary);
    format::FileHeader header{};
    file.in.read(reinterpret_cast<char*>(&header), sizeof header);
    if (!file.in || header.tableBytes > (1u << 30))
        return bake::badInput(fmt::format("{}: not an .xgc file", path.string()));
    std::vector<std::byte> bytes(header.tableBytes);
    file.in.seekg(0);
    file.in.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    file.bytes = bake::alignedCopy(bytes);
    const Status opened = xgc::openTables(file.bytes.span(), file.tables);
    if (!file.in || !opened.ok())
        return bake::badInput(fmt::format("{}: {} (element {})", path.string(), opened.message, opened.element));
    if (file.tables.tierCount() < 2)
        return bake::badInput(fmt::format("{}: has no pages: bake it with --tiers 8", path.string()));
    return {};
}

bake::Status Pages::open(const std::vector<std::filesystem::path>& paths, double share) {
    files_.resize(paths.size());
    ResidencyConfig config;
    config.pageBytes = config.pageRows = 0;
    for (size_t i = 0; i < paths.size(); ++i) {
        const bake::Status status = openTables(paths[i], files_[i]);
        if (!status.ok()) return status;
        const PageLimits limits = pageLimits(files_[i].tables);
        config.pageBytes = std::max(config.pageBytes, limits.bytes);
        config.pageRows = std::max(config.pageRows, limits.rows);
        for (const format::PageRecord& page : files_[i].tables.pages) sceneBytes_ += page.rawBytes;
    }
    config.budgetBytes = uint64_t(share * double(sceneBytes_));
    config.reader = {[](void* user, const PageRequest& r) { static_cast<Pages*>(user)->queue_.push_back(r); }, this};
    Status status = residency_.create(config);
    for (File& file : files_) {
        if (status.ok()) status = residency_.addAsset(file.tables, file.asset);
    }
    if (status.ok()) return {};
    return bake::badInput(fmt::format("--stream: {} ({})", status.message, status.element));
}

bool Pages::readPage(const PageRequest& r) {
    std::ifstream& in = files_[r.asset].in; // assets were added in the order of the files
    stored_.resize(r.storedBytes);
    in.clear();
    in.seekg(std::streamoff(r.offset));
    in.read(reinterpret_cast<char*>(stored_.data()), std::streamsize(stored_.size()));
    return in && decodePage(residency_.view(r.asset), r.page, stored_, r.out).ok();
}

void Pages::read(uint64_t bytes) {
    credit_ = std::min(credit_ + bytes, 4 * bytes);
    while (!queue_.empty() && queue_.front().storedBytes <= std::max(credit_, bytes)) {
        const PageRequest request = queue_.front();
        queue_.pop_front();
        credit_ -= std::min(credit_, request.storedBytes);
        residency_.complete(request.ticket, readPage(request));
    }
}

} // namespace xgc::scene_sample
