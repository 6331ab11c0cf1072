#pragma once

#include <xgc/asset.h>
#include <xgc/bake/asset_writer.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace xgc::viewer {

/// An .xgc image in memory, opened in place.
struct LoadedFile {
    std::string name;
    bake::AlignedBytes bytes;
    AssetView view;
    bool baked = false; ///< here, from a model
};

/// What `Loader::request` makes where no file is called so.
inline constexpr const char* kBundledNames[] = {"creature", "shaft", "terrain", "temple", "tree"};

struct LoadProgress {
    bool busy = false;
    std::string name;
    std::string stage;
    float fraction = 0;
    size_t waiting = 0; ///< behind it
};

/// Opens .xgc files and bakes models, one after the other, on a thread of its own. All calls are from one thread.
class Loader {
public:
    Loader();
    ~Loader(); ///< cancels what is under way

    /// A file, or the name of a bundled model where no file is called so.
    void request(std::filesystem::path file);
    LoadProgress progress() const;
    /// True while something is under way, waiting or not yet taken.
    bool busy() const;
    /// What is finished, in the order of the requests: a file, or a status that says what is wrong with it.
    struct Result {
        bake::Status status;
        LoadedFile file;
    };
    std::optional<Result> take();
    /// Gives up what is under way and what waits; it comes out of `take` no more.
    void cancel();

private:
    void work();
    Result load(const std::filesystem::path& file);
    bake::Status bakeModel(const std::filesystem::path& model, bake::AlignedBytes& out);
    void show(const char* stage, double fraction);

    mutable std::mutex mutex_; ///< guards everything up to `cancelled_`
    std::condition_variable wake_;
    std::deque<std::filesystem::path> requests_;
    std::deque<Result> results_;
    LoadProgress progress_;
    bool quit_ = false;
    std::atomic<bool> cancelled_ = false;
    std::thread thread_; ///< last: it uses the others
};

} // namespace xgc::viewer
