#include <xgc/vulkan/functions.h>

namespace xgc::vulkan {

bool loadFunctions(PFN_vkGetInstanceProcAddr getInstanceProcAddr, VkInstance instance, VkDevice device,
                   Functions& out) {
    Functions f;
#define XGC_VULKAN_LOAD(name)                                                                                          \
    f.name = reinterpret_cast<PFN_##name>(getInstanceProcAddr(instance, #name));                                       \
    if (!f.name) return false;
    XGC_VULKAN_INSTANCE_FUNCTIONS(XGC_VULKAN_LOAD)
#undef XGC_VULKAN_LOAD
#define XGC_VULKAN_LOAD(name)                                                                                          \
    f.name = reinterpret_cast<PFN_##name>(f.vkGetDeviceProcAddr(device, #name));                                       \
    if (!f.name) return false;
    XGC_VULKAN_DEVICE_FUNCTIONS(XGC_VULKAN_LOAD)
#undef XGC_VULKAN_LOAD
    out = f;
    return true;
}

} // namespace xgc::vulkan
