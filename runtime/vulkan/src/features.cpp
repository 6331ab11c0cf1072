#include <xgc/vulkan/features.h>

namespace xgc::vulkan {
namespace {

/// Calls `visit(flag, name)` for each feature that the backend needs, until one returns false.
template <typename F, typename Visit>
void eachNeeded(F& features, Visit visit) {
    const bool done = visit(features.core.features.multiDrawIndirect, "multiDrawIndirect") &&
                      visit(features.core.features.drawIndirectFirstInstance, "drawIndirectFirstInstance") &&
                      visit(features.vulkan11.shaderDrawParameters, "shaderDrawParameters") &&
                      visit(features.vulkan12.bufferDeviceAddress, "bufferDeviceAddress") &&
                      visit(features.vulkan12.timelineSemaphore, "timelineSemaphore") &&
                      visit(features.vulkan13.synchronization2, "synchronization2") &&
                      visit(features.vulkan13.dynamicRendering, "dynamicRendering");
    static_cast<void>(done);
}

} // namespace

void requireFeatures(Features& features) {
    eachNeeded(features, [](VkBool32& flag, const char*) { return (flag = VK_TRUE) == VK_TRUE; });
}

const char* missingFeature(const Features& features) {
    const char* missing = nullptr;
    eachNeeded(features, [&](VkBool32 flag, const char* name) {
        if (!flag) missing = name;
        return flag == VK_TRUE;
    });
    return missing;
}

} // namespace xgc::vulkan
