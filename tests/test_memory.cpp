#include <xgc/draw_list.h>
#include <xgc/memory.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

namespace {

/// Counts what the library holds, and refuses past a limit.
struct Heap {
    size_t held = 0;
    size_t most = 0; ///< that it held at once
    size_t calls = 0;
    size_t limit = SIZE_MAX;

    xgc::Allocator allocator() {
        return {[](void* user, size_t bytes, size_t alignment) -> void* {
                    Heap& heap = *static_cast<Heap*>(user);
                    ++heap.calls;
                    if (bytes > heap.limit - heap.held) return nullptr;
                    heap.held += bytes;
                    heap.most = std::max(heap.most, heap.held);
                    return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
                },
                [](void* user, void* memory, size_t bytes, size_t) {
                    static_cast<Heap*>(user)->held -= bytes;
                    std::free(memory);
                },
                this};
    }
};

/// While it lives the library takes memory from the heap.
struct Installed {
    explicit Installed(Heap& heap) { xgc::setAllocator(heap.allocator()); }
    ~Installed() { xgc::setAllocator({}); }
};

} // namespace

/// Everything that owns memory; false where a heap runs dry.
bool createAll() {
    xgc::Scene scene;
    xgc::Selection selection;
    xgc::IndexCache cache;
    xgc::DrawList list;
    for (const xgc::Status& status : {scene.create({}), selection.create({}), cache.create({}), list.create({})}) {
        if (!status.ok()) {
            CHECK(status.code == xgc::StatusCode::outOfCapacity);
            return false;
        }
    }
    return true;
}

TEST_CASE("all memory comes from the host's allocator and goes back to it") {
    Heap heap;
    const Installed installed(heap);
    CHECK(createAll());
    CHECK(heap.calls > 10);
    CHECK(heap.most > sizeof(uint32_t) * xgc::SceneConfig{}.patchCapacity);
    CHECK(heap.held == 0);
}

TEST_CASE("a heap that runs dry is a status, and nothing stays behind") {
    size_t enough = 0;
    {
        Heap heap;
        const Installed installed(heap);
        REQUIRE(createAll());
        enough = heap.most;
    }
    for (size_t limit = 0; limit < enough; limit += enough / 40 + 1) {
        Heap heap;
        heap.limit = limit;
        const Installed installed(heap);
        CHECK_FALSE(createAll());
        CHECK(heap.held == 0);
    }
}
