#include <xgc/draw_list.h>
#include <xgc/memory.h>

#include <doctest/doctest.h>

#include <cstdlib>

namespace {

/// Counts what the library holds, and refuses past a limit.
struct Heap {
    size_t held = 0;
    size_t calls = 0;
    size_t limit = SIZE_MAX;

    xgc::Allocator allocator() {
        return {[](void* user, size_t bytes, size_t alignment) -> void* {
                    Heap& heap = *static_cast<Heap*>(user);
                    ++heap.calls;
                    if (bytes > heap.limit - heap.held) return nullptr;
                    heap.held += bytes;
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

TEST_CASE("all memory comes from the host's allocator and goes back to it") {
    Heap heap;
    const Installed installed(heap);
    {
        xgc::DrawList list;
        REQUIRE(list.create({}).ok());
        CHECK(heap.calls > 0);
        CHECK(heap.held > sizeof(uint32_t) * xgc::DrawListConfig{}.patchCapacity);
    }
    CHECK(heap.held == 0);
}

TEST_CASE("a heap that runs dry is a status, and nothing stays behind") {
    Heap full;
    {
        const Installed installed(full);
        xgc::DrawList list;
        REQUIRE(list.create({}).ok());
        full.limit = full.held;
    }
    for (size_t limit = 0; limit < full.limit; limit += full.limit / 13 + 1) {
        Heap heap;
        heap.limit = limit;
        const Installed installed(heap);
        {
            xgc::DrawList list;
            const xgc::Status status = list.create({});
            CHECK(status.code == xgc::StatusCode::outOfCapacity);
        }
        CHECK(heap.held == 0);
    }
}
