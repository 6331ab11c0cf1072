#pragma once

#include <cstddef>

namespace xgc {

/// The host's heap. `allocate` returns null where there is no memory; `alignment` is a power of two.
struct Allocator {
    void* (*allocate)(void* user, size_t bytes, size_t alignment) = nullptr;
    void (*free)(void* user, void* memory, size_t bytes, size_t alignment) = nullptr;
    void* user = nullptr;
};

/// Where the runtime takes its memory from: the C++ heap until this is called, and with an empty Allocator again. Call
/// it before the first object of the library is created, and not while any lives.
void setAllocator(const Allocator& allocator);

} // namespace xgc
