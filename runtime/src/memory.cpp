#include "memory.h"

namespace xgc {
namespace {

Allocator current;

} // namespace

void setAllocator(const Allocator& allocator) {
    current = allocator;
}

void* allocateBytes(size_t bytes, size_t alignment) {
    if (current.allocate) return current.allocate(current.user, bytes, alignment);
    if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator new(bytes, std::nothrow);
    return ::operator new(bytes, std::align_val_t(alignment), std::nothrow);
}

void freeBytes(void* memory, size_t bytes, size_t alignment) {
    if (current.free) return current.free(current.user, memory, bytes, alignment);
    if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) return ::operator delete(memory);
    ::operator delete(memory, std::align_val_t(alignment));
}

} // namespace xgc
