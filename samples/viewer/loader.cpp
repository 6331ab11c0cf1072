#include "loader.h"

#include <xgc/bake/bake.h>
#include <xgc/bake/export.h>
#include <xgc/bake/models.h>

#include <fmt/format.h>

#include <random>

namespace xgc::viewer {
namespace {

constexpr uint32_t kBundledFaces = 60000;

std::optional<bake::BundledModel> bundled(const std::string& name) {
    constexpr bake::BundledModel kModels[] = {bake::BundledModel::creature, bake::BundledModel::shaft,
                                              bake::BundledModel::terrain, bake::BundledModel::temple,
                                              bake::BundledModel::tree};
    static_assert(std::size(kModels) == std::size(kBundledNames));
    for (size_t i = 0; i < std::size(kModels); ++i) {
        if (name == kBundledNames[i]) return kModels[i];
    }
    return {};
}

/// A folder of one's own among the system's temporary ones, gone with it.
struct ScratchFolder {
    std::filesystem::path path;

    ScratchFolder() {
        std::random_device random;
        path = std::filesystem::temp_directory_path() / fmt::format("xgc-viewer-{:08x}{:08x}", random(), random());
        std::filesystem::create_directories(path);
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
};

bake::Status open(const std::string& name, const bake::AlignedBytes& bytes, AssetView& view) {
    const Status status = openAll(bytes.span(), view);
    if (status.ok()) return {};
    return bake::badInput(fmt::format("{}: {} (element {})", name, status.message, status.element));
}

} // namespace

Loader::Loader() : thread_([this] { work(); }) {}

Loader::~Loader() {
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
        requests_.clear();
        cancelled_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void Loader::request(std::filesystem::path file) {
    {
        const std::lock_guard lock(mutex_);
        requests_.push_back(std::move(file));
    }
    wake_.notify_all();
}

LoadProgress Loader::progress() const {
    const std::lock_guard lock(mutex_);
    LoadProgress out = progress_;
    out.waiting = requests_.size();
    return out;
}

bool Loader::busy() const {
    const std::lock_guard lock(mutex_);
    return progress_.busy || !requests_.empty() || !results_.empty();
}

std::optional<Loader::Result> Loader::take() {
    const std::lock_guard lock(mutex_);
    if (results_.empty()) return {};
    Result out = std::move(results_.front());
    results_.pop_front();
    return out;
}

void Loader::cancel() {
    const std::lock_guard lock(mutex_);
    requests_.clear();
    results_.clear();
    if (progress_.busy) cancelled_ = true;
}

void Loader::show(const char* stage, double fraction) {
    const std::lock_guard lock(mutex_);
    progress_.stage = stage;
    progress_.fraction = float(fraction);
}

void Loader::work() {
    for (;;) {
        std::filesystem::path file;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return quit_ || !requests_.empty(); });
            if (quit_) return;
            file = std::move(requests_.front());
            requests_.pop_front();
            cancelled_ = false;
            progress_ = {true, file.filename().string(), "open", 0, 0};
        }
        Result result;
        try {
            result = load(file);
        } catch (const std::exception& error) { // the system's: no memory, no temporary folder
            result = {bake::systemError(fmt::format("{}: {}", file.string(), error.what())), {}};
        }
        const std::lock_guard lock(mutex_);
        progress_ = {};
        if (!cancelled_) results_.push_back(std::move(result));
    }
}

Loader::Result Loader::load(const std::filesystem::path& file) {
    Result result;
    LoadedFile& out = result.file;
    out.name = file.filename().string();
    if (file.extension() == ".xgc") {
        result.status = bake::readImage(file, out.bytes);
    } else {
        result.status = bakeModel(file, out.bytes);
        out.baked = true;
    }
    if (result.status.ok()) result.status = open(file.string(), out.bytes, out.view);
    return result;
}

bake::Status Loader::bakeModel(const std::filesystem::path& model, bake::AlignedBytes& out) {
    const ScratchFolder scratch;
    bake::BakeOptions options;
    options.input = model;
    options.output = scratch.path / "baked.xgc";
    options.cancelled = &cancelled_;
    options.progress = [this](const char* stage, double fraction) { show(stage, fraction); };
    const std::optional<bake::BundledModel> made = bundled(model.string());
    if (made && !std::filesystem::exists(model)) {
        show("model", 0);
        options.input = scratch.path / "model.glb";
        const bake::Status written = bake::exportModel(bake::makeModel(*made, kBundledFaces), options.input);
        if (!written.ok()) return written;
    }
    bake::BakeReport report;
    const bake::Status status = bake::bake(options, report);
    return status.ok() ? bake::readImage(options.output, out) : status;
}

} // namespace xgc::viewer
