#pragma once

#include <xgc/memory.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

namespace xgc {

/// From the host's allocator; null where there is no memory.
void* allocateBytes(size_t bytes, size_t alignment);
void freeBytes(void* memory, size_t bytes, size_t alignment);

/// Base of what a public class keeps behind its pointer: comes from the host's allocator.
template <typename Derived>
struct Allocated {
    static void* operator new(size_t bytes, const std::nothrow_t&) noexcept {
        return allocateBytes(bytes, alignof(Derived));
    }
    static void operator delete(void* memory, size_t bytes) noexcept {
        if (memory) freeBytes(memory, bytes, alignof(Derived));
    }
    static void operator delete(void* memory, const std::nothrow_t&) noexcept {
        if (memory) freeBytes(memory, sizeof(Derived), alignof(Derived));
    }
};

/// An array that is allocated once and never grows; without exceptions. For types without a destructor of their own.
template <typename T>
class FixedArray {
public:
    static_assert(std::is_trivially_destructible_v<T>);

    FixedArray() = default;
    ~FixedArray() { reset(); }
    FixedArray(const FixedArray&) = delete;
    FixedArray& operator=(const FixedArray&) = delete;

    /// Value-initialised elements; false where there is no memory.
    [[nodiscard]] bool allocate(size_t count) {
        reset();
        if (count == 0) return true;
        if (count > SIZE_MAX / sizeof(T)) return false;
        data_ = static_cast<T*>(allocateBytes(count * sizeof(T), alignof(T)));
        if (!data_) return false;
        size_ = count;
        for (size_t i = 0; i < count; ++i) new (data_ + i) T();
        return true;
    }
    T& operator[](size_t i) { return data_[i]; }
    const T& operator[](size_t i) const { return data_[i]; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    size_t size() const { return size_; }

private:
    void reset() {
        if (data_) freeBytes(data_, size_ * sizeof(T), alignof(T));
        data_ = nullptr;
        size_ = 0;
    }

    T* data_ = nullptr;
    size_t size_ = 0;
};

} // namespace xgc
