#pragma once

#include <xgc/vulkan/context.h>

#include <memory>
#include <string>
#include <vector>

namespace xgc::vulkan {

struct HeadlessDeviceDesc {
    /// Installs a debug messenger that keeps every warning and error of the validation layer, where one is loaded.
    bool collectMessages = false;
    const VkAllocationCallbacks* allocation = nullptr;
};

/// An instance, device and graphics queue without a window, for programs that have none of their own: tools, tests,
/// samples. Loads libvulkan at run time, so that a program starts on machines without it. Prefers real GPUs over
/// software. A renderer hands its own objects to ContextDesc instead.
class HeadlessDevice {
public:
    HeadlessDevice();
    ~HeadlessDevice();
    HeadlessDevice(HeadlessDevice&&) noexcept;
    HeadlessDevice& operator=(HeadlessDevice&&) noexcept;

    /// deviceRefused where there is no loader, no driver, or no device with the features of features.h.
    Status create(const HeadlessDeviceDesc& desc = {});

    ContextDesc contextDesc() const;
    VkQueue queue() const;
    const char* name() const;
    /// Messages since creation, in order. Any thread that calls Vulkan may add one.
    std::vector<std::string> messages() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace xgc::vulkan
