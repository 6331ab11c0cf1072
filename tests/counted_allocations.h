#pragma once

#include <cstdint>
#include <cstdlib>
#include <new>

/// Counts every allocation of the program that includes this, in one file.
namespace xgc::test {

inline uint64_t allocations = 0;

/// Not inlined: g++ would see memory of `new` given to `free`.
[[gnu::noinline]] inline void* countedAllocate(size_t bytes) {
    ++allocations;
    if (void* p = std::malloc(bytes ? bytes : 1)) return p;
    std::abort();
}
[[gnu::noinline]] inline void countedRelease(void* p) {
    std::free(p);
}

} // namespace xgc::test

// All forms are replaced: a sanitizer brings each of them.
void* operator new(size_t bytes) {
    return xgc::test::countedAllocate(bytes);
}
void* operator new[](size_t bytes) {
    return xgc::test::countedAllocate(bytes);
}
void* operator new(size_t bytes, const std::nothrow_t&) noexcept {
    return xgc::test::countedAllocate(bytes);
}
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept {
    return xgc::test::countedAllocate(bytes);
}
void operator delete(void* p) noexcept {
    xgc::test::countedRelease(p);
}
void operator delete[](void* p) noexcept {
    xgc::test::countedRelease(p);
}
void operator delete(void* p, size_t) noexcept {
    xgc::test::countedRelease(p);
}
void operator delete[](void* p, size_t) noexcept {
    xgc::test::countedRelease(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
    xgc::test::countedRelease(p);
}
void operator delete[](void* p, const std::nothrow_t&) noexcept {
    xgc::test::countedRelease(p);
}
